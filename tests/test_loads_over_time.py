"""A small finger under voltages over time: as by loads by hand, and what is the same whatever the sign or the place."""

import math
import tomllib
from html import escape
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from fingerpad.model.options import FingerModel, by_rule, plan
from fingerpad.model.simulation import Simulation
from fingerpad.report.run_page import page
from fingerpad.results.over_time import NOTE, without_parts_of_jumps
from fingerpad.results.pictures.drawing import Drawing
from fingerpad.results.result import Result
from fingerpad.results.states import load_result
from fingerpad.runs import full
from fingerpad.runs.context import RunContext
from fingerpad.scene import Load, Scene, from_data
from fingerpad.scene.waveform import SAMPLES
from variational.state import ContactState

pytestmark = pytest.mark.slow
SMALL = tomllib.loads((Path(__file__).parents[1] / "demos/scenes/small_finger.toml").read_text(encoding="utf-8"))
SCALE = 2.0  # of the steps: half of the samples of a period
FINGER = {
    "geometry": SMALL["geometry"],
    "mesh": SMALL["mesh"] | {"contact": 40e-6},
    "output": {"receptors": False, "errors": False},
    "numerics": {"step_scale": SCALE},
}
MU_0 = 0.25
PRESS = {"name": "press", "f_ext": 1.0}
SLIDE = {"name": "slide", "bone_x": 256e-6}
WAVE = {"waveform": "sine", "amplitude": 80.0, "frequency": 60.0, "offset": 20.0}
BY = {"name": "wave", "bone_x_by": 128e-6, "duration": 1 / 60}
FORCE = {"waveform": "sine", "amplitude": 0.25, "frequency": 60.0, "offset": 1.0}
HEIGHT = {"waveform": "triangle", "amplitude": 30e-6, "frequency": 60.0, "offset": -20e-6}
PLACE = {"waveform": "sine", "amplitude": 100e-6, "frequency": 60.0}
WAVES = {
    "voltage": ([PRESS, SLIDE], BY | {"voltage": WAVE}),
    "f_ext": ([PRESS, SLIDE], BY | {"f_ext": FORCE}),
    "bone_height": (
        [{"name": "lower", "bone_height": -20e-6}, {"name": "charge", "voltage": 60.0}],
        {"name": "wave", "bone_height": HEIGHT, "duration": 1 / 60},
    ),
    "bone_x": ([PRESS], {"name": "wave", "bone_x": PLACE, "duration": 1 / 60}),
}
"""By the control over time: the loads before it, and its load."""


def scene(*loads: dict, **more) -> Scene:
    return from_data(FINGER | {"history": list(loads)} | more)


_GONE: dict[str, list[ContactState]] = {}


def follow(*loads: dict, **more) -> list[ContactState]:
    """Return the states of a small finger's path; a path is gone once."""
    key = str((loads, more))
    if key not in _GONE:
        asked = by_rule(scene(*loads, **more))
        path = Simulation(FingerModel(asked, plan(asked)), MPI.COMM_WORLD)
        assert path.run() is None
        _GONE[key] = path.states
    return _GONE[key]


def same(a: list[ContactState], b: list[ContactState], but: tuple[str, ...] = ()) -> bool:
    """Return whether two paths are the same bit for bit, but for some of their columns; on one rank.

    On several the order of sums is left to the messages, also of one path gone twice.
    """
    left_out = {"load", "load_number", *but}
    rows = [[{k: v for k, v in state.row().items() if k not in left_out} for state in path] for path in (a, b)]
    return str(rows[0]) == str(rows[1])


