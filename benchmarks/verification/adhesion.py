r"""Attraction: adhesive contact of a cylinder.

The law (Dugdale's; Forsbach et al. 2023, Eq. 10) has the strength and the work of adhesion of the electrostatic
attraction without an air gap, :math:`w = \sigma_0 h_0`: :math:`p_{el} = \sigma_0 = \varepsilon_0 U^2 / (2 h_0^2)` at
y < h_0 and 0 above. A traction that jumps has no tangent, so it falls linearly between :math:`(1 \mp \delta) h_0`.

A cylinder of radius R on a plane, in contact for |x| < a and attracted for |x| < c (Johnson and Greenwood 2008,
doi 10.1088/0022-3727/41/15/155315; Baney and Hui 1997, J. Adhesion Sci. Technol. 11, 393), m = c / a:

.. math:: f = \frac{\pi E^* a^2}{4 R} - 2 \sigma_0 a \sqrt{m^2 - 1}, \qquad
          h_0 = \frac{a^2}{2R} \left( m \sqrt{m^2 - 1} - \operatorname{arcosh} m \right)
          + \frac{4 \sigma_0 a}{\pi E^*} \left( \sqrt{m^2 - 1} \operatorname{arcosh} m - m \ln m \right).
"""

from functools import partial

import numpy as np
import ufl
from scipy.optimize import brentq, minimize_scalar

from benchmarks.verification.bodies import formulations, over_screen
from benchmarks.verification.case import Case, Row
from geometry.bodies import pad
from variational.attraction.dielectric import VACUUM_PERMITTIVITY
from variational.attraction.electroadhesion import Attraction
from variational.contact.interface import Interface
from variational.materials.saint_venant import SaintVenant
from variational.solvers.continuation import Target


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


def maugis_ratio(a: float, radius: float, e_star: float, sigma_0: float, h_0: float) -> float:
    """Return m = c / a for a half-width (m), a radius (m), E* (Pa), a strength (Pa) and a range (m)."""

    def excess(m: float) -> float:
        s, angle = np.sqrt(m**2 - 1), np.arccosh(m)
        hertz = a**2 / (2 * radius) * (m * s - angle)
        return float(hertz + 4 * sigma_0 * a / (np.pi * e_star) * (s * angle - m * np.log(m)) - h_0)

    return float(brentq(excess, 1.0, 1e6, xtol=1e-13, rtol=1e-14))


def maugis_force(a: float, radius: float, e_star: float, sigma_0: float, h_0: float) -> float:
    """Return f (N/m), positive when pressed; arguments as for :func:`maugis_ratio`."""
    m = maugis_ratio(a, radius, e_star, sigma_0, h_0)
    return float(np.pi * e_star * a**2 / (4 * radius) - 2 * sigma_0 * a * np.sqrt(m**2 - 1))


def maugis(small: bool) -> list[Row]:
    """Press a cylinder, charge it and pull it off; half-width over force, and the largest pull."""
    young, nu, radius, unit = 1e6, 0.3, 0.1, 0.2e-3  # unit = (w R^2 / E*)^(1/3)
    e_star = young / (1 - nu**2)
    work = unit**3 * e_star / radius**2
    sigma_0 = (e_star**2 * work / radius) ** (1 / 3)  # Maugis's parameter is 1, between Hertz's and Griffith's limits
    h_0 = work / sigma_0
    load = partial(maugis_force, radius=radius, e_star=e_star, sigma_0=sigma_0, h_0=h_0)
    pull_off = minimize_scalar(load, bounds=(0.1 * unit, 2 * unit), method="bounded", options={"xatol": 1e-9 * unit})

    part = 8 if small else 40
    formulation = formulations(young / (unit / part), 1e-11)["penalty"]
    interface = Interface(formulation, 0.0, h_0, constant_attraction(0.2))
    build, scale = pad(unit / part, 4 * part, radius, 200 * unit), e_star * unit**2 / radius
    run = over_screen(build, SaintVenant(young, nu), interface, scale, touch_depth=0.5e-6, step_scale=2.0)
    run.run(Target("press", bone_height=-0.5e-6))
    run.run(Target("charge", voltage=float(np.sqrt(2 * sigma_0 * h_0**2 / VACUUM_PERMITTIVITY))))
    mesh = f"P2, facets of {unit / part * 1e6:g} um"
    asked = 0.01, "asked for; the edge of the contact settles in facets of up to 1 % of it"
    tolerance, why = (0.04, "a quarter of a facet, of up to 13 %, in which the edge settles") if small else asked
    rows, forces = [], []
    for height in (0.0, 1e-6, 2e-6) if small else (0.0, 0.5e-6, 1e-6, 1.5e-6, 2e-6, 2.3e-6, 2.5e-6):
        run.run(Target("lift", bone_height=height))
        a = float(run.observer.ridge_loads(run.surface_state).length[0]) / 2
        f = float(run.solver.reaction[1])
        forces.append(f)
        if f > 0.99 * pull_off.fun:  # nearer to pull-off the force hardly determines the half-width
            exact = brentq(lambda x, f=f: load(x) - f, pull_off.x, 10 * unit)
            rows.append(Row(f"half-width at f = {f:.3f} N/m (m)", a, exact, tolerance, why, mesh))
    if not small:
        rows.append(Row("pull-off force (N/m)", min(forces), float(pull_off.fun), tolerance, "asked for", mesh))
    return rows


_LINE = "Johnson and Greenwood 2008, doi 10.1088/0022-3727/41/15/155315, closed form"
CASES = (Case("Maugis-Dugdale line contact", _LINE, maugis),)
