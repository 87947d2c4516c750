"""Height maps from files: NumPy's, a plain matrix of numbers, and all that SurfaceTopography reads, in its own units.

SurfaceTopography (Röttger et al. 2022, doi:10.1088/2051-672X/ac860a; MIT licence) reads the formats of Keyence,
Zygo, Bruker and others, and text with a header: ``pip install fingerpad[topography]``.

A plain matrix is a text of four or more columns of numbers and nothing else, separated by commas, semicolons, tabs or
spaces, with decimal points; a pixel is missing where the place is empty or holds ``nan``. It has no unit and no size,
so that both must be given, as for NumPy's files.

Values that are no heights are refused. A mark of missing pixels, as -9999, is an extreme height from which the next
one, and the others' quartiles, are more than 20 interquartile ranges away; a groove, however deep, is measured at many
depths. A line or column of something else, or a step where parts are stitched, differs from its neighbour by more than
three times (rms) what the next ones do; of self-affine surfaces of 16 lines the most is 2.5 times.
"""

import io
import re
from contextlib import redirect_stderr
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from variational import files
from variational.roughness.topography import HeightMap, filled

Array = NDArray[np.float64]
_UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "μm": 1e-6, "nm": 1e-9, "pm": 1e-12}
"""Units of length in m."""
_HIGHEST, _WIDEST = 1.0, 0.1  # m: heights that can be roughness, and a map of five fingertips
_POINTS = 3  # columns of a text of points x, y, z
_STEP, _LINES, _FAR = 3.0, 16, 20.0  # times, least lines for a judgement, interquartile ranges
# What separates numbers in SurfaceTopography's formats of text, whose readers skip lines that they do not understand.
_TEXTS = {"asc": r"\s+", "xyz": r"[\s,;]+"}
_NO_NUMBERS = {"bad", "infinite"}  # words that these readers take for missing pixels


class Found(NamedTuple):
    """What a file holds."""

    map: HeightMap
    """Missing pixels are filled."""
    missing: int
    """Number of pixels that were missing."""
    layout: str
    """Format and pixels, in words."""


class _Read(NamedTuple):
    """Content of a file as it is."""

    heights: Array
    """Shape (nx, ny), NaN where a pixel is missing; in m if the file has a unit."""
    layout: str
    has_unit: bool = False
    size: tuple[float, float] | None = None
    """Lengths (m) along x and y; None if the file has none, or no unit."""


def scan(
    file: str | Path,
    unit: str | None = None,
    size: tuple[float, float] | None = None,
    pixel: tuple[float, float] | None = None,
    missing: str | None = None,
) -> Found:
    """Return the height map of a file, and what was found in it.

    Args:
        file: path of the file.
        unit: of the heights, a key of :data:`_UNITS`, for a file that has no unit of its own.
        size: lengths (m) along x, from the first line of a plain matrix to its last, and y, along a line; for a file
            that has no size of its own.
        pixel: lengths (m) of a pixel along x and y, in place of ``size``.
        missing: number that marks missing pixels, besides empty places and ``nan``. Where it is given a value far from
            all others is taken as measured, and with ``"nan"`` every line too.

    Raises:
        ValueError: the file is no height map, holds values that are none, or has what is given too. Keys to give or to
            change are in quotation marks in the message: 'unit', 'size', 'pixel', 'missing'.
        ImportError: SurfaceTopography is needed and not installed.
        OSError: the file cannot be opened.
    """
    path = Path(file)
    if missing is not None and not files.is_number(missing):
        raise ValueError(f"'missing' is {missing[:30]!r}; it must be a number")
    found = _read(path)
    heights, (nx, ny) = found.heights, found.heights.shape
    if missing is None:
        _refuse_mark(path, heights)
    else:
        heights[heights == float(missing)] = np.nan
    if found.has_unit and unit is not None:
        raise ValueError(f"{path} has a unit of its own; give no 'unit'")
    if not found.has_unit and unit is None:
        raise ValueError(f"{path} holds numbers without a unit; give 'unit', such as um")
    if [found.size, size, pixel].count(None) != 2:
        what = "has a size of its own; give none" if found.size else "has no size; give 'size' or 'pixel', one of them"
        raise ValueError(f"{path} {what}")
    if size is not None and not _square(size, (nx, ny)) and _square(size, (ny, nx)):
        raise ValueError(
            f"{path} has {nx} x {ny} pixels, which are not square where 'size' is {size[0]:g} m x {size[1]:g} m; "
            "exchange the lengths, or give 'pixel'"
        )
    x, y = found.size or size or (pixel[0] * nx, pixel[1] * ny)  # type: ignore[index]
    if max(x, y) > _WIDEST:
        raise ValueError(f"{path} is {x:.3g} m x {y:.3g} m large, at most {_WIDEST:g} m is allowed; check the unit")
    heights = heights * (_UNITS[unit] if unit else 1.0)
    known = heights[np.isfinite(heights)]
    if known.size and (over := float(np.ptp(known))) > _HIGHEST:
        raise ValueError(f"{path} has heights over {over:.3g} m, at most {_HIGHEST:g} m is allowed; check their unit")
    try:
        whole = HeightMap(filled(heights), (x, y))
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    if missing != "nan":
        _refuse_uneven(path, whole.heights)
    return Found(whole, heights.size - known.size, found.layout)


