"""Which states of a history have a name: histories that people invent, as rows without a finger."""

import itertools
import math
from dataclasses import replace

import pytest

from fingerpad.results import states
from fingerpad.scene import Load
from tests.measures import contact_state
from variational.state import ContactState

STEADY, LEAST = 1e-6, 1e-9
MU_0 = 0.25


class History:
    """Rows of a finger that sticks for a tenth of a millimetre after each turn and slips from there on."""

    def __init__(self) -> None:
        self.rows: list[ContactState] = []
        self.x, self.voltage, self.f_ext, self.numbers = 0.0, 0.0, 1.0, itertools.count(1)
        self._anchor = 0.0  # where the bone turned last

    def _row(self, load: str, number: int, all_slip: bool, f_t: float) -> None:
        state = ContactState(
            step=len(self.rows) + 1, load=load, load_number=number, f_ext=self.f_ext, voltage=self.voltage,
            bone_x=self.x, bone_height=-1e-5, f_t=f_t, mu_app=f_t / self.f_ext if self.f_ext else 0.0,
            f_contact=self.f_ext + self._attraction, f_electrostatic=self._attraction,
            ridges_in_contact=3 if self.f_ext > 0 else 0, contact_length=1e-4 * self.f_ext,
            slipping=float(all_slip), all_slip=all_slip,
        )  # fmt: skip
        began, held = states.full_slip(self.rows, state, STEADY, LEAST)
        self.rows.append(replace(state, slip_began=began, slip_held=held))

    @property
    def _attraction(self) -> float:
        return (self.voltage / 100) ** 2

    def still(self, load: str, f_ext: float | None = None, voltage: float | None = None) -> None:
        """Press or charge in two steps; the last one sticks."""
        number, start = next(self.numbers), (self.f_ext, self.voltage)
        for part in (0.5, 1.0):
            self.f_ext = start[0] if f_ext is None else start[0] + part * (f_ext - start[0])
            self.voltage = start[1] if voltage is None else start[1] + part * (voltage - start[1])
            self._row(load, number, False, self.rows[-1].f_t if self.rows else 0.0)
        self._anchor = self.x

    def slide(self, load: str, x: float, voltages: float | None = None) -> None:
        """Slide by 50 um a step, at another voltage in each step where one is to be reached."""
        number, start, steps = next(self.numbers), (self.x, self.voltage), round(abs(x - self.x) / 50e-6)
        if self.rows[-1].f_t * (x - self.x) < 0:
            self._anchor = self.x
        for k in range(1, steps + 1):
            self.x = start[0] + k / steps * (x - start[0])
            if voltages is not None:
                self.voltage = start[1] + k / steps * (voltages - start[1])
            way = 1 if x > start[0] else -1
            slips = abs(self.x - self._anchor) > 0.1e-3 - 1e-9
            cone = MU_0 * (self.f_ext + self._attraction)
            self._row(load, number, slips, way * cone * min(1.0, abs(self.x - self._anchor) / 0.1e-3))

    def names(self) -> dict[str, tuple[str, float, float]]:
        """Return load, voltage and place (mm) of each named state."""
        found = states.named(self.rows).items()
        return {name: (state.load, state.voltage, round(state.bone_x * 1e3, 9)) for name, state in found}


@pytest.fixture
def pressed() -> History:
    history = History()
    history.still("press", f_ext=2.0)
    return history


def test_press_charge_slide(pressed):
    """Full slip is the first of its states, which slides on by 0.2 mm; before there is none, partial or full."""
    assert states.partial_slip(pressed.rows) is None
    pressed.still("charge", voltage=80.0)
    pressed.slide("slide", 0.4e-3)
    assert pressed.names() == {
        "uncharged": ("press", 0.0, 0.0),
        "charged": ("charge", 80.0, 0.0),
        "full_slip": ("slide", 80.0, 0.1),
    }
    assert states.partial_slip(pressed.rows).bone_x < 0.1e-3 + 1e-12


def test_full_slip_is_no_partial_slip(pressed):
    """Not where a slide has no other state either, and not where a state of full slip is nearer to one half."""
    pressed.slide("slide", 0.4e-3)
    partial = states.partial_slip(pressed.rows)
    assert not partial.all_slip
    rows = [row for row in pressed.rows if row.load == "press" or row.all_slip]
    assert rows[-1].slip_held and states.partial_slip(rows) is None
    rows = [replace(row, slipping=0.5) if row.all_slip else row for row in pressed.rows]
    assert states.partial_slip(rows) == partial


