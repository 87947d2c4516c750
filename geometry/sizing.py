"""Whether a finger can be meshed with the sizes given, which ridges get fine elements, and how many; without gmsh."""

import numpy as np

from geometry import refusals
from geometry.parameters import Fingertip, MeshSize
from geometry.profiles import GeometryError, Profiles

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
        GeometryError: see :func:`geometry.refusals.check`; or elements too large for a ridge.
    """
    profiles = Profiles(finger)
    refusals.check(profiles)
    if size.contact > finger.ridge_wavelength / 4:
        raise GeometryError(
            f"contact size {size.contact:g} m is too large for a ridge of {finger.ridge_wavelength:g} m: "
            f"at most a quarter of it, {finger.ridge_wavelength / 4:g} m"
        )
    return profiles


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
