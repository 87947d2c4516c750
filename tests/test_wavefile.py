"""Voltages over time as oscilloscopes write them: preambles, heads, units, columns, times; and repeated."""

import re

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fingerpad as fp
from fingerpad.cli import main
from fingerpad.model import drive_loads
from fingerpad.scene.controls import VOLTAGE, VoltageWaveform
from fingerpad.scene.wavefile import table

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
    found = table(write(tmp_path, text), VOLTAGE.limits, probe=100.0)
    assert found["times"][0] == 0
    assert_allclose(found["times"], T + 0.01, atol=1e-8)
    assert_allclose(found["values"], 100 * U, atol=0.01)
    wave = VoltageWaveform(waveform="file", **found)
    assert wave.period == pytest.approx(0.02)


@pytest.mark.parametrize(
    ("column", "factor"), [("CH1 (V)", 1.0), ("ch1", 1.0), ("CH1 (left) [kV]", -500.0), ("CH1 (left)", -500.0)]
)
def test_columns_are_named_as_written_with_their_units(column, factor, tmp_path, capsys):
    """Brackets in a name belong to it; only the last ones have the unit. A command takes the same names."""
    file = tmp_path / "scope.csv"
    file.write_text("time (s),CH1 (V),CH1 (left) [kV]\n" + TWO, encoding="utf-8")
    assert_allclose(table(str(file), VOLTAGE.limits, column)["values"], factor * U, atol=1e-3)
    assert main(["drive", "--file", str(file), "--column", column, "--frequency", "60"]) == 0


def test_files_are_read_in_the_unit_of_their_control(tmp_path):
    """Newtons per metre and metres of one file, by their columns; less than a nanometre is none."""
    of = {"waveform": "file", "file": write(tmp_path, "t/ms,F (N/cm),h/um\n0,0.01,-20\n500,0.02,0\n1000,0.01,5e-4\n")}
    loads = [{"name": "a", "f_ext": of | {"column": "F"}}, {"name": "b", "bone_height": of | {"column": "h"}}]
    force, height = (load.wave for load in fp.Scene(history=loads).history)
    assert (force.times, force.values) == ((0, 0.5, 1), (1, 2, 1))
    assert height.values == (pytest.approx(-20e-6), 0, 0)
    with pytest.raises(fp.SceneError, match="has 'h/um' in 'um', which is not a unit of force per length"):
        fp.Scene(history=[{"name": "a", "f_ext": of | {"column": "h"}}])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "X,CH1,Start,Increment\nSequence,Volt,0,1e-4\n0,1\n1,2\n2,1\n",
            "nothing named or united as time among 'Sequence' or 'Volt'",
        ),
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
        ({"waveform": "file", "times": [0, 1], "values": [0, 1], "column": "CH1"}, "voltage.column is 'CH1' and no"),
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
    again = VoltageWaveform(waveform="file", times=one, values=values, repeat=True)
    samples = again.samples(0.14, 1.0)
    assert [t for t, u in samples if u == 0.0] == pytest.approx([0.0, 0.04, 0.08, 0.12])
    assert samples.count((0.04, 50.0)) == samples.count((0.04, 0.0)) == 1
    assert samples[-1] == pytest.approx((0.14, 100.0))
    assert again.end == np.inf and again.corners(0.05) == pytest.approx([*one, 0.04, 0.05])
    assert again.count(0.12, 1.0) == 3 * len(again.samples(0.04, 1.0))
    closed = VoltageWaveform(waveform="file", times=one, values=[0.0, 100.0, 100.0, 0.0], repeat=True)
    times = [t for t, _ in closed.samples(0.12, 1.0)]
    assert len(set(times)) == len(times), "no jump where the last sample is the first one"


def test_repeated_table_is_followed_in_a_load(tmp_path):
    """For longer than its file; through a circuit with losses as a sine of the same voltages."""
    t = np.linspace(0, 0.02, 49)
    values = 150 * np.sin(100 * np.pi * t)
    file = {"waveform": "file", "times": t.tolist(), "values": values.tolist(), "repeat": True}
    sine = {"waveform": "sine", "amplitude": 150.0, "frequency": 50.0}
    found = []
    for voltage in (file, sine):
        loads = [{"name": "press", "f_ext": 1.0}, {"name": "wave", "duration": 0.05, "voltage": voltage}]
        wave = drive_loads.loads(fp.Scene(history=loads, electric={"tissue": "dry", "leak": 300.0}))[1].wave
        found.append(np.interp(np.linspace(0, 0.05, 101), wave.times, wave.values))
    assert_allclose(*found, atol=1.5)
    once = file | {"repeat": False}
    with pytest.raises(fp.SceneError, match="has values up to 0.02 s and the load takes 0.05 s"):
        fp.Scene(history=[{"name": "press", "f_ext": 1.0}, {"name": "wave", "duration": 0.05, "voltage": once}])


# -- heads, units and times of records: names decide, what is not read is refused, and a drive has whole periods -----
TIMES = np.linspace(0.0, 20.0, 41)  # ms
PRESS = {"name": "press", "f_ext": 5.0}
VOLTS = 100 * np.sin(2 * np.pi * 50e-3 * TIMES)  # V, of 50 Hz


def written(folder, head, *columns, mark=",", comma=False):
    """Return a file of a head and columns of numbers."""
    lines = [mark.join(f"{x:.9g}" for x in row) for row in zip(*columns, strict=True)]
    text = "\n".join([head, *(line.replace(".", ",") if comma else line for line in lines)]) + "\n"
    (folder / "scope.csv").write_text(text, encoding="utf-8")
    return str(folder / "scope.csv")


