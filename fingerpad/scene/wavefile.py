"""Voltages over time from a CSV file: under a header of two columns, or as an oscilloscope writes it.

Names and units of columns decide, wherever they stand (:mod:`fingerpad.scene.tables`): the times are in the column that
is named or united as time, and a column that counts samples is none. Without units they are in s, and the voltages in
V. Times may begin anywhere: the first becomes 0.

A file that repeats itself ends where a period does. One of 1.5 periods or more is cut to whole ones, another one must
end with its first voltage, or one sample before. Where all periods have more than :data:`POINTS` samples, fewer of them
are kept, one at least. Files of more than :data:`POINTS` samples are averaged in groups, all
of as many. Where this would take more than :data:`_LOST` of the mean square, as of a carrier, the file is refused.
"""

import math
import re
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from numpy.typing import NDArray

from fingerpad.scene.messages import clip, show
from geometry.units import Finite, Range, within

if TYPE_CHECKING:
    from fingerpad.scene.tables import Column, Table

POINTS = 2000
"""Most points of a waveform."""
HIGHEST = 5e3
"""Largest voltage (V)."""
Probe = Annotated[Finite, within(1e-3, 1e5)]
_LEAST = 1e-3  # V; what is less in a table is 0: noise, or roundoff of a computed sine
_LOST = 0.01  # of the mean square
Volts = Annotated[Finite, within(_LEAST, HIGHEST, "V", zero=True, sides=2)]
Seconds = Annotated[Finite, within(1e-9, 1e5, "s", zero=True)]
Array = NDArray[np.float64]
_HEADER = "time (s),voltage (V)"
_TIME = re.compile(r"(time|zeit|temps|tiempo|tempo)\b.*|t|x([-_ ]?(axis|values?))?", re.IGNORECASE)
_COUNT = re.compile(r"(samples?|ticks?|index|points?|number|no\.?|nr\.?|n|i|row|#|unnamed: \d+)?", re.IGNORECASE)
_SIDE = {"s": "horizontal units", "V": "vertical units"}  # of a preamble
_THOUSANDS = (1e3, 1e6, 1e9)  # by which a unit changes within a file
_CLOSED = 0.02  # of the peak-to-peak value: a difference of the ends that is none
_ALIKE = 0.05  # of the variance: half the mean square by which periods differ


def or_zero(value: Any) -> Any:
    """Return a voltage of a table, and 0 for one that is less than a scene can have."""
    return 0.0 if isinstance(value, float) and abs(value) < _LEAST else value


def table(file: str, column: str | None = None, probe: float = 1.0, *, repeat: bool = False) -> dict[str, Any]:
    """Return times (s) and voltages (V) of a CSV file.

    Args:
        file: its path.
        column: name of the voltages' column, with its unit as written there or without; None where there is one alone.
        probe: factor on the voltages.
        repeat: whether the file repeats itself, so that it must end where a period does.

    Raises:
        ValueError: it cannot be read, or has no such column, another unit, or a line without numbers in range; in one
            sentence that begins with the key.
    """
    from fingerpad.scene import tables  # pandas

    name = f"file is {show(file)}"
    try:
        t, u = _columns(tables.read(file, _HEADER), column)
        t, u = t - t[0], probe * u
        if len(t) > 1 and (np.diff(t) > 0).all():
            _refuse_units(np.diff(t))
            t, u = _whole(t, u) if repeat else (t, u)
    except ValueError as error:
        raise ValueError(f"{name}, which {error}") from None
    t, u = _fewer(name, t, u)
    allowed = range_of(Volts)
    wrong = next((k for k, value in enumerate(u) if or_zero(float(value)) not in allowed), None)
    if wrong is not None:
        words = allowed.words(float(u[wrong])).partition(" (")[0]
        raise ValueError(f"{name}, which at {t[wrong]:.6g} s has a number that {words}")
    if np.abs(u).max() < _LEAST:
        raise ValueError(f"{name}, which has 0 V throughout; give a voltage, or the number 0 in its place")
    return {"times": t.tolist(), "voltages": [or_zero(float(value)) for value in u]}


def _columns(found: "Table", wanted: str | None) -> list[Array]:
    """Return the times (s) and the voltages (V) of a table, the latter by the name of its column."""
    from fingerpad.scene.tables import is_of

    columns = [each for each in found.columns if each.numeric]
    if len(columns) < 2:
        raise ValueError("has no two columns of numbers; it must have one in s and one in V")
    if not found.headed and _SIDE["s"] not in found.facts:
        raise ValueError(f"has no heads above its numbers; write '{_HEADER}' there")
    if not found.headed:  # a preamble beside the numbers has times first
        heads = ["time", *[found.facts.get("source", "voltage")] * (len(columns) - 1)]
        columns = [replace(each, name=head, head=head) for each, head in zip(columns, heads, strict=True)]
    named = [each for each in columns if _TIME.fullmatch(each.name)]
    times = [each for each in columns if is_of(each.unit, "s")]
    times = [each for each in named if each in times] or times or [each for each in named if not each.unit] or named
    if not times:
        among = clip(", ".join(show(each.head) for each in columns), 100)
        raise ValueError(f"has nothing named or united as time among {among}; write a head such as 'time (s)'")
    first = times[0]
    others = [each for each in columns if each not in times and (each.unit or not _COUNT.fullmatch(each.name))]
    if other := next((each for each in times[1:] if (each.cells != first.cells).any()), None):
        raise ValueError(f"has time twice, as {show(first.head)} and {show(other.head)}; it must have one alone")
    units = {si: found.facts.get(_SIDE[si]) or si for si in _SIDE}
    both = (("s", first), ("V", _chosen(others, wanted)))
    return [replace(each, unit=each.unit or units[si]).numbers(si).to_numpy() for si, each in both]


