"""Fields inside the finger in one state: as arrays, for PyVista, and as a group of ``fields.npz`` in a folder.

The file is NumPy's: ``numpy.load("fields.npz")["loads/press/stress"]``. Its groups are ``meshes/0``, …; ``loads/NAME``,
the end of each load; ``states/NAME``, the skin of states of the path, and fields too of named states on another mesh;
and ``motion``, see :mod:`fingerpad.results.pictures.animation`. Tensors have 32 bits there.
"""

import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fingerpad.results import files
from fingerpad.results.states import by_load, shown
from variational.files import read as read_bytes
from variational.snapshot import Snapshot
from variational.state import ContactState, Skin

if TYPE_CHECKING:
    from pyvista import MultiBlock, UnstructuredGrid

Array = NDArray[np.float64]
Along = Skin | Mapping[str, Array]
"""The skin of a state, or its arrays by the names of :data:`ALONG`, as a file has them."""
Groups = Mapping[str, Mapping[str, Any]]
FILE = "fields.npz"
ALONG = ("x", "y", "p", "t", "p_el", "d_eq", "ridge")
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
    snapshot: Snapshot | None
    merkel: Array | None
    """Current places (m) of the Merkel sites, shape (sites, 2), None where they are not wanted."""

    def at(self, bone_x: float) -> "View":
        """Return the same with the bone elsewhere (m): in steady full slip the whole finger moves with it."""
        by, skin = np.array([bone_x - self.state.bone_x, 0.0]), self.skin
        if isinstance(skin, Skin):
            skin = replace(skin, x=skin.x + by[0])
        elif skin is not None:
            skin = {**skin, "x": skin["x"] + by[0]}
        snapshot = None if self.snapshot is None else replace(self.snapshot, u=self.snapshot.u + by)
        merkel = None if self.merkel is None else self.merkel + by
        return View(replace(self.state, bone_x=bone_x), self.size, skin, snapshot, merkel)


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
        try:
            import pyvista
        except ModuleNotFoundError as error:
            how = "pip install pyvista, or in a clone environment/wheels"
            raise ImportError(f"to_pyvista needs pyvista, which is not installed; {how}", name="pyvista") from error
        grid = pyvista.UnstructuredGrid({_TRIANGLE: self.triangles}, _in_space(self.points))
        grid.point_data["displacement"] = _in_space(self.displacement)
        cells: dict[str, NDArray[Any]] = {"sed": self.sed, "layer": self.layer}
        cells |= {"stress": self.stress.reshape(-1, 9), "strain": self.strain.reshape(-1, 9)}
        for name, values in cells.items():
            grid.cell_data[name] = values
        return grid


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
        grids = {name: fields.to_pyvista() for name, fields in self.items()}
        import pyvista

        return pyvista.MultiBlock(grids)


def of_snapshot(shown: Snapshot) -> Fields:
    """Return the fields of what a picture shows."""
    count = int(shown.triangles.max(initial=-1)) + 1  # what follows are the middles of lines
    o = np.zeros(len(shown.stress))
    (xx, yy, zz, xy), (e_xx, e_yy, e_xy) = shown.stress.T, shown.strain.T
    stress = np.moveaxis(np.array([[xx, xy, o], [xy, yy, o], [o, o, zz]]), 2, 0)
    strain = np.moveaxis(np.array([[e_xx, e_xy, o], [e_xy, e_yy, o], [o, o, o]]), 2, 0)
    return Fields(shown.x[:count], shown.u[:count], shown.triangles, shown.tag, shown.sed, stress, strain)


def _in_space(plane: Array) -> Array:
    """Return vectors in the plane with a third component, zero."""
    return np.column_stack([plane, np.zeros(len(plane))])


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
    except Exception:  # whatever a file that somebody else wrote makes its readers raise
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
            same = (all(np.array_equal(getattr(mesh, n), getattr(shown, n)) for n in _MESH) for mesh in meshes)
            if (number := next((k for k, each in enumerate(same) if each), len(meshes))) == len(meshes):
                meshes.append(shown)
            arrays |= {"mesh": number, "u": shown.u, "sed": shown.sed}
            arrays |= {name: np.asarray(getattr(shown, name), np.float32) for name in _TENSORS}
        found[group] = arrays
    return {f"meshes/{k}": {name: getattr(mesh, name) for name in _MESH} for k, mesh in enumerate(meshes)} | found


def views_of(
    folder: Path, steps: Sequence[ContactState], named: Mapping[str, ContactState]
) -> tuple[dict[str, View], dict[str, View]]:
    """Return the views in the file of a folder, of the ends of loads and of states by name; none that are not whole.

    Args:
        folder: of a run.
        steps: its accepted states.
        named: its named states.
    """
    groups = read(folder)

    def views(kind: str, of: Mapping[str, ContactState]) -> dict[str, View]:
        found = {name: _view(groups, f"{kind}/{name}", state) for name, state in of.items()}
        return {name: view for name, view in found.items() if view is not None}

    states = views("states", {**named, **shown(steps)})
    for name, view in states.items():
        if view.snapshot is not None and name in named:  # on another mesh than the path's
            there = replace(named[name], bone_x=view.state.bone_x)
            states[name] = replace(view, state=there, size=there.mesh_contact)
    return views("loads", {load: mine[-1] for load, mine in by_load(steps)}), states


def _view(groups: Groups, group: str, state: ContactState) -> View | None:
    """Return the view of a group; None without one, or where its arrays are not whole."""
    arrays = groups.get(group, {})
    try:
        there, snapshot, along = replace(state, bone_x=float(arrays["bone_x"])), None, None
        if "mesh" in arrays:
            mesh = groups[f"meshes/{int(arrays['mesh'])}"]
            tensors = {name: arrays[name].astype(float) for name in _TENSORS}
            snapshot = Snapshot(u=arrays["u"], sed=arrays["sed"], **{name: mesh[name] for name in _MESH}, **tensors)
            if not _fits(snapshot):
                return None
        if (skin := arrays.get("skin")) is not None:
            if skin.ndim != 2 or skin.dtype.kind != "f":
                return None
            along = dict(zip(ALONG, skin, strict=True))
    except (KeyError, TypeError, ValueError):
        return None
    return View(there, None, along, snapshot, arrays.get("merkel"))


def _fits(shown: Snapshot) -> bool:
    """Return whether the arrays of a snapshot fit together, whoever wrote them.

    Raises:
        TypeError: one is of no numbers.
    """
    points, cells, lines = len(shown.x), len(shown.triangles), len(shown.lines)
    shapes = {"x": (points, 2), "u": (points, 2), "triangles": (cells, 3), "tag": (cells,), "sed": (cells,)}
    shapes |= {"stress": (cells, 4), "strain": (cells, 3), "lines": (lines, 3), "beside": (lines, 2)}
    numbers = ((shown.triangles, 0, points), (shown.lines, 0, points), (shown.beside, -1, cells))
    return (
        all(getattr(shown, name).shape == shape for name, shape in shapes.items())
        and all(np.isfinite(each).all() for each in (shown.x, shown.u, shown.sed))
        and all(each.dtype.kind == "i" and ((each >= low) & (each < high)).all() for each, low, high in numbers)
    )


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
