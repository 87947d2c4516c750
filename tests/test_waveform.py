"""Controls over time in scenes: their samples, files, units and refusals."""

import math
import pickle

import pytest

from fingerpad.scene import Scene, SceneError, from_data, load, override
from fingerpad.scene.keys import by_name
from fingerpad.scene.loads import keys_of_load
from fingerpad.scene.waveform import MOST, SAMPLES, Waveform

SINE = {"waveform": "sine", "amplitude": 200.0, "frequency": 60.0}
PRESS = {"name": "press", "f_ext": 1.0}
FORCE = SINE | {"offset": 1.0, "amplitude": 1.0}
LIFT = SINE | {"amplitude": 1e-3}
LONG = {"duration": 1.0}
TABLE = "time (s),voltage (V)\n"


def wave(duration: float = 1.0, **keys) -> Waveform:
    return from_data({"history": [PRESS, {"name": "wave", "duration": duration, "voltage": keys}]}).history[1].wave


def shape(keys: dict, time: float) -> float:
    """Return a voltage of a sine, square or triangle by another formula than the program's."""
    phase = 2 * math.pi * keys["frequency"] * time
    by = {
        "sine": math.sin(phase),
        "square": math.copysign(1.0, math.sin(phase)),
        "triangle": 2 / math.pi * math.asin(math.sin(phase)),
    }
    return keys.get("offset", 0.0) + keys["amplitude"] * by[keys["waveform"]]


# -- samples -------------------------------------------------------------------------------------------
@pytest.mark.parametrize("offset", [50.0, -120.0, 250.0])
@pytest.mark.parametrize("kind", ["sine", "triangle"])
def test_samples_are_of_the_wave(kind, offset):
    """Their times increase, from 0 to the end, with every turning point, and with a zero between two signs."""
    keys = SINE | {"waveform": kind, "offset": offset}
    seconds = 2.3 / 60
    samples = wave(**keys).samples(seconds, 1.0)
    times, values = zip(*samples, strict=True)
    assert times[0] == 0 and times[-1] == seconds and all(b > a for a, b in zip(times, times[1:], strict=False))
    assert values == pytest.approx([shape(keys, time) for time in times], abs=1e-9)
    assert wave(**keys).at(times) == pytest.approx(values, abs=1e-9)
    assert all(a * b >= 0 for a, b in zip(values, values[1:], strict=False))
    assert values.count(max(values)) == 3 and max(values) == offset + 200 and min(values) == offset - 200
    assert len(samples) >= 2.3 * SAMPLES


def test_square_jumps_both_ways():
    """Two samples of one time are a jump, and the voltage is constant between jumps."""
    samples = wave(**SINE | {"waveform": "square", "offset": 50.0}).samples(2 / 60, 1.0)
    jumps = [(a, b) for a, b in zip(samples, samples[1:], strict=False) if a[0] == b[0]]
    assert [(a[1], b[1]) for a, b in jumps] == [(250, -150), (-150, 250), (250, -150)]
    assert [a[0] * 60 for a, _ in jumps] == pytest.approx([0.5, 1.0, 1.5])
    assert samples[0] == (0.0, 250.0) and samples[-1] == (2 / 60, -150.0)
    assert all(a[1] == b[1] for a, b in zip(samples, samples[1:], strict=False) if a[0] < b[0])


