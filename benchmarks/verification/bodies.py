"""Bodies of the cases, over the screen and free of it, set up by :class:`variational.body.Body`."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import dolfinx
import numpy as np
import ufl
from dolfinx import fem
from mpi4py import MPI
from numpy.typing import ArrayLike, NDArray
from petsc4py import PETSc

from benchmarks.verification.case import Row, order, order_row
from geometry import tags
from geometry.mesh import TaggedMesh, load
from variational import jit
from variational.body import Body
from variational.contact.augmented import AugmentedLagrangian
from variational.contact.formulation import Formulation
from variational.contact.interface import Interface
from variational.contact.nitsche import Nitsche
from variational.contact.penalty import Penalty
from variational.materials.material import Material
from variational.problem import Problem
from variational.roughness.closure import AirGap, Closure
from variational.solvers.continuation import Continuation
from variational.solvers.equations import Equations
from variational.solvers.newton import Solver

Array = NDArray[np.float64]
Dofs = NDArray[np.int32]
DEGREES = {"P1": 1, "P2": 2, "P2-P1": 2, "P3": 3}  # of the displacement, by element
Errors = tuple[float, float]  # in L2 and H1


# -- over the screen -----------------------------------------------------------------------------------
@dataclass(frozen=True)
class Smooth(Closure):
    """A screen and skin without roughness: one air gap (m) at any pressure."""

    d_eq: float

    def __call__(self, p_c: ArrayLike) -> AirGap:
        return AirGap(self.d_eq + 0 * np.asarray(p_c, dtype=np.float64))


def over_screen(
    build: Callable[[], float],
    solid: Material,
    interface: Interface,
    force: float,
    *,
    sides_held: bool = False,
    closure: Closure = Smooth(1e-6),  # noqa: B008, frozen
    **options: Any,
) -> Continuation:
    """Return a body over the screen, unloaded; residuals are measured in ``force`` (N/m).

    ``sides_held`` keeps its sides from moving sideways; ``options`` are further arguments of :class:`Body`.
    """
    body = load(MPI.COMM_SELF, build)
    held = body.facets(tags.SIDES) if sides_held else None
    solids = {tags.STRATUM_CORNEUM: solid}
    return Body(body, solids, interface, closure, force_scale=force, held=held, **options).continuation


def formulations(stiffness: float, depth: float) -> dict[str, Formulation]:
    """Return the formulations by name, for a stiffness of the skin over a facet (Pa/m) and a depth left over (m)."""
    return {
        "penalty": Penalty(100 * stiffness, 10 * stiffness),
        "Nitsche 1": Nitsche(100.0, 1),
        "Nitsche 0": Nitsche(10.0, 0),
        "Nitsche -1": Nitsche(10.0, -1),
        "augmented Lagrangian": AugmentedLagrangian(100 * stiffness, 10 * stiffness, depth),
    }


# -- without a screen ----------------------------------------------------------------------------------
def body(build: Callable[[], float], layer: Callable[[Array], Array] | None = None) -> TaggedMesh:
    """Return a mesh; ``layer`` gives the tags of its cells from their midpoints (m), shape (n, 3)."""
    made = load(MPI.COMM_SELF, build)
    if layer is None:
        return made
    cells = np.arange(made.mesh.topology.index_map(2).size_local, dtype=np.int32)
    midpoints = dolfinx.mesh.compute_midpoints(made.mesh, 2, cells)
    cell_tags = dolfinx.mesh.meshtags(made.mesh, 2, cells, layer(midpoints).astype(np.int32))
    return TaggedMesh(made.mesh, cell_tags, made.facet_tags)


def free_problem(made: TaggedMesh, solids: Mapping[int, Material], element: str) -> Problem:
    """Return the problem of a body that no screen bears: the penalty is zero, and so is the voltage."""
    return Body(made, solids, Interface(Penalty(0.0, 1e11), 0.0, 1e-6), element=element).problem


class FreeEquations(Equations):
    """Those of a body that need not have a bone."""

    def assemble_tangent(self, A: PETSc.Mat) -> None:
        """Give the bone a diagonal, which it lacks where no facet is glued to it."""
        for row in self.layout.rigid_rows:
            A.setValue(row, row, 0.0, PETSc.InsertMode.ADD_VALUES)
        super().assemble_tangent(A)


class FreeSolver(Solver):
    """A solver of a body that need not have a bone, with dead loads on its nodes."""

    def __init__(self, problem: Problem, rim: Dofs, force_scale: float, tolerance: float = 1e-9) -> None:
        super().__init__(FreeEquations(problem, rim), force_scale, tolerance)

    def set_load(self, form) -> None:
        """Apply the nodal forces of a linear form, UFL, but in prescribed rows."""
        load = self.equations.dead_load
        load.set(0.0)
        self.layout.add_to_unknowns(fem.assemble_vector(fem.form(form, jit_options=jit.OPTIONS)).array, load)
        load.array_w[self.equations.local(self.equations.prescribed_rows())] = 0.0
        self.equations.load_part = 1.0

    def solve_from_fields(self) -> None:
        """Solve, starting from the problem's displacement and, if it has one, pressure; on one rank."""
        self.set_displacement(self.problem.displacement(), np.zeros(2))
        if self.problem.pressure:
            rows = self.problem.pressure.rows(0)
            self.x.array_w[rows[rows >= 0]] = self.problem.pressure.unknown.x.array[rows >= 0]
        self.solve()


# -- orders of convergence -----------------------------------------------------------------------------
def norm(domain: dolfinx.mesh.Mesh, value: Any) -> float:
    """Return the L2 norm of a UFL expression, integrated to degree 10."""
    squared = ufl.inner(value, value) * ufl.dx(domain, metadata={"quadrature_degree": 10})
    return float(np.sqrt(fem.assemble_scalar(fem.form(squared, jit_options=jit.OPTIONS))))


def relative_errors(u: fem.Function, exact: Callable[[Array], Array]) -> Errors:
    """Return the errors of a displacement and of its gradient over the norms of the exact ones, of degree 6 by cell."""
    domain = u.function_space.mesh
    e = fem.Function(fem.functionspace(domain, ("Discontinuous Lagrange", 6, (2,))))
    e.interpolate(exact)
    gradients = norm(domain, ufl.grad(u - e)) / norm(domain, ufl.grad(e))
    return norm(domain, u - e) / norm(domain, e), gradients


def field_orders(found: Mapping[str, Sequence[Errors]], meshes: Sequence[int], tolerance: float, why: str) -> list[Row]:
    """Return the orders on the last two meshes, p + 1 in L2 and p in H1 expected, by element."""
    made = []
    for element, pairs in found.items():
        p = DEGREES[element]
        for name, expected, errors in zip(("L2", "H1"), (p + 1, p), zip(*pairs, strict=True), strict=True):
            finest = f"{meshes[0]} to {meshes[-1]} divisions, last error {errors[-1]:.1e}"
            observed = order(errors[-2:], meshes[-2:])
            made.append(order_row(f"order in {name}, {element}", observed, expected, tolerance, why, finest))
    return made
