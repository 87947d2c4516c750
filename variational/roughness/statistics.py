r"""What a closure knows of the gaps of a ridge under pressure, and which of them break down.

The equivalent air gap has the attraction of all gaps g, :math:`(h_0 + d_{eq})^{-2} = \langle (h_0 + g)^{-2} \rangle`.

**Breakdown.** Over a gap g the air bears the voltage :math:`U g / (h_0 + g)`. It breaks down above
:math:`V_b = \min(350\,V/\mu m \cdot g,\ 330\,V)`: below a micrometre field emission sets a field, 350 V/um in air
between metals, and deviations from Paschen's law end at four (A. Peschot et al. 2014, "Deviations from the Paschen's
law at short gap distances from 100 nm to 10 µm in air and nitrogen", read in its abstract). Between the two the voltage
is nearly constant, 330 to 350 V; the lower end is taken. *Assumption* for skin. The constant stays above four
micrometres too; it is too low for gaps above some ten, where Paschen's law holds.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
BREAKDOWN_FIELD = 350e6
"""Field (V/m) at which air in a gap below 1 µm breaks down."""
BREAKDOWN_PLATEAU = 330.0
"""Voltage (V) across a wider gap at which air breaks down; 330 to 350 V were measured."""


class Slopes(NamedTuple):
    """Derivatives by the mean contact pressure; each has the shape of the pressures."""

    area: Array
    """Of the part of the area in contact (1/Pa)."""
    u_bar: Array
    """Of the mean separation (m/Pa)."""
    inverse_square: Array
    """Of <(h_0 + g)^-2> (1/(m^2 Pa))."""
    d_eq: Array
    """Of the equivalent air gap (m/Pa)."""


class Statistics(NamedTuple):
    """Gaps of a ridge at mean contact pressures; each array has their shape."""

    area: Array
    """Part of the nominal area in contact."""
    u_bar: Array
    """Mean separation (m)."""
    inverse_square: Array
    """<(h_0 + g)^-2> (1/m^2): the attraction is half of it, times the vacuum's permittivity and the square of U."""
    d_eq: Array
    """Equivalent air gap (m)."""
    broken_down: Array
    """Part of the area whose air has more than its breakdown voltage; without contact, where there is no air."""
    slopes: Slopes


def breakdown_voltage(gap: ArrayLike) -> Array:
    """Return the voltage (V) across air gaps (m) at which air breaks down, of their shape."""
    return np.asarray(np.minimum(BREAKDOWN_FIELD * np.asarray(gap, dtype=float), BREAKDOWN_PLATEAU))


def breaking_gaps(voltage: float, h_0: float) -> list[tuple[float, float]]:
    """Return the ranges of gaps (m) in which air breaks down under a voltage (V) over gap and insulators.

    Args:
        voltage: over gap and insulators (V).
        h_0: effective insulator thickness (m).
    """
    u = abs(voltage)
    small = min(u / BREAKDOWN_FIELD - h_0, BREAKDOWN_PLATEAU / BREAKDOWN_FIELD)
    found = [(0.0, small)] if small > 0 else []
    if u > BREAKDOWN_PLATEAU:
        large = max(BREAKDOWN_PLATEAU * h_0 / (u - BREAKDOWN_PLATEAU), BREAKDOWN_PLATEAU / BREAKDOWN_FIELD)
        found.append((large, np.inf))
    return found
