"""Voltages over time from a CSV file: of two columns under a header, or as an oscilloscope writes it.

The first column of numbers has the times, the others have voltages. Lines before them are a preamble. Its last lines
name the columns and their units, in brackets behind the names or in a line of their own; some instruments write it in
columns beside the numbers. Without units the times are in s and the voltages in V. Times may begin anywhere: the first
becomes 0, and the last sample closes the period.

Files of more than :data:`POINTS` samples are averaged in groups, all of as many. Where this would take more than
:data:`_LOST` of the mean square, a carrier for example, the file is refused.
"""

import math
import re
from collections.abc import Sequence
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fingerpad.scene.messages import clip, show
from geometry.units import Finite, Range, to_si, within
from variational import files

POINTS = 2000
"""Most points of a waveform."""
HIGHEST = 5e3
"""Largest voltage (V)."""
Probe = Annotated[Finite, within(1e-3, 1e5)]
_LEAST = 1e-3  # V; what is less in a table is 0: noise, or roundoff of a computed sine
_LOST = 0.01  # of the mean square
Volts = Annotated[Finite, within(_LEAST, HIGHEST, "V", zero=True, sides=2)]
Seconds = Annotated[Finite, within(1e-9, 1e5, "s", zero=True)]
_WORDS = {"second": "s", "sec": "s", "seconds": "s", "volt": "V", "volts": "V"}
_TIMES = {*_WORDS, "s", "ms", "us", "µs", "μs", "ns", "sequence", "sample", "samples", "point", "points"}
"""Of the first column in a line of units; some are none, and are refused."""
_SIDE = {"s": "horizontal units", "V": "vertical units"}  # keys of a preamble beside the numbers
Array = NDArray[np.float64]
_HEAD = re.compile(r"(.*?)\s*[(\[]([^()\[\]]*)[)\]]")  # a name, and a unit in the last brackets behind it
_Rows = list[tuple[int, list[str]]]  # number of a line, and its cells


def or_zero(value: Any) -> Any:
    """Return a voltage of a table, and 0 for one that is less than a scene can have."""
    return 0.0 if isinstance(value, float) and abs(value) < _LEAST else value


def table(file: str, column: str | None = None, probe: float = 1.0) -> dict[str, Any]:
    """Return times (s) and voltages (V) of a CSV file.

    Args:
        file: its path.
        column: name of the voltages' column, with its unit as written there or without; its number where it has no
            name, that of the times being 1; None where there is one alone.
        probe: factor on the voltages.

    Raises:
        ValueError: it cannot be read, or has no such column, another unit, or a line without numbers in range; in one
            sentence that begins with the key.
    """
    name = f"file is {show(file)}"
    rows = _rows(file, name)
    places = _numbers(rows)
    if len(places) < 2:
        raise ValueError(f"{name}, which has no two columns of numbers; it must have one in s and one in V")
    wide = places[-1]
    numbers = (k for k, (_, row) in enumerate(rows) if len(row) > wide and all(files.is_number(row[j]) for j in places))
    first = next(numbers)
    labels = _labels(rows, first, places)
    place = _chosen(name, labels, places, column)
    factors = [_factor(name, label, unit) for label, unit in zip((labels[0], labels[place]), ("s", "V"), strict=True)]
    for line, cells in rows[first:]:
        _refuse_line(name, line, cells, places)
    t, u = (np.array([float(cells[places[k]]) for _, cells in rows[first:]]) for k in (0, place))
    t, u = _fewer(name, factors[0] * (t - t[0]), factors[1] * probe * u)
    allowed = range_of(Volts)
    wrong = next((k for k, value in enumerate(u) if or_zero(float(value)) not in allowed), None)
    if wrong is not None:
        words = allowed.words(float(u[wrong])).partition(" (")[0]
        raise ValueError(f"{name}, which at {t[wrong]:.6g} s has a number that {words}")
    return {"times": t.tolist(), "voltages": [or_zero(float(value)) for value in u]}


# -- text --------------------------------------------------------------------------------------------------------
def _rows(file: str, name: str) -> _Rows:
    """Return the lines that are not empty, parted by what makes most numbers of them: commas, semicolons or tabs."""
    try:
        data = files.read(file, files.MOST_OF_TEXT)
    except OSError as error:
        raise ValueError(f"{name}, which cannot be read: {show(error.strerror or str(error))}") from None
    text = files.text(data)
    if text is None:
        raise ValueError(f"{name}, which is no text")
    return max((_parted(text, mark, name) for mark in ",;\t"), key=_count)


