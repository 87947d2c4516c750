"""Controls of a load: each a number or a waveform of its own unit, from one registry; a small finger under them."""

import pickle

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fingerpad as fp
from fingerpad.scene import SceneError, from_data
from fingerpad.scene.keys import by_name
from fingerpad.scene.loads import Load, keys_of_load
from fingerpad.scene.scene import Scene
from tests.test_loads_over_time import MU_0, PRESS, SCALE, SLIDE, follow, result
from variational.state import ContactState

WAVES = {name: key for name, key in keys_of_load().items() if key.wave is not None}
SINE = {"waveform": "sine", "frequency": 2.0}
FORCE = SINE | {"offset": 1.0, "amplitude": 0.6}
HEIGHT = SINE | {"waveform": "triangle", "offset": -20e-6, "amplitude": 30e-6}
TABLE = {"waveform": "file", "times": [0, 1]}


# -- scenes --------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", WAVES)
def test_every_control_is_a_waveform_of_its_own_unit(name):
    """With the ranges and the unit of its key in the reference; pickled and printed as any scene."""
    limits = WAVES[name].limits
    of = {"amplitude": f"{limits.high / 200} {limits.unit}", "offset": limits.high / 100}
    scene = from_data({"history": [PRESS, {"name": "wave", "duration": 1.0, name: SINE | of}]})
    assert scene.history[1].wave.peak == pytest.approx(0.015 * limits.high)
    assert pickle.loads(pickle.dumps(scene)) == scene == from_data(scene.parameters())
    key = by_name(Scene)[f"history[].{name}.amplitude"]
    assert (key.unit, key.limits.high) == (limits.unit, limits.high)
    words = "0.5 mm about 1 mm" if limits.unit == "m" else f"25 {limits.unit} about 50 {limits.unit}"
    assert f": sine of {words} at 2 Hz" in next(scene.history[1].aims())


@pytest.mark.parametrize(
    ("load", "message"),
    [
        ({"f_ext": FORCE | {"amplitude": 1.5}}, "f_ext.offset is 1 and history[1].f_ext.amplitude is 1.5, together"),
        ({"f_ext": FORCE | {"amplitude": 1.0}}, "f_ext goes through 0 while voltage is 0, where nothing holds"),
        ({"f_ext": FORCE | {"offset": "1 V"}}, "f_ext.offset is '1 V'; its unit is not a unit of force per length"),
        ({"f_ext": FORCE | {"carrier": {"frequency": 9.0}}}, "f_ext.carrier is not a key of history[1].f_ext; did you"),
        ({"f_ext": TABLE | {"values": [1.0, -1.0]}}, "f_ext.values[1] is -1 N/m; it must be 0 or from 0.001"),
        ({"f_ext": FORCE, "voltage": 9.0}, "voltage is 9 and history[1].f_ext is a waveform; history[1].voltage must"),
        ({"f_ext": FORCE, "bone_height": HEIGHT}, "f_ext is a waveform and history[1].bone_height is a waveform; at"),
        ({"bone_height": HEIGHT | {"offset": 0.09, "amplitude": 0.02}}, "bone_height.offset is 0.09 and history[1]."),
        ({"bone_height": HEIGHT, "duration": None}, "bone_height is a triangle and the load takes no time; give a hi"),
        ({"bone_height": HEIGHT, "duration": 1e4}, "bone_height has 2e+04 periods in 10000 s, some 4.8e+05 steps; th"),
        ({"bone_height": TABLE | {"values": [0.0, 1e-3]}, "duration": 2.0}, "bone_height has values up to 1 s and t"),
        ({"bone_x": HEIGHT, "speed": 0.1, "duration": None}, "speed is 0.1 and the bone does not move by a number"),
        ({"bone_x": HEIGHT, "until_full_slip": True}, "bone_x is a waveform and history[1].until_full_slip is true"),
    ],
    ids=lambda value: "" if isinstance(value, dict) else value[:30],
)
def test_waveforms_are_refused_as_voltages_are(load, message):
    """In one sentence that begins with the key."""
    with pytest.raises(SceneError) as error:
        from_data({"history": [PRESS, {"name": "wave", "duration": 1.0} | load]})
    assert str(error.value).startswith(f"history[1].{message}") and ". " not in str(error.value)


def test_files_are_read_in_the_unit_of_their_control(tmp_path):
    """Newtons per metre and micrometres of one file, by their columns."""
    rows = zip((0, 500, 1000), (0.01, 0.02, 0.01), (-20, 0, 5e-4), strict=True)
    text = "\n".join(["t/ms,F (N/cm),h/um", *(",".join(map(str, row)) for row in rows)])
    (tmp_path / "both.csv").write_text(text, encoding="utf-8")
    of = {"waveform": "file", "file": str(tmp_path / "both.csv")}
    loads = [PRESS, {"name": "a", "f_ext": of | {"column": "F"}}, {"name": "b", "bone_height": of | {"column": "h"}}]
    force, height = (load.wave for load in from_data({"history": loads}).history[1:])
    assert (force.times, force.values) == ((0, 0.5, 1), (1, 2, 1))
    assert height.values == (pytest.approx(-20e-6), 0, 0), "less than a nanometre is none"
    with pytest.raises(SceneError, match=r"f_ext.file is .* has 'h/um' in 'um', which is not a unit of force per len"):
        from_data({"history": [{"name": "a", "f_ext": of | {"column": "h"}}]})


