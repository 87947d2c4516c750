"""Fields inside the finger in one state: as arrays, for PyVista, and as a group of ``fields.npz`` in a folder.

The file is NumPy's: ``numpy.load("fields.npz")["loads/press/stress"]``. Its groups are ``meshes/0``, …; ``loads/NAME``,
the end of each load; ``states/NAME``, the skin of states of the path, and fields too of named states on another mesh;
and ``motion``, see :mod:`fingerpad.results.pictures.animation`. Tensors have 32 bits there.
"""

import zipfile
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fingerpad.results import files
from fingerpad.results.quantities import SKIN
from fingerpad.results.states import by_load, shown
from variational.files import read as read_bytes
from variational.state import ContactState, Skin

if TYPE_CHECKING:
    from pyvista import MultiBlock, UnstructuredGrid

    from variational.snapshot import Snapshot

Array = NDArray[np.float64]
Along = Skin | Mapping[str, Array]
"""The skin of a state, or its arrays by the names of :data:`ALONG`, as a file has them."""
Groups = Mapping[str, Mapping[str, Any]]
FILE = "fields.npz"
ALONG = (*(name.removesuffix("_n").removesuffix("_t") for name in SKIN), "d_eq", "ridge")
"""Arrays of the skin along a state, see :class:`fingerpad.results.pictures.curves.SurfaceProfile`."""
_LEVEL = 1  # of compression: the next ones take longer and save little
_TRIANGLE = 5  # VTK's number of this cell
_MESH = ("x", "triangles", "tag", "lines", "beside")  # of a snapshot, that states on one mesh share
_TENSORS = ("stress", "strain")  # of which a file has 32 bits


@dataclass(frozen=True)
class View:
    """All that is shown of a state."""

    state: ContactState
    size: float | None
    """Contact size (m) of its mesh, where the title has it."""
    skin: Along | None
    """None on ranks other than 0, as the next."""
    snapshot: "Snapshot | None"
    merkel: Array | None
    """Current places (m) of the Merkel sites, shape (sites, 2), None where they are not wanted."""

    def at(self, bone_x: float) -> "View":
        """Return the same with the bone elsewhere (m): in steady full slip the whole finger moves with it."""
        by, found = np.array([bone_x - self.state.bone_x, 0.0]), dict[str, Any](vars(self))
        found["state"] = replace(self.state, bone_x=bone_x)
        for part, array in (("skin", "x"), ("snapshot", "u")):
            if (each := found[part]) is not None:
                kept = dict(each if isinstance(each, Mapping) else vars(each))
                kept[array] = kept[array] + (by[0] if array == "x" else by)
                found[part] = kept if isinstance(each, Mapping) else type(each)(**kept)
        return View(**found | {"merkel": None if self.merkel is None else self.merkel + by})


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


def of_snapshot(shown: "Snapshot") -> Fields:
    """Return the fields of what a picture shows."""
    count = int(shown.triangles.max(initial=-1)) + 1  # what follows are the middles of lines
    zero = np.zeros(len(shown.stress))
    (xx, yy, zz, xy), (e_xx, e_yy, e_xy) = shown.stress.T, shown.strain.T
    return Fields(
        shown.x[:count], shown.u[:count], shown.triangles, shown.tag, shown.sed,
        _tensor([[xx, xy, zero], [xy, yy, zero], [zero, zero, zz]]),
        _tensor([[e_xx, e_xy, zero], [e_xy, e_yy, zero], [zero, zero, zero]]),
    )  # fmt: skip


def _in_space(plane: Array) -> Array:
    """Return vectors in the plane with a third component, zero."""
    return np.column_stack([plane, np.zeros(len(plane))])


def _tensor(rows: Sequence[Sequence[Array]]) -> Array:
    """Return tensors by cell, shape (cells, 3, 3), of their components, each of shape (cells,)."""
    return np.moveaxis(np.array([list(row) for row in rows]), 2, 0)


# -- the file ----------------------------------------------------------------------------------------------
def write(folder: Path, groups: Groups) -> None:
    """Write arrays by group and name, a file that is there as a whole or not at all; whole numbers have 32 bits."""
    data = BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED, compresslevel=_LEVEL) as file:
        for group, arrays in groups.items():
            for name, values in arrays.items():
                known = np.asarray(values)
                with file.open(f"{group}/{name}.npy", "w", force_zip64=True) as part:
                    np.lib.format.write_array(part, known.astype(np.int32) if known.dtype == np.int64 else known)
    files.replace(folder / FILE, data.getvalue())


def read(folder: Path) -> dict[str, dict[str, NDArray[Any]]]:
    """Return the arrays of the file in a folder by group and name; none without a whole file."""
    found = dict[str, dict[str, NDArray[Any]]]()
    try:
        with np.load(BytesIO(read_bytes(folder / FILE)), allow_pickle=False) as file:
            for path in file:
                group, _, name = path.rpartition("/")
                found.setdefault(group, {})[name] = file[path]
    except (OSError, ValueError, EOFError, TypeError, RuntimeError, MemoryError, zipfile.BadZipFile, zlib.error):
        return {}
    return found


