"""Residual and tangent of a load: the weak form in the solver's unknowns, with rows that are prescribed."""

from collections.abc import Sequence

import numpy as np
from dolfinx import fem
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from variational.problem import Problem
from variational.solvers.layout import RigidRimLayout
from variational.solvers.outcome import OUTSIDE, Timings
from variational.solvers.target import Control

Array = NDArray[np.float64]
Rows = NDArray[np.int64]


class Equations:
    """Out-of-balance forces of a problem and their derivative, by the unknowns of a layout.

    Attributes:
        layout: numbering of the unknowns.
        skin: local unknowns of the skin that can touch: horizontal, vertical.
        control: what is prescribed of the bone.
        stiffness: what a prescribed row's metre is worth in N/m (Pa).
        reaction: on the bone of the whole body (N/m), shape (2,), by the last residual.
        dead_load: nodal forces (N/m) that act whatever the displacement, but in prescribed rows.
        load_part: part of them that acts.
        inverted: elements were turned inside out by an iterate since this was last set.
        not_a_number: field of such an iterate that held no number; empty if none did.
        timings: seconds by phase.
    """

    def __init__(
        self,
        problem: Problem,
        rim_facets: NDArray[np.int32],
        fixed: Sequence[tuple[NDArray[np.int32], float]] = (),
        moving_sides: NDArray[np.int32] | None = None,
        mirror: NDArray[np.int32] | None = None,
    ) -> None:
        """Number the unknowns.

        Args:
            problem: forms.
            rim_facets: the facets glued to the bone.
            fixed: further prescribed unknowns: (local indices, displacement in m).
            moving_sides: the lateral facets of a cell, which move sideways with the bone and freely up and down. In
                normal contact that is the symmetry of one of many equal ridges. In sliding it leaves out the shear of
                the column on which the ridge stands.
            mirror: the facets at x = 0 known to this rank if the body is but the half at x >= 0 of one that is its own
                mirror image; forces are those of the whole.
        """
        self.problem, self.control, self.timings = problem, Control(), Timings()
        self.layout = layout = RigidRimLayout(problem.V, rim_facets, problem.pressure)
        self._first_row = int(layout.create_vector().getOwnershipRange()[0])
        # Of the whole body's reaction in x and y, over the part's: the halves' horizontal ones cancel.
        self._copies = np.ones(2) if mirror is None else np.array([0.0, 2.0])
        self._antisymmetric: Rows | None = None
        if mirror is not None:
            on_line = fem.locate_dofs_topological(problem.V, 1, mirror)
            fixed = [*fixed, (2 * on_line, 0.0)]
            self._antisymmetric = self._own_rows(2 * on_line + 1)
        self._fixed_rows = np.concatenate([np.empty(0, PETSc.IntType), *(self._own_rows(dofs) for dofs, _ in fixed)])
        self._fixed_values = np.concatenate(
            [np.empty(0), *(np.full(len(self._own_rows(dofs)), value) for dofs, value in fixed)]
        )
        self._side_rows: Rows = np.empty(0, PETSc.IntType)
        if moving_sides is not None:
            self._side_rows = self._own_rows(2 * fem.locate_dofs_topological(problem.V, 1, moving_sides))
        nodes = fem.locate_dofs_topological(problem.V, 1, problem.surface.facets)
        self.skin = 2 * nodes, 2 * nodes + 1
        self.holds_skin = False
        self._held_skin: tuple[Rows, Array] = np.empty(0, PETSc.IntType), np.empty(0)
        self.stiffness = 1e5
        self.reaction: Array = np.zeros(2)
        self.dead_load = layout.create_vector()
        self.load_part = 0.0
        self.inverted, self.not_a_number = False, ""
        self._nodal = np.zeros_like(problem.w.x.array)
        self._defects = np.zeros_like(problem.pressure.unknown.x.array) if problem.pressure else np.empty(0)

    # -- rows ------------------------------------------------------------------------------------------
    def _own_rows(self, dofs: NDArray[np.int32]) -> Rows:
        """Return the global rows of local unknowns that are this rank's, the bone's left out."""
        rows = self.layout.rows[dofs] - self._first_row
        mine = (rows >= 0) & (rows < self.layout.local_size) & ~np.isin(self.layout.rows[dofs], self.layout.rigid_rows)
        return np.asarray(self.layout.rows[dofs][mine])

    def local(self, rows: Rows) -> Rows:
        """Return where rows of this rank, by their global numbers, are in its part of a vector."""
        return rows - self._first_row

    def skin_rows(self, directions: Sequence[int] = (0, 1)) -> Rows:
        """Return this rank's rows of the displacements, in x (0) and y (1), of the skin that can touch."""
        return self._own_rows(np.concatenate([self.skin[k] for k in directions]))

    def prescribed(self) -> tuple[Rows, Array]:
        """Return this rank's prescribed rows (global) and their values (m)."""
        sides = np.full(len(self._side_rows), self.control.x)
        rows = [self._fixed_rows, self._side_rows, self._held_skin[0]]
        values = [self._fixed_values, sides, self._held_skin[1]]
        if self.layout.owns_rigid:
            bone = self.control.translation
            rows.append(self.layout.rigid_rows[: len(bone)])
            values.append(np.array(bone))
        return np.concatenate(rows), np.concatenate(values)

    def prescribed_rows(self) -> Rows:
        """Return the global numbers of this rank's prescribed rows."""
        return self.prescribed()[0]

    def antisymmetric_rows(self) -> Rows | None:
        """Return this rank's rows that are zero in disturbances which the mirror turns round; None without mirror."""
        if self._antisymmetric is None or not self.layout.owns_rigid:
            return self._antisymmetric
        return np.concatenate([self._antisymmetric, self.layout.rigid_rows])

    # -- residual and tangent --------------------------------------------------------------------------
    def to_fields(self, x: PETSc.Vec) -> None:
        """Write unknowns into the problem's fields: displacement, bone and, if it has one, pressure."""
        w = self.problem.w.x.array
        self.layout.to_nodes(x, w)
        w.reshape(-1, 2)[self.layout.rim] = 0.0
        self.problem.bone.value[:] = self.layout.rigid_part(x)
        if self.problem.pressure:
            self.layout.to_pressure(x, self.problem.pressure.unknown.x.array)

    def residual(self, x: PETSc.Vec, f: PETSc.Vec, part: fem.Form | None = None) -> None:
        """Write the out-of-balance forces (N/m) of an iterate into a vector; collective.

        Args:
            x: unknowns.
            f: the forces.
            part: the problem's residual over some of the cells; the forces are those of nodes that have no other cell.
        """
        with self.timings.phase("assembly"):
            self.to_fields(x)
            self._nodal[:] = 0.0
            fem.assemble_vector(self._nodal, part or self.problem.residual)
            f.set(0.0)
            self.layout.add_to_unknowns(self._nodal, f)
            if self.problem.pressure:
                self._defects[:] = 0.0
                fem.assemble_vector(self._defects, self.problem.pressure_residual)
                self.layout.add_to_pressure(self._defects, f)
            finite = self.layout.comm.allreduce(bool(np.isfinite(f.array_r).all()), op=MPI.LAND)
            if not finite:
                self._blame(x)
                f.set(OUTSIDE / np.sqrt(self.layout.global_size))
                return
            self.reaction = -self._copies * self.layout.rigid_part(f)
            if self.layout.owns_rigid and self.control.y is None:
                f.array_w[-1] += self.control.force / self._copies[1]
            if self.load_part:
                f.axpy(-self.load_part, self.dead_load)
            rows, values = self.prescribed()
            local = self.local(rows)
            f.array_w[local] = self.stiffness * (self.layout.moved(x, local, self.problem.bone.value) - values)

    def forces(self, form: fem.Form, f: PETSc.Vec) -> None:
        """Write a form in the displacement's test function into a vector, zero in prescribed rows; collective."""
        self._nodal[:] = 0.0
        fem.assemble_vector(self._nodal, form)
        f.set(0.0)
        self.layout.add_to_unknowns(self._nodal, f)
        f.array_w[self.local(self.prescribed_rows())] = 0.0

    def _blame(self, x: PETSc.Vec) -> None:
        """Find out why a residual is not finite; collective."""
        suspects = {
            "displacement": x.array_r,
            "air gaps": self.problem.d_eq.x.array,
        }
        if self.problem.anchor is not None:
            suspects["history"] = self.problem.anchor.x.array
        for name, values in suspects.items():
            if not self.layout.comm.allreduce(bool(np.isfinite(values).all()), op=MPI.LAND):
                self.not_a_number = name
                return
        self.inverted = True

    def assemble_tangent(self, A: PETSc.Mat) -> None:
        """Add the derivative of the residual, without regard to prescribed rows, to an empty matrix."""
        blocks = [self.problem.jacobian]
        if self.problem.pressure:
            blocks += self.problem.pressure_jacobian
        for form, part in zip(blocks, ((0, 0), (0, 1), (1, 0), (1, 1)), strict=False):
            self.layout.add_to_matrix(A, form, part)
        A.assemble()

    # -- a state that is no equilibrium ----------------------------------------------------------------
    def hold(self, x: PETSc.Vec, skin: bool = False) -> None:
        """Let a dead load act that balances a state, all of it; lower :attr:`load_part` to take it away.

        Args:
            x: the state.
            skin: the skin that can touch is held where it is, too.
        """
        self.release()
        self.residual(x, self.dead_load)
        self.load_part = 1.0
        if skin:
            rows = self.skin_rows()
            self._held_skin = rows, self.layout.moved(x, self.local(rows), self.problem.bone.value)
            self.holds_skin = True

    def release(self) -> None:
        """Take away what :meth:`hold` added."""
        self.load_part, self._held_skin = 0.0, (np.empty(0, PETSc.IntType), np.empty(0))
        self.holds_skin = False
