r"""Attraction: its resultant on a round body, its potential, pull-in of a plate, and adhesive contact of a cylinder.

A parabola :math:`y = g + x^2 / 2R` of half-width L is attracted by (with :math:`s = h_0 + g`, :math:`k^2 = 2 R s`)

.. math:: \frac{\varepsilon_0 U^2}{2} \int_{-L}^L \frac{dx}{(s + x^2 / 2R)^2}
          = \frac{\varepsilon_0 U^2}{2 s^2} \left( \frac{L}{1 + L^2 / k^2} + k \arctan \frac Lk \right)
          \to \frac{\varepsilon_0 U^2}{2} \frac{\pi \sqrt{2R}}{2 s^{3/2}} \quad (L \to \infty).

A flat block is a spring of stiffness E / H per area, a plate over the screen: at rest at :math:`s_0 = h_0 + g_0` it is
pulled in by :math:`U^2 = 8 E s_0^3 / (27 \varepsilon_0 H)`, after a travel of s_0 / 3 (Nathanson, Newell, Wickstrom and
Davis 1967, doi 10.1109/T-ED.1967.15912). There the least eigenvalue of the tangent vanishes, with the root of what
:math:`U^2` lacks; pull-in is found by extrapolating to where it does.

The cylinder under a constant attraction of finite range: :mod:`benchmarks.verification.dugdale`.
"""

from functools import partial

import numpy as np
from dolfinx import fem
from scipy.optimize import brentq, minimize_scalar

from benchmarks.verification import dugdale
from benchmarks.verification.case import Case, Curves, Outcome, Row
from benchmarks.verification.over_screen import formulations, over_screen, plane_strain_modulus
from geometry.bodies import block, pad
from variational.attraction.electroadhesion import ELECTROSTATIC
from variational.attraction.insulator import VACUUM_PERMITTIVITY
from variational.contact.penalty import Penalty
from variational.materials.saint_venant import SaintVenant
from variational.problem import Interface
from variational.solvers.continuation import Target
from variational.solvers.stability import StabilityCheck

_H_0 = 0.514e-6
_CONTACT = Penalty(1e12, 1e11)


# -- a round body at a height --------------------------------------------------------------------------
def total_attraction(small: bool) -> Outcome:
    """A cylinder too stiff to deform, at several heights, on three meshes."""
    radius, span, voltage = 10e-3, 2e-3, 1.0
    parts = (2, 4, 8) if small else (5, 10, 20)
    rows = []
    for gap in (1e-6, 3e-6, 10e-6):
        s = _H_0 + gap
        k, end = np.sqrt(2 * radius * s), span / 2
        extent = end / (1 + (end / k) ** 2) + k * np.arctan(end / k)
        exact = float(VACUUM_PERMITTIVITY * voltage**2 / (2 * s**2) * extent)
        found = []
        for part in parts:
            build = pad(k / part, int(0.75 * end / k * part), radius, span)
            run = over_screen(build, SaintVenant(1e7, 0.3), Interface(_CONTACT, 0.0, _H_0), 0.1, d_eq=1e-7)
            run.run(Target("lift", bone_height=gap))
            run.run(Target("charge", voltage=voltage))
            found.append(float(run.observer.ridge_loads(run.surface_state).f_attraction[0]))
        order = -float(np.polyfit(np.log(parts), np.log(np.abs(np.array(found) - exact)), 1)[0])
        tolerance = 0.5 / parts[-1] ** 2
        why = "(h / k)^2 / 2: chords of facets of length h are too high by h^2 / 12 R; the outermost quarter is coarser"
        mesh = f"P2, facets of sqrt(2 R (h_0 + g)) / {parts[-1]}"
        rows.append(Row(f"attraction at g = {gap * 1e6:g} um (N/m)", found[-1], exact, tolerance, why, mesh, order))
    return Outcome(tuple(rows))


