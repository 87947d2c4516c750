"""Values over time from a CSV file with heads, as ``time (s),voltage (V)`` or as an oscilloscope writes it.

Names and units of columns decide (:mod:`fingerpad.scene.tables`): the times are in the first column with a unit of
time, or with "time" or "t" for a name; the values in the only one with a unit of the control (V, N/m or m), or in the
only other one. Without units both are in SI. Times may begin anywhere: the first becomes 0.

A file that repeats itself has whole periods: it ends with its first value, or one sample before. Files of more than
:data:`POINTS` samples are averaged in groups, all of as many. Where this would take more than :data:`_LOST` of the mean
square, as of a carrier, the file is refused.
"""

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from numpy.typing import NDArray

from fingerpad.scene.messages import clip, show
from geometry.units import QUANTITIES, Finite, Range, within

if TYPE_CHECKING:
    from fingerpad.scene.tables import Column, Table

POINTS = 2000
"""Most points of a waveform."""
MEASURES = ("amplitude", "peak_to_peak", "rms")
"""Keys that say how large a wave is; one of them is given, and none of a file."""
PROBES = Range(1e-3, 1e5)
_LOST = 0.01  # of the mean square
Seconds = Annotated[Finite, within(1e-9, 1e5, "s", zero=True)]
Sample = tuple[float, float]
"""Time (s) since the start of a load, and value."""
Array = NDArray[np.float64]
_TIME = re.compile(r"time\b.*|t", re.IGNORECASE)
_CLOSED = 0.02  # of the peak-to-peak value: a difference of the ends that is none
_SUDDEN = 0.01  # of the peak: a change of the value, within one sample before a piece of a table, that cuts the piece
_OWN = 0.5  # of the piece's own change: a smaller change before it cuts no piece
_TIME_TOLERANCE = 1e-9  # of a piece


def or_zero(value: Any, limits: Range) -> Any:
    """Return a value of a table, and 0 for one that is less than a scene can have: noise, or roundoff of a sine."""
    return 0.0 if isinstance(value, float) and abs(value) < limits.low else value


# -- reading -----------------------------------------------------------------------------------------------------
def table(
    file: str, limits: Range, column: str | None = None, probe: float = 1.0, *, repeat: bool = False
) -> dict[str, Any]:
    """Return times (s) and values of a CSV file.

    Args:
        file: its path.
        limits: values that are allowed, with their unit.
        column: name of the values' column, with its unit as written there or without; None where there is one alone.
        probe: factor on the values.
        repeat: whether the file repeats itself, so that it must have whole periods.

    Raises:
        ValueError: it cannot be read, or has no such column, another unit, or a line without numbers in range; in one
            sentence that begins with the key.
    """
    from fingerpad.scene import tables  # pandas

    name, unit, header = f"file is {show(file)}", limits.unit, f"time (s),{QUANTITIES[limits.unit]} ({limits.unit})"
    try:
        found = tables.read(file, header)
        columns = _columns(found, column, unit, header)
        sides = zip(columns, (("s", "horizontal units"), (unit, "vertical units")), strict=True)
        t, u = (
            replace(each, unit=each.unit or found.facts.get(side, si)).numbers(si).to_numpy()
            for each, (si, side) in sides
        )
        t, u = t - t[0], probe * u
        if repeat and len(t) > 1 and (np.diff(t) > 0).all():
            t, u = _closed(t, u, unit)
        t, u = _fewer(t, u)
    except ValueError as error:
        raise ValueError(f"{name}, which {error}") from None
    values = [or_zero(float(value), limits) for value in u]
    wrong = next((k for k, value in enumerate(values) if value not in limits), None)
    if wrong is not None:
        words = limits.words(float(u[wrong])).partition(" (")[0]
        raise ValueError(f"{name}, which at {t[wrong]:.6g} s has a number that {words}")
    if not any(values):
        raise ValueError(f"{name}, which has 0 {unit} throughout; give other values, or the number 0 in its place")
    return {"times": t.tolist(), "values": values}


def _columns(found: "Table", wanted: str | None, unit: str, header: str) -> "tuple[Column, Column]":
    """Return the columns of the times and of the values, the latter by its name or as the one in the unit."""
    from fingerpad.scene.tables import is_of

    columns = [each for each in found.columns if each.numeric]
    if len(columns) < 2 or not found.headed:
        raise ValueError(f"has no two columns of numbers with heads; write '{header}' above them")
    among = clip(" or ".join(show(each.head) for each in columns), 100)
    united = [each for each in columns if is_of(each.unit, "s")]
    times = united or [each for each in columns if _TIME.fullmatch(each.name)]
    if not times:
        raise ValueError(f"has nothing named or united as time among {among}; write a head such as 'time (s)'")
    others = [each for each in columns if each not in times]
    if not others:
        raise ValueError(f"has nothing in {unit} beside its time")
    values = [each for each in others if is_of(each.unit, unit)] or others
    if wanted is not None:
        name = wanted.strip().casefold()
        heads, names = ([each for each in others if getattr(each, key).casefold() == name] for key in ("head", "name"))
        values = heads or names
    if len(values) != 1:
        given = "not given" if wanted is None else show(wanted)
        raise ValueError(f"has {among}, and column is {given}; it must be one of these")
    return times[0], values[0]


