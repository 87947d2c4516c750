"""The loop over the scales on macroscales that are one formula: where it converges, how fast, and what it leaves.

And on one ridge: of which length the mean pressure is.

Where no other tolerance is named, 1e-6 of d_eq is the one at which the loop ends.
"""

from types import SimpleNamespace

import numpy as np
import pytest
from mpi4py import MPI
from scipy.optimize import brentq

from geometry import tags
from geometry.bodies import ridge
from geometry.mesh import load
from variational.body import Body
from variational.contact.interface import Interface
from variational.contact.penalty import Penalty
from variational.materials.ogden import Ogden
from variational.roughness.bam import BearingArea
from variational.roughness.closure import AirGap, Closure
from variational.solvers.continuation import Target
from variational.solvers.coupling import AcceptedState, Coupling
from variational.solvers.iteration import EXACT
from variational.solvers.outcome import NotConverged, Timings

H_0, EPS_0, FOLD_VOLTAGE = 0.514e-6, 8.854e-12, 200.0
CENTRE = 2e-6  # m


class Stub:
    """Stands for solver and observer: the ridges' contact pressures are a formula of their air gaps."""

    def __init__(self, closure, pressure, ridges: int = 1, noise: float = 0.0) -> None:
        self.pressure, self.timings, self.noise = pressure, Timings(), noise
        self.draw = np.random.default_rng(0)
        self.stops, self.lost = [], lambda d: False  # how solves may end; air gaps at which there is no equilibrium
        self.problem = SimpleNamespace(
            interface=SimpleNamespace(formulation=SimpleNamespace(error=lambda *_: 0.0, tolerance=0.0), friction=None),
            history=SimpleNamespace(accepted={}),
            voltage=SimpleNamespace(value=FOLD_VOLTAGE),
            mesh=SimpleNamespace(comm=MPI.COMM_SELF),
            set_air_gaps=lambda d: setattr(self, "d", d),
        )
        self.surface, self.state = SimpleNamespace(ridge_numbers=list(range(ridges))), lambda: None
        self.coupling = Coupling(self, self, closure)

    def solve(self, pseudo_transient: bool = False, stop=EXACT, tried: bool = False) -> None:
        self.stops.append("pseudo-transient" if tried else stop)

    def attempt(self, stop) -> bool:
        self.stops.append(stop)
        return not self.lost(float(self.d[0]))

    def ridge_loads(self, state, by_gap):
        p_c = self.pressure(self.d)
        return SimpleNamespace(p_c=p_c * (1 + self.noise * self.draw.uniform(-1, 1, len(p_c))))


class Linear(Closure):
    """An air gap of as many metres more as there are pascals, the unit of the stub's formulas."""

    def __call__(self, p_c):
        return AirGap(CENTRE + np.asarray(p_c), np.ones_like(p_c))


def line(gain) -> Stub:
    """Return ridges in equilibrium at CENTRE with the gains given, each the same everywhere."""
    gain = np.atleast_1d(np.asarray(gain, dtype=float))
    stub = Stub(Linear(), lambda d: gain * (d - CENTRE), len(gain))
    stub.coupling.set_air_gaps(np.full(len(gain), 1.1 * CENTRE))
    return stub


def flat(p_ext: float, noise: float = 0.0) -> Stub:
    """Return a flat ridge that bears an external pressure (Pa) and its attraction at 200 V."""
    half = EPS_0 * FOLD_VOLTAGE**2 / 2
    return Stub(BearingArea(H_0, p_floor=1.0), lambda d: p_ext + half / (H_0 + d) ** 2, 1, noise)


@pytest.mark.parametrize("gain", [-3.0, -0.9, 0.0, 0.5, 0.9, 0.99])
def test_linear_ridge_takes_few_iterations(gain):
    """The plain loop diverges at a gain of -3 and takes a thousand iterations at 0.99; the secant is exact.

    Tolerance: the loop's, and roundoff of a secant over changes of a tenth.
    """
    stub = line(gain)
    stub.coupling.solve()
    assert len(stub.coupling.history.changes) <= 5
    assert stub.coupling.d_eq[0] == pytest.approx(CENTRE, rel=1e-6)
    assert stub.coupling.gain[0] == pytest.approx(gain, abs=1e-9)
    assert not stub.coupling.history.jumped


