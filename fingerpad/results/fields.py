"""Fields inside the finger in one state: as arrays, for PyVista, and as files of VTK.

A state is an XML file of VTK's unstructured grids (``.vtu``, zlib-compressed), and the ends of loads are a collection
of these (``.pvd``). Both formats are described in VTK's manual, https://docs.vtk.org/en/latest/vtk_file_formats/.
"""

import zlib
from base64 import b64encode
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from fingerpad.results import files

if TYPE_CHECKING:
    from pyvista import MultiBlock, UnstructuredGrid

    from variational.snapshot import Snapshot

Array = NDArray[np.float64]
UNITS = {"displacement": "m", "stress": "Pa", "strain": "", "sed": "J/m^3", "layer": ""}
"""Units of the arrays in files; each array has its own beside it, by VTK's key ``UNITS_LABEL``."""
_LEVEL = 1  # of compression: the next ones take longer and save little
_TRIANGLE = 5  # VTK's number of this cell
_TYPES = {"f8": "Float64", "f4": "Float32", "i8": "Int64", "i4": "Int32", "u1": "UInt8"}


@dataclass(frozen=True, eq=False)
class Fields:
    """Displacement of the vertices, and means of each cell, of the whole cross-section."""

    points: Array
    """Vertices of the unloaded finger (m), shape (points, 2)."""
    displacement: Array
    """Of the vertices (m), shape (points, 2)."""
    triangles: NDArray[np.int64]
    """Vertices of each cell, shape (cells, 3)."""
    layer: NDArray[np.int32]
    """Tag of each cell's layer, as in :data:`geometry.tags.LAYERS`, shape (cells,)."""
    sed: Array
    """Strain energy density per reference volume (J/m^3), shape (cells,)."""
    stress: Array
    """Cauchy stress (Pa), z out of the plane, shape (cells, 3, 3): the mean of the values in the cell's three corners,
    each with the strain of this cell. With viscous layers the stress of their branches is part of it."""
    strain: Array
    """Green's strain (C - I) / 2, zero out of the plane, shape (cells, 3, 3); the mean over the corners too."""

    def to_pyvista(self) -> "UnstructuredGrid":
        """Return PyVista's grid of the unloaded finger, in m; ``warp_by_vector("displacement")`` deforms it.

        Raises:
            ImportError: PyVista is not installed.
        """
        pyvista = _pyvista()
        grid = pyvista.UnstructuredGrid({_TRIANGLE: self.triangles}, _in_space(self.points))
        for data, arrays in ((grid.point_data, self.on_points()), (grid.cell_data, self.on_cells())):
            for name, values in arrays.items():
                data[name] = values
        return grid

    def on_points(self) -> dict[str, NDArray[Any]]:
        """Return the arrays by vertex that VTK has, each of shape (points, components)."""
        return {"displacement": _in_space(self.displacement)}

    def on_cells(self) -> dict[str, NDArray[Any]]:
        """Return the arrays by cell that VTK has, shapes (cells,) and, of tensors row by row, (cells, 9)."""
        tensors = {"stress": self.stress.reshape(-1, 9), "strain": self.strain.reshape(-1, 9)}
        return {"sed": self.sed, **tensors, "layer": self.layer}


class StateFields(dict[str, Fields]):
    """Fields by the name of a load or of a named state."""

    def __init__(self, found: Mapping[str, Fields], model: str) -> None:
        """Take the fields of a result of a model."""
        super().__init__(found)
        self._model = model

    def __missing__(self, name: str) -> Fields:
        """Refuse a state of which there are no fields.

        Raises:
            ValueError: what there is.
        """
        if not self:
            raise ValueError(f"the result of the model {self._model!r} has no fields here; full runs have, on rank 0")
        raise ValueError(f"the result has no fields of {name!r}; it has those of {', '.join(map(repr, self))}")

    def to_pyvista(self) -> "MultiBlock":
        """Return a block for each state, each a grid of the unloaded finger in m.

        Raises:
            ImportError: PyVista is not installed.
            ValueError: there are no fields.
        """
        if not self:
            self.__missing__("")
        return _pyvista().MultiBlock({name: fields.to_pyvista() for name, fields in self.items()})


def _pyvista() -> Any:
    try:
        import pyvista
    except ModuleNotFoundError as error:
        how = "pip install pyvista, or in a clone environment/wheels"
        raise ImportError(f"to_pyvista needs pyvista, which is not installed; {how}", name="pyvista") from error
    return pyvista


