"""Whether a finger can be meshed with the sizes given, which ridges get fine elements, and how many; without gmsh."""

import math

import numpy as np
import scipy  # its parts are imported where they are used first: to read a scene needs none
from numpy.typing import NDArray

from geometry.parameters import Fingertip, MeshSize
from geometry.profiles import GeometryError, Profiles

Array = NDArray[np.float64]
_MIN_RIDGES = 3  # of a finger
_CLEAR = 1e-7  # m, between two layers, several times what their samples may miss
_APART = 1e-6  # m, between points that the mesh has where the nail begins
_TURN = 2.0  # rad, by which the skin turns along a facet at most: a parabola of more is another shape
_SAMPLES = 512  # points along a ridge at which its curvature is found; the shortest of 16 waves has 32
FROM_EDGES = 0.5
"""Growth of the element size from where contact ends."""
_FASTER = 2.0  # growth from a tip over that elsewhere; at 4 the densities of the default finger are 4 % off


def growth_from_tips(size: MeshSize) -> float:
    """Return the increase of the element size per distance from the tips of the intermediate ridges.

    The strain varies over a length that grows with this distance, and so may the elements.
    """
    return min(_FASTER * size.growth, 1.0)


def touching_ridges(finger: Fingertip, size: MeshSize) -> range:
    """Return the numbers of the ridges that are meshed finely enough to touch the screen.

    Raises:
        GeometryError: it was not decided how many.
    """
    if size.touching_half_arc is None:
        raise GeometryError("touching_half_arc is not given; it must be a length, or be decided by a run")
    last = int(size.touching_half_arc / finger.ridge_wavelength + 0.5)
    last = min(last, (finger.ridge_count - 1) // 2)
    return range(-last, last + 1)


def check(finger: Fingertip, size: MeshSize) -> Profiles:
    """Return the fingertip's curves if they and the sizes can be meshed.

    Raises:
        GeometryError: see :func:`check_shape`; or elements too large for a ridge or for the curvature of its skin.
    """
    profiles = Profiles(finger)
    check_shape(profiles)
    if size.contact > finger.ridge_wavelength / 4:
        raise GeometryError(
            f"contact size {size.contact:g} m is too large for a ridge of {finger.ridge_wavelength:g} m: "
            f"at most a quarter of it, {finger.ridge_wavelength / 4:g} m"
        )
    radius = _least_radius(profiles, size)
    if size.contact > _TURN * radius:
        raise GeometryError(
            f"contact size {size.contact:g} m is too large for skin that has a radius of curvature of {radius:.3g} m "
            f"where it can touch, by ridge_profile and ridge_amplitude: at most {_rounded_down(_TURN * radius):g} m"
        )
    return profiles


def _least_radius(profiles: Profiles, size: MeshSize) -> float:
    """Return the least radius of curvature (m) of the skin where it can touch."""
    arcs = profiles.touching_arcs(size.touching_fraction, profiles.finger.ridge_wavelength / _SAMPLES)
    return float(profiles.radius(arcs).min())


def coarser(finger: Fingertip, size: MeshSize, factor: float) -> MeshSize:
    """Return element sizes times a factor, as far as the ridges can have them."""
    largest = min(finger.ridge_wavelength / 4, _TURN * _least_radius(Profiles(finger), size))
    coarse = size.scaled(factor)
    return coarse.model_copy(update={"contact": max(size.contact, min(coarse.contact, largest))})


def least_triangles(finger: Fingertip, size: MeshSize, receptors: bool = True, half: bool = False) -> float:
    r"""Return a lower bound of the triangles of a mesh, from areas and element sizes alone, without gmsh.

    Triangles with edges of length h fill an area dA with :math:`4 / \sqrt3 \, h^{-2} dA` of them. The layers are laid
    flat: h grows from the crests that can touch, from the wavy junctions and from the tips.

    Args:
        finger: a shape that was checked.
        size: element sizes, with a ``touching_half_arc``.
        receptors: whether the tips below the Merkel sites are meshed finely.
        half: whether the half at x >= 0 is meshed alone.
    """

    def column(thickness: float, below: float, above: float) -> float:
        """Return the integral of 1 / h^2 over a thickness (m), with sizes (m) at either end; 1/m."""
        d = thickness * np.concatenate([[0.0], np.geomspace(1e-9, 1.0, 400)])
        h = np.minimum.reduce([below + size.growth * d, above + size.growth * (thickness - d), 0 * d + largest])
        return float(np.trapezoid(h**-2, d))

    across = float(np.hypot(finger.width, finger.height))  # no point is farther from what is fine
    largest = min(size.coarsest, size.contact + size.growth * across)
    if receptors:
        largest = min(largest, size.receptor + growth_from_tips(size) * across)
    profiles, period = Profiles(finger), finger.ridge_wavelength
    width, fine = finger.ridge_count * period, size.interface
    crests = len({round(s / period, 6) % 1 for s in profiles.crests})  # the two in the grooves are one
    touching = len(touching_ridges(finger, size)) * min(crests * size.touching_fraction, 1.0) * period
    below = np.pi / 4 * (finger.width * finger.height - finger.bone_width * finger.bone_height)
    below -= width * (finger.sc_thickness + finger.ve_thickness)
    found = touching * column(finger.sc_thickness, size.contact, fine)
    found += max(width - touching, 0.0) * column(finger.sc_thickness, fine, fine)
    found += width * column(finger.ve_thickness, fine, fine)
    found += width * column(max(float(below) / width, 0.0), fine, np.inf)
    if receptors and size.receptor < fine:
        slope = growth_from_tips(size)
        far = min((fine - size.receptor) / slope, finger.ve_thickness / 2)  # of a disc in which h = receptor + slope r
        ratio = slope * far / size.receptor
        disc = 2 * np.pi / slope**2 * (np.log1p(ratio) - ratio / (1 + ratio))
        found += len(touching_ridges(finger, size)) * max(disc - np.pi * far**2 / fine**2, 0.0)
    return float(4 / np.sqrt(3) * found / (2 if half else 1))


def check_shape(profiles: Profiles) -> None:
    """Refuse a set of parameters that describes no fingertip.

    Raises:
        GeometryError: layers touch or cross, the ridges do not fit, or the bone is not inside the
            subcutaneous tissue; the message names the parameters.
    """
    f = profiles.finger
    if profiles.ridged_arc + f.ridge_wavelength > profiles.nail_arc:
        most = int(2 * profiles.nail_arc / f.ridge_wavelength - 2)
        most -= 1 - most % 2
        largest = _rounded_down(2 * profiles.nail_arc / (_MIN_RIDGES + 2))
        few = f"{_MIN_RIDGES} do where ridge_wavelength is {largest:g} m or less"
        raise GeometryError(
            f"ridge_count {f.ridge_count} of ridge_wavelength {f.ridge_wavelength:g} m do not fit between "
            f"the nail's edges; {f'at most {most} do' if most >= _MIN_RIDGES else few}"
        )
    if f.ridge_count < _MIN_RIDGES:
        raise GeometryError(
            f"ridge_count is {f.ridge_count}; a whole finger has {_MIN_RIDGES} ridges at least, since the last one on "
            "either side must not touch"
        )
    ridges = profiles.ridged_arc + f.ridge_wavelength  # the flanks outside go over into the smooth skin
    half = np.union1d(np.linspace(0, ridges, 64 * (f.ridge_count + 2) + 1), np.linspace(0, profiles.nail_arc, 1001))
    s = np.concatenate([-half[:0:-1], half])
    curves = [("skin", profiles.skin), ("SC-VE junction", profiles.sc_ve)]
    curves += [("VE-D junction", profiles.ve_d), ("D-subcutis junction", profiles.d_sub)]
    thickness = ["sc_thickness", "ve_thickness", "dermis_thickness"]
    for (upper, above), (lower, below), name in zip(curves, curves[1:], thickness, strict=False):
        gap = float((below(s) - above(s)).min())
        if gap < _CLEAR:
            how = f"cross by {-gap:.3g} m" if gap <= 0 else f"are {gap:.2g} m apart"
            raise GeometryError(
                f"{upper} and {lower} {how}; {name} is {getattr(f, name):g} m and must exceed "
                f"{getattr(f, name) - gap + _CLEAR:.4g} m"
            )
    a, b = f.width / 2, f.height / 2
    sharpest = min(a**2 / b, b**2 / a)
    if float(profiles.d_sub(0.0)) >= sharpest:
        raise GeometryError(
            f"the skin layers are {float(profiles.d_sub(0.0)):.3g} m deep, more than the outline's radius of "
            f"curvature, {sharpest:.3g} m: reduce dermis_thickness or make width and height more alike"
        )
    _check_sites(profiles)
    _check_bone(profiles)
    _check_edge(profiles)


def _check_sites(profiles: Profiles) -> None:
    """Refuse receptor sites that are not in their layers."""
    f = profiles.finger
    tip = float(profiles.ve_d(0.0))
    top = float(profiles.ve_d(f.ridge_wavelength / 4))
    thickness = tip - float(profiles.sc_ve(0.0))
    if f.merkel_offset >= thickness:
        raise GeometryError(
            f"merkel_offset is {f.merkel_offset:g} m; it must be below the thickness of the viable epidermis at "
            f"the tips of its ridges, {thickness:.4g} m"
        )
    depth = float(profiles.d_sub(0.0)) - top
    if f.meissner_offset >= depth:
        raise GeometryError(
            f"meissner_offset is {f.meissner_offset:g} m; it must be below the height of the papillae above the "
            f"subcutis, {depth:.4g} m"
        )


def _check_bone(profiles: Profiles) -> None:
    f = profiles.finger
    rim = profiles.bone(np.linspace(-np.pi, np.pi, 721))
    s = np.linspace(-profiles.nail_arc, profiles.nail_arc, 2001)
    nearest, distance = _signed_distance(
        rim, profiles.point(s, profiles.d_sub(s)), profiles.point(s, profiles.d_sub(s) + 1e-6)
    )
    between_ends = (nearest > 0) & (nearest < len(s) - 1)
    touching = between_ends & (distance <= 0)
    if touching.any():
        x, y = rim[np.flatnonzero(touching)[0]]
        raise GeometryError(
            f"the bone touches the skin's layers at x = {x:.3g} m, y = {y:.3g} m: change bone_width "
            f"({f.bone_width:g} m), bone_height ({f.bone_height:g} m) or bone_centre ({f.bone_centre:g} m)"
        )
    s = np.linspace(profiles.nail_arc, profiles.half_perimeter, 501)
    nearest, distance = _signed_distance(
        rim[rim[:, 0] >= 0], profiles.point(s, f.nail_thickness), profiles.point(s, f.nail_thickness + 1e-6)
    )
    if distance.min() <= 0:
        raise GeometryError(
            f"the bone reaches the nail: its top, bone_centre + bone_height / 2, is at {rim[:, 1].max():.4g} m "
            f"and must stay below the nail's inner face at {f.height - f.nail_thickness:.4g} m"
        )


def _check_edge(profiles: Profiles) -> None:
    """Refuse layers that do not get from the nail's edge to the bone."""
    f, end = profiles.finger, profiles.nail_arc
    foot = profiles.bone(np.pi - np.arcsin(2 * f.nail_bed_half_width / f.bone_width))
    start = profiles.point(end, profiles.d_sub(end))
    line = start + np.linspace(0, 0.99, 100)[:, None] * (foot - start)
    inside = (2 * line[:, 0] / f.bone_width) ** 2 + (2 * (line[:, 1] - f.bone_centre) / f.bone_height) ** 2 < 1
    if inside.any() or (line[:, 0] <= 0).any():
        raise GeometryError(
            "the skin's layers end inside the bone at the nail's edge: reduce dermis_thickness "
            f"({f.dermis_thickness:g} m) or bone_width ({f.bone_width:g} m), or change nail_half_width "
            f"({f.nail_half_width:g} m) or nail_bed_half_width ({f.nail_bed_half_width:g} m)"
        )
    skin = float(profiles.skin(end))
    if f.nail_thickness < skin + _APART:
        raise GeometryError(
            f"nail_thickness is {f.nail_thickness:g} m, and the skin's mean line at the nail's edge is {skin:.4g} m "
            f"deep, by ridge_amplitude; the nail must be {-_rounded_down(-skin - _APART):g} m thick or more"
        )
    for name, depth in (("SC-VE", profiles.sc_ve(end)), ("VE-D", profiles.ve_d(end))):
        if abs(float(depth) - f.nail_thickness) < _APART:
            raise GeometryError(
                f"nail_thickness is {f.nail_thickness:g} m, the depth of the {name} junction at the nail's edge; "
                f"it must differ by {_APART:g} m or more"
            )


def _rounded_down(value: float) -> float:
    """Return the largest number of three digits that is no larger, so that a limit in a message can be followed."""
    unit = 10.0 ** (math.floor(math.log10(abs(value))) - 2)
    return math.floor(value / unit + 1e-9) * unit


def _signed_distance(points: Array, curve: Array, inward: Array) -> tuple[NDArray[np.intp], Array]:
    """Return the index of the nearest curve point and the distance, positive on the side of ``inward``."""
    distance, nearest = scipy.spatial.cKDTree(curve).query(points)
    side = ((points - curve[nearest]) * (inward - curve)[nearest]).sum(axis=-1)
    return nearest, np.sign(side) * distance