@pytest.mark.parametrize("gain", [1.01, 1.5, 4.0])
@pytest.mark.parametrize("side", [0.9, 1.1])
def test_state_past_the_fold_is_left(gain, side):
    """A gain above one is an unstable state: the loop does not settle on it, and says which ridge it was."""
    stub = line(gain)
    stub.coupling.set_air_gaps(np.array([side * CENTRE]))
    with pytest.raises(NotConverged, match="COUPLING_CAP at ridge 0") as failure:
        stub.coupling.solve()
    assert failure.value.cycling
    assert stub.coupling.history.jumped == {0}
    assert np.sign(stub.coupling.d_eq[0] - CENTRE) == np.sign(side - 1)


# -- a flat ridge of the bearing area model ----------------------------------------------------------------
def gain_at(closure: BearingArea, u_bar: float) -> float:
    p_c, d = closure.contact_pressure(u_bar), closure.air_gap(u_bar)
    return float(closure(p_c).derivative * -EPS_0 * FOLD_VOLTAGE**2 / (H_0 + d) ** 3)


@pytest.mark.parametrize("gain", [0.5, 0.9, 0.99])
@pytest.mark.parametrize("noise", [0.0, 1e-9])
def test_towards_the_fold(gain, noise):
    """A ridge led up to its pull-off fold by halves of the distance settles where its gain is the one asked for.

    Pressures come with the error a solve may leave. That of d_eq is a tenth of the tolerance by secant, or the noise
    over 1 - gain. The last secant's gain lags behind the tangent's by 5e-5.
    """
    closure = BearingArea(H_0, p_floor=1.0)
    fold = closure.pull_off_fold(FOLD_VOLTAGE)
    end = brentq(lambda u: gain_at(closure, u) - gain, 1e-6, fold)
    stub = flat(float(closure.external_pressure(0.5 * end, FOLD_VOLTAGE)), noise)
    stub.coupling.set_air_gaps(closure.air_gap(np.array([0.5 * end])))
    for part in (0.8, 0.9, 0.95, 1.0):
        p_ext = float(closure.external_pressure(part * end, FOLD_VOLTAGE))
        stub.pressure = flat(p_ext).pressure
        stub.coupling.solve()
        assert len(stub.coupling.history.changes) <= 11
        assert stub.coupling.d_eq[0] == pytest.approx(float(closure.air_gap(part * end)), rel=1e-6)
    assert not stub.coupling.history.jumped
    assert stub.coupling.gain[0] == pytest.approx(gain, abs=2e-4)


@pytest.mark.parametrize("gain", [0.3, 0.5, 0.9])
def test_small_changes_of_the_load_leave_no_error(gain):
    """Where a load hardly changes, as at a drive's turning points, the loop does not end just below its tolerance.

    Tolerance: a hundredth of the loop's, beside the closed form of a flat ridge; it is the largest of 20 changes.
    """
    closure = BearingArea(H_0, p_floor=1.0)
    fold = closure.pull_off_fold(FOLD_VOLTAGE)
    end = brentq(lambda u: gain_at(closure, u) - gain, 1e-6, fold)
    error = 0.0
    for change in np.geomspace(1e-6, 3e-2, 20):
        stub = flat(float(closure.external_pressure(end, FOLD_VOLTAGE)))
        stub.coupling.set_air_gaps(closure.air_gap(np.array([0.999 * end])))
        stub.coupling.solve()
        stub.pressure = flat(float(closure.external_pressure((1 - change) * end, FOLD_VOLTAGE))).pressure
        stub.coupling.solve()
        exact = float(closure.air_gap(np.array([(1 - change) * end]))[0])
        error = max(error, abs(float(stub.coupling.d_eq[0]) / exact - 1))
    assert error < 1e-2 * stub.coupling.tolerance


