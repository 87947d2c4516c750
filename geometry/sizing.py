"""Whether a fingertip can be meshed with the sizes given, and which ridges get fine elements; without gmsh."""

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