def _square(size: tuple[float, float], shape: tuple[int, int]) -> bool:
    return 0.98 < size[0] / shape[0] * shape[1] / size[1] < 1.02


# -- reading -----------------------------------------------------------------------------------------------
def _read(path: Path) -> _Read:
    """Return what is in a file, a matrix of 3 x 3 pixels or more, missing ones as NaN."""
    content = files.read(path)
    text, why = files.text(content), "it is no text"
    matrix = _array(path, content) if path.suffix.lower() == ".npy" else None
    if matrix is None and text is not None:
        if not text.strip():
            raise ValueError(f"{path} holds no heights")
        matrix, why = _matrix(text)
    if matrix is not None:
        found = _Read(matrix, f"matrix of {' x '.join(map(str, matrix.shape))} pixels")
    else:
        found = _foreign(path, content, text, why)
    shape = found.heights.shape
    if len(shape) != 2 or min(shape) < 3:
        raise ValueError(f"{path}: heights have shape {shape}; a height map is a matrix of at least 3 x 3")
    return found


def _array(path: Path, content: bytes) -> Array:
    try:
        found = np.lib.format.read_array(io.BytesIO(content), allow_pickle=False)
    except Exception as error:  # a header that is no Python, an array that is larger than the memory
        raise ValueError(f"{path} is no matrix of numbers: {_words(error)}") from error
    if found.dtype.kind not in "iuf":
        raise ValueError(f"{path} is no matrix of numbers: its values are of type {found.dtype}, and heights are real")
    return found.astype(float)


def _matrix(text: str) -> tuple[Array | None, str]:
    """Return a plain matrix of numbers, or None and why it is none."""
    lines = [line.strip(" ") for line in text.splitlines() if line.strip()]
    separator = next((each for each in (";", "\t", ",") if each in lines[0]), None)
    if separator is not None and all(line.endswith(separator) for line in lines):
        lines = [line[:-1] for line in lines]
    rows = [[word.strip(' \t"') for word in line.split(separator)] for line in lines]
    for k, words in enumerate(rows, start=1):
        if unknown := [word for word in words if word and not files.is_number(word)]:
            return None, f"line {k} has {unknown[0][:30]!r}"
        if len(words) != len(rows[0]):
            return None, f"line {k} has {len(words)} numbers and the first one {len(rows[0])}"
    if len(rows[0]) <= _POINTS:
        return None, f"it has {len(rows[0])} columns"
    return np.array([[float(word or "nan") for word in words] for words in rows]), ""


