"""Laws of afferents against second implementations in plain loops, and where each begins."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

import fingerpad as fp

STEP = 1e-4


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
