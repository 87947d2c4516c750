r"""The bearing area model against its equations in 30 digits, and the coupled model of one flat ridge.

The ridge is a block ten thousand times stiffer than skin that does not widen: its bottom stays flat and its contact
length L is the block's width. With f = p_ext L prescribed the mean contact pressure is, at any state,

.. math:: p_c = p_{ext} + \sigma_{el}(d_{eq}(p_c)), \qquad \mu_{app} = \mu_f p_c / p_{ext} \text{ at full slip,}

which :mod:`~benchmarks.verification.bearing_area` solves by bracketing in the mean separation.
"""

from itertools import product
from typing import Any

from scipy.optimize import brentq

from benchmarks.verification import bearing_area as exact
from benchmarks.verification.bodies import over_screen
from benchmarks.verification.case import IDENTITY, Case, Row, worst
from geometry.bodies import block
from variational.contact.interface import Interface
from variational.contact.penalty import Penalty
from variational.materials.saint_venant import SaintVenant
from variational.roughness.bam import BearingArea
from variational.solvers.continuation import Target

H_0, MU_F = float(exact.H_0), 0.25
_UM, _KPA = 1e-6, 1e3
_PAPER = "Forsbach et al. 2023, doi 10.3389/fmech.2022.1074393"
_SIDE = 0.25e-3  # m, width and height of the flat ridge
_MESH = "block of 4 x 4 cells, P2"
_ROUNDOFF = 1e-12, "roundoff, which differences amplify up to a hundred times"
_COUPLED = 5e-7, "loads that change over the bottom strain it by p_c / E, at most 5e-6, of which a tenth shows"

VOLTAGES = (0.0, 50.0, 100.0, 150.0, 200.0)
PRESSURES = (10, 20, 30, 50)  # kPa, p_ext


def _roundoff(quantity: str, ours: Any, reference: exact.Number) -> Row:
    """Return a row that may be off by roundoff."""
    return Row(quantity, float(ours), float(reference), *_ROUNDOFF)


def air_gap_at_external(bam: BearingArea, p_ext: float, voltage: float) -> float:
    """Return d_eq (m) on the branch in contact at an external pressure (Pa) and a voltage (V)."""
    fold = bam.pull_off_fold(voltage)
    end = 20 * bam.h_rms if fold is None else fold
    found = brentq(lambda v: bam.external_pressure(v, voltage) - p_ext, 0.0, end, xtol=1e-15 * bam.h_rms)
    return float(bam.air_gap(found))


def scalar(p_ext: float, voltage: float) -> tuple[float, float, float]:
    """Return d_eq (m), p_c (Pa) and mu_app of the scalar equation at a pressure (Pa) and a voltage (V)."""
    bam = BearingArea(H_0)
    d_eq = air_gap_at_external(bam, p_ext, voltage)
    p_c = p_ext + float(exact.EPS_0) * voltage**2 / 2 / (H_0 + d_eq) ** 2
    return d_eq, p_c, MU_F * p_c / p_ext


def charged(p_ext: float, voltage: float) -> tuple[float, float, float]:
    """Return those of the flat ridge, pressed, charged and slid to full slip: d_eq and p_c before it slides."""
    force = p_ext * _SIDE
    build, solid = block(_SIDE, _SIDE, _SIDE / 4), SaintVenant(1e10, 0.0)
    interface = Interface(Penalty(1e12, 1e11), MU_F, H_0)
    run = over_screen(
        build, solid, interface, force, closure=BearingArea(H_0), touch_depth=5e-9, coupling_tolerance=1e-10
    )
    run.run(Target("press", f_ext=force))
    if voltage:
        run.run(Target("charge", voltage=voltage))
    d_eq, p_c = float(run.coupling.d_eq[0]), float(run.observer.ridge_loads(run.surface_state).p_c[0])
    run.run(Target("slide", bone_x=20e-6, until_full_slip=True))
    if not run.slip[1]:
        raise RuntimeError(f"the block does not slip at {p_ext:g} Pa and {voltage:g} V")
    return d_eq, p_c, -float(run.solver.reaction[0]) / force


def uniform(small: bool) -> list[Row]:
    """Air gap and friction of one uniform ridge, or of a few of its states."""
    gaps, frictions = [], []
    for kpa, voltage in [(10, 200.0), (50, 50.0)] if small else product(PRESSURES, VOLTAGES):
        where, (d_eq, _, mu_app) = f"at {kpa} kPa, {voltage:g} V", scalar(kpa * _KPA, voltage)
        exact_d_eq, p_c = exact.uniform(kpa * 1000, voltage)
        gaps.append(_roundoff(f"d_eq {where} (um)", d_eq / _UM, exact_d_eq / exact.UM))
        frictions.append(_roundoff(f"mu_app {where}", mu_app, MU_F * p_c / (kpa * 1000)))
    return [worst(gaps), worst(frictions)]


def flat_ridge(small: bool) -> list[Row]:
    """The coupled model against the root of the scalar equation."""
    d_eq, p_c = map(float, exact.uniform(20_000, 200))
    names, exacts = ("d_eq (m)", "p_c (Pa)", "mu_app at full slip"), (d_eq, p_c, MU_F * p_c / 20e3)
    pairs = zip(names, charged(20e3, 200.0), exacts, strict=True)
    return [Row(f"{name} at 20 kPa, 200 V", ours, root, *_COUPLED, _MESH) for name, ours, root in pairs]


_ANEW = "in 30 digits by mpmath"
CASES = (Case("Uniform ridge", f"{_PAPER}, Eqs. 3, 9, 13, {_ANEW}", uniform, IDENTITY),)
TWO_SCALES = (
    Case("Flat ridge", f"scalar equation of the closure, {_PAPER}, Eqs. 3, 4, 9, 13, {_ANEW}", flat_ridge, IDENTITY),
)
