"""Height maps from files: matrices by NumPy, text in any layout, instruments' formats by SurfaceTopography.

SurfaceTopography (Röttger et al. 2022, doi:10.1088/2051-672X/ac860a; MIT licence) reads the formats of Keyence,
Zygo, Bruker and others: ``pip install fingerpad[topography]``.
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from variational.roughness import heighttext
from variational.roughness.missing import filled
from variational.roughness.topography import HeightMap

UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "μm": 1e-6, "micron": 1e-6, "nm": 1e-9, "pm": 1e-12}
_TEXT = (".txt", ".csv", ".tsv", ".dat", ".asc", ".xyz", ".prn")


class Found(NamedTuple):
    """What a file holds."""

    map: HeightMap
    """Missing pixels are filled."""
    missing: int
    """Number of pixels that were missing."""
    layout: str
    """How the file is laid out, in words."""


def read(path: str | Path, size: tuple[float, float] | None = None) -> HeightMap:
    """Return the height map of a file in m; arguments and errors as of :func:`scan`."""
    return scan(path, size).map


def scan(
    path: str | Path,
    size: tuple[float, float] | None = None,
    unit: str | None = None,
    size_unit: str | None = None,
    missing: str | None = None,
    pixel: tuple[float, float] | None = None,
) -> Found:
    """Return the height map of a file, and what was found in it.

    Args:
        path: ``.npy`` or text (``.txt``, ``.csv``, ``.tsv``, ``.dat``, ``.asc``, ``.xyz``, ``.prn``, see
            :mod:`variational.roughness.heighttext`) with a matrix of heights, x along its rows' number, or with points
            x, y, z; any other name is left to SurfaceTopography, and so are heights, lengths and their units.
        size: lengths along x and y. A matrix needs them, or those of a pixel; another file has its own.
        unit: of heights, of :data:`UNITS`; m if None.
        size_unit: of lengths along x and y; that of the heights if None.
        missing: how a text marks a missing pixel, beside the usual ways.
        pixel: lengths of a pixel along x and y, in place of ``size``.

    Raises:
        ValueError: the file is no height map, ``size`` is missing or one too many, or a unit is not known.
        ImportError: SurfaceTopography is needed and not installed.
        OSError: the file cannot be opened.
    """
    path = Path(path)
    if not is_plain(path):
        if size is not None or pixel is not None:
            raise ValueError(f"{path} has its own size; give none")
        if unit is not None or size_unit is not None:
            raise ValueError(f"{path} has its own units; give none")
        return _instrument(path)
    height_factor = _factor(unit or "m")
    factor = _factor(size_unit or unit or "m")
    found = _array(path) if path.suffix.lower() == ".npy" else _text(path, missing)
    if pixel is not None and size is not None:
        raise ValueError(f"{path}: size and pixel are given; give one of the two")
    if pixel is not None and found.heights.ndim == 2:
        size = (pixel[0] * found.heights.shape[0], pixel[1] * found.heights.shape[1])
    if found.size is None and size is None:
        raise ValueError(f"{path} holds heights alone; give the lengths along x and y too")
    if found.size is not None and size is not None:
        raise ValueError(f"{path} has its own size, by its points; give none")
    lengths = found.size or size or (0.0, 0.0)
    return _named(path, found.heights * height_factor, (lengths[0] * factor, lengths[1] * factor), found.layout)


def is_plain(path: Path) -> bool:
    """Return whether a file holds plain numbers, by its name: text or NumPy's, which have no units."""
    return path.suffix.lower() in (".npy", *_TEXT)


def _factor(unit: str) -> float:
    if unit not in UNITS:
        raise ValueError(f"{unit[:20]!r} is no unit of length; it must be one of {', '.join(UNITS)}")
    return UNITS[unit]


def _named(path: Path, heights: NDArray[np.float64], size: tuple[float, float], layout: str) -> Found:
    try:
        missing = int(np.count_nonzero(~np.isfinite(heights)))
        return Found(HeightMap(filled(heights) if heights.ndim == 2 else heights, size), missing, layout)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def _array(path: Path) -> heighttext.Text:
    try:
        heights = np.asarray(np.load(path, allow_pickle=False), dtype=float)
    except (ValueError, TypeError, EOFError) as error:
        raise ValueError(f"{path} is no matrix of numbers: {error}") from None
    return heighttext.Text(heights, None, f"matrix of {' x '.join(map(str, heights.shape))} pixels by NumPy")


def _text(path: Path, missing: str | None) -> heighttext.Text:
    raw = path.read_bytes()
    try:
        text = raw.decode("utf-16" if raw[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig")
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    try:
        return heighttext.parse(text, missing)
    except ValueError as error:
        raise ValueError(f"{path} is {error}" if str(error).startswith("no ") else f"{path}: {error}") from None


def _instrument(path: Path) -> Found:
    try:
        from SurfaceTopography import read_topography
        from SurfaceTopography.Exceptions import ReadFileError
    except ImportError:
        raise ImportError(
            f"reading {path} needs SurfaceTopography; get it with: pip install fingerpad[topography], or in a clone "
            "environment/wheels"
        ) from None
    if not path.is_file():
        raise FileNotFoundError(f"{path} is not there")
    try:
        found = read_topography(str(path))
    except ReadFileError:
        raise ValueError(f"{path} is no height map of a format that SurfaceTopography reads") from None
    if found.dim != 2 or found.unit is None:
        raise ValueError(f"{path} has {found.dim} dimensions and unit {found.unit}; a map has 2 and a unit of length")
    found = found.to_unit("m")
    heights = np.ma.filled(found.heights().astype(float), np.nan)
    return _named(path, heights, found.physical_sizes, f"map of {' x '.join(map(str, heights.shape))} pixels")