def _chosen(columns: "Sequence[Column]", wanted: str | None) -> "Column":
    """Return the column of a name, or the one that has voltages."""
    from fingerpad.scene.tables import is_of

    if not columns:
        raise ValueError("has nothing in V beside its time")
    volts = [each for each in columns if is_of(each.unit or "V", "V")] or columns
    if wanted is None and len(volts) == 1:
        return volts[0]
    given = "not given" if wanted is None else show(wanted)
    for heads in ([each.head for each in columns], [each.name for each in columns]):
        for column, head in zip(columns, heads, strict=True):
            if wanted is not None and head.casefold() == wanted.strip().casefold():
                return column
    names = " or ".join(show(each.name) for each in volts)
    raise ValueError(f"has {names}, and column is {given}; it must be one of these")


# -- times -------------------------------------------------------------------------------------------------------
def _refuse_units(steps: Array) -> None:
    """Refuse times whose unit changes on the way, as equal steps and then others a thousand times as large."""
    equal = steps[1:][np.isclose(steps[1:], steps[:-1], rtol=0.01)]
    if equal.size and np.isclose(equal.max() / equal.min(), _THOUSANDS, rtol=0.02).any():
        raise ValueError(
            f"has steps of time of {equal.min():.4g} s and then {equal.max():.4g} s, as if their unit "
            "changed; give one unit throughout, or the points as times and voltages"
        )


def _whole(t: Array, u: Array) -> tuple[Array, Array]:
    """Return a record of whole periods: one that is cut, or goes on for a sample with its first voltage."""
    steps, period, apart, end = np.diff(t), _period(t, u), abs(u[-1] - u[0]), t[-1]
    if period is not None:
        count = math.floor((t[-1] + 1.5 * steps.min()) / period)
        end = max(1, min(count, math.floor(count * (POINTS - 1) / len(t)))) * period  # as many as need no means
        end = t[-1] if abs(end - t[-1]) < 0.25 * steps.min() else end
    elif steps.max() < 1.01 * steps.min() and _CLOSED * np.ptp(u) < apart <= 1.01 * np.abs(np.diff(u)).max():
        end = t[-1] + steps[-1]
    elif apart > _CLOSED * np.ptp(u):
        raise ValueError(
            f"begins with {u[0]:.4g} V and ends with {u[-1]:.4g} V after {t[-1]:.4g} s, without whole "
            "periods; it repeats itself, so it must end with its first voltage"
        )
    kept = t < end - 0.25 * steps.min()
    return np.append(t[kept], end), np.append(u[kept], np.interp(end, t, u, right=u[0] if end > t[-1] else u[-1]))


def _period(t: Array, u: Array) -> float | None:
    """Return the period (s) of a record of 1.5 periods or more, None of another one.

    It is the least delay, past the first lobe, at which the record hardly differs from itself and varies; of several
    periods a part of the delay over all of them, at which it differs least.
    """
    import scipy.optimize
    import scipy.signal

    v = np.interp(np.linspace(0.0, t[-1], POINTS), t, u)
    apart = np.array([np.mean((v[k:] - v[:-k]) ** 2) for k in range(1, 2 * POINTS // 3)])
    near = 1 + scipy.signal.find_peaks(-apart, height=-2 * _ALIKE * v.var())[0]
    near = near[near > 1 + np.argmax(apart > v.var())]
    found = [int(k) for k in near if min(v[k:].var(), v[:-k].var()) > v.var() / 4]
    if not found:
        return None
    count, step = round(found[-1] / found[0]), t[-1] / (POINTS - 1)

    def differ(delay: float) -> float:
        early = t[t <= t[-1] - delay]
        return float(np.mean((np.interp(early + delay, t, u) - u[: len(early)]) ** 2))

    ends = (found[-1] - 1) * step, min((found[-1] + 1) * step, t[-1] - step)
    return float(scipy.optimize.minimize_scalar(differ, bounds=ends, method="bounded").x) / count


def _fewer(name: str, t: Array, u: Array) -> tuple[Array, Array]:
    """Return samples that are few enough: the first, means of groups, and the last."""
    count = len(t)
    if count <= POINTS:
        return t, u
    size = math.ceil((count - 2) / (POINTS - 2))
    starts = np.arange(1, count - 1, size)
    number = np.diff(np.append(starts, count - 1))
    means = [np.concatenate([x[:1], np.add.reduceat(x[1:-1], starts - 1) / number, x[-1:]]) for x in (t, u)]
    square = float(np.mean(u**2))
    left = float(np.sum(np.concatenate([[1], number, [1]]) * means[1] ** 2)) / count
    if left < (1 - _LOST) * square:
        raise ValueError(
            f"{name} with {count} points; there must be from 2 to {POINTS} of them, and means of {size} have "
            f"{left / square:.2g} of the mean square: give a shorter part, or fewer points"
        )
    return means[0], means[1]


def range_of(annotation: Any) -> Range:
    """Return the range of a key's annotation."""
    return next(part.func for part in annotation.__metadata__ if isinstance(getattr(part, "func", None), Range))
