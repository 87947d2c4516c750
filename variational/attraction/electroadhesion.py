r"""Electrostatic attraction across the equivalent air gap (Forsbach et al. 2023, Eqs. 3 and 5).

.. math:: p_{el} = \frac{\varepsilon_0 U^2}{2} (h_0 + g)^{-2}, \qquad g = \max(y, d_{eq})

with the current height y. The traction is p_el n per current area, n the outward normal of the deformed skin.
At frozen d_eq it derives from a potential :math:`\phi(y)` with :math:`\phi' = p_{el}` per projected current length
:math:`dx = -e_y \cdot \mathrm{cof} F N \,dS`:

.. math:: \delta \int \phi \,dx = \int \phi' \delta y \,dx + \phi \,d\delta x
          = \int p_{el} (\delta y \,dx - \delta x \,dy) = -\int p_{el}\, n \cdot \delta u \,da

up to :math:`[\phi \,\delta x]` at the ends of the skin. The weak form takes the left side: its tangent is symmetric,
and its horizontal resultant is zero to roundoff on any mesh, as it must be over a screen that looks the same
everywhere. So each end of the skin bears the force :math:`\phi` (N/m) outward, that of the field on what follows: over
a vertical side from there up, :math:`\int p_{el} \,dy = \phi`. The skin of a finger ends where the potential has all
but vanished with the height. A block's foot ends on the screen, with some 0.1 N/m at 200 V. With d_eq(p_c) there is no
potential; the coupling of the scales keeps d_eq frozen in each solve.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from variational.attraction.dielectric import VACUUM_PERMITTIVITY
from variational.coefficients import ufl


def attraction(y, d_eq, voltage, h_0):
    """Return the electrostatic pressure p_el (Pa of current area).

    Args:
        y: current height above the screen (m).
        d_eq: equivalent air gap of the ridge (m).
        voltage: instantaneous voltage U (V).
        h_0: effective insulator thickness (m).
    """
    g = ufl.conditional(ufl.gt(y, d_eq), y, d_eq)
    return VACUUM_PERMITTIVITY * voltage**2 / 2 / (h_0 + g) ** 2


def potential(y, d_eq, voltage, h_0):
    """Return the potential of the attraction (N/m per current dx) at frozen d_eq."""
    half = VACUUM_PERMITTIVITY * voltage**2 / 2
    outside = -half / (h_0 + y)
    inside = -half / (h_0 + d_eq) - half / (h_0 + d_eq) ** 2 * (d_eq - y)
    return ufl.conditional(ufl.gt(y, d_eq), outside, inside)


@dataclass(frozen=True)
class Attraction:
    """A law of attraction and its potential, UFL functions of (y, d_eq, voltage, h_0)."""

    pressure: Callable[[Any, Any, Any, Any], Any]
    """As :func:`attraction` (Pa of current area)."""
    potential: Callable[[Any, Any, Any, Any], Any]
    """As :func:`potential` (N/m per current dx): its derivative by y is the pressure."""


ELECTROSTATIC = Attraction(attraction, potential)
