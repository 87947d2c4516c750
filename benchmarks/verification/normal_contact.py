r"""Pressing without friction: a uniform pressure, Hertz's line contact, how fast pressures converge, a flat punch.

Hertz (Johnson, Contact Mechanics, 1985, sec. 4.2(c), doi 10.1017/CBO9781139171731): a cylinder of radius R that is
pressed on a rigid plane by f per length bears

.. math:: p_n = p_0 \sqrt{1 - x^2 / a^2}, \qquad a^2 = \frac{4 f R}{\pi E^*}, \quad p_0 = \frac{2 f}{\pi a},
          \qquad E^* = \frac{E}{1 - \nu^2}.

The body here is a square block of side 50 a with a cylinder's bottom, glued to the bone at its top: a half-space to
:math:`(a / 50a)^2 = 4 \cdot 10^{-4}` and, with R = 2000 a, linear to a strain of the order of a / 2R.

The skin's facets are straight, as the finger's are. From one to the next the surface turns by h / R, and a polygon
pressed flat bears a pressure that rises to its corners, by a part h / a of Hertz's: pointwise pressures are of first
order in the facet's length, whatever the element. Facets that bend would remove it in the middle of the contact; at
its edge the square root leaves the first order in the L2 norm anyway.

A rigid flat punch of width 2a on a half-space (Johnson, sec. 2.8(a)) has its match in a half-space that a shallow
recess keeps off the screen for |x| > a: displacement and shear are prescribed in |x| < a, the rest is free, and

.. math:: p_n = \frac{f}{\pi \sqrt{a^2 - x^2}}.

The recess must be deeper than what the free surface sinks, 2 f / (pi E*) arcosh(x / a), and its step low against the
facet that it takes: a steep one is a corner, which bears no singular pressure. At f = 3e-5 E* a both can be had.
"""

from dataclasses import dataclass
from functools import cache, partial

import numpy as np
from scipy.optimize import brentq

from benchmarks.verification.case import Case, Curves, Outcome, Row
from benchmarks.verification.over_screen import Array, formulations, over_screen, plane_strain_modulus, profile
from geometry.bodies import block, foot, pad
from variational.contact.augmented import AugmentedLagrangian
from variational.contact.penalty import Penalty
from variational.materials.saint_venant import SaintVenant
from variational.problem import Interface
from variational.solvers.continuation import Target

YOUNG, NU, RADIUS, HALF_WIDTH = 1e6, 0.3, 1.0, 0.5e-3
SPAN = 50 * HALF_WIDTH
E_STAR = plane_strain_modulus(YOUNG, NU)
FORCE = np.pi * E_STAR * HALF_WIDTH**2 / (4 * RADIUS)
P_0 = 2 * FORCE / (np.pi * HALF_WIDTH)
_H_0 = 1e-6  # m, not felt without voltage
_FORMULATIONS = tuple(formulations(1.0, 1.0))


# -- patch test ----------------------------------------------------------------------------------------
def patch(small: bool) -> Outcome:
    """A block pressed flat between frictionless sides, in confined compression of 2 %."""
    width, height, depth = 1e-3, 0.5e-3, 10e-6
    solid, modulus = SaintVenant(YOUNG, NU), YOUNG * (1 - NU) / ((1 + NU) * (1 - 2 * NU))

    def stress(stretch: float) -> float:
        return modulus / 2 * (stretch**2 - 1) * stretch

    rows = []
    for name, formulation in formulations(YOUNG / 0.25e-3, 1e-14).items():
        if isinstance(formulation, AugmentedLagrangian):  # of a stiffness with which a correction gains five digits
            formulation = AugmentedLagrangian(1e4 * formulation.eps_n, formulation.eps_t, formulation.tolerance)
        build = block(width, height, 0.25e-3)
        run = over_screen(build, solid, Interface(formulation, 0.0, _H_0), 1.0, held=True)
        run.run(Target("press", bone_height=-depth))
        sink = 1 / formulation.eps_n if isinstance(formulation, Penalty) else 0.0
        stretch = partial(lambda p, sink: 1 - (depth - sink * p) / height, sink=sink)
        expected = brentq(lambda p, s=stretch: stress(s(p)) + p, 0.0, YOUNG, xtol=1e-12, rtol=1e-15)
        found = run.surface_state.p_n.ravel()
        farthest = float(found[np.abs(found - expected).argmax()])
        why = "the imbalance of 1e-9 N/m at which solves end, over a quarter of a millimetre"
        rows.append(Row(f"p_n where it is most off, {name} (Pa)", farthest, expected, 1e-8, why, "16 P2 triangles"))
    return Outcome(tuple(rows))


