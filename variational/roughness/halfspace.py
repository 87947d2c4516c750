r"""Contact of a rough, periodic elastic half-space with a rigid plane, solved exactly on a grid by FFT.

Heights h of the rough surface, contact pressure p >= 0 and gap g >= 0 are fields on a periodic rectangle. The plane is
hard: where p > 0 the surfaces touch, elsewhere nothing presses,

.. math:: g = \delta + u - h \ge 0, \qquad p \ge 0, \qquad p\,g = 0, \qquad
          \hat u(\mathbf q) = \frac{2}{E^* |\mathbf q|} (\hat p(\mathbf q) - \hat a(\mathbf q)), \quad
          \mathbf q \ne 0.

The mean pressure is given, and the approach delta follows from it. An attraction a (Pa) may act on the surface too; it
is zero where attraction does not deform (Derjaguin, Muller and Toporov), and acts across the gaps that are found. The
conditions are those of the least complementary energy over pressures of that mean. They are solved by the conjugate
gradients of Polonsky and Keer (1999, Wear 231, 206, doi:10.1016/S0043-1648(99)00113-1): the mean gap over the contact
is subtracted from the gradient, points that would pull leave the contact, and points that overlap enter it.
"""

import hashlib
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from variational.roughness import gaps
from variational.roughness.closure import Progress
from variational.roughness.gaps import FULL, PRESSURES, Bins, GapTable, bins
from variational.roughness.spectrum import power_spectrum
from variational.roughness.topography import HeightMap, polynomials, wavevectors

Array = NDArray[np.float64]
_TOLERANCE = 1e-6
_ITERATIONS = 5000
FEWEST_PIXELS = 20
"""In contact, below which a contact is not resolved."""
_FEWEST_PRESSURES = 6
_METHOD = "2"  # of a measured map's table; another one makes other files
_SQUARE, _LEVEL = 0.01, 0.05  # differences of pixels' sides; part of the mean square that a tilt may be
_WAVE, _UNRESOLVED = 4.0, 0.5  # pixels of a wave that is resolved; part of the mean square that shorter waves may be


class NoContactError(ValueError):
    """A contact that was not found; one sentence."""


class Contact(NamedTuple):
    """A rough surface on a rigid plane."""

    pressure: Array
    """Contact pressure (Pa), shape (nx, ny)."""
    gap: Array
    """Gap (m), shape (nx, ny); zero in contact."""
    iterations: int

    @property
    def fraction(self) -> float:
        """Part of the area that is in contact."""
        return float(np.mean(self.pressure > 0))


