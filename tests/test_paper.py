"""The paper's statements and picture from runs that are made up, so that their numbers are known."""

from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure

from benchmarks.harness import Made
from benchmarks.limits import Limit
from benchmarks.paper import friction
from benchmarks.paper.statement import BUILT, HOLDS, IN_PART, NOT, statement
from benchmarks.runs import FORCES, VOLTAGES
from fingerpad.io import style

MU_0 = 0.25


def state(f_ext, voltage, lost=0.0, ridges=10.0):
    """Return steps of a run in which attraction is U^2 / 1000 and contact 1 mm a ridge, less what sliding loses."""
    f_t = MU_0 * (f_ext + voltage**2 / 1000)
    length = 1e-3 * ridges * (1 + voltage / 1000)
    rows = {
        "f_t": [0.0, f_t / 2, f_t],
        "contact_length": [length, length * (1 - lost / 3), length * (1 - lost)],
        "ridges_in_contact": [ridges, ridges, ridges - 1],
    }
    steps = {name: np.array(values) for name, values in rows.items()} | {"mu_app": np.array(rows["f_t"]) / f_ext}
    touching = {0: np.arange(-5, 5), 2: np.arange(-4, 6)}
    gap = np.full(10, 2e-6 if f_ext < 100 else 1.6e-6)
    return SimpleNamespace(steps=steps, charged=0, full_slip=2, on_ridges=lambda row, name: (touching[row], gap))


PATHS = {"rise_0": 0.02, "left_0": 1.0, "new_0": 1.0, "rise_200": 0.011, "left_200": 1.0, "new_200": 2.0}
LIMIT = Limit(0.5214, 1e-4, 2.0)
MADE = Made("0.1.0", "abc1234", "2026-11-21")


@pytest.fixture
def grid():
    """Runs that lose contact in proportion to their mean shear stress."""
    found = {}
    for f in FORCES:
        for u in VOLTAGES:
            plain = state(f, u)
            x = plain.steps["f_t"][-1] / plain.steps["contact_length"][-1]
            found[f, u] = state(f, u, lost=2e-5 * x)
    return friction.gather(found)


def by(statements, words):
    return next(s for s in statements if words in s.paper)


def judged(grid, paths=PATHS, limit=LIMIT):
    return friction.statements(grid, paths, limit)


def test_friction_statements(grid):
    """The largest rise of F_T is that at the smallest force, where the attraction is eight times the force."""
    found = by(judged(grid), "more than 100 %")
    assert found.numbers["largest"] == pytest.approx(1 + 40 / 5)
    assert found.numbers["least"] == pytest.approx(1 + 40 / 150)
    assert by(judged(grid), "0.55").numbers["coarse"] == pytest.approx(MU_0 * 115 / 75)
    assert by(judged(grid), "ridges fewer").numbers == {"least": 1, "largest": 1, "some": 16, "of": 16}
    assert by(judged(grid), "1.7 to 3").numbers == pytest.approx(
        {"share": 5 / 8, "least": 1.6e-6, "largest": 2e-6, "mostly": 20, "loads": 32}
    )


def test_friction_is_judged_by_its_limit(grid):
    """Within 5 % and 20 % of 0.55; what the grid's own mesh gives does not count."""
    for value, verdict in ((0.55, HOLDS), (0.5214, IN_PART), (0.523, HOLDS), (0.43, NOT), (0.67, NOT)):
        assert by(judged(grid, limit=Limit(value, 0.0, None)), "0.55").verdict == verdict


def times(name, factor, forces=slice(None), voltage=200.0):
    """Return a change of the grid: a quantity at a voltage is that without, times a factor."""

    def change(grid):
        values = grid[name].copy()
        k = int(np.flatnonzero(grid["voltage"] == voltage)[0])
        values[forces, k] = values[forces, 0] * np.asarray(factor)
        return dict(grid) | {name: values}

    return change


def both(change, other):
    return lambda grid: other(change(grid))


def lengths(normal, slip, forces=slice(None)):
    return both(times("charged_contact_length", normal, forces), times("full_slip_contact_length", slip, forces))


def ridges(normal, slip, forces=slice(None)):
    return both(times("charged_ridges_in_contact", normal, forces), times("full_slip_ridges_in_contact", slip, forces))


def put(name, value):
    return lambda grid: dict(grid) | {name: np.broadcast_to(np.asarray(value, dtype=float), grid[name].shape)}


def lose(plain, charged):
    """Return a change of the grid: shares of the contact length that sliding loses at 0 and at 200 V, by force."""

    def change(grid):
        slip = grid["charged_contact_length"] * 0.9
        for k, lost in ((0, plain), (-1, charged)):
            slip[:, k] = grid["charged_contact_length"][:, k] * (1 - lost)
        return dict(grid) | {"full_slip_contact_length": slip}

    return change


