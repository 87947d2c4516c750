r"""Rough contact whose attraction deforms: the self-consistent variant of boundary elements.

The attraction of Eq. 3 acts on each point across its own gap g, :math:`a = \varepsilon_0 U^2 / 2 (h_0 + g)^2`, in
contact with g = 0 where the field acts there. It pulls the surface as the contact pressure pushes it:

.. math:: \langle p \rangle = p_{ext} + \langle a \rangle, \qquad \hat u = \frac{2}{E^* |\mathbf q|} (\hat p - \hat a).

Gap and attraction are iterated until their means agree, by a part of the way each time. Where the field does not act
in contact, points at its edge go on changing sides: an attraction that is largest just beside the contact and zero in
it has no state of rest there. In contact attraction and its share of the pressure balance each other on the spot, and
deform nothing. The closures take the whole contact pressure as the load that deforms, and no attraction (Derjaguin,
Muller and Toporov); both are the same where the attraction is weak.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from variational.attraction.electroadhesion import VACUUM_PERMITTIVITY
from variational.roughness.halfspace import NoContactError, press
from variational.roughness.topography import HeightMap

Array = NDArray[np.float64]
_TOLERANCE = 3e-3
_IN_A_ROW = 3  # iterations within it
_PART = 0.5
_ITERATIONS = 150


class Adhered(NamedTuple):
    """A charged rough surface on a rigid plane."""

    p_c: float
    """Mean contact pressure (Pa)."""
    attraction: float
    """Mean attraction (Pa)."""
    fraction: float
    """Part of the area in contact."""
    gap: float
    """Mean gap (m)."""


def attraction_of(gap: Array, touching: NDArray[np.bool_], voltage: float, h_0: float, in_contact: bool) -> Array:
    """Return the attraction (Pa) across gaps (m)."""
    found = VACUUM_PERMITTIVITY * voltage**2 / 2 / (h_0 + gap) ** 2
    return np.asarray(found if in_contact else np.where(touching, 0.0, found))


def pressed(
    surface: HeightMap,
    p_ext: float,
    modulus: float,
    h_0: float,
    voltage: float,
    in_contact: bool,
    deforms: bool,
    tolerance: float = _TOLERANCE,
) -> Adhered:
    """Return the state of a surface under an external pressure and a voltage.

    Args:
        surface: periodic heights (m).
        p_ext: external pressure (Pa), greater than 0.
        modulus: E* (Pa).
        h_0: effective insulator thickness (m).
        voltage: (V).
        in_contact: whether the field acts where the surfaces touch.
        deforms: whether the attraction deforms the surface.
        tolerance: part of the mean attraction that the gaps may still change.

    Raises:
        NoContactError: the iteration does not settle; the surface jumps into contact.
    """
    a, start, settled = np.zeros_like(surface.heights), None, 0
    for _ in range(_ITERATIONS):
        found = press(surface, p_ext + float(a.mean()), modulus, start, attraction=a if deforms else None)
        touching, start = found.pressure > 0, found.pressure
        new = attraction_of(found.gap, touching, voltage, h_0, in_contact)
        settled = settled + 1 if abs(float((new - a).mean())) <= tolerance * float(new.mean()) else 0
        if settled == _IN_A_ROW:
            return Adhered(float(found.pressure.mean()), float(new.mean()), found.fraction, float(found.gap.mean()))
        a = a + _PART * (new - a)
    raise NoContactError(f"attraction and gaps do not settle at {p_ext:g} Pa and {voltage:g} V")
