r"""Distribution of the gaps between a rough surface and a plane over pressure: what a closure of a surface needs.

Linear elasticity leaves one number of the load. With heights and gaps in units of h_rms and pressures in units of
:math:`E^* q_0 h_{rms}`, one table of a spectrum's shape serves every modulus, h_rms, wavelength, insulator and voltage.
A table has, for each pressure and realisation, the part A of the area in contact, and the rest sorted by gap: for each
bin of gaps its part w of the area, the mean m and the standard deviation s of its gaps. Two points of equal weight,
m - s and m + s, stand for a bin. They have its first three moments but for skewness, so that means of smooth functions
of the gap are those of the surface to 4e-5 for h_0 from 0.01 to 10 h_rms:

.. math:: \Big\langle \frac1{(h_0 + g)^2} \Big\rangle = \frac{A}{h_0^2}
          + \sum_k \frac{w_k}2 \Big( \frac1{(h_0 + m_k - s_k)^2} + \frac1{(h_0 + m_k + s_k)^2} \Big)

Surfaces of the package's tables have four pixels to the shortest wave. The contact's edge is found to a pixel: beside
four times as many, the area in contact is 11 % larger at a tenth of the unit of pressure, this mean 1 % larger at
h_0 = h_rms / 6, and the mean gap the same (``benchmarks/verification/halfspace.py``).

The equivalent air gap has the attraction of all gaps g, :math:`(h_0 + d_{eq})^{-2} = \langle (h_0 + g)^{-2} \rangle`.

**Breakdown.** Over a gap g the air bears the voltage :math:`U g / (h_0 + g)`. It breaks down above
:math:`V_b = \min(350\,V/\mu m \cdot g,\ 330\,V)`: below a micrometre field emission sets a field, 350 V/um in air
between metals, and deviations from Paschen's law end at four (A. Peschot et al. 2014, "Deviations from the Paschen's
law at short gap distances from 100 nm to 10 µm in air and nitrogen", read in its abstract). Between the two the voltage
is nearly constant, 330 to 350 V; the lower end is taken. *Assumption* for skin. The constant stays above four
micrometres too; it is too low for gaps above some ten, where Paschen's law holds.
"""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
PRESSURES: Array = np.asarray(np.geomspace(1e-3, 2.0, 28), dtype=np.float64)
"""Mean contact pressures of a table over E* q_0 h_rms; equal steps of the logarithm."""
EDGES: Array = np.concatenate([[0.0], np.geomspace(1e-3, 16.0, 52)])
"""Edges of the bins of gaps over h_rms; larger gaps are in the last bin."""
FULL = 0.99
"""Part of the area in contact, from which hardly a gap is left."""
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


class Bins(NamedTuple):
    """Gaps of one contact."""

    area: float
    """Part of the area in contact."""
    weight: Array
    """Part of the area of each bin, shape (bins,)."""
    mean: Array
    """Mean gap of each bin."""
    deviation: Array
    """Standard deviation of the gaps of each bin."""


@dataclass(frozen=True, eq=False)
class GapTable:
    """Gaps over pressure; in units of h_rms and E* q_0 h_rms."""

    pressure: Array
    """Mean contact pressures, increasing by equal steps of the logarithm; shape (pressures,)."""
    area: Array
    """Part of the area in contact, shape (realisations, pressures)."""
    weight: Array
    """Parts of the area by gap, shape (realisations, pressures, bins)."""
    mean: Array
    """Mean gap of each bin, of the same shape."""
    deviation: Array
    """Standard deviation of the gaps of each bin, of the same shape."""
    waves: float = field(default=4.0, kw_only=True)
    """Longest waves in the side of a realisation, whose number of patches decides its scatter."""

    def mean_gap(self) -> Array:
        """Return the mean gap, shape (realisations, pressures)."""
        return np.asarray((self.weight * self.mean).sum(axis=-1))

    def inverse_square(self, h_0: float, touching: bool) -> Array:
        """Return <(h_0 + g)^-2>, shape (realisations, pressures).

        Args:
            h_0: over h_rms.
            touching: whether the area in contact counts, with a gap of zero.
        """
        points = 1 / (h_0 + self.mean - self.deviation) ** 2 + 1 / (h_0 + self.mean + self.deviation) ** 2
        found = (self.weight * points).sum(axis=-1) / 2
        return np.asarray(found + self.area / h_0**2 if touching else found)

    def closer(self, gap: float) -> Array:
        """Return the part of the area out of contact with a gap below ``gap``, shape (realisations, pressures).

        Inside a bin gaps are taken as evenly spread over three deviations about the mean.
        """
        width = np.sqrt(3) * self.deviation
        low = self.mean - width
        part = np.divide(gap - low, 2 * width, out=(gap > self.mean).astype(float), where=width > 0)
        return np.asarray((self.weight * np.clip(part, 0, 1)).sum(axis=-1))


def bins(gap: Array, contact: NDArray[np.bool_]) -> Bins:
    """Return the gaps of a contact, in units of h_rms, by bin.

    Args:
        gap: of each pixel.
        contact: whether a pixel is in contact.
    """
    outside = gap[~contact]
    where = np.clip(np.searchsorted(EDGES, outside, side="right") - 1, 0, len(EDGES) - 1)
    count, first, second = (np.bincount(where, weights=outside**k, minlength=len(EDGES)) for k in range(3))
    some = np.maximum(count, 1)
    mean = first / some
    return Bins(
        float(np.mean(contact)), count / gap.size, mean, np.sqrt(np.maximum(second / some - mean**2, 0.0))
    )  # fmt: skip


# -- breakdown --------------------------------------------------------------------------------------------------
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
