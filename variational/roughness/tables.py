"""Tables of gaps: those that come with the package, by Hurst exponent and ratio of waves, and those of measured maps.

The files in ``data/`` are made by ``python3 -m benchmarks.gap_tables``: self-affine Gaussian surfaces without roll-off.
Between two Hurst exponents, and between the logarithms of two ratios of the longest to the shortest wave, means are
interpolated linearly. Of Persson's theory this changes the air gap by less than 1 % at contacts of up to a third of the
area, half way between two exponents, and by up to 4 % near full contact. Contacts themselves of exponents and ratios
between the tables have a mean attraction within 3 % of it (``tests/test_gaps.py``). A measured map's table is kept in a
folder of the user's, under a hash of heights, size and method; ``FINGERPAD_CACHE`` names another folder.
"""

import hashlib
import io
import os
import tempfile
import zipfile
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from variational import files
from variational.roughness.closure import Progress
from variational.roughness.gaps import GapTable

if TYPE_CHECKING:
    from variational.roughness.topography import HeightMap

HURSTS = (0.6, 0.75, 0.9)
"""Hurst exponents of the tables that come with the package; 0.75 is the paper's."""
RATIOS = (8.0, 16.0, 32.0, 64.0)
"""Ratios of the longest to the shortest wave of these tables."""
_WIDE, _NARROW, _MOST = 4, 2, 32.0  # longest waves in the side of a surface, and the ratio up to which it is wide
_FIELDS = ("pressure", "area", "weight", "mean", "deviation")
_METHOD = "2"  # of a measured map's table; another one makes other files
_SHOWN = 16  # digits of a hash
_ROUNDOFF = 1e-6


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
    return _WIDE if ratio <= _MOST else _NARROW


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


def keep(measured: "HeightMap", progress: Progress | None = None) -> tuple[str, float, float]:
    """Return the name of a measured map's table, its h_rms and its wavelength (m); the table is computed once.

    Args:
        measured: heights, without tilt or curvature.
        progress: is told of each contact of a table that is computed.

    Raises:
        ValueError: as :func:`variational.roughness.contacts.measured_table`, or a folder that takes no files.
    """
    from variational.roughness.contacts import measured_table, refuse_map

    refuse_map(measured)
    content = np.ascontiguousarray(measured.heights).tobytes() + repr((measured.size, _METHOD)).encode()
    name = hashlib.sha256(content).hexdigest()[:_SHOWN]
    try:
        of_map(name)
    except ValueError:  # none yet, or a damaged one
        with _kept_in():
            tempfile.TemporaryFile(dir=cache()).close()  # before minutes of contacts
        table = measured_table(measured, progress)[0]
        with _kept_in():
            save(_file(name), table)
    return name, measured.h_rms, min(measured.size)


@contextmanager
def _kept_in() -> Iterator[None]:
    """Name the folder of tables where it takes no files.

    Raises:
        ValueError: it does not; in one sentence.
    """
    try:
        cache().mkdir(parents=True, exist_ok=True)
        yield
    except OSError as error:
        raise ValueError(
            f"the table of the height map cannot be kept in {cache()} ({error.strerror or error}); name another folder "
            "by FINGERPAD_CACHE"
        ) from None


def of_map(name: str) -> list[tuple[float, GapTable]]:
    """Return the table of a measured map by its name, as :func:`of_spectrum`.

    Raises:
        ValueError: it is not in the cache; in one sentence.
    """
    try:
        return [(1.0, read(_file(name)))]
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise ValueError(
            f"surface is {name!r}, and {cache()} has no table of that name ({reason}); compute it again by fingerpad "
            "microscale from a scene with roughness.topography, or name another folder by FINGERPAD_CACHE"
        ) from None


def _file(name: str) -> Path:
    return cache() / f"gaps_{''.join(c for c in name if c.isalnum())}.npz"
