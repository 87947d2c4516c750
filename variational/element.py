r"""Elements for skin that hardly changes its volume.

The energy of the skin has two parts, :math:`W = W_{iso}(F) + \frac K2 (J - 1)^2`. As Poisson's ratio nears 1/2 the
second asks for J = 1 wherever it is integrated, and with more such conditions than the displacement can meet the
element locks. By name:

``"P1"``, ``"P2"``
    Displacement alone: the condition at one point of a triangle with three nodes, at three of one with six. The
    first locks; the second only loses an order.
``"P3"``
    The same with ten nodes and six points.
``"P2 reduced"``
    Selective reduced integration: the volumetric part at the centroid alone, the rest at three points. In small
    strain it is the same as a constant pressure on each triangle (Malkus and Hughes 1978,
    doi 10.1016/0045-7825(78)90005-1).
``"P2-P1"``
    A pressure p of its own, positive in tension (perturbed Lagrangian; Sussman and Bathe 1987,
    doi 10.1016/0045-7949(87)90265-3): a stationary point of

    .. math:: \int W_{iso}(F) + p (J - 1) - \frac{p^2}{2K} \,dX,

    so that p = K (J - 1) weakly. u is quadratic; p is linear and continuous inside a layer (Taylor and Hood), but
    jumps from one layer to the next, as the true one does: what is continuous is the traction, not its volumetric
    part. With a pressure continuous throughout, two layers pressed flat would already have a wrong stress.

A law without a volumetric part of its own (Saint Venant-Kirchhoff: nail and bed, nu = 0.3) is integrated in full
in all of them, and has no pressure.

The pressure of the mixed element is held as a discontinuous function; that the triangles of a layer share its values at
a vertex is a matter of the numbering, as the rim's nodes are one node (:mod:`variational.solvers.layout`): the linear
system has one unknown for each layer at each of its vertices. Triangles of layers without a pressure have no unknown at
all, so none makes the matrix singular. The unknown is :math:`\pi = p / s`, a length like the displacement's, and its
rows of the residual,

.. math:: \int s \Big(J - 1 - \frac pK\Big) \delta\pi \,dX,

are volume defects times s: nodal forces in N/m like the others, under the one tolerance, and the Jacobian stays
symmetric. :math:`s = \max G_0 / \min h`, the largest shear modulus over the smallest element size: a defect counts as
the force with which the stiffest layer would resist it there. By the stability of the pair it changes displacement
and pressure no more than such a force, whatever the bulk modulus.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import dolfinx
import numpy as np
import ufl
from dolfinx import fem, la
from numpy.typing import NDArray

from variational import jit
from variational.materials.material import Material


@dataclass(frozen=True)
class Element:
    """How displacement and volume are approximated."""

    degree: int
    """Polynomial degree of the displacement."""
    reduced: bool = False
    """Whether the volumetric energy is integrated at the centroid alone."""
    mixed: bool = False
    """Whether there is a pressure."""

    @property
    def quadrature_degree(self) -> int:
        """Degree up to which energies are integrated: linear elasticity exactly, so that the order is kept."""
        return max(2 * (self.degree - 1), 1)  # strains are of degree p - 1

    @property
    def volumetric_degree(self) -> int:
        """The same for the volumetric part."""
        return 1 if self.reduced else self.quadrature_degree


ELEMENTS = {
    "P1": Element(1),
    "P2": Element(2),
    "P2 reduced": Element(2, reduced=True),
    "P2-P1": Element(2, mixed=True),
    "P3": Element(3),
}


class Centroid:
    r"""Evaluates the gradient of a displacement of degree 2 at most at the centroid of each triangle.

    With the map X(xi) of the reference triangle the derivative :math:`dw/d\xi = \nabla w\, J` is linear in xi, on a
    curved triangle too.
    """

    def __init__(self, mesh: dolfinx.mesh.Mesh) -> None:
        """Find how far the points are from their triangles' centroids, and the map there."""
        self._J = ufl.Jacobian(mesh)
        self._way = fem.Function(fem.functionspace(mesh, ("Discontinuous Lagrange", 1, (2,))))
        corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
        self._way.x.array.reshape(-1, 3, 2)[:] = 1 / 3 - corners
        self._K = fem.Function(fem.functionspace(mesh, ("Discontinuous Lagrange", 0, (2, 2))))
        here = fem.Expression(ufl.inv(self._J), np.full((1, 2), 1 / 3), jit_options=jit.OPTIONS)
        self._K.interpolate(here)
        self._K.x.scatter_forward()

    def value(self, H):
        """Return H (2, 2) at its triangle's centroid."""
        slope = ufl.dot(ufl.grad(ufl.dot(H, self._J)), self._J)
        return ufl.dot(ufl.dot(H, self._J) + ufl.dot(slope, self._way), self._K)


class LayerwisePressure:
    """The mixed element's pressure in some of the layers: linear in each triangle, with a jump between layers.

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


def grouped(
    solids: Mapping[int, Material], cellwise: fem.FunctionSpace, cell_tags: dolfinx.mesh.MeshTags
) -> dict[tuple[int, ...], Material]:
    """Return the law of each group of layers, with fields in the place of its numbers.

    Args:
        solids: material of each layer's tag.
        cellwise: space of one number a cell.
        cell_tags: tags of layers.

    Raises:
        ValueError: a material that is none; in one sentence.
    """
    groups: list[list[int]] = []
    for tag, solid in solids.items():
        solid.check()
        mine = next((g for g in groups if solids[g[0]].kind() == solid.kind()), None)
        groups.append([tag]) if mine is None else mine.append(tag)

    found: dict[tuple[int, ...], Material] = {}
    for group in groups:
        first = solids[group[0]]
        found[tuple(group)] = first.with_values({name: fem.Function(cellwise) for name in first.names()})
    write(found, solids, cell_tags)
    return found


def write(
    laws: Mapping[tuple[int, ...], Material], solids: Mapping[int, Material], cell_tags: dolfinx.mesh.MeshTags
) -> None:
    """Write the numbers of each layer's material into the fields of laws by group, as of :func:`grouped`."""
    for tags, law in laws.items():
        for name in solids[tags[0]].names():
            field = law.number(name)
            for tag in tags:
                field.x.array[cell_tags.find(tag)] = solids[tag].number(name)
            field.x.scatter_forward()
