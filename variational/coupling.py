"""The two scales meet: a fixed point over the ridges' mean contact pressures.

At given air gaps the macroscale gives each ridge's mean contact pressure, the closure turns it into a new
air gap. With r(d) = closure(p_c(d)) - d the loop takes d + r, and from the second sweep on the secant step of each
ridge by itself (Aitken; ridges hardly feel each other's air gap): it needs fewer sweeps where the loop
contracts. A gain of one is the ridge's fold: past it the loop leaves, in the direction of r, for another state
of the ridge, off the screen or fully on it, and the step is made as long as for a gain just below one.

A formulation of contact whose history is corrected after each solve, the augmented Lagrangian, shares the loop: a
sweep corrects air gaps and multipliers, and the loop ends when both agree.

The tangent of the macroscale is that of frozen air gaps. When a later sweep of a load that was in equilibrium
fails, it is because a ridge jumps, and the solver may creep at once.
"""

from dataclasses import dataclass, field

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from variational.quantities import Observer, SurfaceState
from variational.roughness.closure import Closure
from variational.solver import NotConverged, Solver

Array = NDArray[np.float64]
_LARGEST_GAIN = 0.9
_MOVED = 1e-4  # of d_eq: what a gain is measured over, far above the loop's tolerance


@dataclass
class CouplingHistory:
    """Sweeps of one loop."""

    changes: list[float] = field(default_factory=list)
    """Largest |closure(p_c) - d_eq| / d_eq of each sweep."""
    ridges: list[int] = field(default_factory=list)
    """Number of the ridge it belongs to."""
    errors: list[float] = field(default_factory=list)
    """Largest error of the contact's conditions in each sweep (m), zero where there is nothing to correct."""


class Coupling:
    """Solves macroscale and closure together.

    Attributes:
        d_eq: equivalent air gap of each ridge (m).
        history: sweeps of the last solve.
        gain: d closure(p_c) / d d_eq of each ridge, the secant over the sweeps of the last solve that moved its
            air gap; NaN where none did yet. Below one the ridge's loop contracts: its state is stable if that of
            frozen air gaps is.
    """

    def __init__(
        self,
        solver: Solver,
        observer: Observer,
        closure: Closure,
        tolerance: float = 1e-6,
        cap: int = 30,
        by_gap: bool = False,
    ) -> None:
        """Start from ridges without contact.

        Args:
            solver: the macroscale.
            observer: evaluates its surface.
            closure: the microscale.
            tolerance: relative change of d_eq at which the loop ends.
            cap: most sweeps.
            by_gap: take the length below d_eq, not the length under pressure, as L_R of Eq. 4.
        """
        self.solver, self.observer, self.closure = solver, observer, closure
        self.tolerance, self.cap, self.by_gap = tolerance, cap, by_gap
        self.history = CouplingHistory()
        self.d_eq = closure(np.zeros(len(observer.surface.names))).d_eq
        self.gain = np.full_like(self.d_eq, np.nan)

    def set_air_gaps(self, d_eq: Array) -> None:
        """Impose air gaps (m), shape (ridges,)."""
        self.d_eq = d_eq
        self.solver.problem.set_air_gaps(d_eq)

    def _sweep(self, creep: bool) -> tuple[Array, SurfaceState]:
        """Solve at the current air gaps; return what the closure makes of the pressures (m), and the surface."""
        self.solver.solve(creep)
        with self.solver.timings.phase("coupling"):
            state = self.observer.state()
            d_eq = self.closure(self.observer.ridge_loads(state, self.by_gap).p_c).d_eq
        if not np.isfinite(d_eq).all():
            ridge = self.observer.surface.names[int(np.argmin(np.isfinite(d_eq)))]
            raise NotConverged(f"NOT_A_NUMBER in the air gap of ridge {ridge}", False)
        return d_eq, state

    def solve(self, creep: bool = False) -> None:
        """Find the state in which air gaps and pressures agree, and the contact's conditions hold.

        Args:
            creep: see :meth:`variational.solver.Solver.solve`.

        Raises:
            NotConverged: the macroscale's, ``COUPLING_CAP`` with the ridge that moved most or the contact's error, or
                ``NOT_A_NUMBER`` with the ridge of which the closure made one.
        """
        self.history = CouplingHistory()
        self.set_air_gaps(self.d_eq)
        problem = self.solver.problem
        formulation, charged = problem.interface.formulation, float(problem.voltage.value) != 0.0
        contact_history = problem.history
        first: tuple[Array, Array] | None = None
        previous: tuple[Array, Array] | None = None
        for sweep in range(self.cap):
            d = self.d_eq
            found, state = self._sweep(creep or sweep > 0)
            r = found - d if charged else np.zeros_like(d)  # without attraction the air gaps do not act
            first = first or (d, r)
            error = formulation.error(state, contact_history, problem.interface.mu_f)
            self.history.errors.append(problem.mesh.comm.allreduce(error, op=MPI.MAX))
            worst = int(np.argmax(np.abs(r) / d))
            self.history.changes.append(float(np.abs(r[worst]) / d[worst]))
            self.history.ridges.append(self.observer.surface.names[worst])
            scales = self.history.changes[-1] <= self.tolerance
            contact = self.history.errors[-1] <= formulation.tolerance
            if scales and contact:
                if charged:
                    self._measure_gain(d, r, first)
                else:
                    self.set_air_gaps(found)
                return
            if not contact:
                contact_history = formulation.corrected(state, contact_history)
                problem.correct_history(contact_history)
            if not scales:
                self.set_air_gaps(d + self._step(d, r, previous))
                previous = d, r
        ridge, error = self.history.ridges[-1], self.history.errors[-1]
        where = f"a contact error of {error:.2g} m" if scales else f"ridge {ridge}"
        raise NotConverged(f"COUPLING_CAP at {where}", False)

    def _measure_gain(self, d: Array, r: Array, first: tuple[Array, Array]) -> None:
        moved = d - first[0]
        known = np.abs(moved) > _MOVED * d
        self.gain = self.gain.copy()
        self.gain[known] = 1 + (r - first[1])[known] / moved[known]

    @staticmethod
    def _step(d: Array, r: Array, previous: tuple[Array, Array] | None) -> Array:
        if previous is None:
            return r
        moved = d - previous[0]
        gain = 1 + np.divide(r - previous[1], moved, out=np.full_like(r, -1.0), where=np.abs(moved) > 1e-9 * d)
        return np.clip(r / (1 - np.minimum(gain, _LARGEST_GAIN)), -d / 3, d / 2)