def test_sign_of_the_voltage_is_no_other_state(pressed):
    """A negative voltage is one, and full slip goes on where the voltage changes its sign alone."""
    pressed.still("charge", voltage=-80.0)
    assert pressed.names() == {"uncharged": ("press", 0.0, 0.0), "charged": ("charge", -80.0, 0.0)}
    pressed.slide("slide", 0.2e-3)
    pressed.voltage = 80.0
    pressed.slide("slide on", 0.35e-3)
    assert pressed.names()["full_slip"] == ("slide", -80.0, 0.1)


PRESSED = {"uncharged": ("press", 0.0, 0.0), "charged": ("press", 0.0, 0.0)}
ALTERNATING = (80.0, 0.0, 80.0, 0.0)
CHARGE = ("charge", {"voltage": 80.0})
AIR = [("lift", {"f_ext": 0.0}), ("over", 1e-3), ("again", {"f_ext": 2.0}), CHARGE, ("slide", 1.4e-3)]
CHARGING = [("slide", 0.4e-3), ("charge while sliding", 0.8e-3, 200.0)]
AFTER = {"uncharged": ("again", 0.0, 1.0), "charged": ("charge", 80.0, 1.0), "full_slip": ("slide", 80.0, 1.1)}


@pytest.mark.parametrize(
    ("way", "named"),
    [
        ([], {}),
        ([("slide", 0.25e-3)], {}),
        ([("slide", 0.3e-3)], {"full_slip": ("slide", 0.0, 0.1)}),
        ([("slide", 0.4e-3), CHARGE, ("on", 0.8e-3)], {"full_slip": ("on", 80.0, 0.5)}),
        ([("slide", 0.4e-3), CHARGE, ("on", 0.55e-3)], {"full_slip": ("slide", 0.0, 0.1)}),
        ([("there", 0.4e-3), ("back", 0.0)], {"full_slip": ("back", 0.0, 0.3)}),
        ([("there", 0.1e-3), ("back", -0.3e-3)], {"full_slip": ("back", 0.0, 0.0)}),
        ([("slide", 0.4e-3), ("lift", {"f_ext": 0.5})], {"full_slip": ("slide", 0.0, 0.1)}),
        ([(f"part {k}", 0.3e-3 * k, u) for k, u in enumerate(ALTERNATING, start=1)], {}),
        ([(f"to {u:g}", {"voltage": u}) for u in (80.0, 0.0, 80.0)], {"charged": ("to 80", 80.0, 0.0)}),
        (AIR, AFTER),
        (CHARGING, {"full_slip": ("slide", 0.0, 0.1)}),
        ([*CHARGING, ("on", 1.1e-3)], {"full_slip": ("charge while sliding", 200.0, 0.8)}),
    ],
    ids=[
        "press alone", "0.15 mm of further sliding", "0.2 mm", "two full slips", "ends in the middle of a slip",
        "there and back", "at x = 0 on the way back", "lift", "charged by turns in sliding", "at rest",
        "through the air", "charged while it slides", "and slides on",
    ],
)  # fmt: skip
def test_named_states_of_a_way(pressed, way, named):
    """A full slip that was not held leaves the one before; it keeps its load where unloading sticks.

    The bone has moved, wherever it is now; a way in the air is no slide. Uncharged is before the first voltage.
    """
    for name, end, *voltage in way:
        if isinstance(end, dict):
            pressed.still(name, **end)
        else:
            pressed.slide(name, end, *voltage)
    assert pressed.names() == PRESSED | named
    slip = states.named(pressed.rows).get("full_slip")
    assert slip is None or (slip.f_ext == 2.0 and (slip.f_t < 0) == (slip.load == "back"))


@pytest.mark.parametrize("touches", [False, True], ids=["presses there", "touches as it moves"])
def test_bone_that_goes_aside_in_the_air(touches):
    """Normal contact is at the place where it is pressed at rest; one that moves as it touches makes none."""
    history = History()
    history.f_ext = 0.0
    history.still("wait", f_ext=0.0)
    if touches:
        history.x, history.f_ext = 50e-6, 1.0
    else:
        history.slide("away", 1e-3)
        history.still("press", f_ext=1.0)
        history.still("charge", voltage=100.0)
    history.slide("slide", history.x + 0.5e-3)
    names = history.names()
    assert names["full_slip"][0] == "slide" and (touches or names["full_slip"][2] > 1.0)
    assert names.get("charged") == (None if touches else ("charge", 100.0, 1.0))
    assert touches or names["uncharged"] == ("press", 0.0, 1.0)


def test_all_points_slip_without_friction_before_the_bone_moves():
    """Without friction every state is on its cone; full slip begins with the sliding."""
    rows: list[ContactState] = []
    for step, x in enumerate((0.0, 0.0, 0.1e-3, 0.2e-3, 0.3e-3), start=1):
        state = contact_state(step=step, bone_x=x, all_slip=True)
        began, held = states.full_slip(rows, state, STEADY, LEAST)
        rows.append(replace(state, slip_began=began, slip_held=held))
    assert [row.slip_began for row in rows] == [0, 0, 3, 3, 3]
    assert [row.slip_held for row in rows] == [False] * 4 + [True]


