r"""Means over time and the spectrum of friction of a load over time, from its accepted states.

Between two states a quantity follows the monotone cubic curve of Fritsch and Carlson (SciPy's ``PchipInterpolator``),
which never leaves the range of the two. The curve is cut where the waveform jumps or has a corner. Mean and amplitudes
are integrals of this curve, by 20 Gauss points between two states:

.. math:: a_k = \frac{2}{n T} \left| \int_{nT} f_T(t) \, e^{-2 \pi i k t / T} dt \right|

over the last n whole periods T of the waveform, so that a_k is the amplitude at the frequency k / T. With the 12
samples of a period that friction has under a sine, the amplitudes of a smooth curve are within 0.4 % of the largest
(``tests/test_over_time.py``). Friction does not depend on the sign of the voltage. Under a sine without offset friction
therefore has even k alone: twice the frequency of the voltage, and its multiples.

Fritsch, Carlson, SIAM J. Numer. Anal. 17 (1980), doi 10.1137/0717021.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fingerpad.results.quantities import EXTREMES
from fingerpad.scene.materials import FRICTION_LAWS
from fingerpad.scene.waveform import Waveform
from variational.state import ContactState

_AGING = " and ".join(name for name, law in FRICTION_LAWS.laws.items() if law.memory is not None)  # type: ignore[attr-defined]
NOTE = (
    "Loads over time are quasi-static: no inertia. Time acts in layers with a viscosity, in friction of the laws "
    f"{_AGING}, and in the circuit of electric.tissue and electric.leak. In a scene without these a "
    "frequency sets how far the finger slides in a period, and nothing else."
)
"""What a result with a load over time says of it."""
HARMONICS, _SAMPLED = 6, 4
"""Number of amplitudes in the spectrum of a wave, and of samples that friction has in a period of the last of them. A
file, which may be a carrier under a slow envelope, has as many amplitudes as its samples allow, and no fewer."""
_MAX_AMPLITUDES = 200  # of a waveform from a file
Array = NDArray[np.float64]
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(20)
_TIME_TOLERANCE = 1e-9  # of a period: two times that are one


@dataclass(frozen=True)
class OverTime:
    """A load over time."""

    start: float
    """Time at which the load begins (s)."""
    seconds: float
    """Length of the load (s)."""
    mean: dict[str, float]
    """Mean over time by quantity, in its unit; NaN where a state has no apparent friction coefficient."""
    periods: int = 0
    """Whole periods of the waveform that the spectrum is of, the last of the load; 0 without a spectrum."""
    frequency: tuple[float, ...] = ()
    """Frequencies of the spectrum (Hz): multiples of the waveform's; for a file multiples of one over its length."""
    f_t_amplitude: tuple[float, ...] = ()
    """Amplitudes of the friction force at these frequencies (N/m)."""
    mean_change: dict[str, float] = field(default_factory=dict)
    """What every second state alone would change the means by, in their units; of loads without a waveform."""