def of_snapshot(shown: "Snapshot | Any") -> Fields | None:
    """Return the fields of what a picture shows; None where it has no stress, as in files of earlier versions."""
    stress, strain = (getattr(shown, name, np.empty((0, 0))) for name in ("stress", "strain"))
    if len(stress) != len(shown.triangles) or len(strain) != len(shown.triangles):
        return None
    count = int(shown.triangles.max(initial=-1)) + 1  # what follows are the middles of lines
    zero = np.zeros(len(stress))
    (xx, yy, zz, xy), (e_xx, e_yy, e_xy) = stress.T, strain.T
    return Fields(
        shown.x[:count], shown.u[:count], shown.triangles, shown.tag, shown.sed,
        _tensor([[xx, xy, zero], [xy, yy, zero], [zero, zero, zz]]),
        _tensor([[e_xx, e_xy, zero], [e_xy, e_yy, zero], [zero, zero, zero]]),
    )  # fmt: skip


def write(path: Path, fields: Fields) -> None:
    """Write fields into a file ``.vtu``, which is there as a whole or not at all; values of cells have 32 bits."""
    points, cells = len(fields.points), len(fields.triangles)
    topology: dict[str, NDArray[Any]] = {
        "connectivity": fields.triangles.astype(np.int64).ravel(),
        "offsets": 3 * np.arange(1, cells + 1, dtype=np.int64),
        "types": np.full(cells, _TRIANGLE, dtype=np.uint8),
    }
    on_cells = fields.on_cells().items()
    parts: dict[str, dict[str, NDArray[Any]]] = {
        "Points": {"points": _in_space(fields.points)},
        "Cells": topology,
        "PointData": fields.on_points(),
        "CellData": {name: each.astype(np.float32) if each.dtype == np.float64 else each for name, each in on_cells},
    }
    body = "\n".join(f"<{name}>\n{_arrays(arrays)}</{name}>" for name, arrays in parts.items())
    piece = f'<Piece NumberOfPoints="{points}" NumberOfCells="{cells}">\n{body}\n</Piece>'
    files.replace(path, _file("UnstructuredGrid", f"<UnstructuredGrid>\n{piece}\n</UnstructuredGrid>"))


def write_series(path: Path, states: Iterable[tuple[int, str, str]]) -> None:
    """Write a collection ``.pvd`` of states.

    Args:
        path: where to.
        states: number of the step, as the time, its name, and the name of the file beside the collection.
    """
    rows = "\n".join(
        f'<DataSet timestep="{step}" part="0" name={quoteattr(name)} file={quoteattr(file)}/>'
        for step, name, file in states
    )
    files.replace(path, _file("Collection", f"<Collection>\n{rows}\n</Collection>"))


def _file(kind: str, body: str) -> bytes:
    head = f'<VTKFile type="{kind}" version="1.0" byte_order="LittleEndian" header_type="UInt64"'
    return f'{head} compressor="vtkZLibDataCompressor">\n{body}\n</VTKFile>\n'.encode()


def _arrays(arrays: Mapping[str, NDArray[Any]]) -> str:
    """Return arrays as VTK has them: numbers of blocks and their sizes, then the compressed block, both in base 64."""
    text = ""
    for name, values in arrays.items():
        kind = values.dtype.str[1:]
        raw = np.ascontiguousarray(values, dtype=f"<{kind}").tobytes()
        block = zlib.compress(raw, _LEVEL)
        sizes = np.array([1, len(raw), 0, len(block)], dtype="<u8").tobytes()
        components = 1 if values.ndim == 1 else values.shape[1]
        text += f'<DataArray type="{_TYPES[kind]}" Name="{name}" NumberOfComponents="{components}" format="binary">'
        text += f"{b64encode(sizes).decode()}{b64encode(block).decode()}{_unit(name)}</DataArray>\n"
    return text


def _unit(name: str) -> str:
    unit = UNITS.get(name)
    return f'<InformationKey name="UNITS_LABEL" location="vtkDataArray">{unit}</InformationKey>' if unit else ""


def _in_space(plane: Array) -> Array:
    """Return vectors in the plane with a third component, zero."""
    return np.column_stack([plane, np.zeros(len(plane))])


def _tensor(rows: Sequence[Sequence[Array]]) -> Array:
    """Return tensors by cell, shape (cells, 3, 3), of their components, each of shape (cells,)."""
    return np.moveaxis(np.array([list(row) for row in rows]), 2, 0)
