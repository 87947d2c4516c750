"""Variables with dimensions, units and names as a NetCDF file and back, as xarray writes them, without xarray.

xarray brings pandas: a third of a second, which a run and the report of a run do not need. NetCDF 3 has no texts and no
switches. As in xarray's files texts are bytes along a further dimension, with an attribute ``_Encoding``; switches are
bytes with an attribute ``dtype``; and a missing number is NaN.
"""

import io
from collections.abc import Container, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.io import netcdf_file

from variational.files import read

Variables = Mapping[str, tuple[tuple[str, ...], Any, Mapping[str, str]]]
"""Dimensions, values, and attributes by name."""
_TEXT = "utf-8"


class _Kept(io.BytesIO):
    """A file whose content stays when SciPy closes it."""

    content = b""

    def close(self) -> None:
        """Keep the content."""
        if not self.closed:
            self.content = self.getvalue()
        super().close()


def encoded(variables: Variables, coordinates: Container[str], attributes: Mapping[str, Any]) -> bytes:
    """Return a file of NetCDF 3 with 64-bit offsets.

    Args:
        variables: with their dimensions, values and attributes.
        coordinates: names of those that are coordinates, which come last.
        attributes: of the file: texts, numbers and lists of numbers.
    """
    kept = _Kept()
    file = netcdf_file(kept, "w", version=2)
    for key, value in attributes.items():
        setattr(file, key, _attribute(value))
    for name in sorted(variables, key=lambda name: name in coordinates):
        dims, values, about = variables[name]
        dims, values, more = _plain(tuple(dims), np.asarray(values))
        for dim, length in zip(dims, values.shape, strict=True):
            if dim not in file.dimensions:
                file.createDimension(dim, length)
        variable = file.createVariable(name, values.dtype, dims)
        for key, value in (dict(about) | more).items():
            setattr(variable, key, _attribute(value))
        variable[...] = values
    file.close()
    return kept.content


def _plain(dims: tuple[str, ...], values: NDArray[Any]) -> tuple[tuple[str, ...], NDArray[Any], dict[str, Any]]:
    """Return dimensions and values as NetCDF 3 has them, and attributes that say what they were."""
    if values.dtype.kind in "OU":
        texts = np.char.encode(values.astype(str), _TEXT)
        texts = np.ascontiguousarray(texts.astype(f"S{max(texts.dtype.itemsize, 1)}"))
        length = texts.dtype.itemsize
        return (*dims, f"string{length}"), texts.view("S1").reshape(*texts.shape, length), {"_Encoding": _TEXT}
    if values.dtype.kind == "b":
        return dims, values.astype(np.int8), {"dtype": "bool"}
    return dims, values, {"_FillValue": values.dtype.type(np.nan)} if values.dtype.kind == "f" else {}


def _attribute(value: Any) -> Any:
    """Return an attribute as SciPy writes it; whole numbers have 32 bits."""
    if isinstance(value, str):
        return value.encode(_TEXT)
    known = np.atleast_1d(value)
    return known.astype(np.int32) if known.dtype.kind == "i" else known


def arrays(file: Path) -> dict[str, NDArray[Any]]:
    """Return the values of a file by variable.

    Raises:
        OSError, ValueError, TypeError, KeyError, IndexError, MemoryError, AttributeError: it is no whole file.
    """
    with netcdf_file(io.BytesIO(read(file)), "r", mmap=False) as content:
        return {name: _values(variable) for name, variable in content.variables.items()}


def _values(variable: Any) -> NDArray[Any]:
    values = np.asarray(variable.data)
    if values.dtype.kind == "S":
        whole = np.ascontiguousarray(values).view(f"S{values.shape[-1]}")[..., 0]
        return np.asarray(np.char.decode(whole, _TEXT), dtype=object)
    if getattr(variable, "dtype", b"") == b"bool":
        return values.astype(bool)
    return values.astype(values.dtype.newbyteorder("="))
