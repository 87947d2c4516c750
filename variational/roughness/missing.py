r"""Missing pixels of a height map, filled so that what is around them goes on smoothly.

About the measured heights' mean, tilt and curvature, by least squares, a missing height is the mean of its neighbours:
the discrete Laplace equation, with the measured heights around as values on its boundary and no slope across the map's
own edge. Without the curvature a hole at an edge of a curved map would be filled flat, a step of which the spectrum
makes roughness. The filling is smoother than the surface: it takes away roughness that is finer than a hole, about in
proportion to the part of the map that is missing.

A mark of missing pixels that nobody named, as -9999, or a saturated pixel, is a value far from all other heights. The
smallest height is one where nothing lies between it and the next one over more than 20 interquartile ranges of the
others, 27 standard deviations of Gaussian heights; and so is the largest. A groove, however deep, is measured at many
depths, so that its deepest pixel has others near. Pixels of the two extreme values do not count among the others, as
they may be many. Where half of the others are equal, their whole range stands for that of the quartiles.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.linalg import spsolve

from variational.roughness.topography import polynomials

Array = NDArray[np.float64]
MOST = 0.25  # of a map that may be missing
_FAR = 20.0  # interquartile ranges without a height


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


def filled(heights: Array) -> Array:
    """Return heights (m) without missing ones.

    Args:
        heights: shape (nx, ny), NaN or infinite where missing.

    Raises:
        ValueError: more than a quarter of the map is missing.
    """
    lost = ~np.isfinite(heights)
    count = int(lost.sum())
    if count == 0:
        return heights
    if count > MOST * heights.size:
        raise ValueError(f"{count} of {heights.size} heights are missing or infinite; at most a quarter may be")
    trend = _trend(heights, ~lost)
    rest = heights - trend
    number = np.full(heights.shape, -1)
    number[lost] = np.arange(count)
    rows, columns, values = [], [], []
    right, degree = np.zeros(count), np.zeros(count)
    for axis in (0, 1):
        for side in (1, -1):
            here, there = (_shifted(heights.shape, axis, side, end) for end in (0, 1))
            mine, other, z = number[here], number[there], rest[there]
            inside = mine >= 0
            np.add.at(degree, mine[inside], 1.0)
            known = inside & (other < 0)
            np.add.at(right, mine[known], z[known])
            both = inside & (other >= 0)
            rows.append(mine[both])
            columns.append(other[both])
            values.append(np.full(int(both.sum()), -1.0))
    diagonal = np.arange(count)
    matrix = coo_array(
        (np.concatenate([*values, degree]), (np.concatenate([*rows, diagonal]), np.concatenate([*columns, diagonal]))),
        shape=(count, count),
    ).tocsc()
    whole = heights.copy()
    whole[lost] = spsolve(matrix, right) + trend[lost]
    return whole


def _trend(heights: Array, known: NDArray[np.bool_]) -> Array:
    """Return mean, tilt and curvature of the known heights, everywhere."""
    basis = polynomials(heights.shape, 2)
    part = np.linalg.lstsq(basis[known.ravel()], heights[known], rcond=None)[0]
    return np.asarray((basis @ part).reshape(heights.shape))


def _shifted(shape: tuple[int, ...], axis: int, side: int, end: int) -> tuple[slice, slice]:
    """Return the pixels that have a neighbour on a side of an axis (end 0), or these neighbours (end 1)."""
    n = shape[axis]
    low = slice(0, n - 1) if (side == 1) == (end == 0) else slice(1, n)
    other = slice(0, shape[1 - axis])
    return (low, other) if axis == 0 else (other, low)