def _foreign(path: Path, content: bytes, text: str | None, why: str) -> _Read:
    """Return what SurfaceTopography finds: the first map of heights; ``why`` the file is no plain matrix."""
    try:
        from SurfaceTopography import open_topography
        from SurfaceTopography.Exceptions import CannotDetectFileFormat, ReadFileError
    except ImportError:
        raise ImportError(
            f"{path} is no plain matrix of numbers ({why}), and other files need SurfaceTopography; get it with: pip "
            "install fingerpad[topography], or in a clone environment/wheels"
        ) from None
    form, content = "a map", content if text is None else text.encode()
    try:
        with files.alone(content, f"map{path.suffix}") as copy, redirect_stderr(io.StringIO()):  # what they warn of
            reader = open_topography(str(copy))
            form = reader.name()
            channel = next((each for each in reader.height_channels if each.dim == 2), None)
            if channel is None:
                raise ReadFileError("it holds no map of heights")
            has_size = channel.physical_sizes is not None
            found = channel.topography(**({} if has_size else {"physical_sizes": (1.0, 1.0)}))
    except CannotDetectFileFormat:
        raise ValueError(
            f"{path} has no format that SurfaceTopography reads, and is no plain matrix of numbers with decimal points "
            f"({why}); save the heights alone, without names and numbers of lines and columns"
        ) from None
    except Exception as error:  # of a damaged file, or one of another kind, its readers raise anything
        words = _words(error) if isinstance(error, ReadFileError) else f"{type(error).__name__}: {_words(error)}"
        raise ValueError(
            f"{path} cannot be read by SurfaceTopography as {form} ({words}); export the heights as a plain matrix"
        ) from error
    has_unit = found.unit is not None
    found = found.to_unit("m") if has_unit else found
    if text is not None and reader.format() in _TEXTS:
        _refuse_unread(path, text, _TEXTS[reader.format()], has_unit)
    heights = np.ma.filled(found.heights().astype(float), np.nan)
    layout = f"{form}, channel {_words(channel.name)}, {' x '.join(map(str, heights.shape))} pixels"
    x, y = found.physical_sizes
    return _Read(heights, layout, has_unit, (float(x), float(y)) if has_size and has_unit else None)


def _words(error: object) -> str:
    """Return what a library says, on one line."""
    return "".join(filter(str.isprintable, " ".join(str(error).split())))[:120]


# -- values that are no heights ------------------------------------------------------------------------------
def _refuse_unread(path: Path, text: str, separator: str, has_unit: bool) -> None:
    """Refuse lines that SurfaceTopography has skipped in a text: words, or a head without a unit that it knows."""
    begun = False
    for k, line in enumerate(filter(str.strip, text.splitlines()), start=1):
        words = re.split(separator, line.strip())
        numbers = all(files.is_number(word) or word.lower() in _NO_NUMBERS for word in words)
        if not numbers and not (begun and line.startswith("#")) and (begun or not has_unit):
            where = "among its numbers" if begun else "and no unit of heights that SurfaceTopography knows"
            raise ValueError(f"{path} has {line.strip()[:40]!r} in line {k} {where}; save the heights alone")
        begun = begun or numbers


def _refuse_mark(path: Path, heights: Array) -> None:
    """Refuse a value far from all other heights, of which the spectrum would make roughness."""
    known = heights[np.isfinite(heights)]
    others = known[(known > known.min()) & (known < known.max())] if known.size else known
    if not others.size:
        return
    lower, upper = np.percentile(others, [25, 75])
    gaps = {known.min(): others.min() - known.min(), known.max(): known.max() - others.max()}
    value = max(gaps, key=lambda height: gaps[height])
    if gaps[value] > _FAR * ((upper - lower) or np.ptp(others)) > 0:
        text = repr(float(value)).removesuffix(".0")
        raise ValueError(
            f"{path} has {text} at {np.count_nonzero(heights == value)} pixels, far from all other heights, as a mark "
            f"of missing pixels; give 'missing'=\"{text}\", or 'missing'=\"nan\" if it was measured"
        )


def _refuse_uneven(path: Path, heights: Array) -> None:
    """Refuse a line or column of heights (m) that differs from its neighbours as no other does."""
    found = []
    for lines, line in ((heights, "line"), (heights.T, "column")):
        rms = np.sqrt((np.diff(lines, axis=0) ** 2).mean(axis=1))
        beside = np.pad(rms, 1)
        over = rms - _STEP * np.maximum(beside[:-2], beside[2:])
        k = int(over.argmax())
        if len(lines) >= _LINES and over[k] > 0:
            end = "last" if k else "first"
            at_end = k in (0, len(rms) - 1)
            cause = f"the {end} {line} seems to hold no heights" if at_end else "two parts seem to be stitched there"
            what = f"a step of {rms[k]:.2g} m (rms) from {line} {k + 1} to {k + 2}"
            found.append((over[k], f"{what}, where others are {np.median(rms):.2g} m: {cause}"))
    if found:
        raise ValueError(f"{path} has {max(found)[1]}; give the rest alone, or 'missing'=\"nan\" if it was measured")
