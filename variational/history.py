r"""History: what an accepted step leaves to the next one, a list of named fields with their update rules.

A problem owns one :class:`History`. Acceptance evaluates all rules in the state as solved, :math:`h_{n+1} = g(u, h_n,
\Delta t)`, and only then writes the fields, so that no rule reads what another one has just left. Roll-back, transfer
between meshes and checkpoints go through the same list. A half finger needs no rule of its own: the whole one evaluates
the rules in the mirrored state. So a new field is one :class:`SkinField` or :class:`BodyField` and no other edit.

Of values there are two sets: those last *accepted*, and those *imposed* on the forms, which a formulation may correct
between solves (:mod:`~variational.contact.augmented`).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from dolfinx import fem
from numpy.typing import NDArray

from variational import compat, jit
from variational.surface import Surface

Array = NDArray[np.float64]
Values = Mapping[str, Array]
"""This rank's values by field: of a field of the skin of shape (facets, points), of one of the body its ``x.array``."""
_TOWARDS_CENTROID = 0.1  # of the way: where two cells have a node in one place, this tells them apart


@dataclass(frozen=True, eq=False)
class SkinField:
    """A number at each Gauss point of the skin that can touch."""

    name: str
    update: Any
    """What an accepted step leaves, UFL; it may read ``function``, the displacement and ``Problem.dt``."""
    function: fem.Function | None = None
    """In ``Surface.history_space``, what forms and rules read; None where none does."""
    follows: Any = None
    """A place or displacement (m), UFL, with which the field moves as the body is translated sideways. On other meshes
    the difference of the two is interpolated. None for a field that a translation does not change."""


@dataclass(frozen=True, eq=False)
class BodyField:
    """Numbers at the nodes of a discontinuous Lagrange space, of any shape."""

    name: str
    update: Any
    """What an accepted step leaves, UFL of the function's shape, evaluated at the nodes."""
    function: fem.Function

    @cached_property
    def _rule(self) -> fem.Expression:
        points = compat.interpolation_points(self.function.function_space.element)
        return fem.Expression(self.update, points, jit_options=jit.OPTIONS)

    def updated(self) -> Array:
        """Return what a step to the present state leaves; collective."""
        found = fem.Function(self.function.function_space)
        found.interpolate(self._rule)
        found.x.scatter_forward()
        return np.asarray(found.x.array.copy())

    def left(self) -> Values:
        """Return what a step to the present state leaves of this field, and of those with which it has one rule."""
        return {self.name: self.updated()}

    @property
    def cells(self) -> NDArray[np.int32]:
        """Nodes of this rank's own cells, shape (cells, nodes)."""
        space = self.function.function_space
        return np.asarray(space.dofmap.list[: space.mesh.topology.index_map(2).size_local])

    def places(self) -> tuple[Array, Array]:
        """Return where this rank's nodes are (m), cell by cell, and the same moved towards the centroids of the cells.

        Both have the shape (cells, nodes, 2). Moved, no two nodes are in one place.
        """
        space = self.function.function_space
        corners = space.mesh.geometry.x[compat.cell_geometry(space.mesh)[: len(self.cells)]][:, :3, :2]
        nodes = space.tabulate_dof_coordinates()[self.cells][:, :, :2]
        return nodes, nodes + _TOWARDS_CENTROID * (corners.mean(axis=1, keepdims=True) - nodes)

    def by_cell(self, values: Array) -> Array:
        """Return values as in ``x.array`` by this rank's own cells, shape (cells, nodes, components)."""
        return np.asarray(values.reshape(-1, self.function.function_space.dofmap.bs)[self.cells])

    def from_cells(self, values: Array) -> Array:
        """Return values as in ``x.array`` of those by cell; collective."""
        found = fem.Function(self.function.function_space)
        found.x.array.reshape(-1, values.shape[2])[self.cells] = values
        found.x.scatter_forward()
        return np.asarray(found.x.array.copy())


class History:
    """The fields of one problem.

    Attributes:
        fields: by name.
        accepted: values that the last accepted step left.
        imposed: values that forms and rules read.
        on_impose: called after these were written, to write what else follows from them.
    """

    def __init__(self, surface: Surface) -> None:
        """Start without a field.

        Args:
            surface: the skin that can touch.
        """
        self._surface = surface
        self.fields: dict[str, SkinField | BodyField] = {}
        self.accepted: Values = {}
        self.imposed: Values = {}
        self.on_impose: list[Callable[[], None]] = []

    def add(self, field: SkinField | BodyField, start: Array | None = None) -> None:
        """Add a field.

        Args:
            field: with a name of its own.
            start: values in the unloaded state; by default zero on the skin, and in the body those of its function.

        Raises:
            ValueError: there is a field of its name.
        """
        if field.name in self.fields:
            raise ValueError(f"there are two history fields of the name {field.name!r}; give each a name of its own")
        if start is None:
            on_skin = np.zeros((len(self._surface.pairs), len(self._surface.weights)))
            start = on_skin if isinstance(field, SkinField) else field.function.x.array.copy()
        self.fields[field.name] = field
        self.accepted = self.imposed = {**self.accepted, field.name: start}

    @property
    def skin(self) -> list[SkinField]:
        """The fields of the skin."""
        return [field for field in self.fields.values() if isinstance(field, SkinField)]

    @property
    def body(self) -> list[BodyField]:
        """The fields of the body."""
        return [field for field in self.fields.values() if isinstance(field, BodyField)]

    def updated(self, skin: Values) -> Values:
        """Return what a step to the present state leaves; collective.

        Args:
            skin: that of the fields of the skin, see :attr:`variational.contact.formulation.SurfaceState.history`.
        """
        found = dict(skin)
        for field in self.body:
            if field.name not in found:
                found |= field.left()
        return found

    def accept(self, values: Values) -> None:
        """Accept what a step left; fields that are not among the values stay as they are; collective."""
        self.accepted = {**self.accepted, **values}
        self.impose(self.accepted)

    def impose(self, values: Values) -> None:
        """Have forms and rules read values that are not accepted yet; collective."""
        self.imposed = values
        for name, field in self.fields.items():
            if isinstance(field, BodyField):
                field.function.x.array[:] = values[name]
            elif field.function is not None:
                self._surface.set_history(field.function, values[name])
        for follow in self.on_impose:
            follow()

    def translated(self, distance: float) -> Values:
        """Return the accepted values of a body that is moved sideways, with its history, by a distance (m)."""
        moving = {field.name for field in self.skin if field.follows is not None}
        return {**self.accepted, **{name: np.asarray(self.accepted[name] + distance) for name in moving}}

    def followed(self, state: Values) -> Values:
        """Return what the fields of the skin follow in the present state, zero where they follow nothing.

        Args:
            state: the fields of the skin, as updated in the present state.
        """
        others = [field for field in self.skin if field.follows is not None and field.follows != field.update]
        found = {
            field.name: state[field.name] if field.follows is not None else np.zeros_like(state[field.name])
            for field in self.skin
        }
        if others:
            values = self._surface.evaluate(self._surface.compile([field.follows for field in others]))
            found |= {field.name: values[k] for k, field in enumerate(others)}
        return found