# -- what it is ----------------------------------------------------------------------------------------
@pytest.mark.parametrize("key", WAVES)
def test_waveform_is_the_loads_by_hand(key):
    """One load at each sample, as the paper's Fig. 9B was done before: full slip does not depend on the steps.

    The height leaves the screen and comes back: ridges jump at the same heights. The place goes there and back, and
    friction remembers the same way. The air gaps are found to 1e-8: at 97 V a contact length changes 150 times as much
    as the friction, in parts.
    """
    exact = {"numerics": {"coupling_tolerance": 1e-8, "step_scale": SCALE}}
    before, wave = WAVES[key]
    states = [state for state in follow(*before, wave, **exact) if state.load == "wave"]
    samples, slides = Load(**wave).wave.samples(1 / 60, SCALE), "bone_x_by" in wave
    assert len(states) == pytest.approx(len(samples), abs=2)  # the first is a jump of 20 V
    places = [{"bone_x": 256e-6 + 128e-6 * t * 60} if slides else {} for t, _ in samples]
    hand = [{"name": f"{k}", key: round(x, 12), **places[k]} for k, (_, x) in enumerate(samples)]
    ends = {state.load: state for state in follow(*before, *hand, **exact)}
    for k, (time, value) in enumerate(samples):
        mine, other = next(s for s in reversed(states) if s.time == pytest.approx(time, abs=1e-12)), ends[f"{k}"]
        assert getattr(mine, key) == pytest.approx(value, rel=1e-9, abs=1e-9 if key == "voltage" else 1e-15)
        if slides:
            assert mine.bone_x == pytest.approx(places[k]["bone_x"], rel=1e-12)
            if k > 0:  # the bone stands during a jump
                friction = MU_0 * (mine.f_ext + mine.f_electrostatic)
                assert mine.all_slip and mine.f_t == pytest.approx(friction, rel=1e-6)
        assert (mine.f_t, mine.f_ext) == pytest.approx((other.f_t, other.f_ext), rel=1e-6, abs=1e-9)
        lengths = mine.contact_length, mine.bone_height
        assert lengths == pytest.approx((other.contact_length, other.bone_height), rel=1e-5, abs=1e-12)


@pytest.mark.mpi
def test_force_over_time_without_friction_has_no_history():
    """From the air on: up, down and through the same force again, at the same height. Tolerance: Newton's."""
    states = follow({"name": "wave", "f_ext": FORCE, "duration": 1 / 60}, friction=0.0)
    passes = [state.bone_height for state in states if state.f_ext == pytest.approx(1.0) and state.load == "wave"]
    assert len(passes) == 3 and passes == pytest.approx([passes[0]] * 3, rel=1e-8)


def test_finger_is_lifted_by_a_ramp():
    """By a table of heights, from a force on: the force falls until nothing touches."""
    ramp = {"waveform": "file", "times": [0.0, 1.0], "values": [-20e-6, 20e-6]}
    lift = [state for state in follow(PRESS, {"name": "lift", "bone_height": ramp}) if state.load == "lift"]
    assert lift[0].f_ext > 0 and lift[-1].f_ext == pytest.approx(0.0, abs=1e-9) and lift[-1].ridges_in_contact == 0
    assert all(a.f_ext >= b.f_ext - 1e-9 for a, b in zip(lift, lift[1:], strict=False))


def test_sign_of_the_voltage_changes_nothing():
    """Bit for bit: of a table, and where a sign changes between two loads."""
    for up, down in (
        (
            [{"name": "a", "voltage": 50.0}, {"name": "b", "voltage": 90.0}],
            [{"name": "a", "voltage": 50.0}, {"name": "b", "voltage": -90.0}],
        ),
        (
            [{"name": "table", "voltage": {"waveform": "file", "times": [0, 1, 2], "values": [0, 90, 30]}}],
            [{"name": "table", "voltage": {"waveform": "file", "times": [0, 1, 2], "values": [0, -90, -30]}}],
        ),
    ):
        plus, minus = follow(PRESS, *up, SLIDE), follow(PRESS, *down, SLIDE)
        assert same(plus, minus, but=("voltage",))
        assert [abs(state.voltage) for state in minus] == [state.voltage for state in plus]
        assert minus[-1].voltage < 0


def test_relative_moves_are_moves():
    """There and back and there again: bit for bit the path of absolute places."""
    places, moves = (2**-13, -(2**-14), 0.0), (2**-13, -3 * 2**-14, 2**-14)  # m, sums without rounding
    absolute = [{"name": f"{k}", "bone_x": x} for k, x in enumerate(places)]
    relative = [{"name": f"{k}", "bone_x_by": x} for k, x in enumerate(moves)]
    assert same(follow(PRESS, *absolute), follow(PRESS, *relative))