# -- potential -----------------------------------------------------------------------------------------
def potential(small: bool) -> Outcome:
    """A wavy skin at heights on both sides of d_eq; the residual against differences of the energy."""
    steps = 1e-7 * 0.5 ** np.arange(5)
    rows = []
    for name, law in (("Eq. 3", ELECTROSTATIC), ("constant", dugdale.constant_attraction(0.2))):
        h_0 = _H_0 if law is ELECTROSTATIC else 3e-6
        interface = Interface(_CONTACT, 0.0, h_0, law)
        run = over_screen(block(1e-3, 0.5e-3, 0.125e-3), SaintVenant(1e6, 0.3), interface, 1.0)
        problem = run.problem
        problem.set_air_gaps(np.array([2e-6]))
        problem.w.interpolate(lambda x: np.stack([1e-2 * x[0], 3.3e-6 + 3e-6 * np.sin(7e3 * x[0] + 0.4) - 1e-3 * x[1]]))
        start = problem.w.x.array.copy()
        x, y = problem.V.tabulate_dof_coordinates()[:, :2].T / 1e-3
        way = np.stack([np.sin(9.1 * x + 4.3 * y + 0.2), np.cos(6.7 * x - 5.9 * y + 1.1)], axis=1).ravel()
        up = np.tile([0.0, 1.0], len(start) // 2)

        def charged(form, problem=problem):
            """Return what the voltage adds to a form, a vector or a number."""
            assemble = fem.assemble_scalar if form is problem.energy else lambda f: fem.assemble_vector(f).array.copy()
            values = []
            for voltage in (200.0, 0.0):
                problem.voltage.value = voltage
                values.append(assemble(form))
            return values[0] - values[1]

        def energy(step: float, way=way, problem=problem, start=start, charged=charged) -> float:
            problem.w.x.array[:] = start + step * way
            return float(charged(problem.energy))

        problem.voltage.value = 200.0
        pull = float(run.observer.ridge_loads().f_attraction[0])
        lift = (energy(1e-9, up) - energy(-1e-9, up)) / 2e-9
        problem.w.x.array[:] = start

        slope = float(charged(problem.residual) @ way)
        remainders = np.array([abs(energy(step) - energy(0.0) - step * slope) for step in steps])
        order = float(np.polyfit(np.log(steps), np.log(remainders), 1)[0])
        central = (energy(1e-9) - energy(-1e-9)) / 2e-9
        mesh = "64 P2 triangles"
        why = "a second-order remainder; points that cross an edge of the law bend it"
        rows.append(Row(f"order of Taylor's remainder, {name}", order, 2.0, 0.05, why, mesh, order, absolute=True))
        why = "central difference over 2 nm of laws that change over 1 um, and the energy's roundoff"
        rows.append(
            Row(f"slope of the energy along a wavy displacement, {name} (N/m)", slope, central, 1e-5, why, mesh)
        )
        rows.append(Row(f"resultant of the traction against lifting, {name} (N/m)", pull, lift, 1e-5, why, mesh))
    return Outcome(tuple(rows))


# -- actuator ------------------------------------------------------------------------------------------
def actuator(small: bool) -> Outcome:
    """Raise the voltage of a block over the screen until its tangent is singular."""
    young, height, width, gap = 4e6, 2e-3, 0.5e-3, 1e-6
    rest = _H_0 + gap
    exact = float(np.sqrt(8 * young * rest**3 / (27 * VACUUM_PERMITTIVITY * height)))
    interface = Interface(_CONTACT, 0.0, _H_0)
    build = block(width, height, width / 2, gap=gap)
    run = over_screen(build, SaintVenant(young, 0.0), interface, 1e-2, held=True, d_eq=1e-7)
    check = StabilityCheck(run.solver)
    square, least, y = [], [], []
    aim = 10.0**2
    for _ in range(7):
        run.run(Target("charge", voltage=float(np.sqrt(aim))))
        square.append(aim)
        least.append(check.check().lambda_min)
        y.append(float(run.surface_state.y.mean()))
        if len(square) == 1:
            aim = 12.0**2
            continue
        fold = square[-1] + least[-1] ** 2 * (square[-1] - square[-2]) / (least[-2] ** 2 - least[-1] ** 2)
        aim = (square[-1] + fold) / 2  # from afar the fold looks too far
    fold = float(np.polyval(np.polyfit(np.array(least[-3:]) ** 2, square[-3:], 1), 0.0))
    low = float(np.polyval(np.polyfit(least[-3:], y[-3:], 2), 0.0))
    why, mesh = "the strain at pull-in, 3e-4, in which the solid is not linear", "32 P2 triangles"
    rows = (
        Row("travel at pull-in over h_0 + g_0", (gap - low) / rest, 1 / 3, 1e-3, why, mesh),
        Row("voltage of pull-in (V)", float(np.sqrt(fold)), exact, 1e-3, why, mesh),
    )

    travel = np.linspace(0, 0.5, 201)
    plates = {"parallel plates": (np.sqrt(27 / 4 * travel * (1 - travel) ** 2), travel)}
    block_ = {"block": (np.sqrt(square) / exact, (gap - np.array(y)) / rest)}
    return Outcome(rows, Curves("U / U of pull-in", "travel / (h_0 + g_0)", plates, block_))


# -- cylinder under a constant attraction --------------------------------------------------------------
def maugis(small: bool) -> Outcome:
    """Press a cylinder, charge it and pull it off; half-width over force, and the largest pull."""
    young, nu, radius, unit = 1e6, 0.3, 0.1, 0.2e-3  # unit = (w R^2 / E*)^(1/3)
    e_star = plane_strain_modulus(young, nu)
    work = unit**3 * e_star / radius**2
    sigma_0 = (e_star**2 * work / radius) ** (1 / 3)  # Maugis's parameter is 1, between Hertz's and Griffith's limits
    h_0 = work / sigma_0
    voltage = float(np.sqrt(2 * sigma_0 * h_0**2 / VACUUM_PERMITTIVITY))
    load = partial(dugdale.force, radius=radius, e_star=e_star, sigma_0=sigma_0, h_0=h_0)
    pull_off = minimize_scalar(load, bounds=(0.1 * unit, 2 * unit), method="bounded", options={"xatol": 1e-9 * unit})

    part = 8 if small else 40
    formulation = formulations(young / (unit / part), 1e-11)["penalty"]
    interface = Interface(formulation, 0.0, h_0, dugdale.constant_attraction(0.2))
    scale = e_star * unit**2 / radius
    build = pad(unit / part, 4 * part, radius, 200 * unit)
    run = over_screen(build, SaintVenant(young, nu), interface, scale, touch_depth=0.5e-6, step_scale=4.0)
    run.run(Target("press", bone_height=-0.5e-6))
    run.run(Target("charge", voltage=voltage))
    mesh = f"P2, facets of {unit / part * 1e6:g} um"
    tolerance, why = 0.01, "asked for; the edge of the contact settles in facets of up to 1 % of it"
    if small:
        tolerance, why = 0.04, "a quarter of a facet, of up to 13 %, in which the edge of the contact settles"
    rows, found = [], []
    for height in (0.0, 1e-6, 2e-6) if small else (0.0, 0.5e-6, 1e-6, 1.5e-6, 2e-6, 2.3e-6, 2.5e-6):
        run.run(Target("lift", bone_height=height))
        a = float(run.observer.ridge_loads(run.surface_state).length[0]) / 2
        f = float(run.solver.reaction[1])
        found.append((a, f))
        if f > 0.99 * pull_off.fun:  # nearer to pull-off the force hardly tells the half-width
            exact = brentq(lambda x, f=f: load(x) - f, pull_off.x, 10 * unit)
            rows.append(Row(f"half-width at f = {f:.3f} N/m (m)", a, exact, tolerance, why, mesh))
    if not small:
        largest = min(f for _, f in found)
        rows.append(Row("pull-off force (N/m)", largest, float(pull_off.fun), tolerance, "asked for", mesh))

    x, (a, f) = np.linspace(0.2, 2.1, 300) * unit, np.array(found).T
    known = {"Johnson and Greenwood, λ = 1": ([load(v) / scale for v in x], x / unit)}
    pulled = {"pulled off": (f / scale, a / unit)}
    return Outcome(tuple(rows), Curves("f R / (E* b²), b³ = w R² / E*", "a / b", known, pulled))


_LINE = "Johnson and Greenwood 2008, doi 10.1088/0022-3727/41/15/155315, by the formulas in dugdale.py"
CASES = (
    Case("Attraction of a round body", "closed form, the integral of Eq. 3 over a parabola", total_attraction),
    Case("Potential of the attraction", "differences of the energy at frozen d_eq", potential),
    Case("Parallel-plate actuator", "Nathanson et al. 1967, doi 10.1109/T-ED.1967.15912", actuator),
    Case("Maugis-Dugdale line contact", _LINE, maugis),
)
