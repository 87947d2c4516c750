"""Heads, units and times of records: names decide, what is not read is refused, and a drive has whole periods."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fingerpad as fp
from fingerpad.scene.wavefile import table

T = np.linspace(0.0, 20.0, 41)  # ms
PRESS = {"name": "press", "f_ext": 5.0}
U = 100 * np.sin(2 * np.pi * 50e-3 * T)  # V, of 50 Hz


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
    "a count before the time": ("Sample,Time(S),CH1(V)", (np.arange(41), T / 1e3, U)),
    "a unit for a name": ("ticks,msecs,value 1", (10 * np.arange(41), T, U)),
    "the time at the end": ("U [mV],current (mA),T [us]", (1e3 * U, 0 * U, 1e3 * T)),
    "a line of units": ("Time,Channel A\n(ms),(mV)", (T, 1e3 * U)),
    "preamble with units": ("Model,X\nHorizontal Units,ms\nVertical Units,kV\nLabel,\nTIME,CH1", (T, U / 1e3)),
    "comments": ("#Device Name: X\n#Serial: 5, 6\nTime (s),Channel 1 (V)", (T / 1e3, U)),
}


@pytest.mark.parametrize(("head", "columns"), HEADS.values(), ids=HEADS)
def test_names_and_units_decide(head, columns, tmp_path):
    """One sine of 20 ms and 100 V under the heads of several programs; tolerance of the digits written."""
    found = table(written(tmp_path, head, *columns), repeat=True)
    assert_allclose(found["times"], T / 1e3, atol=1e-10)
    assert_allclose(found["voltages"], np.where(abs(U) < 1e-3, 0, U), atol=1e-6)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("X_Value\tVoltage\n\t0,000\n\t2,500\n\t5,000\n", "has no two columns of numbers with heads"),
        ("a,b\n0,0\n1,2\n2,0\n", "has nothing named or united as time among 'a' or 'b'"),
        (
            "time (s),CH1 (Vpp)\n0,0\n1,2\n2,0\n",
            "has 'CH1 (Vpp)' in 'Vpp', which is V, and pp is a measure of a drive; it must",
        ),
        ("time (s),I/mA\n0,0\n1,2\n2,0\n", "has 'I/mA' in 'mA', which is not a unit of voltage; it must be in V"),
        ("time (V),U (V)\n0,0\n1,2\n2,0\n", "has 'time (V)' in 'V', which is not a unit of time; it must be in s"),
        ("time (s),U (V)\n0,0,1\n1,2,5\n", "has more cells in line 2 than its 2 heads; decimals have points"),
        ("time (s),U (kV)\n0,0\n1,1e308\n", "has '1e308' in line 3 of 'U (kV)'; it must be a finite number"),
        ("time (s),U (V)\n0,0\n1,0.0001\n2,0\n", "has 0 V throughout; give a voltage, or the number 0 in its place"),
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
        table(str(tmp_path / "wide.csv"))


# -- times -----------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("periods", "samples", "start", "end"),
    [
        (2.25, 401, 0.0, 2),
        (2.5, 401, 0.0, 2),  # begins and ends with 0 V
        (1.6, 100, 0.3, 1),
        (2.0, 81, 0.2, 2),
        (39 / 40, 40, 0.0, 1),  # the sample that closes the period is missing
    ],
)
def test_drive_is_cut_to_whole_periods(periods, samples, start, end, tmp_path):
    """Of a sine with a noise of 1 V; within half of a percent of a period, as its delay is found on 2000 points."""
    t, u = sine(periods, samples, start)
    noise = np.random.default_rng(1).normal(size=samples)
    found = table(written(tmp_path, "time (s),U (V)", t, u + noise * (periods > 1.5)), repeat=True)
    assert found["times"][-1] == pytest.approx(end / 50, abs=1e-4 * end)
    mean = np.mean(np.interp(np.linspace(0, end / 50, 999), found["times"], found["voltages"]))
    assert mean == pytest.approx(0, abs=1)


@pytest.mark.parametrize(
    "u",
    [
        np.where(abs(T - 10) < 2, 90.0, 0.0),  # one pulse
        100 * np.sin(np.pi * T / 20) * np.sin(np.pi * T),  # one envelope of a carrier
        np.maximum(0, np.sin(0.3 * np.pi * T)) * (T < 11) * 50,  # two pulses and a pause
    ],
)
def test_one_period_of_any_shape_stays(u, tmp_path):
    found = table(written(tmp_path, "t/ms,U/V", T, u), repeat=True)
    assert found["times"][-1] == pytest.approx(0.02)


def test_record_without_whole_periods_is_refused(tmp_path):
    """1.2 periods as a drive, with both ends; as a load it is the voltage that it is."""
    t, u = sine(1.2, 60)
    file = {"waveform": "file", "file": written(tmp_path, "time (s),U (V)", t, u)}
    with pytest.raises(fp.SceneError, match=r"begins with 0 V and ends with 95.11 V after 0.024 s, without whole per"):
        fp.Scene(voltage=file)
    scene = fp.Scene(history=[PRESS, {"name": "wave", "duration": 0.02, "voltage": file}])
    assert scene.history[1].voltage.times[-1] == pytest.approx(0.024)
