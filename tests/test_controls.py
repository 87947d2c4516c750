"""Controls of a load: each a number or a waveform of its own unit, from one registry."""

import pickle

import pytest

from fingerpad.scene import SceneError, from_data
from fingerpad.scene.keys import by_name
from fingerpad.scene.loads import keys_of_load
from fingerpad.scene.scene import Scene

PRESS = {"name": "press", "f_ext": 1.0}
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