def groups_of(loads: Mapping[str, View], states: Mapping[str, View]) -> Groups:
    """Return the groups of a file: of the ends of loads, and of states by name, each with what its view has."""
    meshes, found = list[Any](), dict[str, dict[str, Any]]()
    views = {f"loads/{name}": view for name, view in loads.items()}
    for group, view in (views | {f"states/{name}": view for name, view in states.items()}).items():
        arrays: dict[str, Any] = {"bone_x": view.state.bone_x}
        arrays |= {} if view.merkel is None else {"merkel": view.merkel}
        arrays |= {} if view.skin is None else {"skin": np.stack([*sorted_along(view.skin, view.state).values()])}
        if (shown := view.snapshot) is not None:
            known = (k for k, mesh in enumerate(meshes) if all(np.array_equal(*each) for each in _pairs(mesh, shown)))
            if (number := next(known, len(meshes))) == len(meshes):
                meshes.append(shown)
            arrays |= {"mesh": number, "u": shown.u, "sed": shown.sed}
            arrays |= {name: np.asarray(getattr(shown, name), np.float32) for name in _TENSORS}
        found[group] = arrays
    return {f"meshes/{k}": {name: getattr(mesh, name) for name in _MESH} for k, mesh in enumerate(meshes)} | found


def _pairs(one: Any, other: Any) -> list[tuple[NDArray[Any], NDArray[Any]]]:
    return [(getattr(one, name), getattr(other, name)) for name in _MESH]


def views_of(
    folder: Path, steps: Sequence[ContactState], named: Mapping[str, ContactState]
) -> tuple[dict[str, View], dict[str, View]]:
    """Return the views in the file of a folder, of the ends of loads and of states by name; none that are not whole.

    Args:
        folder: of a run.
        steps: its accepted states.
        named: its named states.
    """
    groups, ends = read(folder), {load: mine[-1] for load, mine in by_load(steps)}
    loads = {load: _view(groups, f"loads/{load}", end) for load, end in ends.items()}
    of_path = {**named, **shown(steps)}
    states = {name: _view(groups, f"states/{name}", state) for name, state in of_path.items()}
    for name, view in states.items():
        if view is not None and view.snapshot is not None and name in named:  # on another mesh than the path's
            there = replace(named[name], bone_x=view.state.bone_x)
            states[name] = replace(view, state=there, size=there.mesh_contact)
    return tuple({name: view for name, view in each.items() if view} for each in (loads, states))  # type: ignore[return-value]


def _view(groups: Groups, group: str, state: ContactState) -> View | None:
    """Return the view of a group; None without one, or where its arrays are not whole."""
    arrays = groups.get(group, {})
    try:
        skin, number = arrays.get("skin"), arrays.get("mesh")
        snapshot: Any = None
        if number is not None:
            mesh = groups[f"meshes/{int(number)}"]
            tensors = {name: arrays[name].astype(float) for name in _TENSORS}
            snapshot = SimpleNamespace(
                **{name: mesh[name] for name in _MESH}, u=arrays["u"], sed=arrays["sed"], **tensors
            )
            if not _whole(snapshot):
                return None
        if skin is not None and (skin.ndim != 2 or len(skin) != len(ALONG) or skin.dtype.kind != "f"):
            return None
        there = replace(state, bone_x=float(arrays["bone_x"]))
    except (KeyError, TypeError, ValueError):
        return None
    along = None if skin is None else dict(zip(ALONG, skin, strict=True))
    return View(there, None, along, snapshot, arrays.get("merkel"))


def _whole(shown: Any) -> bool:
    """Return whether the arrays of a snapshot fit together, whoever wrote them."""
    points, cells = len(shown.x), len(shown.triangles)
    shapes = {"x": (points, 2), "u": (points, 2), "triangles": (cells, 3), "tag": (cells,), "sed": (cells,)}
    shapes |= {"stress": (cells, 4), "strain": (cells, 3), "lines": (len(shown.lines), 3)}
    shapes |= {"beside": (len(shown.lines), 2)}
    if any(getattr(shown, name).shape != shape for name, shape in shapes.items()):
        return False
    if not all(getattr(shown, name).dtype.kind == "f" for name in ("x", "u", "sed")):
        return False
    for name, least, most in (("triangles", 0, points), ("lines", 0, points), ("beside", -1, cells)):
        values = getattr(shown, name)
        if values.dtype.kind != "i" or np.any((values < least) | (values >= most)):
            return False
    return bool(np.isfinite(shown.x).all() and np.isfinite(shown.u).all() and np.isfinite(shown.sed).all())


def sorted_along(skin: Along, state: ContactState) -> dict[str, Any]:
    """Return the skin of a state by the names of :data:`ALONG`: sorted along each ridge, a NaN between ridges."""
    if not isinstance(skin, Skin):
        return dict(skin)
    assert state.ridges is not None
    columns: list[list[Any]] = [[] for _ in ALONG]
    for number in np.unique(skin.ridge):
        mine = skin.ridge == number
        order = np.argsort(skin.x[mine], axis=None)
        gap = state.ridges.d_eq[state.ridges.number == number]
        parts = [values[mine].ravel()[order] for values in (skin.x, skin.y, skin.p_n, skin.t_t, skin.p_el)]
        parts += [np.full(len(order), value) for value in (gap.item(), number)]
        for column, part in zip(columns, parts, strict=True):
            column += [part, [np.nan]]
    return dict(zip(ALONG, map(np.concatenate, columns), strict=True))