@pytest.mark.parametrize("also_free", [False, True])
def test_ridge_that_lets_go_is_given_the_free_air_gap(also_free):
    """Where the skin finds no equilibrium while its air gap opens, it does at that of a ridge without contact.

    Where it does not even there, pseudo-transient continuation is the last resort.
    """
    closure = BearingArea(H_0)
    fold, free = closure.pull_off_fold(FOLD_VOLTAGE), float(closure(0.0).d_eq)
    start = float(closure.air_gap(np.array([0.95 * fold]))[0])
    stub = flat(float(closure.external_pressure(fold, FOLD_VOLTAGE)) - 100.0)
    stub.coupling.closure = closure
    stub.coupling.set_air_gaps(np.array([start]))
    stub.lost = lambda d: 1.03 * start < d and (also_free or d < 0.99 * free)
    stub.coupling.solve()
    assert stub.coupling.d_eq[0] == free
    assert stub.coupling.history.jumped == {0}
    assert ("pseudo-transient" in stub.stops) == also_free


# -- the length of Eq. 4 -----------------------------------------------------------------------------------
@pytest.mark.parametrize("by_gap", [False, True])
def test_mean_pressure_is_over_the_length_chosen(by_gap):
    """A charged ridge's air gap is the closure's at its force over the length below d_eq, or under pressure.

    The lengths, 121 and 81 um, are read off the heights at the Gauss points, at most 10 um from one another and
    straight between two. That is off by some 2 %, of which the air gap has a third; the other length's is 8 % off.
    """
    closure, skin = BearingArea(H_0), {tags.STRATUM_CORNEUM: Ogden(86.76e3, -14.53, 0.48)}
    body, law = load(MPI.COMM_SELF, ridge(30e-6)), Interface(Penalty(1.5e12, 5e10), 0.0, H_0)
    made = Body(body, skin, law, closure, by_gap=by_gap)
    made.continuation.run(Target("press", f_ext=4.4))
    made.continuation.run(Target("charge", voltage=150.0))
    surface, d_eq = made.continuation.surface_state, made.coupling.d_eq[0]
    x, y = (values.ravel()[np.argsort(surface.x.ravel())] for values in (surface.x, surface.y))
    level = d_eq if by_gap else 0.0
    sides = [np.interp(level, y[x * side > 0][::side], np.abs(x[x * side > 0])[::side]) for side in (1, -1)]
    force = made.observer.ridge_loads(surface).f_contact[0]
    assert d_eq == pytest.approx(float(closure(force / sum(sides)).d_eq), rel=0.01)


def test_state_is_restored_with_its_air_gaps():
    """A rejected attempt leaves nothing: air gaps, loads, history and unknowns are those before, to the last bit."""
    body, law = load(MPI.COMM_SELF, ridge(30e-6)), Interface(Penalty(1.5e12, 5e10), 0.25, H_0)
    made = Body(body, {tags.STRATUM_CORNEUM: Ogden(86.76e3, -14.53, 0.48)}, law, BearingArea(H_0))
    made.continuation.run(Target("press", f_ext=4.4))
    before = AcceptedState.of(made.coupling)
    made.continuation.run(Target("charge", voltage=150.0))
    made.continuation.run(Target("slide", bone_x=50e-6))
    assert not np.array_equal(made.coupling.d_eq, before.d_eq) and not np.array_equal(made.solver.x.array_r, before.x)
    before.restore(made.coupling)
    after = AcceptedState.of(made.coupling)
    for name in ("x", "bone", "d_eq", "reaction"):
        np.testing.assert_array_equal(getattr(after, name), getattr(before, name), err_msg=name)
    for name, values in before.history.items():
        np.testing.assert_array_equal(after.history[name], values, err_msg=name)
    assert (after.control, after.voltage) == (before.control, before.voltage) and after.voltage == 0.0
    assert set(made.problem.d_eq.x.array[made.problem.surface.pairs[:, 0]]) == set(before.d_eq)
