r"""One solve by PETSc SNES: which steps of Newton's method are shortened or refused, and when it ends.

Full steps: with a stiff penalty the iteration is an active-set method, whose residual rises before the right points
are in contact, and backtracking on the residual only slows it. But the first steps of a solve are shortened where
they would drive open skin deep through the screen, which the tangent of open skin does not resist, and any step is
halved that would turn elements inside out or send the residual up tenfold. After each step the elements next to the
screen are brought into balance by themselves (:mod:`~variational.solvers.skin_layer`), which finds the points in
contact at a fraction of the cost. A factorisation serves as long as the residual falls to two fifths an iteration,
accelerated by :mod:`~variational.solvers.tangent`; a step it proposes is refused when the residual would rise, and
made anew with the tangent of the present iterate. Where the right points are not yet in contact, a kept factorisation
or a layer in balance may lower the residual and bring the wrong points into contact, the more so the stiffer the
penalty: without voltage an iteration that cycles starts again without both. (With one it mostly cycles because the skin
jumps, where no tangent helps.) A residual that stalls within some units of roundoff of the forces that cancel in it is
at its floor, and the solve ends as converged there; :attr:`Iteration.floor` is that residual.

In pseudo-transient continuation (:mod:`~variational.solvers.transient`) every iteration has a tangent of its own, and
the layer stays as it is.
"""

from dataclasses import dataclass

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from variational.solvers.equations import Equations
from variational.solvers.outcome import OUT_OF_WORKSPACE, OUTSIDE, Counts, linear_failure
from variational.solvers.skin_layer import SkinLayer
from variational.solvers.tangent import Anderson, Tangent
from variational.solvers.transient import EulerShift

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
    "mat_mumps_icntl_8": "0",  # no scaling, which takes a sixth of a factorisation: all rows are forces over lengths
}
_CONTRACTS = 0.4  # reduction of the residual an iteration below which a factorisation is kept
_DEEPEST = 1e-6  # m, how deep open skin may be driven by one of the first steps
_LIMITED_STEPS = 6
_HALVINGS = 5  # of a step that would turn elements inside out or
_GROWS = 10.0  # make the residual grow more than this
_REST = 0.005  # of the last residual: that of the layer at the screen when the layer is in balance,
_END = 0.3  # or of the residual at convergence
_ROUNDINGS = 4.0  # units of roundoff of the sum of each node's absolute forces, within which a residual may stall,
_FLOOR = 1e-6  # if that is less than this part of the force scale
_MOST_WORKSPACE = 1600  # per cent that are set aside beyond MUMPS's estimate
_SHIFTED_LONGER = 3  # times as many iterations as others: facets of many ridges come down one after the other


@dataclass(frozen=True)
class StopRule:
    """When an iteration by full Newton steps ends: as converged within the solver's tolerance or this, or in vain."""

    part: float = 0.0
    """Norm of the nodal forces' imbalance over that of the first iterate that is small enough,"""
    most: float = np.inf
    """if it is no more than this part of the force scale."""
    patience: int = 4
    """Iterations in which the least residual must fall."""


EXACT = StopRule()


