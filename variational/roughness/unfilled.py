"""A mark of missing pixels that nobody named, as -9999, or a saturated pixel: a value far from all other heights.

The smallest height stands for a mark where nothing lies between it and the next one over more than 20 interquartile
ranges of the others, 27 standard deviations of Gaussian heights; likewise the largest. A groove, however deep, is
measured at many depths, so that its deepest pixel has others near. Pixels of the two extreme values do not count among
the others, as they may be many. Where half of the others are equal, their whole range stands for that of the quartiles.
"""

import numpy as np
from numpy.typing import NDArray

_FAR = 20.0  # interquartile ranges without a height


def mark(heights: NDArray[np.float64]) -> float | None:
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
