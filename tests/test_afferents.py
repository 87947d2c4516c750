"""Laws of afferents against golden values of independent programs, closed forms and each other."""

import doctest
import importlib

import numpy as np
import pytest

import fingerpad as fp
from fingerpad.afferents.afferent import Afferent, History
from fingerpad.afferents.linear import FILTERS

STEP = 1e-4


def ramp(held: float, seconds: float = 1.0, step: float = STEP, begin: float = 0.1, end: float = 0.2) -> np.ndarray:
    time = step * np.arange(round(seconds / step) + 1)
    return np.interp(time, [begin, end], [0, held])


@pytest.mark.parametrize("name", ["sa1", "ra1", "pc", "linear"])
def test_golden_values(name):
    """Those of the docstring of each law."""
    module = importlib.import_module(f"fingerpad.afferents.{name}")
    found = doctest.testmod(module)
    assert found.attempted >= 1 and found.failed == 0


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


# -- refusals --------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("ask", "said"),
    [
        (lambda: fp.afferents.find("SA9"), "the class is 'SA9'; it must be 'SA1' or"),
        (lambda: fp.afferents.threshold("RA", 0), "the frequency is 0; it must be greater than 0 Hz"),
        (lambda: fp.afferents.RA1().spikes([0, 1], 0.02), "dt is 0.02 s; RA1 needs 0.00313 s or less between two"),
        (lambda: fp.afferents.SA1().spikes([0, np.nan], STEP), "must have finite numbers along (samples,)"),
        (lambda: fp.afferents.PC(gain=0.0), "gain is 0.0; it must be greater than 0"),
    ],
)
def test_refusals(ask, said):
    with pytest.raises(ValueError, match=said.replace("(", r"\(").replace(")", r"\)")) as refused:
        ask()
    assert "\n" not in str(refused.value)
