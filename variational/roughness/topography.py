r"""Height maps of a ridge's surface: what is taken away from them, and missing pixels.

A map of heights h (m) over a rectangle loses its mean, its tilt or its curvature by least squares, that is by
projection off the polynomials of degree 0, 1 or 2 (Forsbach et al. 2023, section 3.1,
doi:10.3389/fmech.2022.1074393). Removing a trend removes roughness too: of 3.1 um rms a map of 100 um x 100 um keeps
2.2 um without its curvature (tests/test_topography.py).

**Missing pixels** are filled so that what is around them goes on smoothly. About the measured heights' mean, tilt and
curvature, by least squares, a missing height is the mean of its neighbours: the discrete Laplace equation, with the
measured heights around as values on its boundary and no slope across the map's own edge. Without the curvature a hole
at an edge of a curved map would be filled flat, a step of which the spectrum makes roughness. The filling is smoother
than the surface: it takes away roughness that is finer than a hole, about in proportion to the missing part of the map.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.linalg import spsolve

Array = NDArray[np.float64]
_Trend = Literal["mean", "tilt", "curvature"]
_DEGREE: dict[_Trend, int] = {"mean": 0, "tilt": 1, "curvature": 2}
MOST = 0.25  # of a map that may be missing
_FLAT = 1e-12  # rms height over the largest height, at which what is left of a map is roundoff


@dataclass(frozen=True, eq=False)
class HeightMap:
    """Heights on a regular grid.

    Raises:
        ValueError: heights that are not a finite matrix of at least 3 x 3, or a size that is not positive.
    """

    heights: Array
    """Heights (m), shape (nx, ny), positive outwards: those of a replica have to be inverted first."""
    size: tuple[float, float]
    """Lengths (m) of the map along x and y; a pixel is size / shape."""

    def __post_init__(self) -> None:
        heights = np.asarray(self.heights, dtype=float)
        if heights.ndim != 2 or min(heights.shape) < 3:
            raise ValueError(f"heights have shape {heights.shape}; a height map is a matrix of at least 3 x 3")
        if missing := int(np.count_nonzero(~np.isfinite(heights))):
            raise ValueError(f"{missing} of {heights.size} heights are missing or infinite; fill them in first")
        if len(self.size) != 2 or not all(0 < length < np.inf for length in self.size):
            raise ValueError(f"the size of a height map is two positive lengths in m, not {self.size}")
        object.__setattr__(self, "heights", heights)
        object.__setattr__(self, "size", (float(self.size[0]), float(self.size[1])))

    @property
    def pixel(self) -> tuple[float, float]:
        """Lengths (m) of a pixel along x and y."""
        (nx, ny), (lx, ly) = self.heights.shape, self.size
        return lx / nx, ly / ny

    @property
    def h_rms(self) -> float:
        """Root mean square height (m) about the mean."""
        return float(self.heights.std())

    def detrended(self, trend: _Trend) -> "HeightMap":
        """Return the map without the polynomials up to the degree that ``trend`` names (0, 1, 2).

        Heights that are such a polynomial leave zeros, and not their roundoff.
        """
        basis = polynomials(self.heights.shape, _DEGREE[trend])
        h = self.heights.ravel()
        left = h - basis @ (basis.T @ h)
        if left.std() <= _FLAT * np.abs(h).max():
            left = np.zeros_like(left)
        return HeightMap(left.reshape(self.heights.shape), self.size)

    def cut(self, corner: tuple[int, int], shape: tuple[int, int]) -> "HeightMap":
        """Return the part of ``shape`` pixels that begins at pixel ``corner``.

        Raises:
            ValueError: that part is not inside the map.
        """
        (i, j), (nx, ny) = corner, shape
        if i < 0 or j < 0 or i + nx > self.heights.shape[0] or j + ny > self.heights.shape[1]:
            raise ValueError(f"{nx} x {ny} pixels from {corner} are not inside a map of {self.heights.shape}")
        return HeightMap(self.heights[i : i + nx, j : j + ny], (nx * self.pixel[0], ny * self.pixel[1]))


def polynomials(shape: tuple[int, ...], degree: int) -> Array:
    """Return the polynomials in x and y up to a total degree as orthonormal columns, one row a pixel of ``shape``."""
    x, y = (np.linspace(-1, 1, n) for n in shape)
    powers = [(i, j) for i in range(degree + 1) for j in range(degree + 1 - i)]
    columns = [np.multiply.outer(x**i, y**j).ravel() for i, j in powers]
    return np.linalg.qr(np.stack(columns, axis=1))[0]


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


def wavevectors(shape: tuple[int, ...], size: tuple[float, float]) -> Array:
    r"""Return \|q\| (1/m) of the modes of a grid, shape (nx, ny) as numpy.fft.fft2 orders them."""
    q_x, q_y = (2 * np.pi * np.fft.fftfreq(n, length / n) for n, length in zip(shape, size, strict=True))
    return np.hypot(q_x[:, None], q_y[None, :])
