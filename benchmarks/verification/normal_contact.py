r"""Pressing without friction: a uniform pressure, Hertz's line contact, how fast pressures converge, a flat punch.

Hertz (Johnson, Contact Mechanics, 1985, sec. 4.2(c), doi 10.1017/CBO9781139171731): a cylinder of radius R that is
pressed on a rigid plane by f per length bears

.. math:: p_n = p_0 \sqrt{1 - x^2 / a^2}, \qquad a^2 = \frac{4 f R}{\pi E^*}, \quad p_0 = \frac{2 f}{\pi a},
          \qquad E^* = \frac{E}{1 - \nu^2}.

The body is a block of side 50 a with a cylinder's bottom: a half-space to :math:`(a / 50a)^2 = 4 \cdot 10^{-4}` and,
with R = 2000 a, linear to a strain of a / 2R. Its facets are parabolas. Straight ones are a polygon, which pressed flat
bears a pressure that rises to its corners by a part h / a: 3 % at facets of a / 16, where parabolas are 2e-5 off. What
is of first order in the facet's length h are the half-width and the pressure in the facet at the edge.

A rigid flat punch of width 2a on a half-space (Johnson, sec. 2.8(a)) has its match in a half-space that a shallow
recess keeps off the screen for |x| > a: :math:`p_n = f / (\pi \sqrt{a^2 - x^2})`. The recess is deeper than the free
surface sinks, 2 f / (pi E*) arcosh(x / a), and low against the facet that it takes: at f = 3e-5 E* a both can be had.
"""

from collections.abc import Callable
from functools import cache, partial
from typing import Any

import numpy as np
from scipy.optimize import brentq

from benchmarks.verification.bodies import Array, formulations, over_screen
from benchmarks.verification.case import Case, Row, order, order_row
from geometry.bodies import block, foot, pad
from variational.contact.augmented import AugmentedLagrangian
from variational.contact.interface import Interface
from variational.contact.penalty import Penalty
from variational.materials.saint_venant import SaintVenant
from variational.solvers.continuation import Continuation, Target

YOUNG, NU, RADIUS, HALF_WIDTH = 1e6, 0.3, 1.0, 0.5e-3
SPAN = 50 * HALF_WIDTH
E_STAR = YOUNG / (1 - NU**2)
FORCE = np.pi * E_STAR * HALF_WIDTH**2 / (4 * RADIUS)
P_0 = 2 * FORCE / (np.pi * HALF_WIDTH)
_SOLID = SaintVenant(YOUNG, NU)
_H_0 = 1e-6  # m, not felt without voltage
_PLACES = (1 / 6, 1 / 2, 5 / 6)  # of the edge of contact in its facet


def patch(small: bool) -> list[Row]:
    """A block pressed flat between frictionless sides, in confined compression of 2 %."""
    height, depth, size = 0.5e-3, 10e-6, 0.25e-3
    modulus = YOUNG * (1 - NU) / ((1 + NU) * (1 - 2 * NU))
    why = "the imbalance of 1e-9 N/m at which solves end, over a quarter of a millimetre"

    def excess(p: float, sink: float) -> float:
        stretch = 1 - (depth - sink * p) / height
        return modulus / 2 * (stretch**2 - 1) * stretch + p

    rows = []
    for name, formulation in formulations(YOUNG / size, 1e-14).items():
        if isinstance(formulation, AugmentedLagrangian):  # of a stiffness with which a correction gains five digits
            formulation = AugmentedLagrangian(1e4 * formulation.eps_n, formulation.eps_t, formulation.tolerance)
        run = over_screen(block(1e-3, height, size), _SOLID, Interface(formulation, 0.0, _H_0), 1.0, sides_held=True)
        run.run(Target("press", bone_height=-depth))
        sink = 1 / formulation.eps_n if isinstance(formulation, Penalty) else 0.0
        expected = brentq(partial(excess, sink=sink), 0.0, YOUNG, xtol=1e-12, rtol=1e-15)
        found = run.surface_state.p_n.ravel()
        farthest = float(found[np.abs(found - expected).argmax()])
        rows.append(Row(f"p_n where it is most off, {name} (Pa)", farthest, expected, 1e-8, why, "16 P2 triangles"))
    return rows


def press(build: Callable[[], float], name: str, size: float, force: float = FORCE, **options: Any) -> Continuation:
    """Return a body pressed by a force (N/m), in one step, by the formulation of a name for facets of a size (m)."""
    interface = Interface(formulations(YOUNG / size, 1e-11)[name], 0.0, _H_0)
    run = over_screen(build, _SOLID, interface, force, step_scale=7.5, **({"touch_depth": 0.5e-6} | options))
    run.run(Target("press", f_ext=force))
    return run


def _off(run: Continuation, exact: Callable[[Array], Any], width: float) -> float:
    """Return the error of p_n in L2 for |x| < width (m), relative."""
    s, surface = run.surface_state, run.problem.surface
    middle = np.abs(s.x) < width
    expected = np.where(middle, exact(np.where(middle, s.x, 0.0)), 0.0)
    off, whole = (surface.per_ridge(p**2)[0] for p in (np.where(middle, s.p_n, 0.0) - expected, expected))
    return float(np.sqrt(off / whole))


