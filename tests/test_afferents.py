"""Laws of afferents against golden values of independent programs, closed forms and each other."""

import doctest
import importlib
import os
from pathlib import Path

import numpy as np
import pytest

import fingerpad as fp
from fingerpad.afferents import pin
from fingerpad.afferents.afferent import Afferent, History
from fingerpad.afferents.filtered import FilteredUnit
from fingerpad.afferents.linear import FILTERS
from fingerpad.scene import SceneError

STEP = 1e-4
OWN_COPY = Path(os.environ.get("FINGERPAD_TOUCHSIM", "constants.py of TouchSim"))
MINE = """affparamsSA = np.array([[10.0, 0.5, 0.0, 0, 0, 0, 0, 0, 0.01, 200, -0.3, 0, 1]])
affparamsRA = [[10.0, 0, 0, 0.3, 0.3, 0, 0, 100, 0.01, 20, -2, 0, 1], [9.0, 0, 0, 0.3, 0.3, 0, 0, 100, 0, 20, -2, 0, 1]]
affparamsPC = np.array([[30.0, 0, 0, 10, 10, 100, 100, 5, 0.01, 5, -5, 0, 1]])
"""


def ramp(held: float, seconds: float = 1.0, step: float = STEP, begin: float = 0.1, end: float = 0.2) -> np.ndarray:
    time = step * np.arange(round(seconds / step) + 1)
    return np.interp(time, [begin, end], [0, held])


@pytest.mark.parametrize("name", ["sa1", "ra1", "pc", "linear"])
def test_golden_values(name):
    """Those of the docstring of each law."""
    module = importlib.import_module(f"fingerpad.afferents.{name}")
    found = doctest.testmod(module)
    assert found.attempted >= 1 and found.failed == 0


@pytest.mark.parametrize("name", ["sa1", "ra1", "pc", "filtered"])
def test_a_law_is_a_short_file(name):
    """With its theory and its golden values."""
    module = importlib.import_module(f"fingerpad.afferents.{name}")
    assert len(Path(module.__file__).read_text("utf-8").splitlines()) <= 80


# -- what every law does ---------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", sorted(fp.afferents.LAWS))
def test_units_are_independent(name):
    """One unit alone has the spikes that it has among others. Exact: no sum goes over units."""
    law, loads = fp.afferents.LAWS[name], np.array([2e3, 0.0, 2e4])
    stimulus = loads[:, None] * np.sin(np.linspace(0, 60, 5001)) ** 2 / (1e5 if "strain" in name else 1)
    together = law.spikes(stimulus, STEP)
    assert [len(each) for each in together] == [len(law.spikes(mine, STEP)) for mine in stimulus]
    assert len(together[1]) == 0 < len(together[2])
    assert np.array_equal(together[2], law.spikes(stimulus[2], STEP))


@pytest.mark.parametrize("name", sorted(fp.afferents.LAWS))
def test_what_has_always_been_there_is_no_onset(name):
    """A constant stimulus of SA1 gives the regular spikes of its constant current, one of the others none."""
    spikes = fp.afferents.LAWS[name].spikes(np.full(20001, 3e4), STEP)
    if not name.startswith("SA1"):
        assert len(spikes) == 0
        return
    # V = 8 R k4 sigma (1 - exp(-t / RC)) reaches 30 mV; within a step of 0.1 ms
    interval = -0.15 * np.log(1 - 30e-3 / (8 * 5e9 * 0.0312e-12 * 30))
    assert np.diff(spikes) == pytest.approx(interval, abs=STEP)


def test_sampling_does_not_matter():
    """A ramp is straight between samples: those of 1 ms give the spikes of those of 0.1 ms."""
    for law in (fp.afferents.SA1(), fp.afferents.RA1(), fp.afferents.PC()):
        fine, coarse = law.spikes(ramp(2e4), STEP), law.spikes(ramp(2e4, step=1e-3), 1e-3)
        assert len(fine) > 0 and fine == pytest.approx(coarse, abs=1.1 * STEP)


def test_law_of_ones_own(monkeypatch):
    """A class with two methods, selectable by its name."""

    class Threshold(Afferent):
        name, site, longest_step = "Threshold", "merkel", 5e-3

        def stimulus(self, history):
            return history.stress

        def fire(self, stimulus):
            above = stimulus > 5e3
            return above & ~np.roll(above, 1, axis=1)

    monkeypatch.setitem(fp.afferents.LAWS, "Threshold", Threshold())
    assert fp.afferents.find("Threshold").spikes(ramp(2e4), STEP) == pytest.approx([0.125], abs=1.1 * STEP)


