r"""The pressure of the mixed element: linear in each triangle, continuous inside a layer, with a jump between layers.

The energy and why: :mod:`variational.element`. The pressure is held as a discontinuous function; that the triangles of
a layer share its values at a vertex is a matter of the numbering, as the rim's nodes are one node
(:mod:`variational.solvers.layout`): the linear system has one unknown for each layer at each of its vertices.
Triangles of layers without a pressure have no unknown at all, so none makes the matrix singular.

The unknown is :math:`\pi = p / s`, a length like the displacement's, and its rows of the residual,

.. math:: \int s \Big(J - 1 - \frac pK\Big) \delta\pi \,dX,

are volume defects times s: nodal forces in N/m like the others, under the one tolerance, and the Jacobian stays
symmetric. :math:`s = \max G_0 / \min h`, the largest shear modulus over the smallest element size: a defect counts as
the force with which the stiffest layer would resist it there. By the stability of the pair it changes displacement
and pressure no more than such a force, whatever the bulk modulus.
"""

import dolfinx
import numpy as np
from dolfinx import fem, la
from numpy.typing import NDArray


class LayerwisePressure:
    """Pressure in some of the layers.

    Attributes:
        unknown: pi (m).
        p: the pressure (Pa), positive in tension.
        owned: number of unknowns that this rank owns.
    """

    def __init__(
        self,
        mesh: dolfinx.mesh.Mesh,
        cell_tags: dolfinx.mesh.MeshTags,
        layers: tuple[int, ...],
        shear_modulus: float,
    ) -> None:
        """Find the vertices of each layer.

        Args:
            mesh: the body (m).
            cell_tags: tags of its layers.
            layers: those with a pressure.
            shear_modulus: the largest of theirs (Pa).
        """
        cells = mesh.topology.index_map(2).size_local
        smallest = np.min(mesh.h(2, np.arange(cells, dtype=np.int32)), initial=np.inf)
        self.unknown = fem.Function(fem.functionspace(mesh, ("Discontinuous Lagrange", 1)))
        scale = shear_modulus / min(mesh.comm.allgather(float(smallest)))
        self.p = fem.Constant(mesh, np.float64(scale)) * self.unknown  # as a number it would be compiled in
        vertices = fem.functionspace(mesh, ("Lagrange", 1))
        self._vertices, self._x = vertices.dofmap, vertices.tabulate_dof_coordinates()[:, :2]
        self._cells = [cell_tags.find(tag) for tag in layers]
        self._touched = [self._owned_vertices(layer[layer < cells]) for layer in self._cells]
        self.owned = int(np.sum(self._touched))

    def _owned_vertices(self, cells: NDArray[np.int32]) -> NDArray[np.bool_]:
        """Return which of this rank's own vertices belong to a cell among those that all ranks name."""
        marks = la.vector(self._vertices.index_map, 1, np.int32)
        marks.array[self._vertices.list[cells]] = 1
        marks.scatter_reverse(la.InsertMode.add)
        return np.asarray(marks.array[: self._vertices.index_map.size_local] > 0)

    def places(self) -> NDArray[np.float64]:
        """Return where this rank's unknowns are (m), and the number of their layer, shape (owned, 3)."""
        layers = [self._x[: len(touched)][touched] for touched in self._touched]
        numbers = np.repeat(np.arange(len(layers), dtype=np.float64), [len(layer) for layer in layers])
        return np.column_stack([np.concatenate([np.empty((0, 2)), *layers]), numbers])

    def rows(self, first: int) -> NDArray[np.int64]:
        """Return the global row of each local degree of freedom of ``unknown``, ghosts included; -1 without one.

        Args:
            first: row of this rank's first pressure.
        """
        rows = np.full(len(self.unknown.x.array), -1, dtype=np.int64)
        dofs = self.unknown.function_space.dofmap.list
        for cells, touched in zip(self._cells, self._touched, strict=True):
            numbers = la.vector(self._vertices.index_map, 1, np.int64)
            numbers.array[: len(touched)] = first + np.cumsum(touched) - 1
            numbers.scatter_forward()
            rows[dofs[cells]] = numbers.array[self._vertices.list[cells]]
            first += int(touched.sum())
        return rows
