r"""How many triangles a finger's mesh will have, from its sizes and geometry alone: no mesher, some milliseconds.

A mesh whose element size is h has :math:`4 / \sqrt3 \int h^{-2} dA` equilateral triangles. h grows linearly with the
distance d from what is fine (:mod:`geometry.fingertip`), so that each part needs no more than the length of skin, or of
junctions, that is at that distance:

- the wavy curves, with the area on either side of each of them shared out until a layer is used up, and below them
  everything else to the bone and the nail;
- about the crests that can touch, and about the tips below the Merkel sites, what smaller elements there add to that.

Curvature and the shape of bone and nail are left out. Against 21 meshes of 2600 to 120 000 triangles it is right within
a factor of 1.5 (``tests/test_count.py`` has some of them).
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from geometry.parameters import Fingertip, MeshSize
from geometry.profiles import Profiles
from geometry.sizing import growth_from_tips, touching_ridges

Array = NDArray[np.float64]
_EQUILATERAL = 4 / np.sqrt(3)  # triangles with edges of length 1 in an area of 1
_LEVELS = 600  # distances at which a part is sampled
_GRADED = 1.3  # by how much more than 1 the triangles are more where their size grows, over the growth; from 21 meshes
_SMALLEST = 1e-3  # first of them over the smallest element


def triangles(finger: Fingertip, size: MeshSize, receptors: bool = True, half: bool = False) -> float:
    """Return about how many triangles :func:`geometry.fingertip.build` makes of the same arguments.

    Raises:
        GeometryError: it was not decided how many ridges can touch.
    """
    profiles = Profiles(finger)
    touching = len(touching_ridges(finger, size))
    every = _skin(profiles, size) + _crests(profiles, size, touching)
    if receptors:
        every += touching * _site(profiles, size)
    return float(every / 2 if half else every)


def _area(finger: Fingertip) -> float:
    """Return the area of the section (m^2)."""
    return float(np.pi / 4 * (finger.width * finger.height - finger.bone_width * finger.bone_height))


def _lengths(profiles: Profiles) -> tuple[float, float]:
    """Return the lengths (m) of the skin, or the junction parallel to it, and of the VE-D junction over a ridge."""
    s = np.linspace(0, profiles.finger.ridge_wavelength, 257)
    skin, ve_d = (float(np.hypot(np.diff(s), np.diff(depth)).sum()) for depth in (profiles.skin(s), profiles.ve_d(s)))
    return skin, ve_d


def _graded(smallest: float, distance: Array, size: MeshSize) -> Array:
    """Return the size (m) of triangles at distances (m) from where it is smallest.

    The mesher makes a triangle as small as its smaller end is to be.
    """
    return np.minimum((smallest + size.growth * distance) / np.sqrt(1 + _GRADED * size.growth), size.coarsest)


def _integral(width: Callable[[Array], Array], size: Callable[[Array], Array], far: float, first: float) -> float:
    """Return the triangles up to a distance (m), of a width (m) and of element sizes (m) by distance."""
    distance = np.concatenate([[0.0], np.geomspace(min(_SMALLEST * first, far / 2), far, _LEVELS)])
    return float(_EQUILATERAL * np.trapezoid(width(distance) / size(distance) ** 2, distance))


def _skin(profiles: Profiles, size: MeshSize) -> float:
    """Return the triangles that there are without the crests' and the sites'."""
    f = profiles.finger
    period, count = f.ridge_wavelength, f.ridge_count
    skin, ve_d = _lengths(profiles)
    smallest = min(size.interface, period / 2)  # no curve is coarser than its own pieces

    def graded(distance: Array) -> Array:
        return _graded(smallest, distance, size)

    found = 0.0
    for thickness, length in ((f.sc_thickness, 2 * skin), (f.ve_thickness, skin + ve_d)):
        far = period * thickness / length  # where the area between the two curves is used up
        found += count * _integral(lambda d, length=length: np.full_like(d, length), graded, far, smallest)  # type: ignore[misc]
    layers = count * period * (f.sc_thickness + f.ve_thickness)
    below, across = max(_area(f) - layers, 0.0), count * period
    far = (np.sqrt(across**2 + 2 * np.pi * below) - across) / np.pi  # of across far + pi far^2 / 2 = below
    extra = count * (ve_d - period)  # of the papillae's flanks, over their height
    reach = (f.intermediate_ridge_height + f.limiting_ridge_height) / 8
    return found + _integral(lambda d: across + np.pi * d + extra * np.exp(-d / reach), graded, float(far), smallest)


def _without_crests(profiles: Profiles, size: MeshSize, depth: Array) -> Array:
    """Return the element size (m) at depths below the skin (m), which the wavy curves ask for."""
    f = profiles.finger
    skin, ve_d = _lengths(profiles)
    layers = f.sc_thickness + f.ve_thickness
    in_epidermis = f.ridge_wavelength * f.ve_thickness / (skin + ve_d) / 2
    distance = np.where(
        depth < f.sc_thickness,
        np.minimum(depth, f.sc_thickness - depth),
        np.where(depth < layers, in_epidermis, depth - layers),
    )
    return _graded(min(size.interface, f.ridge_wavelength / 2), distance, size)


def _crests(profiles: Profiles, size: MeshSize, touching: int) -> float:
    """Return what the crests that can touch add."""
    f = profiles.finger
    period = f.ridge_wavelength
    parts = len({round(s / period, 6) % 1 for s in profiles.crests})  # the two in the grooves are one
    wide = min(parts * size.touching_fraction, 1.0) * period

    def width(distance: Array) -> Array:
        each = np.minimum(wide + parts * np.pi * distance, period)
        return np.asarray(touching * each + np.pi * np.maximum(distance - period / 2, 0))

    def more(distance: Array) -> Array:
        fine = _graded(size.contact, distance, size)
        other = _without_crests(profiles, size, distance)
        return np.asarray(1 / np.sqrt(np.maximum(1 / fine**2 - 1 / other**2, 1e-300)))

    return _integral(width, more, min(f.width, f.height) / 2, size.contact)


def _site(profiles: Profiles, size: MeshSize) -> float:
    """Return what the tip below one Merkel site adds."""
    f = profiles.finger
    depth = float(profiles.ve_d(0.0)) - float(profiles.skin(0.0))
    other = float(_without_crests(profiles, size, np.array([f.sc_thickness + f.ve_thickness / 2]))[0])
    other = min(other, float(_graded(size.contact, np.array(depth), size)))
    steep = size.model_copy(update={"growth": growth_from_tips(size)})
    far = (other * np.sqrt(1 + _GRADED * steep.growth) - size.receptor) / steep.growth
    if far <= 0:
        return 0.0

    def more(distance: Array) -> Array:
        fine = _graded(size.receptor, distance, steep)
        return np.asarray(1 / np.sqrt(np.maximum(fine**-2 - other**-2, 1e-300)))

    return _integral(lambda r: 2 * np.pi * r, more, far, size.receptor)
