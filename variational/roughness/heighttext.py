"""Height maps as text: a matrix of numbers with any separator, or points x, y, z; missing pixels allowed.

Numbers are parted by semicolons, tabs, commas or spaces, with a decimal point or a decimal comma. Lines that start with
``#``, ``%`` or ``//`` and lines of words at the top are left out. A pixel is missing where the place is empty, or holds
``nan``, ``na``, ``-``, ``--``, ``***``, ``bad`` or a mark that is given. Three columns are points of a regular grid.
"""

import re
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

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


def parse(text: str, missing: str | None = None) -> Text:
    """Return the height map of a text.

    Args:
        text: of the file.
        missing: how a missing pixel is marked, a word or a number, beside the usual ways.

    Raises:
        ValueError: a line that does not fit, or no map.
    """
    lines = [(k, line) for k, line in enumerate(text.splitlines(), start=1) if line.strip()]
    lines = [(k, line) for k, line in lines if not line.lstrip().startswith(_COMMENT)]
    first = next((k for k, (_, line) in enumerate(lines) if re.match(r"[\s;,]*[-+]?[.,]?\d", line)), None)
    if first is None:
        raise ValueError("no matrix of numbers: no line starts with one")
    lines = lines[first:]
    separator, comma = _separator([line for _, line in lines])
    marks = _MISSING | ({missing.strip().lower()} if missing is not None else set())
    rows = [_row(k, line, separator, comma, marks) for k, line in lines]
    if separator is not None and all(np.isnan(row[-1]) for row in rows):
        rows = [row[:-1] for row in rows]  # a separator at the end of each line
    for (k, _), row in zip(lines, rows, strict=True):
        if len(row) != len(rows[0]):
            raise ValueError(f"no matrix of numbers: line {k} has {len(row)} of them, the first one {len(rows[0])}")
    found = np.array(rows)
    if missing is not None and re.fullmatch(r"[-+.\deE]+", missing.strip()):
        found[found == float(missing)] = np.nan
    layout = f"separated by {_NAMES[separator]}{', decimal commas' if comma else ''}"
    if found.shape[1] == 3 and len(found) > 3:
        heights, size = _grid(found)
        return Text(heights, size, f"points x, y, z on {heights.shape[0]} x {heights.shape[1]} pixels, {layout}")
    return Text(found, None, f"matrix of {found.shape[0]} x {found.shape[1]} pixels, {layout}")


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
        text = word.strip().strip('"')
        if text.lower() in marks:
            values.append(np.nan)
            continue
        try:
            values.append(float(text.replace(",", ".") if comma else text))
        except ValueError:
            raise ValueError(
                f"no matrix of numbers: line {number} has {text[:30]!r}; a mark of missing pixels must be given"
            ) from None
    return values


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
