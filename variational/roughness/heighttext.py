"""Height maps as text: a matrix of numbers with any separator, or points x, y, z; missing pixels allowed.

Numbers are parted by semicolons, tabs, commas or spaces, with a decimal point or a decimal comma. Lines that start with
``#``, ``%`` or ``//`` and lines of words at the top are left out. A pixel is missing where the place is empty, or holds
``nan``, ``na``, ``-``, ``--``, ``***``, ``bad`` or a mark that is given, also by the header; a line of marks alone is a
line of the map. Three columns are points of a regular grid, whose header may give units
(:mod:`variational.roughness.heightheader`).
"""

import math
import re
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from variational.roughness import heightheader

Array = NDArray[np.float64]
_MISSING = {"", "nan", "na", "n/a", "-", "--", "***", "bad"}
_COMMENT = ("#", "%", "//")
_OFF = 0.02  # of a pixel, by which a point may lie beside the grid
_NAMES = {None: "spaces", ";": "semicolons", "\t": "tabs", ",": "commas"}


class Text(NamedTuple):
    """What a text holds."""

    heights: Array
    """Shape (nx, ny), NaN where a pixel is missing; in the unit of the text."""
    size: tuple[float, float] | None
    """Lengths along x and y, in the unit of the text; None of a matrix, which has none."""
    layout: str
    """How the numbers are laid out, in words."""
    units: dict[str, str]
    """Units of x, y and z of points that the header gives."""


def parse(text: str, missing: str | None = None) -> Text:
    """Return the height map of a text.

    Args:
        text: of the file.
        missing: how a missing pixel is marked, a word or a number, beside the usual ways.

    Raises:
        ValueError: a line that does not fit, or no map.
    """
    whole = text.splitlines()
    lines = [(k, line) for k, line in enumerate(whole, start=1) if line.strip()]
    lines = [(k, line) for k, line in lines if not line.lstrip().startswith(_COMMENT)]
    marks = _MISSING | ({_plain(missing, False), _plain(missing, True)} if missing is not None else set())
    first = next((k for k, (_, line) in enumerate(lines) if _has_numbers(line, marks)), None)
    if first is None:
        raise ValueError("no matrix of numbers: no line of numbers")
    header = whole[: lines[first][0] - 1]
    separator, comma = _separator([line for _, line in lines[first:]])
    above, lines = lines[:first], lines[first:]
    rows = [_row(k, line, separator, comma, marks) for k, line in lines]
    for k, line in reversed(above):  # lines of the map in which all is missing, and lines of words
        words = [_plain(word, comma) for word in line.split(separator)]
        unknown = [word for word in words if word not in marks and not is_number(word)]
        if len(words) == len(rows[0]) and not unknown:
            lines, rows = [(k, line), *lines], [[np.nan] * len(words), *rows]
        elif len(words) == len(rows[0]) > 3 and 2 * len(unknown) < len(words):
            raise _unknown(k, unknown[0])
    if separator is not None and all(line.rstrip(" ").endswith(separator) for _, line in lines):
        rows = [row[:-1] for row in rows]  # what comes after the last separator of a line
    for (k, _), row in zip(lines, rows, strict=True):
        if len(row) != len(rows[0]):
            raise ValueError(f"no matrix of numbers: line {k} has {len(row)} of them, the first one {len(rows[0])}")
    found = np.array(rows)
    for mark in (missing, heightheader.mark(header)):
        if mark is not None and is_number(_plain(mark, comma)):
            found[found == float(_plain(mark, comma))] = np.nan
    layout = f"separated by {_NAMES[separator]}{', decimal commas' if comma else ''}"
    if found.shape[1] == 3 and len(found) > 3:
        heights, size = _grid(found)
        units = heightheader.units(header)
        return Text(heights, size, f"points x, y, z on {heights.shape[0]} x {heights.shape[1]} pixels, {layout}", units)
    return Text(found, None, f"matrix of {found.shape[0]} x {found.shape[1]} pixels, {layout}", {})


def _separator(lines: list[str]) -> tuple[str | None, bool]:
    """Return what parts the numbers, None for spaces, and whether they have decimal commas."""
    text = "\n".join(lines[:1000])
    for separator in (";", "\t"):
        if separator in text:
            return separator, _decimal_comma(text)
    if "," not in text:
        return None, False
    # 1,5 2,5 are two numbers with decimal commas; 1.5, 2.5 and 1,2 are parted by the commas.
    if re.search(r"\d[ ]+[-+]?\d", text) and not re.search(r",\s", text):
        return None, _decimal_comma(text)
    return ",", False


def _decimal_comma(text: str) -> bool:
    """Return whether there are decimal commas.

    Raises:
        ValueError: there are decimal points too.
    """
    if re.search(r"\d,\d", text) and re.search(r"\d\.\d", text):
        raise ValueError("no matrix of numbers: it has points and commas in them; write all with decimal points")
    return "," in text


def _row(number: int, line: str, separator: str | None, comma: bool, marks: set[str]) -> list[float]:
    """Return the numbers of a line."""
    values = []
    for word in line.split(separator):
        text = _plain(word, comma)
        try:
            values.append(np.nan if text in marks else float(text))
        except ValueError:
            raise _unknown(number, text) from None
    return values


def _plain(word: str, comma: bool) -> str:
    """Return a word without spaces and quotes around it, in small letters, with a decimal point for a comma."""
    text = word.strip().strip('"').lower()
    return text.replace(",", ".") if comma else text


def _unknown(number: int, word: str) -> ValueError:
    """Return the refusal of a word in a line."""
    return ValueError(f"no matrix of numbers: line {number} has {word[:30]!r}; a mark of missing pixels must be given")


def is_number(text: str) -> bool:
    """Return whether a text is a number with a decimal point, and not nan or inf."""
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


def _has_numbers(line: str, marks: set[str]) -> bool:
    """Return whether a line starts with a number, or has numbers and marks of missing pixels alone."""
    words = [word.strip('"').lower() for word in re.split(r"[;,\s]+", line.strip())]
    numbers = [is_number(word) for word in words]
    known = all(number or word in marks for number, word in zip(numbers, words, strict=True))
    return (known and any(numbers)) or bool(re.match(r"[\s;,]*[-+]?[.,]?\d", line))


def _grid(points: Array) -> tuple[Array, tuple[float, float]]:
    """Return heights on a regular grid, NaN where there is no point, and its lengths.

    Raises:
        ValueError: the points are not those of a regular grid.
    """
    points = points[np.isfinite(points[:, :2]).all(axis=1)]
    index, size, shape = [], [], []
    for axis, name in ((0, "x"), (1, "y")):
        values = np.unique(points[:, axis])
        gaps = np.diff(values)
        steps = gaps[gaps > 1e-3 * gaps.max()] if len(gaps) else gaps
        if not len(steps):
            raise ValueError(f"three columns are points x, y, z, and all of these have the same {name}")
        step = float(np.median(steps))
        place = (points[:, axis] - values[0]) / step
        if np.abs(place - np.round(place)).max() > _OFF * max(1.0, 1e-3 * place.max()):
            raise ValueError(f"three columns are points x, y, z, and these are not on a regular grid along {name}")
        index.append(np.round(place).astype(int))
        shape.append(int(index[-1].max()) + 1)
        size.append(shape[-1] * step)
    if shape[0] * shape[1] > 100 * len(points):
        raise ValueError(f"three columns are points x, y, z, and {len(points)} of these do not fill a grid")
    heights = np.full(shape, np.nan)
    heights[index[0], index[1]] = points[:, 2]
    return heights, (size[0], size[1])