@cache
def _hertz(name: str, facets: int, place: float = 0.5) -> tuple[float, float, float]:
    """Return half-width, largest pressure and its L2 error; Hertz's edge is at a place in the facet ``facets``."""
    size = HALF_WIDTH / (facets + place)
    run = press(pad(size, int(np.ceil(1.3 * facets)), RADIUS, SPAN), name, size)
    length = float(run.observer.ridge_loads(run.surface_state).length[0])
    error = _off(run, lambda x: P_0 * np.sqrt(np.clip(1 - (x / HALF_WIDTH) ** 2, 0, None)), np.inf)
    return length / 2, float(run.surface_state.p_n.max()), error


def hertz(small: bool) -> list[Row]:
    """Half-width and largest pressure by the finger's formulation and by Nitsche's method."""
    meshes = (4, 8, 16) if small else (40, 80, 160)
    asked = 0.005, "what is asked of these facets"
    tolerance, why = (0.05, "of first order: 0.5 % at facets a tenth as long") if small else asked
    rows = []
    for name in ("penalty", "Nitsche 0"):
        runs = [_hertz(name, facets) for facets in meshes]
        mesh = f"P2, facets of a / {meshes[-1] + 0.5:g}"
        observed = order([run[0] - HALF_WIDTH for run in runs], np.array(meshes) + 0.5)
        rows.append(Row(f"half-width (m), {name}", runs[-1][0], HALF_WIDTH, tolerance, why, mesh, observed))
        depth = "a / 2R, the strain, and the half-space's size, 4e-4"
        rows.append(Row(f"largest pressure (Pa), {name}", runs[-1][1], P_0, 1e-3, depth, mesh))
    return rows


def _over_places(name: str, facets: int) -> float:
    """Return the L2 error of the pressure, root mean square over the places of Hertz's edge in its facet."""
    return float(np.sqrt(np.mean([_hertz(name, facets, place)[2] ** 2 for place in _PLACES])))


def convergence(small: bool) -> list[Row]:
    """L2 error of Hertz's pressure over the facets' length, by formulation.

    On curved facets Nitsche's error is that of the facet at the edge alone, and six times as large where the edge is
    near an end of its facet as in the middle. So the error is the root mean square over places of the edge.
    """
    meshes = (4, 8, 16) if small else (10, 20, 40)
    mesh = "P2, facets of a / " + ", ".join(f"{facets + 0.5:g}" for facets in meshes)
    rows = []
    for name in formulations(1.0, 1.0):
        errors = [_over_places(name, facets) for facets in meshes]
        near, most, why = 0.15, 1.5, "1.5 h / a: the facet at the edge"
        if name == "augmented Lagrangian":
            near, most = 0.6, 3.0
            why = "3 h / a: the facet at the edge has four multipliers for one free node: they are undetermined"
        fit, last = f"a fit through {len(meshes)} coarse meshes; {why}", most / (meshes[-1] + 0.5)
        rows += [
            order_row(f"order of the error, {name}", order(errors, np.array(meshes) + 0.5), 1.0, near, fit, mesh),
            Row(f"L2 error on the last mesh, {name}", errors[-1], 0.0, last, why, mesh, absolute=True),
        ]
    return rows


def flat_punch(small: bool) -> list[Row]:
    """A foot with a recess on either side; what its middle bears."""
    force, meshes = 3e-5 * E_STAR * HALF_WIDTH, (10, 20, 40) if small else (40, 80, 160)
    why = "what is asked of a profile; of first order in the facets at the singular edges"
    mesh = f"P2, facets of a / {meshes[-1]} at the edges, growing by an eighth"
    rows = []
    for name in ("penalty", "Nitsche 0"):
        errors = []
        for part in meshes:
            build = foot(HALF_WIDTH / part, HALF_WIDTH, 6 * force / E_STAR, 200 * HALF_WIDTH)
            run = press(build, name, HALF_WIDTH / part, force, tolerance=1e-7, touch_depth=0.05e-6)
            errors.append(_off(run, lambda x: force / (np.pi * np.sqrt(HALF_WIDTH**2 - x**2)), 0.9 * HALF_WIDTH))
        observed, quantity = order(errors, np.array(meshes) + 0.5), f"L2 error of p_n in |x| < 0.9 a, {name}"
        rows.append(Row(quantity, errors[-1], 0.0, 0.01, why, mesh, observed, absolute=True))
    return rows


_JOHNSON = "Johnson, Contact Mechanics, 1985, sec."
_HERTZ = f"Hertz 1882, in {_JOHNSON} 4.2(c), doi 10.1017/CBO9781139171731"
_PATCH = "closed form of Saint Venant and Kirchhoff's law, P = (lambda + 2 mu) (s^2 - 1) s / 2 at the stretch s"
CASES = (
    Case("Patch test", _PATCH, patch),
    Case("Hertz line contact", _HERTZ, hertz),
    Case("Convergence of the contact pressure", _HERTZ, convergence),
    Case("Flat punch", f"{_JOHNSON} 2.8(a), doi 10.1017/CBO9781139171731", flat_punch),
)
