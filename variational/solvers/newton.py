r"""Newton's method by PETSc SNES on the displacement and the bone's translation together.

The unknowns are the bone's translation and the displacement relative to it (:mod:`~variational.problem`). The tangent
is that of the displacement itself, which is sparser: a step that a factorisation proposes is made relative to the bone
right after it (:class:`_Relative`).

Full steps: with a stiff penalty the iteration is an active-set method, whose residual rises before the right points
are in contact, and backtracking on the residual only slows it. But the first steps of a solve are shortened where
they would drive open skin deep through the screen, of which the tangent knows nothing, and any step is halved that
would turn elements inside out or send the residual up tenfold. A factorisation serves as long as the residual falls
to half an iteration; a step it proposes is refused when the residual would rise, and made anew with the tangent of
the present iterate. The first tangent of a load is always that of the state it starts from, so that the first iterate
is the tangent predictor. A residual that stalls within some units of roundoff of the forces that cancel in it is at its
floor, and the solve ends as converged there; :attr:`Solver.floor` says where that was.

Where the iteration does not get ahead, points on the friction cone are first taken for slipping instead of sticking, or
the other way round. Where only friction stays out of balance, its springs are softened and stiffened again step by
step. Or, if the caller asks for it, a part of the skin is taken to be about to jump on or off the screen, where the
tangent has a negative direction, and the solve is repeated as pseudo-transient continuation (Kelley and Keyes 1998, doi
10.1137/S0036142996304796): the tangent gets a shift :math:`\eta` on the touching skin, an implicit Euler step of
:math:`\eta \dot u = -r(u)`, and eta falls as the residual falls. It creeps away from the equilibrium that is lost and
ends in one of the unchanged equations.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from dolfinx import fem
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from variational.problem import SLIPS, STICKS, Problem
from variational.solvers.failure import snes_failure
from variational.solvers.layout import RigidRimLayout
from variational.solvers.timing import Counts, Timings

Array = NDArray[np.float64]
PREFIX = "fingerpad_"
# MUMPS, an LU of an unsymmetric matrix; full Newton steps, see above.
DEFAULTS = {
    "snes_type": "newtonls",
    "snes_linesearch_type": "basic",
    "snes_max_it": "60",
    "snes_rtol": "0",
    "snes_stol": "0",
    "ksp_type": "preonly",
    "pc_type": "lu",
    "pc_factor_mat_solver_type": "mumps",
}
_OUTSIDE = 1e30  # N/m: norm of the residual where J <= 0 somewhere
_PATIENCE = 4  # iterations in which the least residual must fall
_CONTRACTS = 0.5  # reduction of the residual an iteration below which a factorisation is kept
_DEEPEST = 1e-6  # m, how deep open skin may be driven by one of the first steps
_LIMITED_STEPS = 6
_HALVINGS = 5  # of a step that would turn elements inside out or
_GROWS = 10.0  # make the residual grow more than this
_ROUNDINGS = 4.0  # units of roundoff of the sum of each node's absolute forces, within which a residual may stall,
_FLOOR = 1e-6  # if that is less than this part of the force scale
_SIDEWAYS = 0.95  # part of the last residual that is friction's, above which points do not come to stick (0.999 where
# they did not, at most 0.62 where ridges jumped);
_EASE = 0.01  # part of the tangential stiffness to begin with then,
_STIFFER, _LEAST_STIFFER = 4.0, 1.05  # by how much it is raised at a time, and at least
_SHIFT = 2e9  # Pa/m, eta at the start
_SHIFT_FALL, _SHIFT_RISE = 0.4, 4.0  # of eta an iteration


class _Relative:
    """The derivative of the residual by the relative unknowns: the tangent K after their change to displacements."""

    def __init__(self, layout: RigidRimLayout, K: PETSc.Mat) -> None:
        self.layout, self.K = layout, K
        self._moved = layout.create_vector()

    def mult(self, A: PETSc.Mat, x: PETSc.Vec, y: PETSc.Vec) -> None:
        """Multiply by a step of the relative unknowns; PETSc's name."""
        x.copy(self._moved)
        self.layout.translate(self._moved, self.layout.rigid_part(x))
        self.K.mult(self._moved, y)

    def after_solve(self, ksp: PETSc.KSP, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Make the solution of K x = b relative to the bone; what a failed factorisation leaves stays as it is."""
        if ksp.getConvergedReason() > 0:
            self.layout.translate(x, -self.layout.rigid_part(x))


@dataclass
class Control:
    """What is prescribed of the bone: its translation in x, and in y either a translation or a force."""

    x: float = 0.0
    """Translation (m)."""
    y: float | None = 0.0
    """Translation (m), or None under force control."""
    force: float = 0.0
    """External force per length pressing down (N/m), where y is None."""


class Solver:
    """Solves a :class:`Problem` for given loads; owns the vectors SNES works on.

    Attributes:
        control: what is prescribed of the bone.
        force_scale: force per length (N/m) in which residuals are measured.
        stiffness: what a prescribed row's metre is worth in N/m (Pa).
        counts: work done so far.
        held: part of the forces :meth:`hold` took note of that still acts.
        floor: norm of the nodal forces' imbalance over ``force_scale`` with which the last solve ended at the floor of
            roundoff, above its tolerance; zero if it met that.
    """

    def __init__(
        self,
        problem: Problem,
        rim_facets: NDArray[np.int32],
        force_scale: float,
        tolerance: float = 1e-9,
        fixed: Sequence[tuple[NDArray[np.int32], float]] = (),
        mirror: NDArray[np.int32] | None = None,
    ) -> None:
        """Set SNES up.

        Args:
            problem: forms.
            rim_facets: the facets glued to the bone.
            force_scale: force per length (N/m) in which residuals are measured.
            tolerance: norm of the nodal forces' imbalance (N/m) at convergence, over ``force_scale``; volume defects
                count as forces, see :mod:`variational.pressure`.
            fixed: further prescribed unknowns: (local indices, displacement in m).
            mirror: the facets at x = 0 known to this rank if the body is but the half at x >= 0 of one that is its own
                mirror image; forces are those of the whole.
        """
        self.problem, self.control, self.counts = problem, Control(), Counts()
        self.layout = RigidRimLayout(problem.V, rim_facets, problem.pressure)
        self.timings = Timings()
        self._first_row = int(self.layout.create_vector().getOwnershipRange()[0])
        # Of the whole body's reaction in x and y, over the part's: the halves' horizontal ones cancel.
        self._copies = np.ones(2) if mirror is None else np.array([0.0, 2.0])
        self._antisymmetric: NDArray[np.int64] | None = None
        if mirror is not None:
            on_line = fem.locate_dofs_topological(problem.V, 1, mirror)
            fixed = [*fixed, (2 * on_line, 0.0)]
            self._antisymmetric = self._own_rows(2 * on_line + 1)
        self._fixed_rows = np.concatenate([np.empty(0, PETSc.IntType), *(self._own_rows(dofs) for dofs, _ in fixed)])
        self._fixed_values = np.concatenate(
            [np.empty(0), *(np.full(len(self._own_rows(dofs)), value) for dofs, value in fixed)]
        )
        self.reaction: Array = np.zeros(2)
        self._inverted = self._shifted = False
        self._not_a_number = ""  # what is not, in the iterate last rejected
        self._control_rows = False
        self._on_cone = True  # whether points may be on the friction cone
        self._stale = True  # whether the factorisation must be made anew before it is used
        self._kept = False  # whether the present iteration uses a factorisation made before it
        self._refused = False  # whether the present iteration stayed where it was
        self._ahead = False  # whether the residual of the next iterate is known
        self._norms: list[float] = []
        self.force_scale, self.stiffness = force_scale, 1e5
        self._nodal = np.zeros_like(problem.w.x.array)
        self._defects = np.zeros_like(problem.pressure.unknown.x.array) if problem.pressure else np.empty(0)
        nodes = fem.locate_dofs_topological(problem.V, 1, problem.surface.facets)
        self._skin = 2 * nodes + 1  # vertical displacements of the skin that can touch
        self._skin_height = problem.V.tabulate_dof_coordinates()[nodes, 1]
        self._skin_rows = self._own_rows(np.concatenate([2 * nodes, 2 * nodes + 1]))
        self._skin_rows_x = self._own_rows(2 * nodes)
        self._skin_place: Array | None = None  # displacements (m) that they are held at
        self.x = self.layout.create_vector()
        self._f, self._next_x, self._next_f, self._unbalanced, self._moved = (
            self.layout.create_vector() for _ in range(5)
        )
        self.held = self.floor = 0.0
        self._K = self.layout.create_matrix()
        self._relative = _Relative(self.layout, self._K)
        self.jacobian = PETSc.Mat().createPython(self._K.getSizes(), self._relative, comm=self.layout.comm)
        self._snes = self._create_snes(force_scale * tolerance)

    def _create_snes(self, imbalance: float) -> PETSc.SNES:
        options = PETSc.Options()
        for name, value in DEFAULTS.items():
            if not options.hasName(PREFIX + name):
                options.setValue(PREFIX + name, value)
        snes = PETSc.SNES().create(self.layout.comm)
        snes.setOptionsPrefix(PREFIX)
        snes.setTolerances(atol=imbalance)
        snes.setFunction(self._residual, self._f)
        snes.setJacobian(self._jacobian, self.jacobian, self._K)
        snes.setConvergenceTest(self._test)
        snes.setLineSearchPreCheck(self._limit)
        snes.setFromOptions()
        snes.getKSP().setPostSolve(self._relative.after_solve)
        return snes

    def _own_rows(self, dofs: NDArray[np.int32]) -> NDArray[np.int64]:
        """Return the global rows of local unknowns that are this rank's, the bone's left out."""
        rows = self.layout.rows[dofs] - self._first_row
        mine = (rows >= 0) & (rows < self.layout.local_size) & ~np.isin(self.layout.rows[dofs], self.layout.rigid_rows)
        return np.asarray(self.layout.rows[dofs][mine])

    # -- callbacks -------------------------------------------------------------------------------------
    def _prescribed(self) -> tuple[NDArray[np.int64], Array]:
        """Return this rank's prescribed rows (global) and their values (m)."""
        rows, values = self._fixed_rows, self._fixed_values
        if self._skin_place is not None:
            rows, values = np.concatenate([rows, self._skin_rows]), np.concatenate([values, self._skin_place])
        if self.layout.owns_rigid:
            bone = [self.control.x] if self.control.y is None else [self.control.x, self.control.y]
            rows = np.concatenate([rows, self.layout.rigid_rows[: len(bone)]])
            values = np.concatenate([values, bone])
        return rows, values

    def to_fields(self, x: PETSc.Vec) -> None:
        """Write unknowns into the problem's fields: displacement, bone and, if it has one, pressure."""
        w = self.problem.w.x.array
        self.layout.to_nodes(x, w)
        w.reshape(-1, 2)[self.layout.rim] = 0.0
        self.problem.bone.value[:] = self.layout.rigid_part(x)
        if self.problem.pressure:
            self.layout.to_pressure(x, self.problem.pressure.unknown.x.array)

    def set_displacement(self, u: Array, bone: Array) -> None:
        """Start from a displacement (m) of all nodes, shape (nodes, 2), and the bone's translation (m), (2,)."""
        self.layout.from_nodes((u - bone).ravel(), bone, self.x)
        self.to_fields(self.x)

    def _residual(self, snes: PETSc.SNES | None, x: PETSc.Vec, f: PETSc.Vec) -> None:
        if self._ahead:  # the step's length was found with it
            self._ahead = False
            self._next_f.copy(f)
            return
        with self.timings.phase("assembly"):
            self.to_fields(x)
            self._nodal[:] = 0.0
            fem.assemble_vector(self._nodal, self.problem.residual)
            f.set(0.0)
            self.layout.add_to_unknowns(self._nodal, f)
            if self.problem.pressure:
                self._defects[:] = 0.0
                fem.assemble_vector(self._defects, self.problem.pressure_residual)
                self.layout.add_to_pressure(self._defects, f)
            finite = self.layout.comm.allreduce(bool(np.isfinite(f.array_r).all()), op=MPI.LAND)
            if not finite:
                self._blame(x)
                f.set(_OUTSIDE / np.sqrt(self.layout.global_size))
                return
            self.reaction = -self._copies * self.layout.rigid_part(f)
            if self.layout.owns_rigid and self.control.y is None:
                f.array_w[-1] += self.control.force / self._copies[1]
            if self.held:
                f.axpy(-self.held, self._unbalanced)
            rows, values = self._prescribed()
            x.copy(self._moved)
            self.layout.translate(self._moved, self.problem.bone.value)
            local = rows - self._first_row
            f.array_w[local] = self.stiffness * (self._moved.array_r[local] - values)

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
                self._not_a_number = name
                return
        self._inverted = True

    def _jacobian(self, snes: PETSc.SNES | None, x: PETSc.Vec, A: PETSc.Mat, K: PETSc.Mat) -> None:
        self._kept = not (self._stale or self._shifted)
        if self._kept:
            return
        with self.timings.phase("assembly"):
            K.zeroEntries()
            self.assemble_tangent(K)
            K.zeroRows(self._prescribed()[0], diag=self.stiffness)
        self.counts.factorisations += 1
        self._stale = False

    def assemble_tangent(self, A: PETSc.Mat) -> None:
        """Add the derivative of the residual, without a word of prescribed rows, to an empty matrix."""
        blocks = [self.problem.jacobian]
        if self.problem.pressure:
            blocks += self.problem.pressure_jacobian
        for form, part in zip(blocks, ((0, 0), (0, 1), (1, 0), (1, 1)), strict=False):
            self.layout.add_to_matrix(A, form, part)
        A.assemble()

    def _test(self, snes: PETSc.SNES, iteration: int, norms: tuple[float, float, float]) -> int:
        """Judge an iterate by its residual alone, and set the next shift."""
        reason, eta = PETSc.SNES.ConvergedReason, self.problem.eta
        _, atol, _, most = snes.getTolerances()
        if iteration == 0:
            self._norms, self._refused = [], False
            eta.value = _SHIFT if self._shifted else 0.0
        previous = self._norms[-1] if self._norms else np.inf
        norm = norms[2]
        if not self._refused:
            self._norms.append(norm)
        self.floor = 0.0
        if norm <= atol:
            return reason.CONVERGED_FNORM_ABS
        if norm >= _OUTSIDE / 2:
            return reason.DIVERGED_FUNCTION_DOMAIN
        if iteration >= most:
            return reason.DIVERGED_MAX_IT
        if iteration > 0:
            self._stale = self._refused or norm > _CONTRACTS * previous
            if self._stale and norm <= self._roundoff(norm):
                self.floor = norm / self.force_scale
                return reason.CONVERGED_SNORM_RELATIVE
        if self._shifted and iteration > 0:
            eta.value *= min(norm / previous, _SHIFT_RISE) if norm > previous else _SHIFT_FALL
        # The first norm is left out: it may hold a prescribed displacement not yet made.
        late, early = self._norms[1:][-_PATIENCE:], self._norms[1:][-2 * _PATIENCE : -_PATIENCE]
        if not self._shifted and len(early) == _PATIENCE and min(late) > 0.7 * min(early):
            return reason.DIVERGED_LOCAL_MIN  # cycles
        return reason.ITERATING

    def _roundoff(self, norm: float) -> float:
        r"""Return the norm of nodal forces (N/m) that roundoff may leave in the present iterate.

        Each force is a sum of parts that cancel. Their magnitudes are those of the tangent times the relative
        displacement, so that the roundoff of all of them is some units of
        :math:`\epsilon \, \| |K| |w| \|`. Measured from the first touch to 10 mm of sliding: 0.13 to 0.4 of it.

        Args:
            norm: of the residual (N/m); where it is too large to be accepted as roundoff, zero is returned.
        """
        if norm > _FLOOR * self.force_scale:
            return 0.0
        x, comm = self._snes.getSolution(), self.layout.comm
        scatter, everywhere = PETSc.Scatter.toAll(x)
        scatter.scatter(x, everywhere, mode=PETSc.ScatterMode.FORWARD)
        w = np.abs(everywhere.array_r)
        w[self.layout.rigid_rows] = 0.0  # a translation of all nodes makes no force between them
        start, columns, values = self._K.getValuesCSR()
        parts = np.append(np.abs(values) * w[columns], 0.0)
        sums = np.add.reduceat(parts, start[:-1]) if len(start) > 1 else np.zeros(0)
        total = comm.allreduce(float(sums @ sums))
        return float(_ROUNDINGS * np.finfo(float).eps * np.sqrt(total))

    def _limit(self, x: PETSc.Vec, step: PETSc.Vec) -> bool:
        """Shorten a step where its tangent knows nothing of what it would lead to."""
        if len(self._norms) <= _LIMITED_STEPS:
            step.scale(self._until_deep(x, step))
        norm = self._look_ahead(x, step)
        for _ in range(_HALVINGS):
            if norm < _GROWS * max(self._norms):
                break
            step.scale(0.5)
            norm = self._look_ahead(x, step)
        self._refused = self._kept and len(self._norms) > 1 and norm > self._norms[-1]
        if self._refused:
            step.set(0.0)
            self._look_ahead(x, step)
        self._ahead = True
        return True

    def _look_ahead(self, x: PETSc.Vec, step: PETSc.Vec) -> float:
        """Evaluate the residual where a step leads, and return its norm."""
        self._next_x.waxpy(-1.0, step, x)
        self._residual(None, self._next_x, self._next_f)
        return float(self._next_f.norm())

    def _until_deep(self, x: PETSc.Vec, step: PETSc.Vec) -> float:
        """Return the part of a step that drives open skin at most a little through the screen."""
        self.layout.to_nodes(x, self._nodal)
        height = self._skin_height + self._nodal[self._skin] + self.layout.rigid_part(x)[1]
        self.layout.to_nodes(step, self._nodal)
        sink = self._nodal[self._skin] + self.layout.rigid_part(step)[1]  # PETSc subtracts the step
        deep = (height > 0) & (height - sink < -_DEEPEST)
        part = float(np.min((height[deep] + _DEEPEST) / sink[deep], initial=1.0))
        return float(self.layout.comm.allreduce(part, op=MPI.MIN))

    # -- use -------------------------------------------------------------------------------------------
    def new_load(self, control: Control, voltage: float, slipping: bool = False, on_cone: bool = True) -> None:
        """Prescribe a load; the next solve starts from the tangent of the present state, not from a kept one.

        Args:
            control: what is prescribed of the bone.
            voltage: (V).
            slipping: points on the friction cone are first taken for slipping on, not for sticking.
            on_cone: whether there are any, as the last accepted state of a path leaves; else no other guess is tried.
        """
        self.control, self.problem.voltage.value = control, voltage
        self.problem.guess.value = SLIPS if slipping else STICKS
        self._on_cone = on_cone
        self._stale = True

    def hold(self, skin: bool = False) -> None:
        """Let forces act that balance the present state; :attr:`held` says how much of them.

        Lowered from one to zero bit by bit it leads from any state to an equilibrium (Newton's homotopy; Allgower and
        Georg 1990, doi 10.1007/978-3-642-61257-2).

        Args:
            skin: the skin that can touch is held where it is, too.
        """
        self.release()
        self._residual(None, self.x, self._f)
        self._f.copy(self._unbalanced)
        self.held = 1.0
        if skin:
            self.x.copy(self._moved)
            self.layout.translate(self._moved, self.bone)
            self._skin_place = self._moved.array_r[self._skin_rows - self._first_row].copy()

    def release(self) -> None:
        """Let go of all that :meth:`hold` held."""
        self.held, self._skin_place = 0.0, None

    def solve(self, creep: bool = False) -> None:
        """Find the equilibrium near ``x`` for the current loads and leave it in ``x`` and the problem's u.

        Args:
            creep: repeat as pseudo-transient continuation what full Newton steps do not manage, instead of with
                the other guess for the points on the friction cone.

        Raises:
            NotConverged: with SNES's reason; ``x`` is then the last iterate.
        """
        start = self.x.array_r.copy()
        self._inverted, self._not_a_number = False, ""
        reason = self._run(shifted=False)
        friction = self.problem.anchor is not None
        if reason <= 0 and not creep and friction and self._on_cone:  # the other guess for them, which is then kept
            self.x.array_w[:] = start
            self.problem.guess.value = SLIPS if self.problem.guess.value == STICKS else STICKS
            self._stale = True
            reason = self._run(shifted=False)
        if reason <= 0 and friction and self._sideways() > _SIDEWAYS:
            reason = self._ease(start)
        if reason <= 0 and creep:
            self.counts.pseudo_transient += 1
            self.x.array_w[:] = start
            reason = self._run(shifted=True)
        if reason <= 0:
            raise snes_failure(self._snes, self._inverted, self._not_a_number)

    def _ease(self, start: Array) -> int:
        """Solve with softened tangential springs and stiffen them step by step; return SNES's reason.

        A point sticks while its elastic slip is below t_max / gamma_t: 0.1 nm at a friction coefficient of 0.002.
        Where that is far less than a facet moves in an iteration, Newton's method throws the point from slipping one
        way to slipping the other way and back. With softer springs the point comes to stick, and it stays so while the
        springs are stiffened. The last solve is that of the unchanged equations.
        """
        ease, part, ratio = self.problem.ease, 0.0, _STIFFER
        try:
            while part < 1 and ratio > _LEAST_STIFFER:
                ease.value = min(part * ratio, 1.0) if part else _EASE
                self.x.array_w[:] = start
                self._stale = True
                reason = self._run(shifted=False)
                if reason > 0:
                    part, start = float(ease.value), self.x.array_r.copy()
                elif part:
                    ratio = np.sqrt(ratio)
                else:
                    break
        finally:
            ease.value = 1.0
        return reason

    def _sideways(self) -> float:
        """Return the part of the present residual's norm that is sideways on the skin that can touch; collective."""
        sideways = self._f.array_r[self._skin_rows_x - self._first_row]
        own = self.layout.comm.allreduce(float(sideways @ sideways))
        whole = float(self._f.norm())
        return float(np.sqrt(own)) / whole if whole > 0 else 0.0

    def _run(self, shifted: bool) -> int:
        self._shifted = shifted
        self._stale |= shifted or self._control_rows != (self.control.y is None)
        self._control_rows = self.control.y is None
        assembly = self.timings.seconds["assembly"]
        with self.timings.phase("factorisation"):
            self._snes.solve(None, self.x)
        self.timings.seconds["factorisation"] -= self.timings.seconds["assembly"] - assembly
        self.counts.newton += self._snes.getIterationNumber()
        self._stale |= shifted
        self.problem.eta.value = 0.0
        reason = int(self._snes.getConvergedReason())
        self._ahead = False
        # Nodes and reaction are those of a rejected iterate, or of one that another solver than Newton's went on from.
        if reason <= 0 or self._snes.getType() != PETSc.SNES.Type.NEWTONLS:
            self._residual(None, self.x, self._f)
        return reason

    def prescribed_rows(self) -> NDArray[np.int64]:
        """Return the global numbers of this rank's prescribed rows."""
        return self._prescribed()[0]

    def antisymmetric_rows(self) -> NDArray[np.int64] | None:
        """Return this rank's rows that are zero in disturbances which the mirror turns round; None without mirror."""
        if self._antisymmetric is None or not self.layout.owns_rigid:
            return self._antisymmetric
        return np.concatenate([self._antisymmetric, self.layout.rigid_rows])

    def imbalance(self) -> float:
        """Return the largest force that the last solve left at a node or on the bone, over ``force_scale``."""
        forces = np.abs(self._f.array_r)
        forces[self.prescribed_rows() - self._first_row] = 0.0
        largest = float(np.max(forces, initial=0.0))
        return float(self.layout.comm.allreduce(largest, op=MPI.MAX)) / self.force_scale

    @property
    def bone(self) -> Array:
        """The bone's translation (m), shape (2,)."""
        return self.layout.rigid_part(self.x)
