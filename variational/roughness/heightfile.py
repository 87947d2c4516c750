"""Height maps from files: matrices by NumPy, text in any layout, instruments' formats by SurfaceTopography.

SurfaceTopography (Röttger et al. 2022, doi:10.1088/2051-672X/ac860a; MIT licence) reads the formats of Keyence,
Zygo, Bruker and others: ``pip install fingerpad[topography]``.
"""

import io
from contextlib import redirect_stderr
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from variational import files
from variational.roughness import heighttext, unfilled
from variational.roughness.heightheader import UNITS
from variational.roughness.missing import filled
from variational.roughness.topography import HeightMap

_HIGHEST = 1.0  # m, of what can be roughness
_WIDEST = 0.1  # m, of a map of skin: five fingertips
_TEXT = (".txt", ".csv", ".tsv", ".dat", ".asc", ".xyz", ".prn")


class NoUnit(ValueError):  # noqa: N818
    """A file of numbers that has no unit of heights, where none is given."""


class Found(NamedTuple):
    """What a file holds."""

    map: HeightMap
    """Missing pixels are filled."""
    missing: int
    """Number of pixels that were missing."""
    layout: str
    """How the file is laid out, in words."""


class _Read(NamedTuple):
    """Content of a file as it is."""

    heights: NDArray[np.float64]
    """Shape (nx, ny), NaN where a pixel is missing."""
    size: tuple[float, float] | None
    """Lengths along x and y; None if the file has none."""
    unit: str | None
    """Of all of these, of :data:`UNITS`; None if the file has none."""
    layout: str
    units: dict[str, str]
    """Units of x, y and z, of :data:`UNITS`, where the header of a text gives them."""


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
            :mod:`variational.roughness.heighttext`) with a matrix of heights, of which each line has one x, or with
            points x, y, z; any other name is left to SurfaceTopography, which mostly finds lengths and units too.
        size: lengths along x, from the first line of a matrix to its last, and y, along a line. A matrix needs them,
            or those of a pixel; most other files have their own.
        unit: of heights, a key of :data:`variational.roughness.heightheader.UNITS`; if None that of the file.
        size_unit: of lengths along x and y; if None that of a header, or of the heights.
        missing: how a text marks a missing pixel, beside the usual ways; in ``.npy`` a number. Where it is given, a
            value far from all others is taken as measured.
        pixel: lengths of a pixel along x and y, in place of ``size``.

    Raises:
        NoUnit: heights without a unit, a ValueError.
        ValueError: the file is no height map; ``size``, ``unit`` or ``missing`` is missing or one too many; a value
            seems to mark missing pixels; the lengths along x and y seem to be exchanged; a unit is not known, or is
            another one than in the header.
        ImportError: SurfaceTopography is needed and not installed.
        OSError: the file cannot be opened.
    """
    path = Path(path)
    found = _read(path, missing)
    if not found.heights.size:
        raise ValueError(f"{path} holds no heights")
    if missing is None and is_plain(path):
        _refuse_unfilled(path, found.heights)
    if found.unit is not None and (unit is not None or size_unit is not None):
        raise ValueError(f"{path} has its own units; give none")
    if found.unit is None and unit is None and not is_plain(path):
        raise ValueError(f"{path} has no unit of its own; give that of the heights")
    own_unit = found.unit or unit or found.units.get("z")
    if own_unit is None:
        raise NoUnit(f"{path} holds numbers without a unit; give that of the heights")
    if found.size is not None and (size is not None or pixel is not None):
        raise ValueError(f"{path} has its own size; give none")
    if found.size is None and size is None and pixel is None:
        raise ValueError(f"{path} holds heights alone; give the lengths along x and y too")
    if pixel is not None and size is not None:
        raise ValueError(f"{path}: size and pixel are given; give one of the two")
    shape = found.heights.shape
    if size is not None and len(shape) == 2:
        _refuse_exchanged(path, shape, size)
    if pixel is not None and len(shape) == 2:
        size = (pixel[0] * shape[0], pixel[1] * shape[1])
    for axis, own in found.units.items():
        name, given = ("unit", unit) if axis == "z" else ("size_unit", size_unit)
        if given is not None and _factor(given) != _factor(own):
            raise ValueError(f"{path} has {axis} in {own} by its header, and {name} is {given}; give the header's unit")
    heights = found.heights * _factor(own_unit)
    lengths, general = found.size or size or (0.0, 0.0), found.unit or size_unit or own_unit
    x, y = (length * _factor(found.units.get(axis, general)) for axis, length in zip("xy", lengths, strict=True))
    return _named(path, heights, (x, y), found.layout)


def _refuse_unfilled(path: Path, heights: NDArray[np.float64]) -> None:
    """Refuse a value far from all other heights, of which the spectrum would make roughness.

    Raises:
        ValueError: there is one.
    """
    value = unfilled.mark(heights)
    if value is not None:
        count, text = int(np.count_nonzero(heights == value)), repr(value).removesuffix(".0")
        pixels = "1 pixel" if count == 1 else f"{count} pixels"
        raise ValueError(
            f"{path} has {text} at {pixels}, far from all other heights, as a mark of missing pixels; give "
            f'missing="{text}", or missing="nan" if it was measured'
        )


def _refuse_exchanged(path: Path, shape: tuple[int, ...], size: tuple[float, float]) -> None:
    """Refuse lengths of the two sides that are exchanged, by which square pixels become long ones.

    Raises:
        ValueError: they seem to be.
    """
    (nx, ny), (x, y) = shape, size
    if not 0.98 < x * ny / (y * nx) < 1.02 and 0.99 < x * nx / (y * ny) < 1.01:
        raise ValueError(
            f"{path} has {nx} lines of {ny} heights, and x, along which there are {nx}, is {x:g} long and y {y:g}, so "
            "that the pixels are not square; exchange the two lengths, or give those of a pixel"
        )


def is_plain(path: Path) -> bool:
    """Return whether a file holds plain numbers, by its name: text or NumPy's, which have no units."""
    return path.suffix.lower() in (".npy", *_TEXT)