@pytest.mark.parametrize(
    "wave", [WAVE, {"waveform": "file", "times": [0, 1 / 60], "values": [0, 100]}], ids=["sine", "file"]
)
def test_every_state_is_at_the_voltage_of_its_time(wave):
    """Also where the bone moves so far between two samples that steps are cut. Tolerance: roundoff of the square."""
    states = follow(PRESS, {"name": "wave", "bone_x_by": 4e-3, "duration": 1 / 60, "voltage": wave})
    states = [state for state in states if state.time > 0]  # a jump takes no time
    assert len(states) > 1.25 * SAMPLES / SCALE

    def voltage(time: float) -> float:
        if wave["waveform"] == "sine":
            return 20 + 80 * math.sin(2 * math.pi * 60 * time)
        return 100 * 60 * time

    for state in states:
        assert state.voltage == pytest.approx(voltage(state.time), rel=1e-9, abs=1e-6)


@pytest.mark.mpi
def test_move_after_full_slip_and_its_time():
    """It starts where the slide stopped; time passes with the way of the bone, at its speed."""
    slide = {"name": "slide", "bone_x": 2e-3, "until_full_slip": True, "speed": 0.02}
    states = follow(PRESS, slide, {"name": "on", "bone_x_by": -100e-6, "speed": 0.01})
    stop = [state for state in states if state.load == "slide"][-1]
    assert stop.slip_held and stop.bone_x < 1e-3
    assert states[-1].bone_x == pytest.approx(stop.bone_x - 100e-6, rel=1e-12)
    assert {state.time for state in states if state.load in ("touch", "press")} == {0.0}
    for state in (state for state in states if state.load == "slide"):
        assert state.time == pytest.approx(state.bone_x / 0.02, rel=1e-12)
    assert states[-1].time == pytest.approx(stop.time + 0.01, rel=1e-12)


def test_square_jumps_at_one_place():
    """The bone stands while the voltage jumps, up and down; the forces on either side are those of the plateaus."""
    states = follow(PRESS, SLIDE, BY | {"voltage": WAVE | {"waveform": "square"}, "duration": 1.6 / 60})
    wave = [state for state in states if state.load == "wave"]
    assert {round(state.voltage) for state in wave} >= {100, -60}
    for jump in (0.5, 1.0, 1.5):
        here = [state for state in wave if state.time == pytest.approx(jump / 60, abs=1e-12)]
        assert len(here) >= 2 and len({state.bone_x for state in here}) == 1
        assert {abs(here[0].voltage), abs(here[-1].voltage)} == {100.0, 60.0}
    for voltage in (100.0, -60.0):
        # The slip that a jump takes is over within the first samples of a plateau.
        plateau = [state.f_t for state in wave if state.voltage == voltage][-3:]
        assert plateau == pytest.approx([plateau[-1]] * 3, rel=1e-5)


def test_parts_of_a_jump_are_no_extremes():
    """A large jump is done in parts, at voltages that a square never has; at its begin, too."""
    square = {"waveform": "square", "amplitude": 5.0, "offset": 95.0, "frequency": 60.0}
    path = follow(PRESS, SLIDE, BY | {"voltage": square}, numerics={"step_scale": 1.0})
    states = [state for state in path if state.load == "wave"]
    own = [state for state in states if min(abs(state.voltage - u) for u in (100.0, 90.0)) < 1e-6]
    assert len(own) < len(states)
    assert without_parts_of_jumps(states, states[0].time) == own
    picture = Drawing(MU_0, path, {}, {}, {}, None, {}).figure("time")
    drawn = picture.axes[0].lines[0].get_ydata()
    assert set(np.round(drawn, 6)) <= {0.0, 100.0, 90.0}
    least = load_result("wave", states, None, (), scene(PRESS, BY | {"voltage": square}).history[1].wave).extremes
    assert least["f_electrostatic"].min == min(state.f_electrostatic for state in own)


def test_bone_at_a_height():
    """Under a voltage over time it stays there; what it presses with falls where the attraction rises."""
    lower = {"name": "lower", "bone_height": -30e-6}
    wave = {"name": "wave", "duration": 1 / 60, "voltage": WAVE | {"waveform": "triangle", "offset": 0.0}}
    states = [state for state in follow(lower, wave) if state.load == "wave"]
    assert all(state.bone_height == pytest.approx(-30e-6, rel=1e-12) and state.bone_x == 0 for state in states)
    assert len(states) == pytest.approx(SAMPLES / SCALE + 1, abs=1)
    forces = {round(abs(state.voltage), 6): state.f_ext for state in states}
    assert [forces[u] for u in sorted(forces)] == sorted(forces.values(), reverse=True)
    assert forces[80.0] < 0.99 * forces[0.0]


