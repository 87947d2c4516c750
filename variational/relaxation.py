r"""Viscous layers of a body: the history of their stresses, and the law of the present step.

Each group of layers of one :class:`~variational.materials.viscoelastic.Viscoelastic` law has the fields of history

- ``isochoric stress``, S of the elastic law, and ``overstress 1``, ``overstress 2``, ..., Q of each branch (Pa), with
  the components 11, 22, 12 and 33;
- ``strain``, Green's, with the components 11, 22 and 12, and ``viscous work`` (J/m^3), the work of all Q so far,

  .. math:: w^{n+1} = w^n + \tfrac12 \sum_i (Q_i^n + Q_i^{n+1}) : (E^{n+1} - E^n).

All are values at the quadrature points of the energy, held as the polynomials through them, which other points can
read. The law of the step reads them with the time ``lapse`` that has passed since they were accepted: the duration of
a step on the way to its state, and zero in an accepted state, of whose stress they are then part.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, cast

import basix
import dolfinx
import numpy as np
import ufl
from dolfinx import fem
from mpi4py import MPI
from numpy.typing import NDArray

from variational import compat, jit
from variational.history import BodyField
from variational.kinematics import green_strain, work

if TYPE_CHECKING:
    from variational.materials.material import Material
    from variational.materials.viscoelastic import Viscoelastic

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LayerField(BodyField):
    """Numbers at the quadrature points of some layers, as the polynomial through them; zero in other layers."""

    layers: NDArray[np.int32] = field(default_factory=lambda: np.empty(0, dtype=np.int32))
    """This rank's own cells of these layers."""
    points: Array = field(default_factory=lambda: np.empty((0, 2)))
    """Quadrature points of the reference cell, as many as nodes."""

    @cached_property
    def _at_points(self) -> fem.Expression:
        return fem.Expression(self.update, self.points, jit_options=jit.OPTIONS)

    @cached_property
    def _to_nodes(self) -> Array:
        """Matrix from values at the points to nodal ones."""
        element = self.function.function_space.element.basix_element
        return np.linalg.inv(np.asarray(element.tabulate(0, self.points))[0, :, :, 0])

    def updated(self) -> Array:
        """Return what a step to the present state leaves; collective."""
        space = self.function.function_space
        found = np.zeros((*self.cells.shape, space.dofmap.bs))
        if len(self.layers):
            values = compat.evaluate_on_cells(self._at_points, space.mesh, self.layers)
            found[self.layers] = self._to_nodes @ values.reshape(len(self.layers), len(self.points), -1)
        return self.from_cells(found)

    def at_points(self, values: Array) -> Array:
        """Return values as in ``x.array`` at the points of these layers, shape (cells, points, components)."""
        return np.asarray(np.linalg.inv(self._to_nodes) @ self.by_cell(values)[self.layers])


def relaxations(
    laws: Mapping[tuple[int, ...], "Material"],
    w: fem.Function,
    lapse: fem.Constant,
    cell_tags: dolfinx.mesh.MeshTags,
    quadrature_degree: int,
) -> dict[tuple[int, ...], "Relaxation"]:
    """Return the history of each group of layers whose law is viscous; arguments as in :class:`Relaxation`."""
    return {
        tags: Relaxation(cast("Viscoelastic", law), w, lapse, cell_tags, tags, quadrature_degree)
        for tags, law in laws.items()
        if law.times
    }


def viscous_work(found: Mapping[tuple[int, ...], "Relaxation"], dx: ufl.Measure) -> fem.Form | None:
    """Return the compiled work (J/m) of all viscous stresses so far; None without viscous layers."""
    if not found:
        return None
    return fem.form(sum(each.work.function * dx(tags) for tags, each in found.items()), jit_options=jit.OPTIONS)


class Relaxation:
    """The history of a group of viscous layers.

    Attributes:
        law: of the present step.
        fields: of history.
        work: the viscous work's field.
    """

    def __init__(
        self,
        law: "Viscoelastic",
        w: fem.Function,
        lapse: fem.Constant,
        cell_tags: dolfinx.mesh.MeshTags,
        tags: tuple[int, ...],
        quadrature_degree: int,
    ) -> None:
        """Start from unloaded layers.

        Args:
            law: with fields in the place of its numbers.
            w: displacement (m).
            lapse: time (s) since the history was accepted.
            cell_tags: tags of layers.
            tags: of these layers.
            quadrature_degree: of the energy.
        """
        mesh = w.function_space.mesh
        points = np.asarray(basix.make_quadrature(basix.CellType.triangle, quadrature_degree)[0])
        degree = {1: 0, 3: 1, 6: 2}[len(points)]
        cells = np.concatenate([cell_tags.find(tag) for tag in tags]).astype(np.int32)
        self._own = np.sort(cells[cells < mesh.topology.index_map(2).size_local])
        self._points, self._named = points, ", ".join(map(str, tags))

        def field(components: int) -> fem.Function:
            shape = (components,) if components > 1 else ()
            return fem.Function(fem.functionspace(mesh, ("Discontinuous Lagrange", degree, shape)))

        H, past, before = ufl.grad(w), [field(4) for _ in law.branches], field(4)
        self.law = law.step(lapse, before, list(past))
        now, left = self.law.updated(H)
        spent, stretched = field(1), field(3)
        more = work((sum(past) + sum(left)) / 2, green_strain(H) - stretched)
        self.work = self._field("viscous work", spent + more, spent)
        self.fields = [self._field("isochoric stress", now, before), self._field("strain", green_strain(H), stretched)]
        self.fields += [self._field(f"overstress {k}", *each) for k, each in enumerate(zip(left, past, strict=True), 1)]
        self.fields.append(self.work)

    def _field(self, name: str, update: Any, function: fem.Function) -> LayerField:
        return LayerField(f"{name} of {self._named}", update, function, self._own, self._points)

    def extreme_work(self) -> tuple[float, float]:
        """Return least and largest viscous work (J/m^3) so far at all ranks' points; collective."""
        mine = self.work.at_points(self.work.function.x.array)
        comm = self.work.function.function_space.mesh.comm
        return (
            float(comm.allreduce(float(mine.min(initial=np.inf)), op=MPI.MIN)),
            float(comm.allreduce(float(mine.max(initial=-np.inf)), op=MPI.MAX)),
        )