# -- Hertz ---------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class _Pressed:
    half_width: float
    x: Array
    p_n: Array
    error: float  # of p_n in L2, relative


def hertz_pressure(x: Array) -> Array:
    """Return Hertz's pressure (Pa) at abscissae (m)."""
    return P_0 * np.sqrt(np.clip(1 - (x / HALF_WIDTH) ** 2, 0, None))


@cache
def _press(name: str, facets: int) -> _Pressed:
    """Press the cylinder with Hertz's edge in the middle of a facet, the one after ``facets`` on either side."""
    size = HALF_WIDTH / (facets + 0.5)
    formulation = formulations(YOUNG / size, 1e-11)[name]
    build = pad(size, int(np.ceil(1.3 * facets)), RADIUS, SPAN)
    # Without friction the path does not matter: one step.
    run = over_screen(
        build, SaintVenant(YOUNG, NU), Interface(formulation, 0.0, _H_0), FORCE, touch_depth=0.5e-6, step_scale=15.0
    )
    run.run(Target("press", f_ext=FORCE))
    s, surface = run.surface_state, run.problem.surface
    length = float(run.observer.ridge_loads(s).length[0])
    off, whole = (surface.per_ridge(p**2)[0] for p in (s.p_n - hertz_pressure(s.x), hertz_pressure(s.x)))
    return _Pressed(length / 2, *profile(run, s.p_n), float(np.sqrt(off / whole)))


def _order(errors: list[float], facets: tuple[int, ...]) -> float:
    return -float(np.polyfit(np.log(np.array(facets) + 0.5), np.log(np.abs(errors)), 1)[0])


def hertz(small: bool) -> Outcome:
    """Half-width and largest pressure by the finger's formulation and by Nitsche's method."""
    meshes = (4, 8, 16) if small else (40, 80, 160)
    tolerance, why = 0.005, "what is asked of these facets"
    if small:
        tolerance, why = 0.05, "of first order: 0.5 % at facets a tenth as long"
    rows, finest = [], {}
    for name in ("penalty", "Nitsche 0"):
        runs = [_press(name, facets) for facets in meshes]
        finest[name] = runs[-1]
        mesh = f"P2, facets of a / {meshes[-1] + 0.5:g}"
        for quantity, values, reference in (
            ("half-width (m)", [r.half_width for r in runs], HALF_WIDTH),
            ("largest pressure (Pa)", [float(r.p_n.max()) for r in runs], P_0),
        ):
            order = _order([value - reference for value in values], meshes)
            rows.append(Row(f"{quantity}, {name}", values[-1], reference, tolerance, why, mesh, order))

    x = np.linspace(-1.2, 1.2, 481)
    known = {"Hertz": (x, hertz_pressure(x * HALF_WIDTH) / P_0)}
    found = {name: (r.x / HALF_WIDTH, r.p_n / P_0) for name, r in finest.items()}
    return Outcome(tuple(rows), Curves("x / a (–)", "p_n / p_0 (–)", known, found, limits=(-1.2, 1.2)))