def test_inputs():
    """Each law takes its own of the histories; PC the mean over sites, RA1 of the strain its compression."""
    stress, sed, strain = (k * np.arange(6.0).reshape(2, 3) for k in (1, 10, 100))
    history, laws = History(stress, sed, strain), fp.afferents.LAWS
    assert np.array_equal(laws["SA1"].stimulus(history), stress)
    assert np.array_equal(laws["SA1 sed"].stimulus(history), sed)
    assert np.array_equal(laws["RA1"].stimulus(history), stress)
    assert np.array_equal(laws["RA1 strain"].stimulus(history), -strain)
    assert np.array_equal(laws["PC"].stimulus(history), [[1.5, 2.5, 3.5]])


def test_compression_counts_more_than_stretch():
    """A surface that is compressed by half in 0.1 s fires in that time; one that is stretched as fast does not."""
    law = fp.afferents.find("RA1 strain")
    compressed, stretched = (law.spikes(sign * ramp(0.5), STEP) for sign in (1, -1))
    assert (compressed < 0.2).sum() > 0 == (stretched < 0.2).sum()


# -- linear filters --------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(("name", "frequency"), [("SA1", 5), ("SA1", 40), ("RA1", 30), ("PC", 80), ("PC", 250)])
def test_filter_in_time_has_its_closed_form(name, frequency):
    """The amplitude of a vibration, after 1 s. Tolerance 1 %: the samples are 0.1 ms apart, of a period of 4 ms."""
    wave = np.sin(2 * np.pi * frequency * STEP * np.arange(20001))
    found = FILTERS[name].potential(1e-6 * wave, STEP)[10000:]
    assert np.ptp(found) / 2 == pytest.approx(15e-3 * 1e-6 / fp.afferents.threshold(name, frequency), rel=1e-2)


def test_thresholds_take_arrays_and_short_names():
    assert fp.afferents.threshold("RA", 40) == pytest.approx(1.050e-6, rel=1e-3)
    assert fp.afferents.threshold("PC", [[100, 250]]) == pytest.approx(np.array([[0.174e-6, 0.084e-6]]), rel=1e-2)


# -- units of thirteen parameters ------------------------------------------------------------------------------------
def test_pin_far_and_near():
    """Far below a pin the stress is that of a point force; the gain inverts it."""
    assert pin.stress(1e-3, 0.1) == pytest.approx(3 * pin.force(1e-3) / (2 * np.pi * 0.1**2), rel=1e-3)
    assert pin.stress(pin.indentation_per_stress("RA1"), pin.DEPTH["RA1"]) == pytest.approx(1.0)


def test_unit_without_dynamics_has_its_closed_form():
    """I and tau alone: V = I tau (1 - (1 - 1/tau)^n) passes 1 after n samples, and again after each spike."""
    current, tau = 0.02, 100.0
    unit = FilteredUnit((100.0, current, *[0.0] * 7, tau, 0.0, 0.0, 0.0))
    spikes = unit.spikes(np.full(5001, 1e6), unit.step)  # 1 MPa
    every = np.ceil(np.log(1 - 1 / (current * tau)) / np.log(1 - 1 / tau))
    assert np.diff(spikes)[5:] == pytest.approx(every * unit.step)


def test_current_after_a_spike():
    """It delays or brings forward the next spike, by its sign."""
    counts = [
        len(FilteredUnit((100.0, 0.05, *[0.0] * 7, 100.0, p10, 0.0, 0.0)).spikes(np.full(5001, 1e6), 2e-4))
        for p10 in (-0.05, 0.0, 0.05)
    ]
    assert counts[0] < counts[1] < counts[2]


def test_file_of_units(tmp_path):
    (file := tmp_path / "constants.py").write_text(MINE, encoding="utf-8")
    units = fp.afferents.read_units(file)
    assert {name: len(each) for name, each in units.items()} == {"SA1": 1, "RA1": 2, "PC": 1}
    assert units["RA1"][1].parameters[0] == 9.0 and units["RA1"][1].site == "meissner"
    noisy = FilteredUnit(units["SA1"][0].parameters, noise=1)
    assert np.array_equal(noisy.spikes(ramp(2e4), STEP), noisy.spikes(ramp(2e4), STEP))


