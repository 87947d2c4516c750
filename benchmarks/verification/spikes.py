r"""Spikes of afferents: counts and times of programs that share no line with the package.

**SA-I.** Numbers of spikes under ramps of 0.1 s that are held, and first spikes, were computed apart by Runge and
Kutta's method (equations of Lesniak et al. 2014, doi 10.7554/eLife.01488). **Filtered units** (Saal et al. 2017, doi
10.1073/pnas.1704856114) are followed here sample by sample, with parameters of our own: a low-pass by its difference
equation from three poles, and the current after a spike from its two parts. **Thresholds** of linear filters (Ouyang et
al. 2021, doi 10.1109/TBME.2020.3007397) were computed apart too.
"""

import math

import numpy as np
from numpy.typing import NDArray

from benchmarks.verification.case import IDENTITY, Case, Row
from fingerpad.afferents.filtered import FilteredUnit
from fingerpad.afferents.linear import threshold
from fingerpad.afferents.pin import DEPTH, force, stress
from fingerpad.afferents.sa1 import SA1

Array = NDArray[np.float64]
_STEP = 1e-4  # s
_RAMPS = {5e3: (1, 261.7), 10e3: (6, 181.0), 20e3: (33, 151.0)}  # Pa: spikes in 5 s, and the first (ms)
_THRESHOLDS = {"SA1": (24.38, 110.98), "RA1": (6.995, 2.524), "PC": (36.87, 0.0836)}  # µm at 10 and 250 Hz
_UNITS = {  # thirteen numbers each, none of a published unit
    "SA1": (8.0, 3.0, 0.0, 0.05, 0.02, 1.0, 0.5, 0.0, 0.0, 60.0, -0.4, 0.05, 0.0),
    "RA1": (20.0, 0.0, 0.0, 0.6, 0.4, 20.0, 10.0, 0.8, 0.0, 25.0, -1.0, -0.1, 0.0),
    "PC": (40.0, 0.0, 0.0, 0.5, 0.5, 60.0, 60.0, 2.0, 0.0, 15.0, -2.0, 0.0, 0.0),
}
_PINS = {"SA1": (1e-3, 0.0), "RA1": (0.5e-3, 25.0), "PC": (0.1e-3, 100.0)}  # m and Hz; 0 Hz is held


def held(small: bool) -> list[Row]:
    """Spikes of SA-I units under ramps."""
    rows, time = [], _STEP * np.arange(50001)
    for top, (count, first) in _RAMPS.items():
        spikes = SA1().spikes(np.interp(time, [0.1, 0.2], [0, top]), _STEP)
        words = f"at {top / 1e3:g} kPa"
        rows.append(Row(f"spikes {words}", len(spikes), count, 0.0, "a count", absolute=True))
        late = 1e3 * float(spikes[0])
        rows.append(
            Row(f"first spike {words} (ms)", late, first, 0.15, "a step of 0.1 ms, and rounding", absolute=True)
        )
    return rows


def _low_pass(values: list[float], cut: float, step: float) -> list[float]:
    """Return values behind three poles of Butterworth's low-pass, from rest, by the trapezoidal rule of each pole."""
    w, found = 2 / step * math.tan(math.pi * cut * step), [complex(each) for each in values]
    for pole in (-w, w * complex(-0.5, math.sqrt(0.75)), w * complex(-0.5, -math.sqrt(0.75))):
        out, y, before = [], 0j, 0j
        for x in found:
            y = ((1 + pole * step / 2) * y - pole * step / 2 * (x + before)) / (1 - pole * step / 2)
            before = x
            out.append(y)
        found = out
    return [each.real for each in found]


def _filtered(p: tuple[float, ...], stress: Array, rate: Array) -> int:
    """Return the spikes of a unit under a stress (MPa) and a dynamic input, 0.2 ms apart."""
    s, d = (_low_pass([float(value) for value in each], 10 * p[0], 2e-4) for each in (stress, rate))
    kappa, v, since, count = 0.75 * math.pi / math.log(3), 0.0, 10**6, 0
    for n in range(len(s) - 1):
        a = d[n + 1] - d[n]
        current = sum(
            weight * max(value, 0.0) for weight, value in zip(p[1:7], (s[n], -s[n], d[n], -d[n], a, -a), strict=True)
        )
        if p[7] > 0:
            current = p[7] * current / (p[7] + abs(current))
        if since < 190:
            first = min(math.pi, kappa * math.log((since + 5) / 5))
            second = max(-math.pi, min(math.pi, kappa * math.log((since + 5) / 45)))
            current += p[10] * (1 + math.cos(first)) / 2 + p[11] * (1 + math.cos(second)) / 2
        v += current - v / p[9]
        since += 1
        if v > 1 and since > 5:
            v, since, count = 0.0, 0, count + 1
    return count


def pins(small: bool) -> list[Row]:
    """Spikes of filtered units under a pin of 1 mm, in 1 s with ramps of 50 ms."""
    rows, samples = [], np.arange(5001)
    for name, (amplitude, frequency) in _PINS.items():
        wave = np.sin(2 * np.pi * frequency * samples / 5000) if frequency else 1.0
        moved = amplitude * wave * np.clip(samples / 250, 0, 1) * np.clip((5000 - samples) / 250, 0, 1)
        z, one = DEPTH[name], stress(1.0, DEPTH[name])
        gain = force(1.0) / (2 * 1e-3 * z**2) / one
        found = len(FilteredUnit(_UNITS[name], dynamic_gain=gain).spikes(one * moved, 2e-4))
        rate = 2 * 0.05 * np.gradient(1e3 * moved, 2e-4) / 0.84 / (2 * (1e3 * z) ** 2)  # (dP/dt) / (2 a z^2), MPa, mm
        expected = _filtered(_UNITS[name], 1e-6 * one * moved, rate)
        at = f"{frequency:g} Hz" if frequency else "held"
        quantity, why = f"spikes of {name}, {1e3 * amplitude:g} mm, {at}", "one that comes at an end, by roundoff"
        rows.append(Row(quantity, found, expected, 1.0, why, absolute=True))
    return rows


def thresholds(small: bool) -> list[Row]:
    """Displacements at the threshold, at both ends of the frequencies."""
    why = "digits of the reference"
    return [
        Row(f"threshold of {name} at {f} Hz (µm)", 1e6 * threshold(name, f), given, 1e-3, why)
        for name, pair in _THRESHOLDS.items()
        for f, given in zip((10, 250), pair, strict=True)
    ]


_APART = "by a program apart, doi"
CASES = (
    Case("Held ramps of SA-I", f"{_APART} 10.7554/eLife.01488", held),
    Case("Filtered units under a pin", f"{_APART} 10.1073/pnas.1704856114, with constants of our own", pins, IDENTITY),
    Case("Thresholds of linear filters", f"{_APART} 10.1109/TBME.2020.3007397", thresholds),
)
