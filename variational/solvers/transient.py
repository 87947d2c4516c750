r"""Pseudo-transient continuation: the shift of the tangent that makes Newton's steps implicit Euler steps of the skin.

(Kelley and Keyes 1998, doi 10.1137/S0036142996304796.) The tangent gets a shift :math:`\eta` on the touching skin, an
implicit Euler step of :math:`\eta M \dot u = -r(u)`, M the skin's mass. Every iteration has a tangent of its own then.
The residual does not control eta: it grows where the skin speeds up towards the screen, and falls where a large eta
stops the skin. What controls eta is how well one Newton iteration solves the Euler step (Deuflhard 2011,
doi 10.1007/978-3-642-23899-4, ch. 6),

.. math:: q = \| r(u + \Delta u) + \eta M \Delta u \| / \| r(u) \|.

Where q is small eta falls, else it rises. So the skin is followed from the equilibrium that is lost to the next one,
which hardly depends on the numbers here.
"""

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from variational.solvers.equations import Equations

_START = 2e9  # Pa/m, eta at the start
_FALL, _RISE = 0.3, 4.0  # of eta an iteration, the former where
_FOLLOWED = 0.5  # the Euler step's error q is below this, the latter at most
_MADE = 1e-6  # of the residual: that of prescribed rows where their displacements are made
_STEADY = 2.0  # eta at least, over a negative stiffness along the last Euler step


class EulerShift:
    """The shift eta of a problem's tangent, from step to step."""

    def __init__(self, equations: Equations) -> None:
        """Take the equations; the skin's mass is assembled where it is first needed."""
        self._equations, self._layout, self._eta = equations, equations.layout, equations.problem.eta
        self._skin_mass: PETSc.Mat | None = None
        self._before, self._moved, self._drag = (self._layout.create_vector() for _ in range(3))
        self._least = 0.0  # Pa/m, by the stiffness along the last step
        self._judged = False  # whether that was all the step did

    def begin(self, x: PETSc.Vec) -> None:
        """Set the shift of the first step, from unknowns ``x``."""
        self._eta.value, self._least, self._judged = _START, 0.0, False
        x.copy(self._before)

    def adapt(self, x: PETSc.Vec, f: PETSc.Vec, norm: float) -> None:
        """Set the shift of the next step by how well the last one was solved; collective.

        It stays where the last step made a prescribed displacement.

        Args:
            x: unknowns to which it led.
            f: their residual (N/m).
            norm: of the residual (N/m) where it began.
        """
        if self._judged:
            drag = self._drag
            self._before.aypx(-1.0, x)
            self._layout.translate(self._before, self._layout.rigid_part(self._before))
            self._mass().mult(self._before, drag)
            drag.array_w[self._prescribed()] = 0.0
            drag.aypx(float(self._eta.value), f)
            error = drag.norm() / norm
            factor = _FALL if error < _FOLLOWED else min(error / _FOLLOWED, _RISE)
            self._eta.value = max(factor * float(self._eta.value), self._least)
        x.copy(self._before)

    def leads_uphill(self, f: PETSc.Vec, norm: float, step: PETSc.Vec) -> bool:
        r"""Return whether eta is too small for the negative stiffness along a step; collective.

        The stiffness is the tangent's, :math:`\lambda = \Delta u^T K \Delta u / \Delta u^T M \Delta u` (Pa/m). Where it
        is below :math:`-\eta` the step leads back to an unstable equilibrium. A step that makes a prescribed
        displacement has forces of its own, and is not judged.

        Args:
            f: residual (N/m) where the step begins.
            norm: of that residual (N/m).
            step: which PETSc subtracts from the unknowns.
        """
        moved, rows, eta = self._moved, self._prescribed(), float(self._eta.value)
        self._least, self._judged = 0.0, False
        to_make = float(np.abs(f.array_r[rows]).max(initial=0.0))
        if self._layout.comm.allreduce(to_make, op=MPI.MAX) > _MADE * norm:
            return False
        self._judged = True
        step.copy(moved)
        self._layout.translate(moved, self._layout.rigid_part(moved))
        moved.array_w[rows] = 0.0
        self._mass().mult(moved, self._drag)
        along = moved.dot(self._drag)
        stiffness = moved.dot(f) / along - eta if along > 0 else 0.0
        self._least = max(-_STEADY * stiffness, 0.0)
        return bool(stiffness < -eta)

    def _prescribed(self) -> np.ndarray:
        return self._equations.local(self._equations.prescribed_rows())

    def _mass(self) -> PETSc.Mat:
        if self._skin_mass is None:
            self._skin_mass = self._layout.create_matrix()
            self._layout.add_to_matrix(self._skin_mass, self._equations.problem.skin_mass, (0, 0))
            self._skin_mass.assemble()
        return self._skin_mass