@pytest.mark.skipif(not OWN_COPY.is_file(), reason="FINGERPAD_TOUCHSIM names no copy of the parameter file")
@pytest.mark.parametrize(
    ("name", "amplitude", "frequency", "radius", "count", "first"),
    [
        ("SA1", 1e-3, 0, 1e-3, 22, 6.2),
        ("RA1", 1e-3, 0, 1e-3, 7, 9.2),
        ("PC", 1e-3, 0, 1e-3, 3, None),
        ("SA1", 0.5e-3, 10, 0.5e-3, 43, None),
        ("RA1", 0.5e-3, 25, 0.5e-3, 119, None),
        ("PC", 5e-6, 250, 0.5e-3, 247, None),
    ],
)
def test_units_of_the_users_own_copy(name, amplitude, frequency, radius, count, first):
    """Number of spikes in 1 s with ramps of 50 ms, and the first (ms), of the first unit of each class."""
    unit, samples = fp.afferents.read_units(OWN_COPY)[name][0], np.arange(5000)
    wave = np.sin(2 * np.pi * frequency * samples / 5000) if frequency else 1.0
    indentation = amplitude * wave * np.minimum(1, np.minimum(samples, samples[::-1]) / 250)
    z, one = pin.DEPTH[name], pin.stress(1.0, pin.DEPTH[name], radius)
    gain = pin.force(1.0, radius) / (2 * radius * z**2) / one
    spikes = FilteredUnit(unit.parameters, dynamic_gain=gain).spikes(one * indentation, 2e-4)
    assert len(spikes) == count
    assert first is None or 1e3 * spikes[0] == pytest.approx(first, abs=0.05)


# -- refusals --------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("ask", "said"),
    [
        (lambda: fp.afferents.find("SA9"), "the class is 'SA9'; it must be 'SA1' or"),
        (lambda: fp.afferents.threshold("touch", 40), "the class is 'touch'; it must be 'SA1' or 'RA1' or 'PC'"),
        (lambda: fp.afferents.threshold("RA", 0), "the frequency is 0; it must be greater than 0 Hz"),
        (lambda: fp.afferents.SA1().spikes([0, 1], 0), "dt is 0; it must be greater than 0 s"),
        (lambda: fp.afferents.RA1().spikes([0, 1], 0.02), "dt is 0.02 s; RA1 needs 0.00313 s or less between two"),
        (lambda: fp.afferents.SA1().spikes([0, np.nan], STEP), "must have finite numbers along (samples,)"),
        (lambda: fp.afferents.SA1().spikes("loud", STEP), "the stimulus of SA1 or its dt is no number"),
        (lambda: fp.afferents.RA1("touch"), "input is 'touch'; it must be 'stress' or 'strain'"),
        (lambda: fp.afferents.threshold("RA", "loud"), "the frequency is 'loud'; it must be greater than 0 Hz"),
        (lambda: fp.afferents.RA1(gain=-1.0), "gain is -1; it must be greater than 0"),
        (lambda: fp.afferents.PC(gain=0.0), "gain is 0; it must be greater than 0"),
        (lambda: fp.afferents.read_units("nowhere.py"), "the parameter file nowhere.py cannot be read"),
    ],
)
def test_refusals(ask, said):
    with pytest.raises(SceneError, match=said.replace("(", r"\(").replace(")", r"\)")) as refused:
        ask()
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a = 1", "has no affparamsSA; it must be constants.py of TouchSim"),
        (MINE.replace("10.0, 0.5,", "10.0,"), "affparamsSA in .* is no list of rows of 13 finite numbers"),
        (MINE.replace("0.5", "1e400"), "affparamsSA in .* is no list of rows of 13 finite numbers"),
        (MINE.replace("[[10.0", "[" * 100_000), "affparamsSA in .* is no list of rows of 13 finite numbers"),
        (MINE * 4000, r"cannot be read: it has .* MB, and at most 1 MB are read"),
        (MINE.replace("0.5", "f(1)"), "affparamsSA in .* is no list of rows of 13 finite numbers"),
    ],
)
def test_refused_files(tmp_path, text, said):
    (file := tmp_path / "constants.py").write_text(text, encoding="utf-8")
    with pytest.raises(SceneError, match=said):
        fp.afferents.read_units(file)
