"""Voltages over time as oscilloscopes write them: preambles, units, columns, probes, many samples; and repeated."""

import re

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fingerpad as fp
from fingerpad.cli import main
from fingerpad.model import drive_loads
from fingerpad.scene.wavefile import table
from fingerpad.scene.waveform import Waveform

T = np.linspace(-0.01, 0.01, 41)
U = 1.5 * np.sin(2 * np.pi * 100 * T)
PLAIN = "".join(f"{t:.6e},{u:.6e}\n" for t, u in zip(T, U, strict=True))
TWO = "".join(f"{t:.6e},{u:.6e},{-u / 2:.6e}\n" for t, u in zip(T, U, strict=True))
COMMAS = "".join(f"{1e3 * t:.4f};{1e3 * u:.4f}\n" for t, u in zip(T, U, strict=True)).replace(".", ",")
FILES = {
    "units in a line of their own": "Record Length,41\nSample Interval,5e-4\nSource,CH1\nSecond,Volt\n" + PLAIN,
    "semicolons and decimal commas": "Zeit;Kanal A\n(ms);(mV)\n\n" + COMMAS,
    "heads of NumPy": "# t/ms,U/kV\n" + "".join(f"{1e3 * t:.4f},{u / 1e3:.9f}\n" for t, u in zip(T, U, strict=True)),
}


def write(folder, text) -> str:
    file = folder / "scope.csv"
    file.write_bytes(text.encode("latin-1"))
    return str(file)


@pytest.mark.parametrize("text", FILES.values(), ids=FILES)
def test_files_of_instruments(text, tmp_path):
    """The same sine: from 0 on, whose last sample closes the period. Tolerance: of the digits that are written."""
    found = table(write(tmp_path, text), probe=100.0)
    assert found["times"][0] == 0
    assert_allclose(found["times"], T + 0.01, atol=1e-8)
    assert_allclose(found["voltages"], 100 * U, atol=0.01)
    wave = Waveform(waveform="file", **found)
    assert wave.period == pytest.approx(0.02)


@pytest.mark.parametrize(
    ("column", "factor"), [("CH1 (V)", 1.0), ("ch1", 1.0), ("CH1 (left) [kV]", -500.0), ("CH1 (left)", -500.0)]
)
def test_columns_are_named_as_written_with_their_units(column, factor, tmp_path, capsys):
    """Brackets in a name belong to it; only the last ones have the unit. A command takes the same names."""
    file = tmp_path / "scope.csv"
    file.write_text("time (s),CH1 (V),CH1 (left) [kV]\n" + TWO, encoding="utf-8")
    assert_allclose(table(str(file), column)["voltages"], factor * U, atol=1e-3)
    assert main(["drive", "--file", str(file), "--column", column, "--frequency", "60"]) == 0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "X,CH1,Start,Increment\nSequence,Volt,0,1e-4\n0,1\n1,2\n2,1\n",
            "nothing named or united as time among 'Sequence' or 'Volt'",
        ),
        ("Source,CH1\nSecond,Ampere\n0,1\n1,2\n", "which has 'CH1' in 'Ampere', which is not known; it must be in V"),
        ("Second,Volt\n0,1\n1,\n2,3\n", "which has nothing in line 3 of 'Volt'; it must be a finite number"),
        ("", "which has no numbers below a header"),
        ("t,u\n0,1\n1,2\n1,3\n", "times are 1 and then 1 s; each must be later"),
    ],
)
def test_refusals(text, message, tmp_path):
    with pytest.raises(fp.SceneError, match=re.escape(message)) as refused:
        fp.Scene(voltage={"waveform": "file", "file": write(tmp_path, text)})
    assert str(refused.value).startswith("voltage.") and ". " not in str(refused.value)


@pytest.mark.parametrize(
    ("wave", "words"),
    [
        ({"waveform": "sine", "amplitude": 1.0, "frequency": 1.0, "probe": 10.0}, "voltage.probe is 10 and no volt"),
        ({"waveform": "file", "times": [0, 1], "voltages": [0, 1], "column": "CH1"}, "voltage.column is 'CH1' and no"),
        ({"waveform": "file", "file": "x.csv", "probe": 0.0}, "voltage.probe is 0; it must be from 0.001 to 100000"),
        ({"waveform": "sine", "amplitude": 1.0, "frequency": 1.0, "repeat": True}, "voltage.repeat is true and volt"),
    ],
)
def test_keys_of_files_are_refused(wave, words):
    with pytest.raises(fp.SceneError) as refused:
        fp.Scene(voltage=wave)
    assert str(refused.value).startswith(words)


# -- repeated ----------------------------------------------------------------------------------------------------
def test_repeated_table_is_that_of_its_periods():
    """Samples, corners and count of three periods and a half, with a jump where the ends differ."""
    one, values = [0.0, 0.01, 0.03, 0.04], [0.0, 100.0, 100.0, 50.0]
    again = Waveform(waveform="file", times=one, voltages=values, repeat=True)
    samples = again.samples(0.14, 1.0)
    assert [t for t, u in samples if u == 0.0] == pytest.approx([0.0, 0.04, 0.08, 0.12])
    assert samples.count((0.04, 50.0)) == samples.count((0.04, 0.0)) == 1
    assert samples[-1] == pytest.approx((0.14, 100.0))
    assert again.end == np.inf and again.corners(0.05) == pytest.approx([*one, 0.04, 0.05])
    assert again.count(0.12, 1.0) == 3 * len(again.samples(0.04, 1.0))
    closed = Waveform(waveform="file", times=one, voltages=[0.0, 100.0, 100.0, 0.0], repeat=True)
    times = [t for t, _ in closed.samples(0.12, 1.0)]
    assert len(set(times)) == len(times), "no jump where the last sample is the first one"


def test_repeated_table_is_followed_in_a_load(tmp_path):
    """For longer than its file; through a circuit with losses as a sine of the same voltages."""
    t = np.linspace(0, 0.02, 49)
    values = 150 * np.sin(100 * np.pi * t)
    file = {"waveform": "file", "times": t.tolist(), "voltages": values.tolist(), "repeat": True}
    sine = {"waveform": "sine", "amplitude": 150.0, "frequency": 50.0}
    found = []
    for voltage in (file, sine):
        loads = [{"name": "press", "f_ext": 1.0}, {"name": "wave", "duration": 0.05, "voltage": voltage}]
        wave = drive_loads.loads(fp.Scene(history=loads, electric={"tissue": "dry", "leak": 300.0}))[1].wave
        found.append(np.interp(np.linspace(0, 0.05, 101), wave.times, wave.voltages))
    assert_allclose(*found, atol=1.5)
    once = file | {"repeat": False}
    with pytest.raises(fp.SceneError, match="has values up to 0.02 s and the load takes 0.05 s"):
        fp.Scene(history=[{"name": "press", "f_ext": 1.0}, {"name": "wave", "duration": 0.05, "voltage": once}])
