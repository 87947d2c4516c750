"""Tables of gaps: those that come with the package, by Hurst exponent and ratio of waves, and those of measured maps.

The files in ``data/`` are made by ``python3 -m benchmarks.gap_tables``: self-affine Gaussian surfaces without roll-off.
Between two Hurst exponents, and between the logarithms of two ratios of the longest to the shortest wave, means are
interpolated linearly. Of Persson's theory this changes the air gap by less than 1 % at contacts of up to a third of the
area, half way between two exponents, and by up to 4 % near full contact. Contacts themselves of exponents and ratios
between the tables have a mean attraction within 3 % of it (``tests/test_gaps.py``). A measured map's table is kept in a
folder of the user's, under a hash of heights, size and method; ``FINGERPAD_CACHE`` names another folder.
"""

import io
import os
import zipfile
import zlib
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from variational import files
from variational.roughness.gaps import GapTable

if TYPE_CHECKING:
    pass

HURSTS = (0.6, 0.75, 0.9)
"""Hurst exponents of the tables that come with the package; 0.75 is the paper's."""
RATIOS = (8.0, 16.0, 32.0, 64.0)
"""Ratios of the longest to the shortest wave of these tables."""
_WIDE, _NARROW, _WIDEST_RATIO = 4, 2, 32.0  # longest waves in the side of a surface; ratio up to which it is wide
_FIELDS = ("pressure", "area", "weight", "mean", "deviation")
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
