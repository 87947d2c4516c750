r"""The equilibrium for given loads: Newton's method, and what is tried where it fails.

The unknowns are the bone's translation and the displacement relative to it (:mod:`~variational.problem`). The first
tangent of a load is that of the state it starts from, so that the first iterate is the tangent predictor; along a slide
and in loads over time, whose steps are small, it is the last one, which goes on serving while it serves.
:mod:`~variational.solvers.iteration` has the rules for steps.

Where the iteration fails and mostly friction stays out of balance, points on the friction cone are first taken for
slipping instead of sticking, or the other way round. A smaller step is cheaper than what comes next, which is for
callers whose steps have been cut before. Where hardly anything else than friction stays, its springs are softened and
stiffened again step by step. Or a part of the skin is taken to be about to jump on or off the screen, where the tangent
has a negative direction, and the solve is repeated as pseudo-transient continuation: it moves slowly away from the
equilibrium that is lost and ends in one of the unchanged equations.
"""

from dataclasses import replace

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from variational.contact.formulation import SLIPS, STICKS
from variational.solvers.equations import Equations
from variational.solvers.iteration import EXACT, Iteration, StopRule
from variational.solvers.outcome import OUTSIDE, Counts, snes_failure
from variational.solvers.target import Control

Array = NDArray[np.float64]
_SIDEWAYS = 0.95  # part of the last residual that is friction's, above which points do not come to stick (0.999 where
# they did not, at most 0.62 where ridges jumped);
_MOSTLY = 0.5  # the same, above which the guess for points on the friction cone may be wrong (0.2 where ridges jumped)
_EASE = 0.01  # part of the tangential stiffness to begin with then,
_STIFFER, _LEAST_STIFFER = 4.0, 1.05  # by how much it is raised at a time, and at least


