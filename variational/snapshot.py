"""The whole body on one rank, as a picture shows it: its vertices, triangles, densities, tensors and lines."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from variational import compat
from variational.outline import outline
from variational.output import sed_per_cell, tensors_per_cell

if TYPE_CHECKING:
    from variational.problem import Problem

Array = NDArray[np.float64]
_ON_LINE = 1e-9  # m from x = 0, within which a vertex is its own image
_MIDDLES = np.array([[0.5, 0.5], [0.0, 0.5], [0.5, 0.0]])  # of the reference triangle's edges, by opposite vertex


@dataclass(frozen=True)
class Snapshot:
    """A state of the whole body on one rank; its lines are parabolas, as the edges of P2 triangles are."""

    x: Array
    """Reference positions of vertices and of the lines' middles (m), shape (points, 2)."""
    u: Array
    """Their displacements (m), shape (points, 2)."""
    triangles: NDArray[np.int64]
    """Vertices of each cell, shape (cells, 3)."""
    sed: Array
    """Mean strain energy density of each cell (J/m^3), shape (cells,)."""
    tag: NDArray[np.int32]
    """Tag of each cell, zero where it has none, shape (cells,)."""
    lines: NDArray[np.int64] = field(default_factory=lambda: np.empty((0, 3), dtype=np.int64))
    """Edges between tags and on the boundary: points where each begins, has its middle and ends, shape (lines, 3)."""
    beside: NDArray[np.int64] = field(default_factory=lambda: np.empty((0, 2), dtype=np.int64))
    """Cells on the left and on the right of each line, -1 outside, shape (lines, 2)."""
    stress: Array = field(default_factory=lambda: np.empty((0, 4)))
    """Mean Cauchy stress of each cell (Pa), components xx, yy, zz and xy, shape (cells, 4)."""
    strain: Array = field(default_factory=lambda: np.empty((0, 3)))
    """Mean Green's strain of each cell, components xx, yy and xy, shape (cells, 3)."""

    def whole(self) -> "Snapshot":
        """Return the body whose half at x >= 0 this is, one body along the line of symmetry."""
        on_line = np.abs(self.x[:, 0]) < _ON_LINE
        image = np.where(on_line, np.arange(len(on_line)), len(on_line) + np.cumsum(~on_line) - 1)
        flip = np.array([-1.0, 1.0])
        off = ~on_line[self.lines].all(axis=1)  # the line of symmetry is none of the whole body
        lines, beside = self.lines[off], self.beside[off]
        other = np.where(beside >= 0, beside + len(self.triangles), -1)
        return Snapshot(
            np.concatenate([self.x, flip * self.x[~on_line]]),
            np.concatenate([self.u, flip * self.u[~on_line]]),
            np.concatenate([self.triangles, image[self.triangles][:, ::-1]]),
            np.concatenate([self.sed, self.sed]),
            np.concatenate([self.tag, self.tag]),
            np.concatenate([lines, image[lines][:, ::-1]]),
            np.concatenate([beside, other]),
            np.concatenate([self.stress, self.stress * [1, 1, 1, -1]]),
            np.concatenate([self.strain, self.strain * [1, 1, -1]]),
        )


class Nodes:
    """Brings values to every rank, numbered as the mesh was before it was distributed.

    Attributes:
        coordinates: nodes of the unloaded mesh (m), shape (nodes, 2).
        triangles: nodes of each cell, shape (cells, 3).
    """

    def __init__(self, problem: "Problem") -> None:
        mesh = problem.mesh
        self._comm, cells = mesh.comm, np.arange(mesh.topology.index_map(2).size_local)
        # The first three degrees of freedom of a Lagrange triangle are its vertices, in the geometry's order.
        self._dofs = problem.V.dofmap.list[cells][:, :3]
        nodes = compat.cell_geometry(mesh)[cells][:, :3]
        names = self._together(np.asarray(mesh.geometry.input_global_indices)[nodes])
        self._sort = np.argsort(self._together(np.asarray(mesh.topology.original_cell_index)[cells]))
        _, self._first, corners = np.unique(names[self._sort].ravel(), return_index=True, return_inverse=True)
        self.triangles = corners.reshape(-1, 3)
        self.coordinates = self._pick(mesh.geometry.x[nodes][:, :, :2])

    def _together(self, mine: NDArray[Any]) -> NDArray[Any]:
        return np.concatenate(self._comm.allgather(mine))

    def by_cell(self, mine: NDArray[Any]) -> NDArray[Any]:
        """Return one value a cell of those of own cells, on every rank; collective."""
        return np.asarray(self._together(mine)[self._sort])

    def _pick(self, mine: Array) -> Array:
        """Return one value a node of values by cell and corner, shape (cells, 3, 2)."""
        return np.asarray(self.by_cell(mine).reshape(-1, 2)[self._first])

    def gather(self, problem: "Problem") -> Array:
        """Return the displacement of all nodes (m), shape (nodes, 2); collective."""
        return self._pick(problem.displacement()[self._dofs])

    def middles(self, problem: "Problem") -> tuple[Array, Array]:
        """Return place and displacement (m) of the middle of each cell's edges, shape (cells, 3, 2) each; collective.

        An edge has the number of the opposite vertex.
        """
        cells = np.arange(len(self._dofs))
        nodes = problem.mesh.geometry.x[compat.cell_geometry(problem.mesh)[cells]][:, :, :2]
        straight = (nodes[:, [1, 0, 0]] + nodes[:, [2, 2, 1]]) / 2
        basis = problem.V.element.basix_element.tabulate(0, _MIDDLES)[0, :, :, 0]
        u = np.einsum("mk,cki->cmi", basis, problem.displacement()[problem.V.dofmap.list[cells]])
        places = nodes[:, 3:] if nodes.shape[1] == 6 else straight
        return self.by_cell(places), self.by_cell(u)


class Lines:
    """The lines of a body, found once, and its states with them; numbered as the mesh was before it was distributed."""

    def __init__(self, problem: "Problem") -> None:
        self._nodes, cells = Nodes(problem), problem.mesh.topology.index_map(2).size_local
        tag = np.zeros(cells, dtype=np.int32)
        own = problem.cell_tags.indices < cells
        tag[problem.cell_tags.indices[own]] = problem.cell_tags.values[own]
        self._tag = self._nodes.by_cell(tag)
        self._ends, self._beside, self._edge = outline(self._nodes.coordinates, self._nodes.triangles, self._tag)

    def snapshot(self, problem: "Problem", fields: bool = True) -> Snapshot | None:
        """Bring the current state to rank 0, None on the others; collective.

        Args:
            problem: on the mesh of these lines.
            fields: whether energy densities, stresses and strains are computed; densities are 0 otherwise.
        """
        nodes, edges = self._nodes, (self._beside[:, 0], self._edge)
        vertices, middles = (nodes.coordinates, nodes.gather(problem)), nodes.middles(problem)
        tensors = [nodes.by_cell(each) for each in tensors_per_cell(problem)] if fields else []
        sed = nodes.by_cell(sed_per_cell(problem)[1]) if fields else np.zeros(len(self._tag))
        if problem.mesh.comm.rank > 0:
            return None
        x, u = (np.concatenate([at, there[edges]]) for at, there in zip(vertices, middles, strict=True))
        middle = len(nodes.coordinates) + np.arange(len(self._ends))
        lines = np.stack([self._ends[:, 0], middle, self._ends[:, 1]], axis=1)
        return Snapshot(x, u, nodes.triangles, sed, self._tag, lines, self._beside, *tensors)
