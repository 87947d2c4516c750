"""Means and spectra of curves over time, against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest

from fingerpad.results.over_time import HARMONICS, over_time, spectrum
from fingerpad.scene import from_data
from fingerpad.scene.waveform import Waveform
from tests.measures import contact_state
from variational.state import ContactState

FREQUENCY = 60.0
PERIOD = 1 / FREQUENCY


def wave(kind: str, offset: float = 0.0) -> Waveform:
    keys = {"waveform": kind, "amplitude": 100.0, "frequency": FREQUENCY, "offset": offset}
    loads = [{"name": "press", "f_ext": 1.0}, {"name": "wave", "duration": 1.0, "voltage": keys}]
    return from_data({"history": loads}).history[1].wave


def states(samples, friction) -> list[ContactState]:
    """Return states of a friction force (N/m) that is a function of the voltage alone."""
    return [
        contact_state(voltage=u, f_t=friction(u), mu_app=0.5, step=k, time=7.0 + t) for k, (t, u) in enumerate(samples)
    ]


@pytest.mark.parametrize("periods", [1.0, 2.6])
def test_square_of_a_sine(periods):
    """sin^2 is half of 1 - cos: its mean, its one amplitude at twice the frequency, over the last whole periods."""
    found = over_time(
        states(wave("sine").samples(periods * PERIOD, 1.0), lambda u: 3 + 2 * (u / 100) ** 2), wave("sine")
    )
    assert (found.start, found.periods) == (7.0, int(periods)) and found.seconds == pytest.approx(periods * PERIOD)
    assert found.frequency == pytest.approx([FREQUENCY * k for k in range(1, HARMONICS + 1)])
    whole = math.floor(periods)
    left = 2 * math.pi * (periods - whole)
    mean = 3 + (periods - (math.sin(2 * left) / (4 * math.pi))) / periods
    assert found.mean["f_t"] == pytest.approx(mean, rel=4e-3)
    assert found.mean["contact_length"] == pytest.approx(1e-3, rel=1e-12)
    assert np.abs(np.array(found.f_t_amplitude) - [0, 1, 0, 0, 0, 0]).max() < 4e-3


def test_square_wave_and_triangle():
    """To roundoff: the curve is constant between jumps, and straight between corners."""
    k = np.arange(1, HARMONICS + 1)
    square = over_time(states(wave("square", 50.0).samples(2 * PERIOD, 1.0), lambda u: u), wave("square", 50.0))
    assert square.f_t_amplitude == pytest.approx(100 * 4 / np.pi / k * (k % 2), abs=1e-9)
    assert square.mean["f_t"] == pytest.approx(50.0, rel=1e-12)
    triangle = over_time(states(wave("triangle").samples(2 * PERIOD, 1.0), lambda u: u), wave("triangle"))
    assert triangle.f_t_amplitude == pytest.approx(100 * 8 / (np.pi * k) ** 2 * (k % 2), abs=1e-5)


def test_spectrum_of_a_file_has_its_carrier():
    """Four periods of a carrier under an envelope, whose friction is its square: twice the carrier's frequency leads.

    The envelope is e = (1 - cos) / 2, so that e^2 / 2 has the mean 3 / 16 and the amplitudes 1 / 4 and 1 / 16.
    """
    time = np.arange(161) / 160 * PERIOD
    turn = 2 * np.pi * time / PERIOD
    voltage = 100 * np.sin(4 * turn) * (1 - np.cos(turn)) / 2
    keys = {"waveform": "file", "times": time.tolist(), "values": [round(u, 9) for u in voltage.tolist()]}
    loads = [{"name": "press", "f_ext": 1.0}, {"name": "wave", "duration": PERIOD, "voltage": keys}]
    file = from_data({"history": loads}).history[1].wave
    found = over_time(states(list(zip(time, voltage, strict=True)), lambda u: (u / 100) ** 2), file)
    assert len(found.frequency) == 161 // 4 and found.frequency[7] == pytest.approx(8 * FREQUENCY)
    exact = np.zeros(12)
    exact[[0, 1, 7, 6, 8, 5, 9]] = 1 / 4, 1 / 16, 3 / 16, 1 / 8, 1 / 8, 1 / 32, 1 / 32
    assert np.abs(np.array(found.f_t_amplitude[:12]) - exact).max() < 4e-3


def test_spectrum_of_jumps_and_corners_at_odd_times():
    """Samples need not be evenly spaced, and a jump needs no more than its two samples."""
    rng = np.random.default_rng(1)
    inner = np.sort(rng.uniform(0.01, 0.49, 5))
    time = np.concatenate([[0, *inner, 0.5], [0.5, *(0.5 + inner), 1]])
    found = spectrum(time, np.where(np.arange(len(time)) < 7, 1.0, 0.0), 1.0, 1)
    assert found == pytest.approx([2 / np.pi, 0, 2 / 3 / np.pi, 0, 2 / 5 / np.pi, 0], abs=1e-9)


def test_states_that_take_no_time_count_by_their_last():
    """A lifted finger, without a coefficient, touches at the start of its press; then µ_app is 1 + t."""
    air = [replace(states([(0.0, 0.0)], float)[0], mu_app=math.nan, contact_length=0.0)] * 2
    press = [replace(state, mu_app=1.0 + t) for t in (0.0, 0.5, 1.0) for state in states([(t, 0.0)], float)]
    mean = over_time([*air, *press], None).mean
    assert mean["mu_app"] == pytest.approx(1.5, rel=1e-12)
    assert mean["contact_length"] == pytest.approx(1e-3, rel=1e-12)