# -- a small finger ------------------------------------------------------------------------------------
def by_numbers(key: str, states: list[ContactState], before: list[dict], every: int = 1, **more) -> None:
    """Compare the states of a load over time with those of one load at each of some of them, given as numbers.

    Tolerance: of Newton's method and of the air gaps, which the voltage multiplies.
    """
    chosen = [state for state in states if state.load == "wave" and state.time > 0][every - 1 :: every]
    hand = [{"name": f"{k}", key: float(f"{getattr(state, key):.12g}")} for k, state in enumerate(chosen)]
    ends = {state.load: state for state in follow(*before, *hand, **more)}
    for k, state in enumerate(chosen):
        for name in ("f_ext", "bone_height", "contact_length", "f_t", "f_electrostatic"):
            assert_allclose(getattr(state, name), getattr(ends[f"{k}"], name), rtol=1e-6, atol=1e-12)


@pytest.mark.slow
@pytest.mark.mpi
def test_force_over_time_is_the_loads_by_numbers():
    """Without friction nothing remembers: up and down, and the same at 1 N/m each time it passes there."""
    states = follow({"name": "wave", "f_ext": FORCE, "duration": 0.5}, friction=0.0)
    by_numbers("f_ext", states, [], 3, friction=0.0)
    for state in states:
        if state.time > 0:
            assert state.f_ext == pytest.approx(1.0 + 0.6 * np.sin(4 * np.pi * state.time), rel=1e-9)
    passes = [state.bone_height for state in states if state.f_ext == pytest.approx(1.0) and state.load == "wave"]
    assert len(passes) == 3 and passes == pytest.approx([passes[0]] * 3, rel=1e-8)


@pytest.mark.slow
def test_height_there_and_back_under_voltage():
    """Off the screen and on it again: the ridges jump, at the same heights as by numbers."""
    before = [{"name": "lower", "bone_height": -20e-6}, {"name": "charge", "voltage": 60.0}]
    exact = {"numerics": {"coupling_tolerance": 1e-8, "step_scale": SCALE}}
    states = follow(*before, {"name": "wave", "bone_height": HEIGHT, "duration": 0.5}, **exact)
    by_numbers("bone_height", states, before, **exact)
    wave = [state for state in states if state.load == "wave"]
    assert min(state.contact_length for state in wave) == 0.0 < wave[-1].contact_length


@pytest.mark.slow
def test_force_over_time_in_a_slide(tmp_path):
    """Friction follows Coulomb's law at each instant, so that its amplitude is that of the force times µ_0."""
    wave = {"name": "wave", "f_ext": FORCE | {"amplitude": 0.25}, "bone_x_by": 500e-6, "duration": 0.5}
    found = result(PRESS, SLIDE, wave, out=tmp_path)
    load = found.loads[-1]
    assert not found.failure and load.full_slip_part == 1 and load.over_time.periods == 1
    assert load.over_time.frequency[0] == 2.0
    assert load.over_time.f_t_amplitude[0] == pytest.approx(0.25 * MU_0, rel=2e-3)  # between samples by cubics
    assert load.over_time.mean["f_t"] == pytest.approx(MU_0, rel=2e-3)
    assert load.extremes["f_t"].max == pytest.approx(1.25 * MU_0, rel=1e-6)
    assert fp.Result.load(tmp_path).loads[-1].over_time == load.over_time
    assert "In the load wave the friction force" in str(found)


@pytest.mark.slow
def test_place_over_time_is_the_moves_by_numbers():
    """There and back: friction remembers the way, and both go the same one."""
    wave = Load(name="wave", bone_x=SINE | {"amplitude": 100e-6}, duration=0.5)
    states = follow(PRESS, wave.model_dump(exclude_none=True))
    by_numbers("bone_x", states, [PRESS])
    assert min(state.f_t for state in states) < 0 < max(state.f_t for state in states)


@pytest.mark.slow
def test_finger_is_lifted_by_a_ramp():
    """By a table of heights, from a force on: the force falls until nothing touches."""
    ramp = {"waveform": "file", "times": [0.0, 1.0], "values": [-20e-6, 20e-6]}
    states = follow(PRESS, {"name": "lift", "bone_height": ramp})
    lift = [state for state in states if state.load == "lift"]
    assert lift[0].f_ext > 0 and lift[-1].f_ext == pytest.approx(0.0, abs=1e-9) and lift[-1].ridges_in_contact == 0
    assert all(a.f_ext >= b.f_ext - 1e-9 for a, b in zip(lift, lift[1:], strict=False))
    assert [state.bone_height for state in lift[1:]] == pytest.approx([40e-6 * s.time - 20e-6 for s in lift[1:]])