FIRST, EVEN = slice(0, 1), np.full(8, 0.05)
FALLING = np.linspace(0.1, 0.06, 8)


@pytest.mark.parametrize(
    ("words", "change", "verdict"),
    [
        ("1.7 to 3", put("gaps_within", 0), NOT),
        ("1.7 to 3", both(put("gaps", 40), put("gaps_within", [[0]] * 5 + [[40]] * 3)), NOT),
        ("1.7 to 3", both(put("gaps", 40), put("gaps_within", [[0]] * 4 + [[40]] * 4)), IN_PART),
        ("1.7 to 3", both(put("gaps", 40), put("gaps_within", 21)), HOLDS),
        ("more than 100 %", times("full_slip_f_t", 2.1), HOLDS),
        ("more than 100 %", times("full_slip_f_t", 1.9), NOT),
        ("more than 100 %", times("full_slip_f_t", 2.1, FIRST), NOT),
        ("more than 100 %", times("full_slip_f_t", [2.1] * 4 + [1.9] * 4), IN_PART),
        ("below 50 V", times("full_slip_f_t", 1.04, voltage=50.0), HOLDS),
        ("below 50 V", times("full_slip_f_t", 1.21, voltage=50.0), NOT),
        ("below 50 V", times("full_slip_f_t", 1.06, voltage=50.0), IN_PART),
        ("largest at small", times("full_slip_f_t", np.linspace(3, 2, 8)), HOLDS),
        ("largest at small", times("full_slip_f_t", np.linspace(2, 3, 8)), NOT),
        ("largest at small", times("full_slip_f_t", [3, 2, 2.5, 2, 2, 2, 2, 2]), IN_PART),
        ("much less", both(times("full_slip_f_t", 2.0), lengths(1.3, 1.3)), HOLDS),
        ("much less", both(times("full_slip_f_t", 1.2), lengths(1.3, 1.3)), IN_PART),
        ("much less", both(times("full_slip_f_t", 2.0), lengths(1.01, 1.01)), NOT),
        ("20 % larger", lengths(1.21, 1.21), HOLDS),
        ("20 % larger", lengths(1.19, 1.19), NOT),
        ("20 % larger", lengths(1.41, 1.41), NOT),
        ("20 % larger", lengths(1.3, 1.1), IN_PART),
        ("20 % larger", lengths(1.3, 1.5), IN_PART),
        ("20 % larger", both(lengths(1.1, 1.1), lengths(1.3, 1.3, FIRST)), NOT),
        ("new ridges in contact", both(lengths(1.5, 1.5), ridges(1.2, 1.2)), HOLDS),
        ("new ridges in contact", both(lengths(1.5, 1.5), ridges(1.0, 1.0)), IN_PART),
        ("new ridges in contact", both(lengths(1.1, 1.1), ridges(1.2, 1.2)), NOT),
        ("new ridges in contact", both(lengths(1.5, 1.5), ridges(1.2, 1.2, FIRST)), IN_PART),
        ("average ridge", put("full_slip_ridges_in_contact", 10), IN_PART),
        ("ridges fewer", put("full_slip_ridges_in_contact", 10), NOT),
        ("ridges fewer", put("full_slip_ridges_in_contact", [[10]] + [[8]] * 7), IN_PART),
        ("up to 12 %", lose(EVEN, EVEN + 0.06), HOLDS),
        ("up to 12 %", lose(EVEN, EVEN + 0.2), IN_PART),
        ("up to 12 %", put("full_slip_contact_length", 1.0), NOT),
        ("up to 12 %", lose(np.array([-0.01] + [0.05] * 7), EVEN + 0.06), IN_PART),
        ("enhances", lose(EVEN, EVEN + FALLING), HOLDS),
        ("enhances", lose(EVEN, EVEN + FALLING[::-1]), NOT),
        ("enhances", lose(EVEN, EVEN - FALLING[::-1]), NOT),
        ("enhances", lose(EVEN, EVEN + [0.12, 0.05, 0.12, 0.12, 0.06, 0.04, 0.06, 0.04]), IN_PART),
        ("enhances", lose(EVEN - 0.04, EVEN + FALLING), HOLDS),
        ("enhances", lose(EVEN * ([0.1] * 4 + [1] * 4), EVEN * ([0.3] * 4 + [1.4] * 4)), IN_PART),
        ("even without", lose(EVEN + 0.01, EVEN), HOLDS),
        ("even without", lose(EVEN - 0.01, EVEN), NOT),
        ("even without", lose(FALLING - 0.02, EVEN), IN_PART),
        ("increases the contact pressure", times("full_slip_f_t", 3.0, voltage=150.0), HOLDS),
        ("increases the contact pressure", times("full_slip_f_t", 1.04, voltage=150.0), NOT),
        ("largest tangential force", both(lengths(1.1, 1.1), times("full_slip_f_t", 0.9)), NOT),
        ("about linear", lose(EVEN, -EVEN), NOT),
    ],
)
def test_verdict_on_the_grid(grid, words, change, verdict):
    """Each statement holds, holds in part or fails with the numbers of the grid that it is about."""
    assert by(judged(change(grid)), words).verdict == verdict


