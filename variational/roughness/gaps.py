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

**Tables of the package**, in ``data/``, are made by ``python3 -m benchmarks.gap_tables``: self-affine Gaussian surfaces
without roll-off. Between two Hurst exponents, and between the logarithms of two ratios of the longest to the shortest
wave, means are interpolated linearly. Of Persson's theory this changes the air gap by less than 1 % at contacts of up
to a third of the area, half way between two exponents, and by up to 4 % near full contact. Contacts themselves of
exponents and ratios between the tables have a mean attraction within 3 % of it (``tests/test_gaps.py``). A measured
map's table is kept in a folder of the user's, under a hash of heights, size and method; ``FINGERPAD_CACHE`` names
another folder.
"""

import io
import os
import zipfile
import zlib
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from variational import files

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
HURSTS = (0.6, 0.75, 0.9)
"""Hurst exponents of the tables that come with the package; 0.75 is the paper's."""
RATIOS = (8.0, 16.0, 32.0, 64.0)
"""Ratios of the longest to the shortest wave of these tables."""
_WIDE, _NARROW, _WIDEST_RATIO = 4, 2, 32.0  # longest waves in the side of a surface; ratio up to which it is wide
_FIELDS = ("pressure", "area", "weight", "mean", "deviation")
_ROUNDOFF = 1e-6


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


# -- tables of the package -------------------------------------------------------------------------------------
def shipped_file(hurst: float, ratio: float) -> Path:
    """Return the path of the table of an exponent in :data:`HURSTS` and a ratio in :data:`RATIOS`."""
    return Path(__file__).parent / "data" / f"gaps_{hurst:g}_{ratio:g}.npz"


def save(path: Path, table: GapTable) -> None:
    """Write a table, whole or not at all."""
    content = io.BytesIO()
    arrays = {name: getattr(table, name) for name in _FIELDS}
    small = {name: a.astype(np.float32) if a.ndim == 3 else a for name, a in arrays.items()}
    np.savez_compressed(content, **small)  # type: ignore[arg-type]
    path.parent.mkdir(parents=True, exist_ok=True)
    own = path.with_suffix(f".{os.getpid()}")
    own.write_bytes(content.getvalue())
    own.replace(path)


def read(path: Path) -> GapTable:
    """Return a table of a file.

    Raises:
        OSError: the file cannot be opened.
        ValueError: it holds no table.
    """
    content = io.BytesIO(files.read(path))
    try:
        with np.load(content, allow_pickle=False) as found:
            return GapTable(*(found[name].astype(float) for name in _FIELDS))
    except (KeyError, EOFError, ValueError, zipfile.BadZipFile, zlib.error):
        raise ValueError(f"{path.name} holds no table of gaps") from None


@lru_cache(maxsize=len(HURSTS) * len(RATIOS))
def _shipped(hurst: float, ratio: float) -> GapTable:
    return replace(read(shipped_file(hurst, ratio)), waves=waves(ratio))


def waves(ratio: float) -> int:
    """Return the longest waves in the side of each surface of a table of the package, by the ratio of its waves."""
    return _WIDE if ratio <= _WIDEST_RATIO else _NARROW


def ratios(hurst: float) -> list[float]:
    """Return the ratios of the longest to the shortest wave of which there are tables about a Hurst exponent.

    Raises:
        ValueError: there are none of the exponent; in one sentence.
    """
    if not _within(hurst, HURSTS):
        raise ValueError(f"hurst is {hurst:g}; tables of the package are for {HURSTS[0]:g} to {HURSTS[-1]:g}")
    near = [HURSTS[k] for k, _ in _parts(hurst, HURSTS)]
    return [ratio for ratio in RATIOS if all(shipped_file(each, ratio).exists() for each in near)]


def of_spectrum(hurst: float, ratio: float) -> list[tuple[float, GapTable]]:
    """Return the tables of a self-affine spectrum, one to four, and their parts of the whole.

    Args:
        hurst: Hurst exponent.
        ratio: of the longest to the shortest wave.

    Raises:
        ValueError: there is none for the exponent or the ratio; in one sentence.
    """
    known = ratios(hurst)
    if not _within(ratio, known):
        raise ValueError(
            f"the largest wavelength is {ratio:.4g} times the shortest one; tables of the package are for "
            f"{known[0]:g} to {known[-1]:g} times"
        )
    places = _parts(float(np.log(ratio)), [float(np.log(each)) for each in known])
    return [(p * q, _shipped(HURSTS[i], known[k])) for i, p in _parts(hurst, HURSTS) for k, q in places]


def _within(value: float, known: Sequence[float]) -> bool:
    return known[0] * (1 - _ROUNDOFF) <= value <= known[-1] * (1 + _ROUNDOFF)


def _parts(value: float, known: Sequence[float]) -> list[tuple[int, float]]:
    """Return places in increasing numbers, one or two, and the part of each in the value between them."""
    at = float(np.interp(value, known, range(len(known))))
    if abs(at - round(at)) <= _ROUNDOFF:
        return [(round(at), 1.0)]
    return [(int(at), 1 - at % 1), (int(at) + 1, at % 1)]


# -- measured maps ------------------------------------------------------------------------------------------
def cache() -> Path:
    """Return the folder of tables of measured maps."""
    given = os.environ.get("FINGERPAD_CACHE")
    return Path(given) if given else Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "fingerpad"


def of_map(name: str) -> list[tuple[float, GapTable]]:
    """Return the table of a measured map by its name, as :func:`of_spectrum`.

    Raises:
        ValueError: it is not in the cache; in one sentence.
    """
    try:
        return [(1.0, read(map_file(name)))]
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise ValueError(
            f"surface is {name!r}, and {cache()} has no table of that name ({reason}); compute it again by fingerpad "
            "microscale from a scene with roughness.topography, or name another folder by FINGERPAD_CACHE"
        ) from None


def map_file(name: str) -> Path:
    """Return the path of a measured map's table by its name."""
    return cache() / f"gaps_{''.join(c for c in name if c.isalnum())}.npz"


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
