r"""Pressing without friction: a uniform pressure and Hertz's line contact.

Hertz (Johnson, Contact Mechanics, 1985, sec. 4.2(c), doi 10.1017/CBO9781139171731): a cylinder of radius R that is
pressed on a rigid plane by f per length bears

.. math:: p_n = p_0 \sqrt{1 - x^2 / a^2}, \qquad a^2 = \frac{4 f R}{\pi E^*}, \quad p_0 = \frac{2 f}{\pi a},
          \qquad E^* = \frac{E}{1 - \nu^2}.

The body is a block of side 50 a with a cylinder's bottom: a half-space to :math:`(a / 50a)^2 = 4 \cdot 10^{-4}` and,
with R = 2000 a, linear to a strain of a / 2R. Its facets are parabolas. Straight ones are a polygon, which pressed flat
bears a pressure that rises to its corners by a part h / a: 3 % at facets of a / 16, where parabolas are 2e-5 off. What
is of first order in the facet's length h are the half-width and the pressure in the facet at the edge.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from scipy.optimize import brentq

from benchmarks.verification.bodies import formulations, over_screen
from benchmarks.verification.case import Case, Row, order
from geometry.bodies import block, pad
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


def _hertz(name: str, facets: int) -> tuple[float, float]:
    """Return half-width and largest pressure; Hertz's edge is in the middle of the facet ``facets``."""
    size = HALF_WIDTH / (facets + 0.5)
    run = press(pad(size, int(np.ceil(1.3 * facets)), RADIUS, SPAN), name, size)
    length = float(run.observer.ridge_loads(run.surface_state).length[0])
    return length / 2, float(run.surface_state.p_n.max())


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


_JOHNSON = "Johnson, Contact Mechanics, 1985, sec."
_HERTZ = f"Hertz 1882, in {_JOHNSON} 4.2(c), doi 10.1017/CBO9781139171731"
_PATCH = "closed form of Saint Venant and Kirchhoff's law, P = (lambda + 2 mu) (s^2 - 1) s / 2 at the stretch s"
CASES = (
    Case("Patch test", _PATCH, patch),
    Case("Hertz line contact", _HERTZ, hertz),
)
