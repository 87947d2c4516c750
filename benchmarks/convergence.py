r"""Limit of a quantity under mesh refinement, from its values on meshes of halved size.

With values :math:`f_k` on meshes of size :math:`h_k`, each half of the one before, the last three give

.. math:: p = \log_2 \frac{f_1 - f_0}{f_2 - f_1}, \qquad f = f_2 + \frac{f_2 - f_1}{2^p - 1}

and Roache's grid convergence index the error bar, :math:`1.25\,|f - f_2|` (Roache 1994, doi 10.1115/1.2910291). An
order above 2, that of the strains of quadratic elements, is an accident of the last change: p is 2 then, and the bar
that of the change which p = 2 would have left of the one before, :math:`(f_1 - f_0) / 4`. Changes that hardly shrink
(an order below 1/2) or change sign give no order; the limit is the last value then. Its bar is three times the last
change if the changes alternate and shrink, else three times the larger of the last two: the index's factor for two
meshes.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

_SAFETY, _UNSAFE = 1.25, 3.0
_LOWEST, _HIGHEST = 0.5, 2.0  # orders used for extrapolation


@dataclass(frozen=True)
class Limit:
    """Limit of a quantity."""

    value: float
    bar: float
    """Half the width of the error bar about ``value``."""
    order: float | None
    """Observed order, None where there is none."""


def limit(values: Sequence[float]) -> Limit:
    """Estimate the limit of values on meshes of halved size.

    Args:
        values: from the coarsest to the finest, at least three.

    Raises:
        ValueError: fewer than three.
    """
    if len(values) < 3:
        raise ValueError(f"{len(values)} values were given; an order needs three")
    before, last = np.diff(np.asarray(values, dtype=float)[-3:])
    finest = float(values[-1])
    if last == 0 or before / last <= 1:
        sides = last != 0 and before / last < -1
        return Limit(finest, _UNSAFE * float(abs(last) if sides else max(abs(before), abs(last))), None)
    order = float(np.log2(before / last))
    if order < _LOWEST:
        return Limit(finest, _UNSAFE * float(max(abs(before), abs(last))), None)
    factor = 2 ** min(order, _HIGHEST)
    return Limit(finest + float(last) / (factor - 1), _SAFETY * float(abs(before)) / factor / (factor - 1), order)