def _parted(text: str, mark: str, name: str) -> _Rows:
    """Return the lines of a text with their cells."""
    try:
        return files.parted(text, mark)
    except ValueError as error:
        raise ValueError(f"{name}, which is no table in CSV: {show(clip(str(error), 100))}") from None


def _count(rows: _Rows) -> int:
    """Return how many lines are of two numbers or more, and of nothing else."""
    found = ([cell for cell in cells if cell] for _, cells in rows)
    return sum(len(cells) > 1 and all(map(files.is_number, cells)) for cells in found)


def _numbers(rows: _Rows) -> list[int]:
    """Return the places of columns of numbers, as many as half of those of the column with most of them, or more."""
    counts = dict[int, int]()
    for _, cells in rows:
        for k, cell in enumerate(cells):
            counts[k] = counts.get(k, 0) + files.is_number(cell)
    most = max(counts.values(), default=0)
    return [k for k, count in counts.items() if count > most / 2]


def _refuse_line(name: str, line: int, cells: Sequence[str], places: Sequence[int]) -> None:
    texts = [cells[k] if k < len(cells) else "" for k in places]
    wrong = next((text for text in texts if not (files.is_number(text) and math.isfinite(float(text)))), None)
    if wrong is not None:
        raise ValueError(f"{name}, whose line {line} has {show(wrong)}; it must be a finite number")
    count = sum(map(bool, cells))
    if places[0] == 0 and count > len(places):
        raise ValueError(f"{name}, whose line {line} has {count} cells; it must have {len(places)}, as the others")


# -- columns -----------------------------------------------------------------------------------------------------
class _Label(NamedTuple):
    """What stands above a column of numbers; empty where there is nothing."""

    name: str
    unit: str
    head: str
    """Both as written."""


def _labels(rows: _Rows, first: int, places: Sequence[int]) -> list[_Label]:
    """Return the label of each column of numbers."""
    if places[0] > 0:
        beside = {cells[0].casefold(): cells[1] for _, cells in rows if len(cells) > 1 and cells[0]}
        units = [beside.get(_SIDE[unit], "") for unit in ("s", "V")]
        names = ["", *[beside.get("source", "")] * (len(places) - 1)]
        return [_Label(names[k], units[min(k, 1)], names[k]) for k in range(len(places))]
    above = [cells for _, cells in rows[max(first - 2, 0) : first] if all(k < len(cells) and cells[k] for k in places)]
    last = above[-1] if above else [""] * (places[-1] + 1)
    bare = [cell.strip("()[]") for cell in last]
    if len(above) > 1 and bare[0].casefold() in _TIMES:  # names, and a line of units
        return [_Label(above[0][k], bare[k], above[0][k]) for k in places]
    found = [(last[k], _HEAD.fullmatch(last[k])) for k in places]
    return [_Label(match[1], match[2].strip(), head) if match else _Label(head, "", head) for head, match in found]


def _chosen(name: str, labels: Sequence[_Label], places: Sequence[int], column: str | None) -> int:
    """Return which of the columns of numbers has the voltages."""
    if column is None and len(places) == 2:
        return 1
    names = [label.name or str(place + 1) for label, place in zip(labels, places, strict=True)]
    wanted = None if column is None else column.strip().casefold()
    for known in ([label.head for label in labels], names):
        same = [k for k in range(1, len(places)) if known[k].casefold() == wanted]
        if same:
            return same[0]
    given = "is not given" if column is None else f"is {show(column)}"
    raise ValueError(f"column {given} and {name}; it must be {' or '.join(map(show, names[1:]))}, as named there")


def _factor(name: str, label: _Label, si: str) -> float:
    """Return the unit of a column over the SI unit."""
    column, unit = label.name, label.unit
    if not unit:
        return 1.0
    try:
        return to_si(f"1 {_WORDS.get(unit.casefold(), unit)}", si)
    except ValueError:
        what = "first numbers" if si == "s" else f"numbers of {show(column)}"
        raise ValueError(f"{name}, whose {what} are in {show(clip(unit, 40))}; they must be in {si} or m{si}") from None


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