# -- results -------------------------------------------------------------------------------------------
def result(*loads: dict, out: Path | None = None, **more) -> Result:
    return full.run(scene(*loads, **more), RunContext(out, bar=False))


def test_results_of_a_run(tmp_path):
    """Time, means, extremes and spectrum in every file; one picture a load at most, none by choice; a report."""
    quiet = FINGER["output"] | {"each_load": False}
    found = result(PRESS, SLIDE, BY | {"voltage": WAVE}, out=tmp_path, output=quiet)
    wave = found.loads[-1]
    assert not found.failure and NOTE in found.notes
    assert [load.over_time is None for load in found.loads] == [True, True, False]
    assert wave.over_time.periods == 1 and wave.over_time.frequency[0] == pytest.approx(60.0)
    most = wave.extremes["f_t"]
    peak = next(state for state in found.steps if state.step == most.max_step)
    assert (peak.voltage, most.max_time) == (100.0, pytest.approx(0.25 / 60))
    assert not list(tmp_path.glob("finger_*")) and not list(tmp_path.glob("surface_*"))
    assert (tmp_path / "time.png").is_file() and (tmp_path / "surface.png").is_file()
    again = Result.load(tmp_path)
    assert again.loads[-1].extremes == wave.extremes and again.loads[-1].over_time == wave.over_time
    assert [state.time for state in again.steps] == [state.time for state in found.steps]
    data = found.to_xarray()
    assert data.load_f_t_amplitude.sel(load="wave").values == pytest.approx(wave.over_time.f_t_amplitude)
    assert np.isnan(data.load_f_t_mean.sel(load="slide")) and data.time.attrs["units"] == "s"
    assert data.harmonic.size == 6 and data.load_frequency.attrs["units"] == "Hz"
    shown = page(found).replace("\u00a0", " ")  # between a value and its unit
    mu, mean = wave.extremes["mu_app"], wave.over_time.mean["mu_app"]
    most = np.argmax(wave.over_time.f_t_amplitude)
    amplitude = f"amplitude of f_T at {60 * (most + 1)} Hz {wave.over_time.f_t_amplitude[most]:.3f} N/m"
    assert f"  wave: µ_app {mu.min:.4f} to {mu.max:.4f}, mean {mean:.4f}; {amplitude}\n" in str(found)
    assert f"</sub> from {mu.min:.4f} to {mu.max:.4f} <" in shown and "In the load wave the friction force" in shown
    assert "in the load wave, over time" in shown
    assert "Loads over time" in shown and "sine of 80 V about 20 V at 60 Hz" in shown and escape(NOTE) in shown


def test_friction_over_time_is_that_of_the_force():
    """By Coulomb's law at each instant: its amplitude is that of the force times µ_0, by cubics between samples."""
    found = result(PRESS, SLIDE, BY | {"f_ext": FORCE})
    load = found.loads[-1]
    assert not found.failure and load.full_slip_part == 1 and load.over_time.frequency[0] == pytest.approx(60.0)
    assert load.over_time.f_t_amplitude[0] == pytest.approx(0.25 * MU_0, rel=2e-3)
    assert load.over_time.mean["f_t"] == pytest.approx(MU_0, rel=2e-3)
    assert load.extremes["f_t"].max == pytest.approx(1.25 * MU_0, rel=1e-6)
    assert (load.extremes["f_ext"].min, load.over_time.mean["f_ext"]) == pytest.approx((0.75, 1.0), rel=1e-3)
    assert "In the load wave the friction force" in str(found)


def test_first_touch_has_no_estimated_errors():
    """A finger that slides as it is pressed has no normal contact, of which errors could be estimated."""
    found = result(
        PRESS | {"bone_x": 1e-4}, {"name": "charge", "voltage": 50.0}, output=FINGER["output"] | {"errors": True}
    )
    assert found.charged is None and found.full_slip is not None
    estimated = found.record["accuracy"]["quantities"]
    assert estimated and not any(key.startswith("charged_") for key in estimated)