def _factor(unit: str) -> float:
    if unit not in UNITS:
        raise ValueError(f"{unit[:20]!r} is no unit of length; it must be one of {', '.join(UNITS)}")
    return UNITS[unit]


def _named(path: Path, heights: NDArray[np.float64], size: tuple[float, float], layout: str) -> Found:
    known = heights[np.isfinite(heights)]
    over = float(np.ptp(known)) if known.size else 0.0
    if over > _HIGHEST:
        raise ValueError(f"{path} has heights over {over:.3g} m, at most {_HIGHEST:g} m is allowed; check their unit")
    try:
        missing = int(np.count_nonzero(~np.isfinite(heights)))
        found = HeightMap(filled(heights) if heights.ndim == 2 else heights, size)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    if max(size) > _WIDEST:
        wide = f"{size[0]:.3g} m x {size[1]:.3g} m"
        raise ValueError(f"{path} is {wide} large, at most {_WIDEST:g} m is allowed; check the unit of its lengths")
    return Found(found, missing, layout)


def _read(path: Path, missing: str | None) -> _Read:
    """Return what is in a file, missing pixels as NaN."""
    if not is_plain(path):
        if missing is not None:
            raise ValueError(f"{path} has its own mark of missing pixels; give none")
        return _instrument(path)
    if path.suffix.lower() == ".npy":
        return _array(path, missing)
    text = _text(path, missing)
    return _Read(text.heights, text.size, None, text.layout, text.units)


def _array(path: Path, missing: str | None) -> _Read:
    content = io.BytesIO(files.read(path))
    try:
        found = np.lib.format.read_array(content, allow_pickle=False)
    except Exception as error:  # a header that is no Python, an array that is larger than the memory
        raise ValueError(f"{path} is no matrix of numbers: {_words(error)}") from error
    if found.dtype.kind not in "iuf":
        raise ValueError(f"{path} is no matrix of numbers: its values are of type {found.dtype}, and heights are real")
    heights = found.astype(float)
    if missing is not None:
        if not heighttext.is_number(missing) and missing.lower() != "nan":
            raise ValueError(f"missing is {missing[:30]!r}; {path} has numbers alone, so it must be one")
        heights[heights == float(missing)] = np.nan
    return _Read(heights, None, None, f"matrix of {' x '.join(map(str, heights.shape))} pixels by NumPy", {})


def _text(path: Path, missing: str | None) -> heighttext.Text:
    raw = files.read(path)
    try:
        text = raw.decode("utf-16" if raw[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig")
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    try:
        return heighttext.parse(text, missing)
    except ValueError as error:
        raise ValueError(f"{path} is {error}" if str(error).startswith("no ") else f"{path}: {error}") from None


def _instrument(path: Path) -> _Read:
    content = files.read(path)
    try:
        from SurfaceTopography import open_topography
        from SurfaceTopography.Exceptions import CannotDetectFileFormat, ReadFileError
    except ImportError:
        raise ImportError(
            f"reading {path} needs SurfaceTopography; get it with: pip install fingerpad[topography], or in a clone "
            "environment/wheels"
        ) from None
    form = "a map"
    try:
        with files.alone(content, f"map{path.suffix}") as copy, redirect_stderr(io.StringIO()):  # what they warn of
            reader = open_topography(str(copy))
            form = reader.name()
            if not reader.channels or reader.default_channel.dim != 2:
                raise ReadFileError("it holds no map of heights")
            return _map(reader)
    except CannotDetectFileFormat:
        raise ValueError(f"{path} is no height map of a format that SurfaceTopography reads") from None
    except Exception as error:  # of a damaged file, or one of another kind, its readers raise anything
        words = _words(error) if isinstance(error, ReadFileError) else f"{type(error).__name__}: {_words(error)}"
        raise ValueError(
            f"{path} cannot be read by SurfaceTopography as {form} ({words}); export the heights as text"
        ) from error


def _words(error: Exception) -> str:
    """Return what an error of a library has to say, on one line."""
    return "".join(filter(str.isprintable, " ".join(str(error).split())))[:120]


def _map(reader: Any) -> _Read:
    """Return the default channel of a reader of SurfaceTopography."""
    own = reader.default_channel.physical_sizes is not None
    found = reader.topography(**({} if own else {"physical_sizes": (1.0, 1.0)}))
    if found.unit is not None:
        found = found.to_unit("m")
    heights = np.ma.filled(found.heights().astype(float), np.nan)
    size = (float(found.physical_sizes[0]), float(found.physical_sizes[1])) if own else None
    layout = f"map of {' x '.join(map(str, heights.shape))} pixels"
    return _Read(heights, size, None if found.unit is None else "m", layout, {})
