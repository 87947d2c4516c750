"""What a height map is refused for by its heights alone: values that are none, stitched parts, lines that are off.

With d the differences of two neighbouring lines (or columns), a map has

- numbers and places of lines or columns, where a first or last line has equal steps and most others do not;
- a first or last line that is something else, or a step where parts are stitched, where d, root mean square over the
  line, is above :data:`_STEP` times that on either side (of self-affine surfaces of 16 lines the most is 2.5, of 40
  lines 1.8);
- offsets of scan lines, where for most lines the mean of d over the line is above the scatter of d along it, and
  changes its sign from line to line (at random it does so at two of three lines; along a smooth surface seldom).

A mark of missing pixels that nobody named, as -9999, or a saturated pixel, is a value far from all other heights. The
smallest height is one where nothing lies between it and the next one over more than 20 interquartile ranges of the
others, 27 standard deviations of Gaussian heights; and so is the largest. A groove, however deep, is measured at many
depths, so that its deepest pixel has others near. Pixels of the two extreme values do not count among the others, as
they may be many. Where half of the others are equal, their whole range stands for that of the quartiles.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_EQUAL = 0.01  # relative difference of steps that are the same
_STEP, _LINES = 3.0, 16  # see above, and the least lines for a judgement
_FAR = 20.0  # interquartile ranges without a height
_MEASURED = "or 'missing'=\"nan\" if it was measured"


def mark(heights: Array) -> float | None:
    """Return the height that seems to mark missing pixels, None without one.

    Args:
        heights: in any unit and shape, NaN where they are known to be missing.
    """
    known = heights[np.isfinite(heights)]
    if not known.size:
        return None
    low, high = float(known.min()), float(known.max())
    others = known[(known > low) & (known < high)]
    if not others.size:
        return None
    lower, upper = np.percentile(others, [25, 75])
    far = _FAR * float((upper - lower) or np.ptp(others))
    gaps = {low: float(others.min()) - low, high: high - float(others.max())}
    value = max(gaps, key=lambda height: gaps[height])
    return value if 0 < far < gaps[value] else None


def refuse_numbering(path: Path, heights: Array) -> None:
    """Refuse numbers or coordinates of rows or columns, as pandas and instruments write them beside the heights.

    Args:
        path: of the file.
        heights: in any unit, shape (nx, ny), NaN where they are known to be missing.

    Raises:
        ValueError: in one sentence.
    """
    for lines, name in ((heights, "line"), (heights.T, "column")):
        steps = np.diff(lines[:, 1:], axis=1)
        even = (steps[:, 0] != 0) & (np.ptp(steps, axis=1) < _EQUAL * np.abs(steps[:, 0]))
        for k, which in ((0, "first"), (-1, "last")):
            if even[k] and even.mean() < 0.5:
                raise ValueError(
                    f"{path} has values at equal steps in its {which} {name}, from {lines[k, 1]:g} to "
                    f"{lines[k, -1]:g}, which number or place the others; save the heights alone, in pandas with "
                    "header=False, index=False"
                )


def refuse_mark(path: Path, heights: Array) -> None:
    """Refuse a value far from all other heights, of which the spectrum would make roughness.

    Args and errors are those of :func:`refuse_numbering`.
    """
    value = mark(heights)
    if value is not None:
        count, text = int(np.count_nonzero(heights == value)), repr(value).removesuffix(".0")
        pixels = "1 pixel" if count == 1 else f"{count} pixels"
        raise ValueError(
            f"{path} has {text} at {pixels}, far from all other heights, as a mark of missing pixels; give "
            f"'missing'=\"{text}\", {_MEASURED}"
        )


def refuse_uneven(path: Path, heights: Array) -> None:
    """Refuse a line or column that differs from its neighbours as no other does, and offsets of all of them.

    Args:
        path: of the file.
        heights: (m), shape (nx, ny), all of them finite.

    Raises:
        ValueError: in one sentence.
    """
    found = [*_uneven(heights, "line"), *_uneven(heights.T, "column")]
    if found:
        raise ValueError(f"{path} has {max(found)[1]}, {_MEASURED}")


def _uneven(heights: Array, line: str) -> Iterator[tuple[float, str]]:
    """Yield what is wrong with lines, in heights of shape (lines, pixels of a line), and how far from even it is."""
    if len(heights) < _LINES:
        return
    steps = np.diff(heights, axis=0)
    common, scatter = np.abs(steps.mean(axis=1)), steps.std(axis=1)
    turns = np.diff(np.sign(steps.mean(axis=1))) != 0
    if (common > scatter).mean() > 0.5 and turns.mean() > 0.5:
        yield (
            np.inf,
            f"{line}s that are {np.median(common):.2g} m off from one to the next as a whole, and pixels scatter by "
            f"{np.median(scatter):.2g} m about that; level the {line}s in the instrument's program and give that map",
        )
    rms = np.hypot(common, scatter)
    beside = np.pad(rms, 1)
    over = rms - _STEP * np.maximum(beside[:-2], beside[2:])
    k = int(over.argmax())
    if over[k] > 0:
        if k in (0, len(rms) - 1):
            cause = f"the {'last' if k else 'first'} {line} seems to hold no heights; save and give the others alone"
        else:
            cause = "two parts seem to be stitched there; give one of them"
        what = f"a step of {rms[k]:.2g} m (rms) from {line} {k + 1} to {k + 2}, where others are {np.median(rms):.2g} m"
        yield float(over[k]), f"{what}: {cause}"