def test_loads_out_of_line_are_named(grid):
    """The largest loss and the next one; a shorter contact of the same ridges; no ratio where sliding gains."""
    lost = np.full(8, 0.1)
    lost[2] = 0.2
    found = judged(lose(np.array([0.05] * 7 + [-0.01]), lost)(grid))
    assert by(found, "up to 12 %").why.startswith("20 % is at 25 N/m and 200 V, where the number of ridges falls by 1;")
    assert by(found, "up to 12 %").numbers["second"] == pytest.approx(0.1)
    assert "0 V loses nothing: 150 N/m" in by(found, "enhances").ours
    assert by(found, "enhances").numbers["small_most"] == pytest.approx(4)
    same = both(put("moved", [[0]] + [[2]] * 7), put("full_slip_ridges_in_contact", 20))
    assert by(judged(same(grid)), "average ridge").why.startswith(
        "over 5 % at 16 of 16: ridges come and go at 14; at 5 N/m and 0 V, 5 N/m and 200 V the same"
    )


def test_ridges_that_come_and_leave_are_counted(grid):
    """Ridge -5 leaves and ridge 5 comes, at every load."""
    assert (grid["moved"] == 2).all()


def test_reduction_is_fitted(grid):
    """Nearly linear, since the stress counts with the length that is left."""
    found = friction.reduction(grid)
    assert found.stress.size == 40
    assert found.slope == pytest.approx(2e-5, rel=0.1)
    assert found.r_squared > 0.99


def test_markers_of_the_reductions_are_of_their_voltage(grid):
    """A colour a voltage, over f_T / L_R of its runs in kPa."""
    figure = Figure()
    friction.paint(figure, grid)
    markers = {line.get_color(): line for line in figure.axes[1].lines if line.get_linestyle() == "None"}
    for k, voltage in enumerate(VOLTAGES):
        stress = 1e-3 * grid["full_slip_f_t"][:, k] / grid["full_slip_contact_length"][:, k]
        assert markers[style.voltage(voltage)].get_xdata() == pytest.approx(stress, rel=1e-12)


def test_waves_need_ridges_that_come_and_go(grid):
    """Rises of the length by more than 1 % at each voltage, ridges that leave at the back and new ones in front."""

    def verdict(**changed):
        return by(judged(grid, PATHS | changed), "wavy").verdict

    assert by(judged(grid), "wavy").numbers == PATHS
    assert verdict() == HOLDS
    assert verdict(left_0=0.0) == verdict(new_200=0.0) == verdict(rise_0=0.009) == IN_PART
    assert verdict(rise_0=0.009, rise_200=0.009) == IN_PART  # the cause is there at every voltage
    assert verdict(rise_0=0.009, new_200=0.0) == NOT
    assert by(judged(grid, PATHS | {"rise_0": 0.009}), "wavy").why.endswith("at 0 V the waves are under 1 %")


def test_paths_count_rises_and_ridges():
    """The length falls, then rises; ridge -5 leaves, ridge 5 comes. One that comes at the back does not count."""
    run = state(120.0, 0.0)
    run.steps["contact_length"] = np.array([3.0, 1.0, 2.0])
    found = friction.paths({(120.0, 0.0): run, (75.0, 0.0): state(75.0, 0.0)})
    assert found == pytest.approx({"rise_0": 1 / 3, "left_0": 1.0, "new_0": 1.0})
    run.steps["contact_length"] = np.array([3.0, 2.0, 1.0])
    run.on_ridges = lambda row, name: (np.array([0, 1, 5]) if row == 0 else np.array([-3, 0]), None)
    assert friction.paths({(120.0, 0.0): run}) == {"rise_0": 0.0, "left_0": 0.0, "new_0": 0.0}


def test_picture_has_units(grid):
    figure = Figure()
    friction.paint(figure, grid)
    assert all(ax.has_data() and "(" in ax.get_ylabel() for ax in figure.axes)


def test_verdicts():
    """One that holds by construction can fail all the same."""
    given = (True,), (False, True), (False,)
    assert [statement("papillae", {"plain": 2, "charged": 3}, *g).verdict for g in given] == [HOLDS, IN_PART, NOT]
    assert [statement("frequency", {"turns": 1}, *g).verdict for g in given] == [BUILT, IN_PART, NOT]