@pytest.mark.parametrize(("name", "change"), [("f_t", 2e-6), ("f_ext", 2e-6), ("voltage", 1e-6)])
def test_forces_that_change_end_a_full_slip(pressed, name, change):
    """Twice what is allowed of a force, a millionth of a voltage; half of what is allowed changes nothing."""
    pressed.still("charge", voltage=80.0)
    pressed.slide("slide", 0.2e-3)
    last = pressed.rows[-1]
    for part, same in ((1.0, False), (0.25, name != "voltage")):
        values = {"step": last.step + 1, "bone_x": 0.25e-3, name: getattr(last, name) * (1 + part * change)}
        row = replace(last, **values)
        began, _ = states.full_slip(pressed.rows, row, STEADY, 0.0)
        assert began == (last.slip_began if same else row.step)


def test_each_load_has_its_summary(pressed):
    """The state at its end, extremes with their steps, and whether full slip was reached and held."""
    pressed.slide("slide", 0.4e-3)
    pressed.still("charge", voltage=80.0)
    pressed.slide("slide on", 0.55e-3)
    found = [states.load_result(name, mine, None) for name, mine in states.by_load(pressed.rows)]
    assert [load.name for load in found] == ["press", "slide", "charge", "slide on"]
    assert [(load.full_slip_reached, load.full_slip_held) for load in found] == [
        (False, False),
        (True, True),
        (False, False),
        (True, False),
    ]
    slide = found[1]
    assert slide.end.f_t == slide.extremes["f_t"].max == pytest.approx(MU_0 * 2.0)
    assert slide.extremes["f_t"].min_step == pressed.rows[2].step
    assert slide.end.step == pressed.rows[9].step


def test_friction_without_a_force_has_no_coefficient(pressed):
    """It is neither zero nor the least: extremes are of the states that have one, and left out where none has."""
    pressed.slide("slide", 0.4e-3)
    lifted = replace(pressed.rows[-1], mu_app=math.nan)
    whole, before, up = (
        states.load_result("", rows, None).extremes for rows in ([*pressed.rows, lifted], pressed.rows, [lifted])
    )
    assert repr(whole["mu_app"]) == repr(before["mu_app"])
    assert "mu_app" not in up and up["f_t"].min == lifted.f_t


def test_first_press_begins_unloaded(pressed):
    """A first load over time by the bone's height has no state at its begin: the mean is that from zero on."""
    two = [replace(pressed.rows[0], time=t, contact_length=1e-3 * t) for t in (1.0, 2.0)]
    passed = states.load_result("press", two, None).over_time
    assert (passed.start, passed.seconds) == (0.0, 2.0)
    assert passed.mean["contact_length"] == pytest.approx(1e-3, rel=1e-12)
    assert math.isnan(passed.mean["mu_app"])


def test_touch_belongs_to_the_load_on_the_way():
    """And a load that has the name of another one is a load of its own."""
    history = History()
    history.still("touch", f_ext=1.5)
    history.rows = [replace(state, load_number=1) for state in history.rows]
    history.numbers = itertools.count(1)
    history.still("press", f_ext=2.0)
    history.still("press", f_ext=3.0)
    assert [(name, len(mine)) for name, mine in states.by_load(history.rows)] == [("press", 4), ("press", 2)]
    stopped = states.load_results(history.rows[:1], [Load(name="press", f_ext=2.0)], lambda end: None)
    assert [load.name for load in stopped] == ["press"], "a run stopped in the first touch"


@pytest.mark.parametrize("slides", [False, True])
def test_first_touch_is_no_named_state(slides):
    """Its depth is the program's: 0.17 N/m where a load asks for 0.05 N/m, charged or sliding."""
    history = History()
    history.still("touch", f_ext=0.17)
    history.rows = [replace(state, load_number=1) for state in history.rows]
    history.numbers = itertools.count(1)
    if slides:
        history.slide("press", 0.5e-3)
    else:
        history.still("press", f_ext=0.05, voltage=100.0)
    found = states.named(history.rows)
    assert "uncharged" not in found and ("charged" in found) == (not slides)
    assert not states.named(history.rows[:2], ["press"]), "a run that was cut short in the touch"
    (press,) = states.load_results(history.rows, [Load(name="press", f_ext=0.05)], lambda end: None)
    own = [state.contact_length for state in history.rows if state.load == "press"]
    assert press.extremes["contact_length"].max == max(own)
