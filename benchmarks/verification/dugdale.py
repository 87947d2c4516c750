r"""A constant attraction of finite range, and Maugis's solution for a cylinder under it.

The law (Dugdale's; Forsbach et al. 2023, Eq. 10) has the strength and the work of adhesion of the electrostatic
attraction without an air gap, :math:`w = \sigma_0 h_0`: :math:`p_{el} = \sigma_0 = \varepsilon_0 U^2 / (2 h_0^2)` at
y < h_0 and 0 above. A traction that jumps has no tangent, so it falls linearly between :math:`(1 \mp \delta) h_0`.

A cylinder of radius R on a plane, in contact for |x| < a and attracted for |x| < c (Johnson and Greenwood 2008,
doi 10.1088/0022-3727/41/15/155315; Baney and Hui 1997, J. Adhesion Sci. Technol. 11, 393), m = c / a:

.. math:: f = \frac{\pi E^* a^2}{4 R} - 2 \sigma_0 a \sqrt{m^2 - 1}, \qquad
          h_0 = \frac{a^2}{2R} \left( m \sqrt{m^2 - 1} - \operatorname{arcosh} m \right)
          + \frac{4 \sigma_0 a}{\pi E^*} \left( \sqrt{m^2 - 1} \operatorname{arcosh} m - m \ln m \right).
"""

import numpy as np
import ufl
from scipy.optimize import brentq

from variational.attraction.electroadhesion import Attraction
from variational.attraction.insulator import VACUUM_PERMITTIVITY


def constant_attraction(ramp: float) -> Attraction:
    """Return the law; ``ramp`` is delta, half the width of its fall over its range."""

    def strength(voltage, h_0):
        return VACUUM_PERMITTIVITY * voltage**2 / (2 * h_0**2)

    def pressure(y, d_eq, voltage, h_0):
        part = ((1 + ramp) * h_0 - y) / (2 * ramp * h_0)
        return strength(voltage, h_0) * ufl.max_value(0.0, ufl.min_value(1.0, part))

    def potential(y, d_eq, voltage, h_0):
        left = (1 + ramp) * h_0 - y
        falling = ufl.conditional(ufl.gt(left, 0.0), left**2 / (4 * ramp * h_0), 0.0)
        return -strength(voltage, h_0) * ufl.conditional(ufl.gt(left, 2 * ramp * h_0), h_0 - y, falling)

    return Attraction(pressure, potential)


def ratio(a: float, radius: float, e_star: float, sigma_0: float, h_0: float) -> float:
    """Return m = c / a for a half-width (m), a radius (m), E* (Pa), a strength (Pa) and a range (m)."""

    def excess(m: float) -> float:
        s, angle = np.sqrt(m**2 - 1), np.arccosh(m)
        hertz = a**2 / (2 * radius) * (m * s - angle)
        return float(hertz + 4 * sigma_0 * a / (np.pi * e_star) * (s * angle - m * np.log(m)) - h_0)

    return float(brentq(excess, 1.0, 1e6, xtol=1e-13, rtol=1e-14))


def force(a: float, radius: float, e_star: float, sigma_0: float, h_0: float) -> float:
    """Return f (N/m), positive when pressed; arguments as for :func:`ratio`."""
    m = ratio(a, radius, e_star, sigma_0, h_0)
    return float(np.pi * e_star * a**2 / (4 * radius) - 2 * sigma_0 * a * np.sqrt(m**2 - 1))