def _closed(t: Array, u: Array, unit: str) -> tuple[Array, Array]:
    """Return a record that ends with its first value; one that does so a sample later goes on for that sample."""
    steps, apart = np.diff(t), abs(u[-1] - u[0])
    if apart <= _CLOSED * np.ptp(u):
        return t, u
    if steps.max() < 1.01 * steps.min() and apart <= 1.01 * np.abs(np.diff(u)).max():
        return np.append(t, t[-1] + steps[-1]), np.append(u, u[0])
    raise ValueError(
        f"begins with {u[0]:.4g} {unit} and ends with {u[-1]:.4g} {unit} after {t[-1]:.4g} s; it repeats itself, so "
        "cut it to whole periods, which end with their first value"
    )


def _fewer(t: Array, u: Array) -> tuple[Array, Array]:
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
            f"has {count} points; there must be from 2 to {POINTS} of them, and means of {size} have "
            f"{left / square:.2g} of the mean square: give a shorter part, or fewer points"
        )
    return means[0], means[1]


# -- tables of a scene -------------------------------------------------------------------------------------------
def refuse_table(wave: Any) -> None:
    """Refuse a waveform of a table that is none.

    Raises:
        ValueError: in one sentence, with the waveform's keys.
    """
    times, values = wave.times, wave.values
    for name in (*MEASURES, "frequency", "offset", "burst"):
        if name in wave.model_fields_set and getattr(wave, name) not in (None, 0.0):
            given = "given" if name == "burst" else show(getattr(wave, name))
            raise ValueError(f"{name} is {given} and waveform is 'file', which has none")
    if times is None or values is None:
        raise ValueError("file is missing; waveform is 'file' and needs it")
    if len(times) != len(values):
        raise ValueError(f"times are {len(times)} and values are {len(values)}; give as many of each")
    if not 2 <= len(times) <= POINTS:
        raise ValueError(f"times are {len(times)}; there must be from 2 to {POINTS} of them")
    if times[0] != 0:
        raise ValueError(f"times start at {show(times[0])} s; the first must be 0, where the load starts")
    for before, after in pairwise(times):
        if after <= before:
            raise ValueError(
                f"times are {show(before)} and then {show(after)} s; each must be later than the one before, so give a "
                "jump a short time"
            )


def refined(times: Sequence[float], values: Sequence[float], most: float, behind: int) -> Iterator[Sample]:
    """Yield the points of a table, the zeros between them, and more within its pieces.

    Args:
        times: of the table (s).
        values: of the table.
        most: change of the value between two samples.
        behind: samples of a piece behind a sudden change, and of the first piece.
    """
    least = _SUDDEN * max(map(abs, values))
    yield times[0], values[0]
    for k in range(1, len(times)):
        (t0, t1), (u0, u1) = times[k - 1 : k + 1], values[k - 1 : k + 1]
        before = _change_before(times, values, k - 1, (t1 - t0) / behind)
        even = behind if k == 1 or before > max(least, _OWN * abs(u1 - u0)) else 1
        zero = [(t0 + (t1 - t0) * u0 / (u0 - u1), 0.0)] if u0 * u1 < 0 else []
        for (a, ua), (b, ub) in pairwise([(t0, u0), *zero, (t1, u1)]):
            by_time = math.ceil(even * (b - a) / (t1 - t0) - _TIME_TOLERANCE)
            by_value = math.ceil(abs(ub - ua) / most - _TIME_TOLERANCE) if most > 0 else 1
            pieces = max(by_time, by_value, 1)
            for j in range(1, pieces):
                yield a + (b - a) * j / pieces, ua + (ub - ua) * j / pieces
            yield b, ub


def _change_before(times: Sequence[float], values: Sequence[float], k: int, seconds: float) -> float:
    """Return by how much the value of a table changes in some seconds before its point k."""
    first, seen = times[k] - seconds, [values[k]]
    while k > 0 and times[k] > first:
        k -= 1
        part = min((times[k + 1] - first) / (times[k + 1] - times[k]), 1.0)
        seen.append(values[k + 1] + part * (values[k] - values[k + 1]))
    return max(seen) - min(seen)