def sine(periods, samples, start=0.0):
    """Return times (s) and voltages (V) of a sine of 50 Hz and 100 V."""
    t = np.linspace(0.0, periods / 50, samples)
    return t, 100 * np.sin(2 * np.pi * (50 * t + start))


# -- heads and units -------------------------------------------------------------------------------------------------
HEADS = {
    "a count before the time": ("Sample,Time(S),CH1(V)", (np.arange(41), TIMES / 1e3, VOLTS)),
    "a unit for a name": ("msecs,value 1", (TIMES, VOLTS)),
    "the time at the end": ("U [mV],current (mA),T [us]", (1e3 * VOLTS, 0 * VOLTS, 1e3 * TIMES)),
    "a line of units": ("Time,Channel A\n(ms),(mV)", (TIMES, 1e3 * VOLTS)),
    "preamble with units": ("Model,X\nHorizontal Units,ms\nVertical Units,kV\nLabel,\nTIME,CH1", (TIMES, VOLTS / 1e3)),
    "comments": ("#Device Name: X\n#Serial: 5, 6\nTime (s),Channel 1 (V)", (TIMES / 1e3, VOLTS)),
}


@pytest.mark.parametrize(("head", "columns"), HEADS.values(), ids=HEADS)
def test_names_and_units_decide(head, columns, tmp_path):
    """One sine of 20 ms and 100 V under the heads of several programs; tolerance of the digits written."""
    found = table(written(tmp_path, head, *columns), VOLTAGE.limits, repeat=True)
    assert_allclose(found["times"], TIMES / 1e3, atol=1e-10)
    assert_allclose(found["values"], np.where(abs(VOLTS) < 1e-3, 0, VOLTS), atol=1e-6)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a,b\n0,0\n1,2\n2,0\n", "has nothing named or united as time among 'a' or 'b'"),
        (
            "time (s),CH1 (Vpp)\n0,0\n1,2\n2,0\n",
            "has 'CH1 (Vpp)' in 'Vpp', which is V, and pp is a measure of a drive; it must",
        ),
        (
            "ticks,msecs,value 1\n0,0,0\n1,2,3\n",
            "has 'ticks' or 'msecs' or 'value 1', and history[1].voltage.column is not given",
        ),
        ("time (s),I/mA\n0,0\n1,2\n2,0\n", "has 'I/mA' in 'mA', which is not a unit of voltage; it must be in V"),
        ("time (s),U (V)\n0,0,1\n1,2,5\n", "has more cells in line 2 than its 2 heads; decimals have points"),
        ("time (s),U (kV)\n0,0\n1,1e308\n", "has '1e308' in line 3 of 'U (kV)'; it must be a finite number"),
        ('time (s),U (V)\n0,"0\n1,1\n', "is no table in CSV: a quotation in line 2 does not end there"),
    ],
)
def test_what_is_not_read_is_refused(text, said, tmp_path):
    (tmp_path / "scope.csv").write_text(text, encoding="utf-8")
    wave = {"waveform": "file", "file": str(tmp_path / "scope.csv")}
    try:
        fp.Scene(history=[PRESS, {"name": "wave", "duration": 0.1, "voltage": wave}])
    except fp.SceneError as error:
        assert said is not None and f"which {said}" in str(error)
    else:
        assert said is None


@pytest.mark.timeout(20)
@pytest.mark.parametrize("text", ["," * 900 + "\n" + "1\n" * 100_000, "," * 2000 + "\n1\n"])
def test_tables_that_would_fill_the_memory(text, tmp_path):
    (tmp_path / "wide.csv").write_text(text)
    with pytest.raises(ValueError, match=r"has \d+ lines of up to \d+ cells; at most 1000 columns"):
        table(str(tmp_path / "wide.csv"), VOLTAGE.limits)


# -- times -----------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(("periods", "samples", "start"), [(1.0, 41, 0.0), (2.0, 81, 0.2), (39 / 40, 40, 0.0)])
def test_drive_has_whole_periods(periods, samples, start, tmp_path):
    """The last one without the sample that closes the period, which is added. Tolerance: digits of the file."""
    t, u = sine(periods, samples, start)
    found = table(written(tmp_path, "time (s),U (V)", t, u), VOLTAGE.limits, repeat=True)
    assert found["times"][-1] == pytest.approx(np.ceil(periods) / 50, rel=1e-6)
    assert found["values"][-1] == pytest.approx(u[0], abs=1e-3)


@pytest.mark.parametrize(
    "u",
    [
        np.where(abs(TIMES - 10) < 2, 90.0, 0.0),  # one pulse
        100 * np.sin(np.pi * TIMES / 20) * np.sin(np.pi * TIMES),  # one envelope of a carrier
        np.maximum(0, np.sin(0.3 * np.pi * TIMES)) * (TIMES < 11) * 50,  # two pulses and a pause
    ],
)
def test_one_period_of_any_shape_stays(u, tmp_path):
    found = table(written(tmp_path, "t/ms,U/V", TIMES, u), VOLTAGE.limits, repeat=True)
    assert found["times"][-1] == pytest.approx(0.02)


@pytest.mark.parametrize(("periods", "end"), [(1.2, "95.11 V after 0.024 s"), (2.25, "100 V after 0.045 s")])
def test_record_without_whole_periods_is_refused(periods, end, tmp_path):
    """As a drive, with both ends; as a load it is the voltage that it is."""
    t, u = sine(periods, 200)
    file = {"waveform": "file", "file": written(tmp_path, "time (s),U (V)", t, u)}
    with pytest.raises(fp.SceneError, match=rf"begins with 0 V and ends with {end}.*so cut it to whole periods"):
        fp.Scene(voltage=file)
    scene = fp.Scene(history=[PRESS, {"name": "wave", "duration": 0.02, "voltage": file}])
    assert scene.history[1].voltage.times[-1] == pytest.approx(periods / 50)
