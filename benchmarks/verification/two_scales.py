r"""A block with one flat ridge, where the coupled model is a scalar equation.

The block is ten thousand times stiffer than skin and does not widen, so that its bottom stays flat and its contact
length L is the block's width. With f = p_ext L prescribed the mean contact pressure is, at any state,

.. math:: p_c = p_{ext} + \sigma_{el}(d_{eq}(p_c)), \qquad \mu_{app} = \mu_f p_c / p_{ext} \text{ at full slip,}

which is solved by bracketing in the mean separation.
"""

import numpy as np
from mpi4py import MPI

from benchmarks.verification.case import Case, Curves, Outcome, Row, worst
from benchmarks.verification.microscale import CLOSURE, EPS_0, H_0, MU_F, VOLTAGES
from geometry import tags
from geometry.bodies import block
from geometry.mesh import load
from variational.body import Body
from variational.contact.penalty import Penalty
from variational.materials.saint_venant import SaintVenant
from variational.problem import Interface
from variational.roughness.bam import BearingArea
from variational.solvers.continuation import Target

_SIDE = 0.25e-3  # m, width and height
_YOUNG = 1e10  # Pa
_PENALTY = Penalty(1e12, 1e11)
_MESH = "block of 4 x 4 cells, P2"
# Loads that change over the bottom strain it by p_c / E = 5e-6, of which a tenth shows; ten times softer, ten times so.
_SOLVE = "air gaps are accepted within 1e-6 of themselves; what the block strains moves p_c by 3e-7"


def charged(p_ext: float, voltage: float) -> tuple[float, float, float]:
    """Press a flat ridge, charge it and slide it to full slip.

    Args:
        p_ext: (Pa).
        voltage: (V).

    Returns:
        d_eq before it slides (m), mean contact pressure then (Pa), and mu_app at full slip.
    """
    body = load(MPI.COMM_WORLD, block(_SIDE, _SIDE, _SIDE / 4))
    law, force = Interface(_PENALTY, MU_F, H_0), p_ext * _SIDE
    solids = {tags.STRATUM_CORNEUM: SaintVenant(_YOUNG, 0.0)}
    made = Body(body, solids, law, BearingArea(H_0), force_scale=force, touch_depth=5e-9)
    run, coupling = made.continuation, made.coupling
    run.run(Target("press", f_ext=force))
    if voltage:
        run.run(Target("charge", voltage=voltage))
    d_eq, p_c = float(coupling.d_eq[0]), float(run.observer.ridge_loads(run.surface_state).p_c[0])
    run.run(Target("slide", bone_x=20e-6, until_full_slip=True))
    if not run.slip[1]:
        raise RuntimeError(f"the block does not slip at {p_ext:g} Pa and {voltage:g} V")
    return d_eq, p_c, -float(run.solver.reaction[0]) / force


def scalar(p_ext: float, voltage: float) -> tuple[float, float, float]:
    """Return d_eq (m), p_c (Pa) and mu_app of the scalar equation."""
    d_eq = BearingArea(H_0).air_gap_at_external(p_ext, voltage)
    p_c = p_ext + EPS_0 * voltage**2 / 2 / (H_0 + d_eq) ** 2
    return d_eq, p_c, MU_F * p_c / p_ext


def flat_ridge(small: bool) -> Outcome:
    """The coupled model against the root of the scalar equation."""
    found, exact = charged(20e3, 200.0), scalar(20e3, 200.0)
    names = "d_eq (m)", "p_c (Pa)", "mu_app at full slip"
    rows = [
        Row(f"{name} at 20 kPa, 200 V", a, b, 1e-6, _SOLVE, _MESH)
        for name, a, b in zip(names, found, exact, strict=True)
    ]
    return Outcome(tuple(rows))


def table(small: bool) -> Outcome:
    """The coupled model against the printed closure table."""
    found: dict[tuple[int, float], tuple[float, float, float]] = {}
    gaps, frictions = [], []
    for kpa, printed in CLOSURE.items():
        for voltage, (d_eq, mu_app) in zip(VOLTAGES, printed, strict=True):
            if small and (kpa, voltage) not in ((10, 200.0), (50, 50.0)):
                continue
            d, _, mu = found[kpa, voltage] = charged(kpa * 1e3, voltage)
            where, why = f"at {kpa} kPa, {voltage:g} V", "half of the last digit printed"
            gaps.append(Row(f"d_eq {where} (um)", d / 1e-6, d_eq, 0.5005e-2, why, _MESH, absolute=True))
            digits = 0.5005e-2 if mu_app > 1 else 0.5005e-3
            frictions.append(Row(f"mu_app {where}", mu, mu_app, digits, why, _MESH, absolute=True))

    p, known, computed = np.linspace(9, 55, 100), {}, {}
    for voltage in VOLTAGES:
        known[f"{voltage:g} V, scalar equation"] = (p, [scalar(kpa * 1e3, voltage)[2] for kpa in p])
        points = {kpa: mu for (kpa, u), (_, _, mu) in found.items() if u == voltage}
        computed[f"{voltage:g} V"] = (list(points), list(points.values()))
    curves = Curves("external pressure (kPa)", "apparent friction coefficient (–)", known, computed)
    return Outcome((worst(gaps), worst(frictions)), curves)


CASES = (
    Case("Flat ridge", "scalar equation of the closure, Forsbach et al. 2023, Eqs. 3, 4, 9, 13", flat_ridge),
    Case("Closure table", "the same equation's root as printed, evaluated independently", table),
)
