"""Bodies without a screen: what the cases of solids and elements have in common."""

from collections.abc import Callable, Mapping, Sequence

import dolfinx
import numpy as np
from dolfinx import fem
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from geometry.mesh import TaggedMesh, load
from variational import jit
from variational.body import Body
from variational.contact.penalty import Penalty
from variational.materials.material import Material
from variational.problem import Interface, Problem
from variational.solvers.equations import Equations
from variational.solvers.newton import Solver

Array = NDArray[np.float64]
Solid = Material
Facets = NDArray[np.int32]
Held = tuple[NDArray[np.int32], float]
NOTHING = np.empty(0, dtype=np.int32)  # facets of the bone's rim


def body(build: Callable[[], float], layer: Callable[[Array], Array] | None = None) -> TaggedMesh:
    """Return a mesh; with ``layer`` its cells have the tags that this gives for their midpoints (m), shape (n, 3)."""
    made = load(MPI.COMM_SELF, build)
    if layer is None:
        return made
    cells = np.arange(made.mesh.topology.index_map(2).size_local, dtype=np.int32)
    midpoints = dolfinx.mesh.compute_midpoints(made.mesh, 2, cells)
    cell_tags = dolfinx.mesh.meshtags(made.mesh, 2, cells, layer(midpoints).astype(np.int32))
    return TaggedMesh(made.mesh, cell_tags, made.facet_tags)


def free_problem(made: TaggedMesh, solids: Mapping[int, Solid], element: str) -> Problem:
    """Return the problem of a body that no screen bears: the penalty is zero, and so is the voltage."""
    return Body(made, solids, Interface(Penalty(0.0, 1e11), 0.0, 1e-6), element=element).problem


def nodes_of(problem: Problem, facets: NDArray[np.int32]) -> NDArray[np.int32]:
    """Return the displacement's nodes on facets."""
    return np.asarray(fem.locate_dofs_topological(problem.V, 1, facets))


def held(dofs: NDArray[np.int32], values: Array) -> list[Held]:
    """Return unknowns, each with a value of its own (m), as a solver takes them."""
    return [(np.array([dof], dtype=np.int32), float(value)) for dof, value in zip(dofs, values, strict=True)]


def nodal_forces(problem: Problem) -> Array:
    """Return the forces (N/m) that hold the nodes in the problem's state, shape (nodes, 2)."""
    return np.asarray(fem.assemble_vector(problem.residual).array.reshape(-1, 2))


class FreeEquations(Equations):
    """Those of a body that need not have a bone."""

    def assemble_tangent(self, A: PETSc.Mat) -> None:
        """Make sure that the bone has a diagonal, which nothing else does where no facet is glued to it."""
        for row in self.layout.rigid_rows:
            A.setValue(row, row, 0.0, PETSc.InsertMode.ADD_VALUES)
        super().assemble_tangent(A)


class FreeSolver(Solver):
    """A solver of a body that need not have a bone, with dead loads on its nodes, of which the finger has none.

    Attributes:
        load: nodal forces (N/m) as a vector of unknowns; zero where displacements are prescribed.
    """

    def __init__(
        self, problem: Problem, rim: Facets, force_scale: float, tolerance: float = 1e-9, fixed: Sequence[Held] = ()
    ) -> None:
        """Set the solver up; the arguments are those of :class:`Equations` and :class:`Solver`."""
        super().__init__(FreeEquations(problem, rim, fixed), force_scale, tolerance)
        self.load = self.equations.dead_load

    def set_load(self, form) -> None:
        """Take the nodal forces of a linear form, UFL, in the displacement's test function."""
        self.load.set(0.0)
        self.layout.add_to_unknowns(fem.assemble_vector(fem.form(form, jit_options=jit.OPTIONS)).array, self.load)
        self.load.array_w[self.equations.local(self.equations.prescribed_rows())] = 0.0
        self.equations.load_part = 1.0

    def start(self) -> None:
        """Start from the problem's displacement and, if it has one, pressure; on one rank."""
        self.set_displacement(self.problem.displacement(), np.zeros(2))
        if self.problem.pressure:
            rows = self.problem.pressure.rows(0)
            self.x.array_w[rows[rows >= 0]] = self.problem.pressure.unknown.x.array[rows >= 0]
