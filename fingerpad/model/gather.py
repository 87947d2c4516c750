"""Displacements and the skin of a distributed body on every rank, in an order that does not depend on the ranks."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from variational import body as setup
from variational import compat
from variational.contact.formulation import SurfaceState
from variational.problem import Problem
from variational.state import Skin

Array = NDArray[np.float64]


class Nodes:
    """Brings displacements to every rank, numbered as the mesh was before it was distributed."""

    def __init__(self, made: setup.Body) -> None:
        mesh = made.problem.mesh
        self._comm, cells = mesh.comm, np.arange(mesh.topology.index_map(2).size_local)
        # The first three degrees of freedom of a Lagrange triangle are its vertices, in the geometry's order.
        self._dofs = made.problem.V.dofmap.list[cells][:, :3]
        nodes = compat.cell_geometry(mesh)[cells][:, :3]
        names = self._together(np.asarray(mesh.geometry.input_global_indices)[nodes])
        self._sort = np.argsort(self._together(np.asarray(mesh.topology.original_cell_index)[cells]))
        _, self._first, corners = np.unique(names[self._sort].ravel(), return_index=True, return_inverse=True)
        self.triangles = corners.reshape(-1, 3)
        self.coordinates = self._pick(mesh.geometry.x[nodes][:, :, :2])

    def _together(self, mine: NDArray[Any]) -> NDArray[Any]:
        return np.concatenate(self._comm.allgather(mine))

    def _pick(self, mine: Array) -> Array:
        """Return one value a node of values by cell and corner, shape (cells, 3, 2)."""
        return np.asarray(self._together(mine)[self._sort].reshape(-1, 2)[self._first])

    def gather(self, problem: Problem) -> Array:
        """Return the displacement of all nodes (m), shape (nodes, 2); collective."""
        return self._pick(problem.displacement()[self._dofs])


class Points:
    """Brings the skin to every rank, ridge by ridge and from left to right, whatever ranks hold it."""

    def __init__(self, made: setup.Body) -> None:
        self._surface = surface = made.surface
        unloaded = made.continuation.surface_state
        x, y, ridge = self._gather(unloaded.x, unloaded.y, np.broadcast_to(surface.ridge[:, None], unloaded.x.shape))
        self._flip = x[:, 0] > x[:, -1]
        middle = ((z[:, 0] + z[:, -1]) / 2 for z in (y, x))
        self._order = np.lexsort((*middle, ridge[:, 0]))
        self._ridge = np.array(surface.ridge_numbers)[ridge[self._order, 0].astype(int)]

    def _gather(self, *mine: Array) -> Array:
        stacked = np.stack([np.asarray(values, dtype=np.float64) for values in mine])
        return np.concatenate(self._surface.mesh.comm.allgather(stacked), axis=1)

    def gather(self, state: SurfaceState) -> Skin:
        """Return the skin in a state; collective."""
        stretch = np.hypot(state.area_x, state.area_y)  # current per reference area
        pull = np.broadcast_to(state.p_el, state.x.shape)
        values = self._gather(state.x, state.y, state.p_n / stretch, state.t_t / stretch, pull)
        values[:, self._flip] = values[:, self._flip, ::-1]
        return Skin(self._ridge, *values[:, self._order])
