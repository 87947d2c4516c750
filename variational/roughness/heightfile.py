"""Height maps from files: plain matrices by NumPy, instruments' formats by the optional package SurfaceTopography.

SurfaceTopography (Röttger et al. 2022, doi:10.1088/2051-672X/ac860a; MIT licence) knows the formats of Keyence,
Zygo, Bruker and others: ``pip install fingerpad[topography]``.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from variational.roughness.topography import HeightMap

_DELIMITERS = {".txt": None, ".csv": ","}


def read(path: str | Path, size: tuple[float, float] | None = None) -> HeightMap:
    """Return the height map of a file.

    Args:
        path: ``.npy``, ``.txt`` (columns parted by spaces) or ``.csv`` with a matrix of heights in m, x along its
            rows' number; any other name is left to SurfaceTopography, and so are heights, lengths and their units.
        size: lengths (m) along x and y. A plain matrix needs it; another file has its own.

    Raises:
        ValueError: the file is no height map, or ``size`` is missing or one too many.
        ImportError: SurfaceTopography is needed and not installed.
        OSError: the file cannot be opened.
    """
    path = Path(path)
    if path.suffix == ".npy" or path.suffix in _DELIMITERS:
        if size is None:
            raise ValueError(f"{path} holds heights alone; give the lengths along x and y (m) too")
        return _named(path, _matrix(path), size)
    if size is not None:
        raise ValueError(f"{path} has its own size; give none")
    return _instrument(path)


def _named(path: Path, heights: NDArray[np.float64], size: tuple[float, float]) -> HeightMap:
    try:
        return HeightMap(heights, size)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def _matrix(path: Path) -> NDArray[np.float64]:
    try:
        if path.suffix == ".npy":
            return np.asarray(np.load(path, allow_pickle=False), dtype=float)
        return np.loadtxt(path, delimiter=_DELIMITERS[path.suffix], ndmin=2)
    except (ValueError, TypeError) as error:
        raise ValueError(f"{path} is no matrix of numbers: {error}") from None


def _instrument(path: Path) -> HeightMap:
    try:
        from SurfaceTopography import read_topography
        from SurfaceTopography.Exceptions import ReadFileError
    except ImportError:
        raise ImportError(
            f"reading {path} needs SurfaceTopography; get it with: pip install fingerpad[topography]"
        ) from None
    if not path.is_file():
        raise FileNotFoundError(f"{path} is not there")
    try:
        found = read_topography(str(path))
    except ReadFileError:
        raise ValueError(f"{path} is no height map of a format that SurfaceTopography knows") from None
    if found.dim != 2 or found.unit is None:
        raise ValueError(f"{path} has {found.dim} dimensions and unit {found.unit}; a map has 2 and a unit of length")
    found = found.to_unit("m")
    return _named(path, np.ma.filled(found.heights().astype(float), np.nan), found.physical_sizes)