def over_time(states: Sequence[ContactState], wave: Waveform | None) -> OverTime | None:
    """Return means and spectrum of a load; None where it takes no time.

    Args:
        states: at the begin of the load and of the load, in order, with their times.
        wave: its waveform; None without one.
    """
    times = np.array([state.time for state in states])
    start, seconds = float(times[0]), float(times[-1] - times[0])
    if not seconds > 0:  # also where no load is over time
        return None
    # the last of those that take no time, as a first touch
    last = int(np.flatnonzero(times <= start + _TIME_TOLERANCE * seconds)[-1])
    states, time = states[last:], times[last:] - start
    corners = [] if wave is None else wave.corners(seconds)
    names = (*EXTREMES, *states[-1].own)
    values = {name: np.array([getattr(state, name, math.nan) for state in states]) for name in names}
    mean = {
        name: math.nan if np.isnan(value).any() else float(_rule(time, value, corners)[1].sum()) / seconds
        for name, value in values.items()
    }
    if wave is None:
        change = {name: _change(time, values[name], value) for name, value in mean.items() if not math.isnan(value)}
        return OverTime(start, seconds, mean, mean_change=change)
    if (periods := int(seconds / wave.period + _TIME_TOLERANCE)) < 1:
        return OverTime(start, seconds, mean)
    samples = int(np.count_nonzero(time >= time[-1] - periods * wave.period)) // periods
    count = min(max(HARMONICS, samples // _SAMPLED), _MAX_AMPLITUDES) if wave.waveform == "file" else HARMONICS
    found = spectrum(time, values["f_t"], wave.period, periods, corners, count)
    frequency = tuple(k / wave.period for k in range(1, count + 1))
    return OverTime(start, seconds, mean, periods, frequency, tuple(map(float, found)))


def without_parts_of_jumps(states: Sequence[ContactState], start: float = -math.inf) -> list[ContactState]:
    """Return states over time without those in which a jump of a waveform is done in part.

    A jump takes no time. Where a solve reaches it in parts, these have values that the waveform never has.

    Args:
        states: in order, with their times.
        start: time at which a load begins (s), of which they are; of a jump there only the state behind it counts.
    """
    near = _TIME_TOLERANCE * (states[-1].time - states[0].time)
    kept = list[ContactState]()
    for k, state in enumerate(states):
        begins = state.time <= start + near or k == 0 or state.time - states[k - 1].time > near
        ends = k == len(states) - 1 or states[k + 1].time - state.time > near
        if ends or (begins and state.time > start + near):
            kept.append(state)
    return kept


def _change(time: Array, value: Array, mean: float) -> float:
    """Return what every second sample alone would change a mean by; of a single step half of its change."""
    few = sorted({*range(0, len(time), 2), len(time) - 1})
    if len(few) == len(time):
        return float(abs(value[-1] - value[0]) / 2)
    return abs(float(_rule(time[few], value[few], ())[1].sum()) / float(time[-1] - time[0]) - mean)


def spectrum(
    time: Array, value: Array, period: float, periods: int, corners: Sequence[float] = (), count: int = HARMONICS
) -> Array:
    """Return the amplitudes at the first multiples of a frequency over the last whole periods.

    Args:
        time: of the samples (s), shape (samples,), not decreasing; two of one time are a jump.
        value: samples, shape (samples,).
        period: of the first frequency (s).
        periods: how many, back from the last time.
        corners: times (s) at which the curve has a corner.
        count: number of multiples.

    Returns:
        Amplitudes in the unit of the samples, shape (count,).
    """
    whole = periods * period
    at, weighted = _rule(time, value, corners, time[-1] - whole)
    turns = (2 * np.pi * k / period for k in range(1, count + 1))
    return np.array([2 / whole * abs(np.sum(weighted * np.exp(-1j * turn * at))) for turn in turns])


def _rule(time: Array, value: Array, corners: Sequence[float], first: float = 0.0) -> tuple[Array, Array]:
    """Return the points of a quadrature from a first time on, and the curve there times the weights."""
    from scipy.interpolate import PchipInterpolator  # not for those who only read scenes

    near, places, parts = _TIME_TOLERANCE * (time[-1] - time[0]), list[Array](), list[Array]()
    jumps = set(map(int, np.flatnonzero(np.diff(time) <= near) + 1))
    known = np.sort(np.asarray(corners, dtype=float))
    beside = np.searchsorted(known, time)
    bends = np.zeros(len(time), dtype=bool)
    for k in (beside - 1, beside):
        there = (k >= 0) & (k < len(known))
        bends[there] |= np.abs(time[there] - known[k[there]]) <= near
    # A segment begins with the state after a jump; a state in a corner belongs to both.
    starts = sorted({0, *map(int, np.flatnonzero(bends)), *jumps})
    for a, b in zip(starts, [*starts[1:], len(time) - 1], strict=True):
        last = b - 1 if b in jumps else b
        if last <= a:
            continue
        t, f = time[a : last + 1], value[a : last + 1]
        edges = np.concatenate([[max(first, t[0])], t[t > max(first, t[0]) + near]])
        half = np.diff(edges)[:, None] / 2
        at = edges[:-1, None] + half * (1 + _POINTS)
        places.append(at.ravel())
        parts.append((half * _WEIGHTS * PchipInterpolator(t, f)(at)).ravel())
    empty = np.empty(0)
    return np.concatenate([empty, *places]), np.concatenate([empty, *parts])
