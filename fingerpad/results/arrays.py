"""The arrays of pictures in a folder: written as a whole, and read whoever wrote them."""

import zipfile
import zlib
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fingerpad.results import files
from variational.files import read
from variational.snapshot import outline

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]
_LEVEL = 1  # of compression: the next ones take longer and save little
ALONG = ("x", "y", "p", "t", "p_el", "d_eq", "ridge")
"""Names of the skin's arrays along a state, see :class:`fingerpad.results.curves.SurfaceProfile`."""


def put(path: Path, arrays: Mapping[str, Any]) -> None:
    """Write arrays into a file of NumPy's format npz, which is there as a whole or not at all; numbers have 32 bits."""
    data = BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED, compresslevel=_LEVEL) as file:
        for name, values in arrays.items():
            known = np.asarray(values)
            with file.open(f"{name}.npy", "w", force_zip64=True) as part:
                np.lib.format.write_array(part, known.astype(np.int32) if known.dtype == np.int64 else known)
    files.replace(path, data.getvalue())


def finger_of(file: Path) -> dict[str, Any]:
    """Return the arrays of a finger by name, see :class:`variational.snapshot.Snapshot`; none that are not whole.

    A file without lines is of an earlier version: its lines are straight.
    """
    found = arrays_of(file)
    try:
        points, triangles = len(found["x"]), found["triangles"]
        whole = found["x"].shape == found["u"].shape == (points, 2) and triangles.shape[1:] == (3,)
        whole &= found["sed"].shape == found["tag"].shape == (len(triangles),)
        whole &= triangles.dtype.kind in "iu" and bool(np.all((triangles >= 0) & (triangles < points)))
        whole &= all(found[name].dtype.kind in "iuf" for name in ("x", "u", "sed", "tag"))
        whole &= bool(all(np.isfinite(found[name]).all() for name in ("x", "u", "sed")))
        for name, components in (("stress", 4), ("strain", 3)):  # files of earlier versions have none
            values = found.get(name, np.empty((len(triangles), components)))
            whole &= values.shape == (len(triangles), components) and values.dtype.kind == "f"
        if whole and "lines" not in found:
            found |= _straight(**{name: found[name] for name in ("x", "u", "triangles", "tag")})
        for name, columns, least, most in (("lines", 3, 0, len(found["x"])), ("beside", 2, -1, len(triangles))):
            whole &= found[name].shape == (len(found["lines"]), columns) and found[name].dtype.kind == "i"
            whole &= bool(np.all((found[name] >= least) & (found[name] < most)))
    except (KeyError, TypeError):
        whole = False
    return found if whole else {}


def _straight(x: Array, u: Array, triangles: Numbers, tag: Numbers) -> dict[str, Any]:
    """Return points, displacements and lines of a finger of which vertices alone are known."""
    ends, beside, _ = outline(x, triangles, tag)
    points, moved = (np.concatenate([each, each[ends].mean(axis=1)]) for each in (x, u))
    middle = len(x) + np.arange(len(ends))
    return {"x": points, "u": moved, "lines": np.stack([ends[:, 0], middle, ends[:, 1]], axis=1), "beside": beside}


def skin_of(file: Path, prefix: str) -> dict[str, Any]:
    """Return the skin of a state, by the names of :class:`SurfaceProfile`, or nothing.

    Args:
        file: of one state or several.
        prefix: of the state.
    """
    found = arrays_of(file)
    skin = {name: found[f"{prefix}_{name}"] for name in ALONG if f"{prefix}_{name}" in found}
    whole = all(value.ndim == 1 and value.dtype.kind == "f" for value in skin.values())
    return skin if whole and len(skin) == len(ALONG) and len({len(value) for value in skin.values()}) == 1 else {}


def arrays_of(file: Path) -> dict[str, Any]:
    """Return the arrays of a file by name; none without a file that can be read."""
    try:
        with np.load(BytesIO(read(file)), allow_pickle=False) as found:
            return dict(found)
    except (OSError, ValueError, EOFError, TypeError, RuntimeError, MemoryError, zipfile.BadZipFile, zlib.error):
        return {}