def convergence(small: bool) -> Outcome:
    """L2 error of Hertz's pressure over the facets' length, by formulation."""
    meshes = (4, 8, 16) if small else (10, 20, 40)
    sizes = 1 / (np.array(meshes) + 0.5)
    mesh = "P2, facets of a / " + ", ".join(f"{facets + 0.5:g}" for facets in meshes)
    errors = {name: [_press(name, facets).error for facets in meshes] for name in _FORMULATIONS}
    rows = []
    for name, values in errors.items():
        order = _order(values, meshes)
        near, most, why = 0.15, 1.5, "1.5 h / a: corners of the straight facets, h / a, and the edge"
        if name == "augmented Lagrangian":
            near, most = 0.6, 3.0
            why = (
                "3 h / a: the facet at the edge has four multipliers for one free node, which leaves them undetermined"
            )
        fit = f"a fit through {len(meshes)} coarse meshes; {why}"
        rows += [
            Row(f"order of the error, {name}", order, 1.0, near, fit, mesh, order, absolute=True),
            Row(f"L2 error on the last mesh, {name}", values[-1], 0.0, most * sizes[-1], why, mesh, absolute=True),
        ]

    found, known = {name: (sizes, values) for name, values in errors.items()}, {"first order": (sizes, sizes)}
    axes = "facet length / a (–)", "L2 error of p_n (relative)"
    return Outcome(tuple(rows), Curves(*axes, known, found, logarithmic=True))


# -- flat punch ----------------------------------------------------------------------------------------
def flat_punch(small: bool) -> Outcome:
    """A foot with a recess on either side; what its middle bears."""
    force, meshes = 3e-5 * E_STAR * HALF_WIDTH, (10, 20, 40) if small else (40, 80, 160)
    step = 6 * force / E_STAR
    rows, finest = [], []
    for name in ("penalty", "Nitsche 0"):
        errors = []
        for part in meshes:
            size = HALF_WIDTH / part
            formulation = formulations(YOUNG / size, 1e-11)[name]
            build = foot(size, HALF_WIDTH, step, 200 * HALF_WIDTH)
            solid, interface = SaintVenant(YOUNG, NU), Interface(formulation, 0.0, _H_0)
            run = over_screen(build, solid, interface, force, tolerance=1e-7, touch_depth=0.05e-6, step_scale=15.0)
            run.run(Target("press", f_ext=force))
            s, surface = run.surface_state, run.problem.surface
            middle = np.abs(s.x) < 0.9 * HALF_WIDTH
            exact = force / (np.pi * np.sqrt(np.where(middle, HALF_WIDTH**2 - s.x**2, np.inf)))
            off, whole = (surface.per_ridge(p**2)[0] for p in (np.where(middle, s.p_n, 0.0) - exact, exact))
            errors.append(float(np.sqrt(off / whole)))
        finest.append((name, *profile(run, s.p_n)))
        why = "what is asked of a profile; of first order in the facets at the singular edges"
        mesh = f"P2, facets of a / {meshes[-1]} at the edges, growing by an eighth"
        order = _order(errors, meshes)
        quantity = f"L2 error of p_n in |x| < 0.9 a, {name}"
        rows.append(Row(quantity, errors[-1], 0.0, 0.01, why, mesh, order, absolute=True))

    x = np.linspace(-0.98, 0.98, 999)
    known = {"rigid punch on a half-space": (x, 1 / np.sqrt(1 - x**2))}
    found = {name: (at / HALF_WIDTH, p_n * np.pi * HALF_WIDTH / force) for name, at, p_n in finest}
    return Outcome(tuple(rows), Curves("x / a (–)", "π a p_n / f (–)", known, found, limits=(-1.2, 1.2)))


_HERTZ = "Hertz 1882, in Johnson, Contact Mechanics, 1985, sec. 4.2(c), doi 10.1017/CBO9781139171731"
CASES = (
    Case(
        "Patch test",
        "closed form of Saint Venant and Kirchhoff's law, P = (lambda + 2 mu) (s^2 - 1) s / 2 at the stretch s",
        patch,
    ),
    Case("Hertz line contact", _HERTZ, hertz),
    Case("Convergence of the contact pressure", _HERTZ, convergence),
    Case("Flat punch", "Johnson, Contact Mechanics, 1985, sec. 2.8(a), doi 10.1017/CBO9781139171731", flat_punch),
)
