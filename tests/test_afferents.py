"""Laws of afferents against golden values, closed forms and second implementations, and where each begins."""

import doctest
import importlib
import math

import numpy as np
import pytest
from scipy.integrate import quad

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


# -- where a law begins ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("law", fp.afferents.LAWS.values(), ids=fp.afferents.LAWS)
def test_every_law_begins_in_the_steady_state(law):
    """3 s of the same stimulus before it changes move no spike: all decays are of 0.2 s or less. Exact.

    The rise is of the size of the held stimulus for those that answer to changes alone.
    """
    held = 20e3 if law.name != "RA1" or law.input == "stress" else 0.3
    rise = 5e3 if law.name == "SA1" else held

    def spikes(before: float) -> np.ndarray:
        time = STEP * np.arange(round((before + 0.6) / STEP) + 1) - before
        return law.spikes(np.interp(time, [0.02, 0.05], [held, held + rise]), STEP) - before

    assert len(spikes(0.0)) > 0
    assert spikes(0.0) == pytest.approx(spikes(3.0), abs=1e-9)


# -- SA1 -------------------------------------------------------------------------------------------------------------
def sa1(stress: np.ndarray) -> list[float]:
    """Return spikes (ms) of a unit under a stress (kPa) at 0.1 ms, by Runge and Kutta's method in fA, mV and ms."""
    tau, k = (8.0, 200.0, 1744.6), (0.74, 0.2088, 0.07)
    branches, volts, spikes = [0.0] * 3, None, []
    for n in range(len(stress)):
        if n:
            branches = [
                b * math.exp(-0.1 / t) + g * (stress[n] - stress[n - 1])
                for b, t, g in zip(branches, tau, k, strict=True)
            ]
        drive = 8 * (sum(max(b, 0.0) for b in branches) + max(0.0312 * stress[n], 0.0))  # pA
        if volts is None:
            volts = drive * 5.0 if drive * 5.0 <= 30.0 else 0.0
            continue

        def rate(v: float, drive: float = drive) -> float:
            return drive / 30.0 - v / 150.0

        slope = [rate(volts)]
        for part in (0.05, 0.05, 0.1):
            slope.append(rate(volts + part * slope[-1]))
        volts += 0.1 / 6 * (slope[0] + 2 * slope[1] + 2 * slope[2] + slope[3])
        if volts > 30.0 and (not spikes or 0.1 * n - spikes[-1] > 0.95):
            spikes.append(0.1 * n)
            volts = 0.0
    return spikes


@pytest.mark.parametrize(
    ("times", "stress", "least"),
    [
        ([0.1, 0.2], [0, 20], 10),  # held
        ([0.1, 0.15], [-40, -5], 3),  # in tension throughout: what decays fires, and the static branch is at 0
        ([0.1, 0.12, 0.3, 0.35], [10, -30, -30, 20], 3),  # through tension, at which branches are clipped each
        ([0.1, 0.105], [0, 400], 200),  # the least interval of 1 ms
    ],
)
def test_sa1_has_the_spikes_of_a_second_program(times, stress, least):
    """In plain loops, from the equations. Tolerance: one step, since both round V where it passes the threshold."""
    held = np.interp(STEP * np.arange(8001), times, stress)
    found, expected = 1e3 * fp.afferents.SA1().spikes(1e3 * held, STEP), sa1(held)
    assert len(found) == len(expected) >= least
    assert found == pytest.approx(expected, abs=0.11)


# -- RA1 and PC ------------------------------------------------------------------------------------------------------
CONSTANTS = {"RA1": (200.0, 0.0151), "PC": (300.0, 0.11)}
"""K_f (1/(s V)) and c of doi 10.3389/fninf.2019.00027."""


def in_half_cycles(amplitude: float, frequency: float, per_volt: float) -> int:
    """Return the spikes of a half cycle of a potential of an amplitude (V): one, and one each time its rate has made
    one more, from passing 15 mV on."""
    time = np.linspace(0, 0.5 / frequency, 100001)
    above = np.clip(amplitude * np.sin(2 * np.pi * frequency * time) - 15e-3, 0, 0.999)
    return int(above.any()) + math.floor(per_volt * above.mean() * 0.5 / frequency)


@pytest.mark.parametrize(
    ("name", "times"),
    [(name, times) for name, (_, off) in CONSTANTS.items() for times in (0.9, 5, 12, 80, 0.98 / off, 1.02 / off, 2000)],
)
def test_spikes_of_a_vibration(name, times):
    """Of both half cycles at 2 Hz, in closed form; an amplitude is a multiple of that at the threshold.

    Tolerance: 2 %, one spike of a half cycle whose phase ends near a whole number.
    """
    per_volt, off = CONSTANTS[name]
    law, frequency = fp.afferents.find(name), 2.0
    wave = np.sin(2 * np.pi * frequency * STEP * np.arange(30001))
    spikes = law.spikes(times * fp.afferents.threshold(name, frequency) / law.gain * wave, STEP)
    each = [in_half_cycles(weight * times * 15e-3, frequency, per_volt) for weight in (1.0, off)]
    found = ((spikes > 1.0) & (spikes <= 2.0)).sum() / 2
    assert found == pytest.approx(sum(each), abs=0.01 + 0.02 * sum(each))


@pytest.mark.parametrize(("law", "depth"), [(fp.afferents.RA1(), 1.6e-3), (fp.afferents.PC(), 2e-3)])
def test_gain_is_that_of_a_pin_at_the_depth_of_the_class(law, depth):
    """Boussinesq's stress below the pressure of a flat punch, P / (2 pi a root(a^2 - r^2)), over its indentation.

    Depths, 0.05 MPa and 0.4 are those of doi 10.1073/pnas.1704856114. With r = a sin(t); tolerance: quadrature.
    """
    a = 1e-3
    force = 2 * a * 0.05e6 / (1 - 0.4**2)  # N, at an indentation of 1 m

    def ring(t: float) -> float:
        r = a * math.sin(t)
        return force / (2 * math.pi * a) * 2 * math.pi * r * 3 * depth**3 / (2 * math.pi * (r**2 + depth**2) ** 2.5)

    assert law.gain == pytest.approx(1 / quad(ring, 0, math.pi / 2)[0], rel=1e-9)
