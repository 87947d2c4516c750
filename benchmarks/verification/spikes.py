r"""Spikes of afferents: counts and times of programs that share no line with the package.

**SA-I.** Numbers of spikes under ramps of 0.1 s that are held, and first spikes, were computed apart by Runge and
Kutta's method (equations of Lesniak et al. 2014, doi 10.7554/eLife.01488). **Thresholds** of linear filters (Ouyang et
al. 2021, doi 10.1109/TBME.2020.3007397) were computed apart too.
"""

import numpy as np

from benchmarks.verification.case import Case, Row
from fingerpad.afferents.linear import threshold
from fingerpad.afferents.sa1 import SA1

_STEP = 1e-4  # s
_RAMPS = {5e3: (1, 261.7), 10e3: (6, 181.0), 20e3: (33, 151.0)}  # Pa: spikes in 5 s, and the first (ms)
_THRESHOLDS = {"SA1": (24.38, 110.98), "RA1": (6.995, 2.524), "PC": (36.87, 0.0836)}  # µm at 10 and 250 Hz


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
    Case("Thresholds of linear filters", f"{_APART} 10.1109/TBME.2020.3007397", thresholds),
)