class Solver:
    """Solves :class:`Equations` for given loads.

    Attributes:
        equations: residual and tangent, with what is prescribed.
        iteration: Newton's method.
        x: unknowns.
        force_scale: force per length (N/m) in which residuals are measured.
        counts: work done so far.
        timings: seconds by phase.
    """

    def __init__(self, equations: Equations, force_scale: float, tolerance: float = 1e-9) -> None:
        """Set SNES up.

        Args:
            equations: of a problem.
            force_scale: force per length (N/m) in which residuals are measured.
            tolerance: norm of the nodal forces' imbalance (N/m) at convergence, over ``force_scale``; volume defects
                count as forces, see :mod:`variational.element`.
        """
        self.equations, self.problem, self.layout = equations, equations.problem, equations.layout
        self.force_scale, self.counts, self.timings = force_scale, Counts(), equations.timings
        self.x = self.layout.create_vector()
        self.iteration = Iteration(equations, self.counts, force_scale, tolerance)
        self._solved = False  # whether the last solve ended in an equilibrium
        self._on_cone = True  # whether points may be on the friction cone
        self._skin_rows_x = equations.skin_rows([0])

    @property
    def control(self) -> Control:
        """What is prescribed of the bone."""
        return self.equations.control

    @control.setter
    def control(self, control: Control) -> None:
        self.equations.control = control

    @property
    def reaction(self) -> Array:
        """Reaction on the bone of the whole body (N/m), shape (2,)."""
        return self.equations.reaction

    @reaction.setter
    def reaction(self, reaction: Array) -> None:
        self.equations.reaction = reaction

    @property
    def bone(self) -> Array:
        """The bone's translation (m), shape (2,)."""
        return self.layout.rigid_part(self.x)

    @property
    def floor(self) -> float:
        """See :attr:`variational.solvers.iteration.Iteration.floor`."""
        return self.iteration.floor

    @property
    def pressure(self) -> Array:
        """This rank's unknowns of a mixed element's pressure (m), see :mod:`variational.element`."""
        return self.x.array_r[: self.layout.local_size - len(self.layout.displacement_rows)].copy()

    def set_displacement(self, u: Array, bone: Array) -> None:
        """Start from a displacement (m) of all nodes, shape (nodes, 2), and the bone's translation (m), (2,).

        A mixed element's pressure becomes that of the displacement.
        """
        self.layout.from_nodes((u - bone).ravel(), bone, self.x)
        if self.problem.pressure:
            self._set_pressure()
        self.equations.to_fields(self.x)

    def take(self, w: Array, bone: Array, pressure: Array) -> None:
        """Take an equilibrium that was found elsewhere as that of the last solve; collective.

        Args:
            w: displacement of all nodes relative to the bone (m), shape (nodes, 2).
            bone: its translation (m), shape (2,).
            pressure: this rank's unknowns of a mixed element's pressure (m), of shape (0,) without one.
        """
        self.layout.from_nodes(w.ravel(), bone, self.x)
        self.x.array_w[: len(pressure)] = pressure
        self.iteration.take(self.x)

    def slide(self, distance: float) -> None:
        """Translate the body with its bone sideways by a distance (m)."""
        if self.layout.owns_rigid:
            self.x.array_w[-2] += distance
        self.control = replace(self.control, x=self.control.x + distance)

    def _set_pressure(self) -> None:
        """Solve the second equation, which is linear in the pressure, at the present displacement.

        Where elements are inside out or the factorisation fails, the last pressure stays.
        """
        A, f, step = self.layout.create_matrix(), self.layout.create_vector(), self.layout.create_vector()
        self.equations.residual(self.x, f)
        if f.norm() >= OUTSIDE / 2:
            return
        self.equations.assemble_tangent(A)
        A.zeroRows(self.layout.displacement_rows)
        f.array_w[self.equations.local(self.layout.displacement_rows)] = 0.0
        ksp = PETSc.KSP().create(self.layout.comm)
        ksp.setOperators(A)
        ksp.setType(PETSc.KSP.Type.PREONLY)
        ksp.getPC().setType(PETSc.PC.Type.LU)
        ksp.getPC().setFactorSolverType(PETSc.Mat.SolverType.MUMPS)
        ksp.solve(f, step)
        if ksp.getConvergedReason() > 0:
            self.x.axpy(-1.0, step)
        ksp.destroy()
        A.destroy()

    def new_load(self, control: Control, voltage: float, slipping: bool = False, on_cone: bool = True) -> None:
        """Prescribe a load.

        The next solve starts from the tangent of the present state; along a slide, and in loads over time, from a kept
        one if the last solve ended in an equilibrium.

        Args:
            control: what is prescribed of the bone.
            voltage: (V).
            slipping: points on the friction cone are first taken for slipping on, not for sticking.
            on_cone: whether there are any, as the last accepted state of a path leaves; else no other guess is tried.
        """
        guess = SLIPS if slipping else STICKS
        small = self.problem.dt.value > 0 or (self.problem.voltage.value == voltage and self.control.x != control.x)
        self.iteration.tangent.stale |= not (self._solved and small and self.problem.guess.value == guess)
        self.control, self.problem.voltage.value = control, voltage
        self.problem.guess.value = guess
        self._on_cone = on_cone

    def attempt(self, stop: StopRule) -> bool:
        """Iterate from ``x`` by full Newton steps alone.

        Args:
            stop: when the iteration ends.

        Returns:
            Whether it ended in an equilibrium; else ``x`` is where it was.
        """
        start = self.x.array_r.copy()
        self._solved = self.iteration.run(self.x, stop=stop) > 0
        if not self._solved:
            self.x.array_w[:] = start
            self.iteration.tangent.stale = True
        return self._solved

    def solve(self, pseudo_transient: bool = False, stop: StopRule = EXACT, tried: bool = False) -> None:
        """Find the equilibrium near ``x`` for the current loads and leave it in ``x`` and the problem's u.

        Args:
            pseudo_transient: repeat with softened friction, or as pseudo-transient continuation, what full Newton steps
                do not manage.
            stop: when full Newton steps end.
            tried: whether full Newton steps from ``x`` have just failed, see :meth:`attempt`.

        Raises:
            NotConverged: with SNES's reason; ``x`` is then the last iterate.
        """
        start = self.x.array_r.copy()
        self._solved = False

        def run(x: PETSc.Vec, shifted: bool = False) -> int:
            return self.iteration.run(x, shifted, EXACT if shifted else stop)

        self.equations.inverted, self.equations.not_a_number = False, ""
        reason = -1 if tried else run(self.x)
        friction = self.problem.anchor is not None
        guessed = friction and self._on_cone and not tried
        if reason <= 0 and guessed and self._sideways() > _MOSTLY:  # the other guess, which is then kept
            self.x.array_w[:] = start
            self.problem.guess.value = SLIPS if self.problem.guess.value == STICKS else STICKS
            self.iteration.tangent.stale = True
            reason = run(self.x)
        if reason <= 0 and friction and pseudo_transient and self._sideways() > _SIDEWAYS:
            reason = self._ease(start)
        if reason <= 0 and pseudo_transient:
            self.counts.pseudo_transient += 1
            self.x.array_w[:] = start
            reason = run(self.x, shifted=True)
        if reason <= 0:
            raise snes_failure(self.iteration.snes, self.equations.inverted, self.equations.not_a_number)
        self._solved = True

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
                self.iteration.tangent.stale = True
                reason = self.iteration.run(self.x)
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
        sideways = self.iteration.f.array_r[self.equations.local(self._skin_rows_x)]
        own = self.layout.comm.allreduce(float(sideways @ sideways))
        whole = float(self.iteration.f.norm())
        return float(np.sqrt(own)) / whole if whole > 0 else 0.0

    def imbalance(self) -> float:
        """Return the largest force that the last solve left at a node or on the bone, over ``force_scale``."""
        forces = np.abs(self.iteration.f.array_r)
        forces[self.equations.local(self.equations.prescribed_rows())] = 0.0
        largest = float(np.max(forces, initial=0.0))
        return float(self.layout.comm.allreduce(largest, op=MPI.MAX)) / self.force_scale