class Iteration:
    """Newton's method from an iterate on.

    Attributes:
        tangent: with its factorisation.
        force_scale: force per length (N/m) in which residuals are measured.
        tolerance: norm of the nodal forces' imbalance (N/m) at convergence.
        f: the residual (N/m) where the last run ended.
        floor: norm of the nodal forces' imbalance over ``force_scale`` with which the last run ended at the floor of
            roundoff, above its tolerance; zero if it met that.
    """

    def __init__(self, equations: Equations, counts: Counts, force_scale: float, tolerance: float) -> None:
        """Set SNES up; the arguments are those of :class:`variational.solvers.newton.Solver`."""
        self.equations, self.layout, self.counts = equations, equations.layout, counts
        self.tangent, self.force_scale = Tangent(equations, counts), force_scale
        self.f, self._next_x, self._next_f = (self.layout.create_vector() for _ in range(3))
        self._anderson = Anderson(self.layout.comm)
        self.floor = 0.0
        self._norms: list[float] = []
        self._stop, self._atol = EXACT, 0.0
        self._shifted = False  # whether the tangent has the shift of pseudo-transient continuation
        self._shift = EulerShift(equations)
        self._layer = SkinLayer(equations) if equations.problem.pressure is None else None
        self._keeps = _CONTRACTS  # as the constant, or zero where each iteration has a tangent of its own
        self._balances = False  # whether the layer at the screen is brought into balance after each step
        self._refused = False  # whether the present iteration stayed where it was
        self._ahead = False  # whether the residual of the next iterate is known
        self._skin = equations.skin[1]  # vertical displacements of the skin that can touch
        self._skin_height = equations.problem.V.tabulate_dof_coordinates()[self._skin // 2, 1]
        self._nodal = np.zeros_like(equations.problem.w.x.array)
        self.snes = self._create_snes(force_scale * tolerance)
        self.tolerance = float(self.snes.getTolerances()[1])
        self._most = int(self.snes.getTolerances()[3])  # iterations of a run that is not shifted

    def _create_snes(self, imbalance: float) -> PETSc.SNES:
        options = PETSc.Options()
        for name, value in DEFAULTS.items():
            if not options.hasName(PREFIX + name):
                options.setValue(PREFIX + name, value)
        snes = PETSc.SNES().create(self.layout.comm)
        snes.setOptionsPrefix(PREFIX)
        snes.setTolerances(atol=imbalance)
        snes.setFunction(self._residual, self.f)
        snes.setJacobian(self.tangent.update, self.tangent.relative, self.tangent.matrix)
        snes.setConvergenceTest(self._test)
        snes.setLineSearchPreCheck(self._limit)
        snes.setFromOptions()
        snes.getKSP().setPostSolve(self.tangent.make_relative)
        return snes

    def run(self, x: PETSc.Vec, shifted: bool = False, stop: StopRule = EXACT) -> int:
        """Iterate from ``x`` and leave the last iterate there; return SNES's reason, positive if it converged.

        Args:
            x: unknowns.
            shifted: by pseudo-transient continuation.
            stop: when the iteration ends.
        """
        self._shifted, self._stop = shifted, stop
        self.snes.setTolerances(max_it=self._most * (_SHIFTED_LONGER if shifted else 1))
        self._anderson.interrupt()
        pc = self.snes.getKSP().getPC()
        if pc.getFailedReason():  # as of a tangent that is not a number, after which MUMPS would fail for ever
            pc.reset()
            self.tangent.stale = True
        self.tangent.start()
        self.tangent.stale |= shifted
        seconds = self.equations.timings.seconds
        assembly = seconds["assembly"]
        start, made = x.array_r.copy(), self.counts.factorisations
        self._keeps = 0.0 if shifted else _CONTRACTS
        self._balances = not (shifted or self._layer is None or self.equations.holds_skin)
        with self.equations.timings.phase("factorisation"):
            self._solve(x)
            iterations = self.snes.getIterationNumber()
            cycles = self.snes.getConvergedReason() == PETSc.SNES.ConvergedReason.DIVERGED_LOCAL_MIN
            uncharged = float(self.equations.problem.voltage.value) == 0.0
            kept = self.counts.factorisations - made < iterations
            if cycles and uncharged and (kept or self._balances):
                self._keeps, self._balances, self._ahead, self.tangent.stale = 0.0, False, False, True
                x.array_w[:] = start
                self._solve(x)
                iterations += self.snes.getIterationNumber()
        self.counts.newton += iterations
        seconds["factorisation"] -= seconds["assembly"] - assembly
        self.tangent.stale |= shifted
        self.equations.problem.eta.value = 0.0
        reason = int(self.snes.getConvergedReason())
        self._ahead = False
        # Nodes and reaction are those of a rejected iterate, or of one that another solver than Newton's went on from.
        if reason <= 0 or self.snes.getType() != PETSc.SNES.Type.NEWTONLS:
            self.equations.residual(x, self.f)
        return reason

    def take(self, x: PETSc.Vec) -> None:
        """Take a state that was found elsewhere as that in which the last run ended; collective."""
        self.equations.residual(x, self.f)
        norm = float(self.f.norm())
        self.floor = norm / self.force_scale if norm > self.tolerance else 0.0

    def _solve(self, x: PETSc.Vec) -> None:
        """Let SNES iterate, again with more workspace where MUMPS ran out of it; collective."""
        start = x.array_r.copy()
        self._iterate(x)
        while self._enlarged():
            x.array_w[:] = start
            self.tangent.stale, self._ahead = True, False
            self._iterate(x)

    def _enlarged(self) -> bool:
        """Return whether the last factorisation ran out of workspace, and set more aside for the next ones.

        MUMPS estimates its workspace before it pivots, which depends on the matrix, and adds ICNTL(14) per cent.
        """
        pc, failed = self.snes.getKSP().getPC(), PETSc.SNES.ConvergedReason.DIVERGED_LINEAR_SOLVE
        if self.snes.getConvergedReason() != failed or not linear_failure(pc)[0].startswith(OUT_OF_WORKSPACE):
            return False
        percent = int(pc.getFactorMatrix().getMumpsIcntl(14))
        if percent >= _MOST_WORKSPACE:
            return False
        PETSc.Options().setValue(f"{PREFIX}mat_mumps_icntl_14", str(min(max(4 * percent, 100), _MOST_WORKSPACE)))
        pc.reset()
        return True

    def _iterate(self, x: PETSc.Vec) -> None:
        """Let SNES iterate; what one of its callbacks raised is raised as it was, not as PETSc's error -1."""
        try:
            self.snes.solve(None, x)
            return
        except PETSc.Error as error:
            raised = error.__cause__
            if raised is None:
                raise
        raise raised

    def forget(self) -> None:
        """Leave nothing of earlier solves to the next one: neither a factorisation nor a layer; collective."""
        self.tangent.stale = True
        if self._layer:
            self._layer.forget()

    def free(self) -> None:
        """Free the tangent and its factorisation, the larger part of all memory; nothing can be solved any more."""
        self.snes.destroy()
        self.tangent.matrix.destroy()
        if self._layer:
            self._layer.free()

    # -- callbacks -------------------------------------------------------------------------------------
    def _residual(self, snes: PETSc.SNES, x: PETSc.Vec, f: PETSc.Vec) -> None:
        if self._ahead:  # the step's length was found with it
            self._ahead = False
            self._next_f.copy(f)
        else:
            self.equations.residual(x, f)

    def _test(self, snes: PETSc.SNES, iteration: int, norms: tuple[float, float, float]) -> int:
        """Judge an iterate by its residual alone, and set the next shift."""
        reason = PETSc.SNES.ConvergedReason
        _, atol, _, most = snes.getTolerances()
        if iteration == 0:
            self._norms, self._refused = [], False
            self._atol = max(atol, min(self._stop.part * norms[2], self._stop.most * self.force_scale))
            if self._shifted:
                self._shift.begin(snes.getSolution())
        elif self._shifted:
            self._shift.adapt(snes.getSolution(), self.f, self._norms[-1])
        previous = self._norms[-1] if self._norms else np.inf
        norm = norms[2]
        if not self._refused:
            self._norms.append(norm)
        self.floor = 0.0
        if norm <= self._atol:
            return reason.CONVERGED_FNORM_ABS
        if norm >= OUTSIDE / 2:
            return reason.DIVERGED_FUNCTION_DOMAIN
        if iteration >= most:
            return reason.DIVERGED_MAX_IT
        if iteration > 0:
            slow = self._refused or norm > _CONTRACTS * previous
            self.tangent.stale = slow or norm > self._keeps * previous
            if slow and norm <= self._roundoff(norm):
                self.floor = norm / self.force_scale
                return reason.CONVERGED_SNORM_RELATIVE
        # The first norm is left out: it may hold a prescribed displacement not yet made.
        few = self._stop.patience
        late, early = self._norms[1:][-few:], self._norms[1:][-2 * few : -few]
        if not self._shifted and len(early) == few and min(late) > 0.7 * min(early):
            return reason.DIVERGED_LOCAL_MIN  # cycles
        return reason.ITERATING

    def _roundoff(self, norm: float) -> float:
        r"""Return the norm of nodal forces (N/m) that roundoff may leave in the present iterate.

        Each force is a sum of parts that cancel. Their magnitudes are those of the tangent times the relative
        displacement, so that the roundoff of all of them is some units of
        :math:`\epsilon \, \| |K| |w| \|`. Measured from the first touch to 10 mm of sliding: 0.13 to 0.4 of it.
        A shift is no part of the forces: with it any residual that stalls would be roundoff once the shift has grown.

        Args:
            norm: of the residual (N/m); where it is too large to be accepted as roundoff, zero is returned.
        """
        if norm > _FLOOR * self.force_scale:
            return 0.0
        x, comm = self.snes.getSolution(), self.layout.comm
        scatter, everywhere = PETSc.Scatter.toAll(x)
        scatter.scatter(x, everywhere, mode=PETSc.ScatterMode.FORWARD)
        w = np.abs(everywhere.array_r)
        w[self.layout.rigid_rows] = 0.0  # a translation of all nodes makes no force between them
        tangent = self.tangent.unshifted() if self._shifted else self.tangent.matrix
        start, columns, values = tangent.getValuesCSR()
        parts = np.append(np.abs(values) * w[columns], 0.0)
        sums = np.add.reduceat(parts, start[:-1]) if len(start) > 1 else np.zeros(0)
        total = comm.allreduce(float(sums @ sums))
        return float(_ROUNDINGS * np.finfo(float).eps * np.sqrt(total))

    def _limit(self, x: PETSc.Vec, step: PETSc.Vec) -> bool:
        """Accelerate a step, shorten it to where its tangent still holds, bring the skin into balance, or refuse it."""
        if not self.tangent.kept:
            self._anderson.forget()
        if not self._shifted:
            more = self._anderson.correction(x.array_r, self.f.array_r, step.array_r)
            if more is not None:
                step.array_w[:] += more
        uphill = self._shifted and self._shift.leads_uphill(self.f, self._norms[-1], step)
        if len(self._norms) <= _LIMITED_STEPS:
            step.scale(self._until_deep(x, step))
        norm = self._look_ahead(x, step)
        for _ in range(_HALVINGS):
            if norm < _GROWS * max(self._norms):
                break
            step.scale(0.5)
            norm = self._look_ahead(x, step)
        self._refused = uphill or self.tangent.kept and len(self._norms) > 1 and norm > self._norms[-1]
        if self._refused:
            self._anderson.interrupt()
            step.set(0.0)
            self.equations.residual(x, self._next_f)
        else:
            step.waxpy(-1.0, self._next_x, x)
        self._ahead = True
        return True

    def _look_ahead(self, x: PETSc.Vec, step: PETSc.Vec) -> float:
        """Evaluate the residual where a step leads, with the layer at the screen in balance; return its norm."""
        self._next_x.waxpy(-1.0, step, x)
        if self._layer and self._balances:
            enough = max(_REST * self._norms[-1], _END * self._atol)
            self._layer.balance(self._next_x, self._next_f, enough, self._most_before_balance())
        self.equations.residual(self._next_x, self._next_f)
        return float(self._next_f.norm())

    def _most_before_balance(self) -> float:
        """Return the residual of the layer (N/m) above which a step is halved instead.

        Without a voltage the layer finds its way back from wherever a step leads. With one, another equilibrium may be
        nearer.
        """
        uncharged = float(self.equations.problem.voltage.value) == 0.0
        return np.inf if uncharged else _GROWS * max(self._norms)

    def _until_deep(self, x: PETSc.Vec, step: PETSc.Vec) -> float:
        """Return the part of a step that drives open skin at most a little through the screen."""
        self.layout.to_nodes(x, self._nodal)
        height = self._skin_height + self._nodal[self._skin] + self.layout.rigid_part(x)[1]
        self.layout.to_nodes(step, self._nodal)
        sink = self._nodal[self._skin] + self.layout.rigid_part(step)[1]  # PETSc subtracts the step
        deep = (height > 0) & (height - sink < -_DEEPEST)
        part = float(np.min((height[deep] + _DEEPEST) / sink[deep], initial=1.0))
        return float(self.layout.comm.allreduce(part, op=MPI.MIN))