def compliance(shape: tuple[int, ...], size: tuple[float, float], modulus: float) -> Array:
    """Return displacement over pressure of each mode (m/Pa), in the order of ``scipy.fft.rfft2``; zero at q = 0.

    Args:
        shape: pixels along x and y.
        size: lengths (m) along x and y.
        modulus: contact modulus E* (Pa).
    """
    q = wavevectors(shape, size)[:, : shape[1] // 2 + 1]
    return np.divide(2 / modulus, q, out=np.zeros_like(q), where=q > 0)


def displacement(pressure: Array, modes: Array) -> Array:
    """Return the surface's displacement (m), of zero mean, under a pressure (Pa) by :func:`compliance`."""
    return np.asarray(fft.irfft2(modes * fft.rfft2(pressure), s=pressure.shape))


def press(
    surface: HeightMap,
    mean_pressure: float,
    modulus: float,
    start: Array | None = None,
    tolerance: float = _TOLERANCE,
    attraction: Array | None = None,
) -> Contact:
    """Return the contact of a surface under a mean contact pressure.

    Args:
        surface: heights, positive towards the plane, taken as periodic.
        mean_pressure: (Pa), greater than 0.
        modulus: contact modulus E* (Pa).
        start: contact pressure to start at (Pa), shape (nx, ny), of any mean; uniform by default.
        tolerance: largest rms of the gap in contact, and largest overlap beside it, over the rms height.
        attraction: held attraction (Pa), shape (nx, ny), which pulls the surface to the plane; none by default.

    Raises:
        ValueError: a pressure or a modulus that is not positive, or a flat surface; in one sentence.
        NoContactError: the iteration does not converge.
    """
    h, h_rms = surface.heights, surface.h_rms
    for name, value, unit in (("mean pressure", mean_pressure, "Pa"), ("modulus", modulus, "Pa")):
        if not 0 < value < np.inf:
            raise ValueError(f"the {name} of a contact is {value:g} {unit}; it must be finite and greater than 0")
    if h_rms == 0:
        raise ValueError("all heights are the same; there is no roughness to press")
    modes = compliance(h.shape, surface.size, modulus)
    p = np.full(h.shape, mean_pressure) if start is None else start * (mean_pressure / float(start.mean()))
    if attraction is not None:
        h = h + displacement(attraction, modes)
    direction, before, conjugate = np.zeros_like(h), 1.0, False
    for iteration in range(_ITERATIONS):
        contact = p > 0
        gap = displacement(p, modes) - h
        gap -= gap[contact].mean()
        inside = np.where(contact, gap, 0.0)
        square = float(np.vdot(inside, inside))
        if max(np.sqrt(square / np.count_nonzero(contact)), -float(gap.min())) <= tolerance * h_rms:
            return Contact(p, np.where(contact, 0.0, np.maximum(gap, 0.0)), iteration)
        direction = np.where(contact, inside + (square / before * direction if conjugate else 0.0), 0.0)
        before = square
        change = displacement(direction, modes)
        change -= change[contact].mean()
        curvature = float(np.vdot(change, direction))
        # One pixel alone in contact has no direction: others come in by the steepest descent's safe step.
        step = float(np.vdot(inside, direction)) / curvature if curvature > 0 else 1 / float(modes.max())
        p = np.maximum(p - step * direction, 0.0)
        overlap = (p == 0) & (gap < 0)
        conjugate = not overlap.any()
        p[overlap] -= step * gap[overlap]
        p *= mean_pressure / float(p.mean())
    raise NoContactError(
        f"no contact under {mean_pressure:g} Pa was found in {_ITERATIONS} iterations on {h.shape[0]} x {h.shape[1]} "
        "pixels; take a smoother surface or a larger tolerance"
    )


# -- tables of gaps: of surfaces of one spectrum, and of a measured height map ---------------------------------
def over_pressure(surface: HeightMap, wavelength: float, pressures: Sequence[float]) -> Iterable[tuple[float, Bins]]:
    """Yield pressures and gaps of one surface, from the lowest that is resolved up to nearly full contact.

    Args:
        surface: periodic.
        wavelength: lambda_0 in the surface's unit of length.
        pressures: increasing.
    """
    h = surface.heights - surface.heights.mean()
    h_rms, q_0 = float(h.std()), 2 * np.pi / wavelength
    # Heights, lengths and pressures in the units of the table: the modulus is 1 / (q_0 h_rms) h_rms / (1 / q_0) = 1.
    scaled = HeightMap(h / h_rms, (surface.size[0] * q_0, surface.size[1] * q_0))
    start = None
    for pressure in pressures:
        found = press(scaled, float(pressure), 1.0, start)
        start = found.pressure
        yield float(pressure), bins(found.gap, found.pressure > 0)


def gap_table(
    surfaces: Sequence[HeightMap],
    wavelength: float,
    pressures: Sequence[float] = tuple(PRESSURES),
    progress: Progress | None = None,
    copies: int = 1,
) -> GapTable:
    """Return the table of several surfaces of one spectrum.

    Pressures are left out at which less than :data:`FEWEST_PIXELS` pixels of a surface touch, or nearly all do.

    Args:
        surfaces: periodic.
        wavelength: lambda_0, in the surfaces' unit of length.
        pressures: over E* q_0 h_rms, increasing by equal steps of the logarithm.
        progress: called after each contact with the number done and the total.
        copies: how often a surface has each of its pixels, which count once.

    Raises:
        ValueError: no surface, or one without enough pixels in contact.
    """
    if not surfaces:
        raise ValueError("a table of gaps needs at least one surface")
    rows: list[list[Bins]] = []
    for k, surface in enumerate(surfaces):
        rows.append([])
        for j, (_, found) in enumerate(over_pressure(surface, wavelength, pressures)):
            rows[k].append(found)
            if progress is not None:
                progress(k * len(pressures) + j + 1, len(surfaces) * len(pressures))
    area = np.array([[each.area for each in row] for row in rows])
    pixels = np.array([surface.heights.size / copies for surface in surfaces])[:, None]
    kept = np.flatnonzero(((area * pixels >= FEWEST_PIXELS) & (area <= FULL)).all(axis=0))
    if len(kept) < _FEWEST_PRESSURES:
        raise ValueError(
            f"of {len(pressures)} pressures {len(kept)} have {FEWEST_PIXELS} pixels or more in contact and gaps left; "
            "a table needs 6: measure with smaller pixels or over a larger area"
        )
    inside = slice(kept[0], kept[-1] + 1)
    columns = (np.array([[each[n] for each in row] for row in rows])[:, inside] for n in range(1, 4))
    return GapTable(np.asarray(pressures, dtype=float)[inside], area[:, inside], *columns)


def measured_table(measured: HeightMap, progress: Progress | None = None) -> tuple[GapTable, float, float]:
    """Return the table of a measured height map, its h_rms and the wavelength of its pressures' unit (m).

    The map is continued by its mirror images. The wavelength is the map's shorter side: it is a unit alone, and drops
    out of what the table gives.

    Args:
        measured: heights, positive towards the plane, without their tilt or curvature.
        progress: called after each contact with the number done and the total.

    Raises:
        ValueError: a flat map, one with a tilt or with pixels that are not square, or of too few pixels; one sentence.
    """
    _refuse_map(measured)
    wavelength = min(measured.size)
    return gap_table([mirrored(measured)], wavelength, progress=progress, copies=4), measured.h_rms, wavelength


def mirrored(measured: HeightMap) -> HeightMap:
    """Return a map and its mirror images on the twofold length and width, periodic without steps (*assumption*).

    Mirrors and a removed curvature make the air gap too small. Of maps cut out of a Gaussian surface of H = 0.75 with
    eight shortest waves to the largest it is 6 to 13 % too small if they are one largest wave wide, 2 to 5 % if two,
    and 1 to 2 % if four, where 2 to 40 % of the area touch. From one such map to the next it scatters by 12 to 17 %,
    5 to 11 % and 1 to 8 %.
    """
    h = measured.heights
    both = np.concatenate([h, h[::-1]], axis=0)
    return HeightMap(np.concatenate([both, both[:, ::-1]], axis=1), (2 * measured.size[0], 2 * measured.size[1]))


def _refuse_map(measured: HeightMap) -> None:
    """Refuse a height map whose contact would not be that of its roughness.

    Raises:
        ValueError: a flat map, one with a tilt, with pixels that are not square, or with most of its height in waves
            of a few pixels; in one sentence.
    """
    (a, b), h = measured.pixel, measured.heights - measured.heights.mean()
    if not h.any():
        raise ValueError("all heights of the map are the same; there is no roughness to press")
    if abs(a - b) > _SQUARE * max(a, b):
        raise ValueError(
            f"pixels of the map are {a:.4g} m x {b:.4g} m; a contact needs square ones, so resample the map"
        )
    basis = polynomials(h.shape, 1)
    tilt = float(np.sum((basis.T @ h.ravel()) ** 2) / np.sum(h**2))
    if tilt > _LEVEL:
        raise ValueError(
            f"a tilt makes {100 * tilt:.2g} % of the map's mean square height, at most {100 * _LEVEL:g} % is allowed; "
            "remove it first, by detrended('tilt') or detrended('curvature')"
        )
    waves = power_spectrum(measured, window="hann")
    short = float(waves.psd[waves.q > 2 * np.pi / (_WAVE * max(a, b))].sum() / waves.psd.sum())
    if short > _UNRESOLVED:
        raise ValueError(
            f"waves shorter than {_WAVE:g} pixels have {100 * short:.2g} % of the map's mean square height, at most "
            f"{100 * _UNRESOLVED:g} % is allowed: pixels of {max(a, b):.3g} m do not resolve it, or it is noise; "
            "measure with smaller pixels, or filter the map"
        )


def keep(measured: HeightMap, progress: Progress | None = None) -> tuple[str, float, float]:
    """Return the name of a measured map's table, its h_rms and its wavelength (m); the table is computed once.

    Args:
        measured: heights, without tilt or curvature.
        progress: called after each contact with the number done and the total.

    Raises:
        ValueError: as :func:`measured_table`, or a folder that takes no files.
    """
    _refuse_map(measured)
    content = np.ascontiguousarray(measured.heights).tobytes() + repr((measured.size, _METHOD)).encode()
    name = hashlib.sha256(content).hexdigest()[:16]
    try:
        gaps.of_map(name)
    except ValueError:  # none yet, or a damaged one
        with _kept_in():
            tempfile.TemporaryFile(dir=gaps.cache()).close()  # before minutes of contacts
        table = measured_table(measured, progress)[0]
        with _kept_in():
            gaps.save(gaps.map_file(name), table)
    return name, measured.h_rms, min(measured.size)


@contextmanager
def _kept_in() -> Iterator[None]:
    """Name the folder of tables where it takes no files.

    Raises:
        ValueError: it does not; in one sentence.
    """
    try:
        gaps.cache().mkdir(parents=True, exist_ok=True)
        yield
    except OSError as error:
        raise ValueError(
            f"the table of the height map cannot be kept in {gaps.cache()} ({error.strerror or error}); name another "
            "folder by FINGERPAD_CACHE"
        ) from None