def test_flat_parts_of_a_file_have_samples_behind_a_jump():
    """As many as half a square's period, also where the load begins; where nothing jumped a piece is one step."""
    burst = {"waveform": "file", "times": (0, 0.01, 0.010001, 0.02, 0.03), "values": (0, 0, 100, 100, 100)}
    times = [time for time, _ in wave(0.03, **burst).samples(0.03, 1.0)]
    counts = [sum(a < time <= b for time in times) for a, b in ((0, 0.01), (0.010001, 0.02), (0.02, 0.03))]
    assert counts == [SAMPLES // 2, SAMPLES // 2, 1]
    dense = [k / SAMPLES for k in range(SAMPLES + 1)]  # of a sine: no jump in it
    sine = {"waveform": "file", "times": dense, "values": [100 * math.sin(2 * math.pi * t) for t in dense]}
    assert len(wave(**sine).samples(1.0, 1.0)) <= SAMPLES + 1 + SAMPLES // 2


def test_file_is_straight_between_its_points(write, tmp_path):
    """With its zeros and more samples where the voltage changes much; the scene keeps the points and not the file."""
    (tmp_path / "mine.csv").write_text(TABLE + "0,0\n0.01,100\n\n0.02,-100\n0.04,-100\n", encoding="utf-8")
    path = write(
        '[[history]]\nname = "press"\nf_ext = 1\n[[history]]\nname = "wave"\n'
        'voltage = { waveform = "file", file = "mine.csv" }\n'
    )
    scene = load(path)
    found = scene.history[1].wave
    assert (found.times, found.values) == ((0, 0.01, 0.02, 0.04), (0, 100, -100, -100))
    assert from_data(scene.parameters()) == scene and "mine" not in str(scene.parameters())
    samples = found.samples(0.04, 1.0)
    assert {(0.0, 0.0), (0.01, 100.0), (0.015, 0.0), (0.02, -100.0), (0.04, -100.0)} <= set(samples)
    assert max(abs(b[1] - a[1]) for a, b in zip(samples, samples[1:], strict=False)) <= 2 * math.pi / SAMPLES * 100
    assert found.samples(0.005, 1.0)[-1] == pytest.approx((0.005, 50.0))


# -- keys ----------------------------------------------------------------------------------------------
def test_units_and_changes(write):
    """Units work within a load and a waveform, and so do changes of the command line."""
    path = write(
        '[[history]]\nname = "press"\nf_ext = 1\n[[history]]\nname = "wave"\nbone_x_by = "1 mm"\nspeed = "20 mm/s"\n'
        'voltage = { waveform = "sine", amplitude = "0.2 kV", frequency = "0.06 kHz", offset = "-50 V" }\n'
    )
    key, value = override("history[1].voltage.frequency=50 Hz")
    scene = load(path, {key: value})
    assert str(scene.history[1].wave) == "sine of 200 V about -50 V at 50 Hz"
    assert (scene.history[1].bone_x_by, scene.history[1].speed) == (1e-3, 0.02)
    assert load(path, {"history[1].voltage": "-80 V"}).history[1].level == -80.0


@pytest.mark.parametrize("name", [name for name, key in keys_of_load().items() if key.wave is not None])
def test_every_control_is_a_waveform_of_its_own_unit(name):
    """With the ranges and the unit of its key in the reference; pickled and printed as any scene."""
    limits = keys_of_load()[name].limits
    of = {"amplitude": f"{limits.high / 200} {limits.unit}", "offset": limits.high / 100, "waveform": "square"}
    scene = from_data({"history": [PRESS, {"name": "wave", "duration": 1.0, name: SINE | of}]})
    assert scene.history[1].wave.peak == pytest.approx(0.015 * limits.high)
    assert pickle.loads(pickle.dumps(scene)) == scene == from_data(scene.parameters())
    key = by_name(Scene)[f"history[].{name}.amplitude"]
    assert (key.unit, key.limits.high) == (limits.unit, limits.high)
    words = "0.5 mm about 1 mm" if limits.unit == "m" else f"25 {limits.unit} about 50 {limits.unit}"
    assert f": square of {words} at 60 Hz" in next(scene.history[1].aims())


# -- refusals ------------------------------------------------------------------------------------------
def refusal(*loads: dict) -> str:
    with pytest.raises(SceneError) as error:
        from_data({"history": [PRESS, *loads]})
    return str(error.value)


@pytest.mark.parametrize(
    ("load_", "message"),
    [
        ({"voltage": SINE}, "history[1].voltage is a sine and the load takes no time"),
        ({"voltage": SINE, "bone_x": 0.0, "speed": 0.1}, "history[1].speed is 0.1 and the bone is there already"),
        ({"bone_x": 1e-3, "bone_x_by": 1e-3}, "history[1].bone_x is 0.001 and history[1].bone_x_by is 0.001"),
        ({"bone_x": 1e-3, "speed": 0.1, "duration": 1.0}, "history[1].speed is 0.1 and history[1].duration is 1"),
        ({"voltage": SINE, "duration": 1.0, "f_ext": 2.0}, "history[1].f_ext is 2 and history[1].voltage is a wave"),
        ({"voltage": SINE, "speed": 0.1}, "history[1].speed is 0.1 and the bone does not move"),
        ({"voltage": SINE | {"amplitude": 4e3, "offset": -2e3}, "duration": 1.0}, "history[1].voltage.offset is -2000"),
        (
            {"voltage": SINE, "bone_x_by": 1e-3, "speed": 0.1, "until_full_slip": True},
            "history[1].voltage is a waveform and history[1].until_full_slip is true",
        ),
        (
            {"voltage": SINE, "duration": 100.0},
            f"history[1].voltage has 6000 periods in 100 s, some 1.44e+05 steps; there must be at most {MOST} of them",
        ),
        (
            {"voltage": {"waveform": "sine", "amplitude": 3.0}, "duration": 1.0},
            "history[1].voltage.frequency is missing; history[1].voltage.waveform is 'sine' and needs it",
        ),
        (
            {"voltage": {"waveform": "file", "times": [0, 1], "values": [0, 9]}, "duration": 2.0},
            "history[1].voltage has values up to 1 s and the load takes 2 s",
        ),
        (
            {"f_ext": FORCE | {"amplitude": 1.5}} | LONG,
            "history[1].f_ext.offset is 1 and history[1].f_ext.amplitude is",
        ),
        ({"f_ext": FORCE} | LONG, "history[1].f_ext goes through 0 while voltage is 0, where nothing holds the skin"),
        ({"f_ext": FORCE | {"offset": "1 V"}}, "history[1].f_ext.offset is '1 V'; its unit is not a unit of force per"),
        ({"f_ext": FORCE | {"carrier": {"frequency": 9.0}}}, "history[1].f_ext.carrier is not a key of history[1].f_"),
        ({"f_ext": {"waveform": "file", "times": [0, 1], "values": [1, -1]}}, "history[1].f_ext.values[1] is -1 N/m;"),
        ({"f_ext": FORCE, "voltage": SINE} | LONG, "history[1].voltage is a waveform and history[1].f_ext is a wave"),
        ({"f_ext": FORCE, "bone_height": LIFT}, "history[1].f_ext is a waveform and history[1].bone_height is a wave"),
        ({"bone_height": LIFT | {"offset": 0.1}} | LONG, "history[1].bone_height.offset is 0.1 and history[1].bone_h"),
        ({"bone_height": LIFT}, "history[1].bone_height is a sine and the load takes no time; give a history[1].speed"),
        ({"bone_x": LIFT, "speed": 0.1}, "history[1].speed is 0.1 and the bone does not move by a number; give a his"),
        ({"bone_x": LIFT, "until_full_slip": True} | LONG, "history[1].bone_x is a waveform and history[1].until_ful"),
    ],
    ids=lambda value: "" if isinstance(value, dict) else value[:40],
)
def test_contradictions_are_refused(load_, message):
    """In one sentence that begins with the key."""
    found = refusal({"name": "wave"} | load_)
    assert found.startswith(message) and len(found) <= 280 and ". " not in found


@pytest.mark.parametrize(("points", "allowed"), [(1900, False), (1000, True)])
def test_steps_of_a_table_are_counted(points, allowed):
    """From 100 to -100 V and back at each point takes eight steps: four to zero, and four on; the first piece 12."""
    times, voltages = [1e-3 * k for k in range(points)], [100.0 * (-1) ** k for k in range(points)]
    table = {"waveform": "file", "times": times, "values": voltages}
    load_ = {"name": "wave", "duration": times[-1], "voltage": table}
    if allowed:
        wave = from_data({"history": [PRESS, load_]}).history[1].wave
        assert wave.count(times[-1], 1.0) == len(wave.samples(times[-1], 1.0)) == 8 * (points - 1) + 5
    else:
        assert refusal(load_).startswith(f"history[1].voltage has {points} points, some 1.52e+04 steps; there must be")


def test_time_that_is_not_known_is_refused():
    """A place after a load that may stop early; the same move relative to it is known."""
    slide = {"name": "slide", "bone_x": 1e-3, "until_full_slip": True}
    after = {"name": "wave", "speed": 0.1, "voltage": SINE}
    assert refusal(slide, after | {"bone_x": 2e-3}).startswith("history[2].bone_x is 0.002 after a load that may stop")
    assert from_data({"history": [PRESS, slide, after | {"bone_x_by": 2e-3}]})


@pytest.mark.parametrize(("offset", "allowed"), [(0.0, False), (200.0, False), (201.0, True), (-201.0, True)])
def test_nothing_but_the_voltage_holds_the_skin(offset, allowed):
    """At f_ext 0 a voltage over time must not reach 0."""
    loads = [
        {"name": "charge", "voltage": 100.0},
        {"name": "unload", "f_ext": 0.0},
        {"name": "wave", "duration": 1.0, "voltage": SINE | {"offset": offset}},
    ]
    if allowed:
        assert from_data({"history": [PRESS, *loads]})
    else:
        assert refusal(*loads).startswith("history[3].voltage goes through 0 while f_ext is 0")
    assert refusal({"name": "wave", "duration": 1.0, "voltage": SINE}, {"name": "unload", "f_ext": 0.0}).startswith(
        "history[2].name is 'unload', which ends at f_ext 0 and voltage 0"
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (None, "which cannot be read: 'No such file or directory'"),
        (TABLE + "0,1\n1,inf\n", "which has 'inf' in line 3 of 'voltage (V)'; it must be a finite number"),
        (TABLE + "0,1\n1,6000\n", "which at 1 s has a number that is 6000 V; it must be 0 or from 0.001 to 5000 V"),
        (
            TABLE + "".join(f"{k},{(-1) ** k}\n" for k in range(2500)),
            "which has 2500 points; there must be from 2 to 2000 of them, and means of 2 have 0.0",
        ),
    ],
    ids=lambda value: str(value)[:40],
)
def test_files_are_refused(tmp_path, text, message):
    """In one sentence that names the file or its line, and what must be there."""
    file = tmp_path / "mine.csv"
    if text is not None:
        file.write_text(text, encoding="utf-8")
    found = refusal({"name": "wave", "voltage": {"waveform": "file", "file": str(file)}})
    assert message in found.replace("history[1].voltage.", "") and found.startswith("history[1].voltage")
