"""The two scales meet: a fixed point over the ridges' mean contact pressures.

At given air gaps d the macroscale gives each ridge's mean contact pressure, the closure turns it into a new air gap;
:mod:`~variational.solvers.secant` iterates until the two agree. A loop starts with the gains it last ended with. Ridges
that go past their fold on the way are listed in :attr:`CouplingHistory.jumped`. (Nothing is stored in the closure: the
energy that a jump of the micro layer releases is not in the model; :mod:`~variational.energy` has what the skin
releases.)

On leaving contact a ridge has p_c = 0, and its air gap is the closure's at that end: the bearing area model holds
d_eq at its value at p_floor, some 12 um. It does not keep the gap it was pressed to, and d_eq does not follow
p_c to infinity. A ridge without contact is attracted across its height where that is larger.

There may be no such state. A ridge about to leave touches with a facet or two, which leave one at a time:
with one facet less its pressure is higher, its air gap smaller and its attraction stronger, so that the facet comes
back. Between the loads at which either state is one of equilibrium the loop cycles, however small the step;
:mod:`~variational.solvers.continuation` steps over them.

A formulation of contact whose history is corrected after each solve, the augmented Lagrangian, shares the loop: an
iteration corrects air gaps and multipliers, and the loop ends when both agree. Without a closure, for a path without
voltage, the multipliers are all there is to correct, and a step is mostly one solve.

The tangent of the macroscale is that of frozen air gaps. When a later iteration of a load that was in equilibrium
fails, it is because a ridge jumps. If its air gap opens, the ridge is given that of one without contact. Where this
does not help, pseudo-transient continuation follows at once. Solves at air gaps that change again end inexactly.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from variational.contact.formulation import SurfaceState
from variational.history import Values
from variational.resultants import Observer
from variational.roughness.closure import Closure, air_gaps, check
from variational.solvers.iteration import EXACT, StopRule
from variational.solvers.newton import Solver
from variational.solvers.outcome import NotConverged
from variational.solvers.secant import Secants
from variational.solvers.target import Control

Array = NDArray[np.float64]
# Solves at air gaps that change again are not exact. They leave a part of what the load brought out of balance, at most
_FIRST, _LATER = StopRule(0.1, most=1e-3), StopRule(0.03)  # so much of the force scale; or of what air gaps brought,
_SETTLED = 1e-3  # until the air gaps' relative error is below this;
_ON_ITS_WAY = StopRule(0.5)  # where a ridge comes down, whose next air gap is known already.
_SURELY = 0.01  # of the tolerance: a larger error of a loop that may end is corrected once more
_HASTE = 2  # iterations in which the residual must fall where a ridge lets go, as there is a remedy then


@dataclass
class CouplingHistory:
    """Coupling iterations of one loop."""

    changes: list[float] = field(default_factory=list)
    """Largest |closure(p_c) - d_eq| / d_eq of each iteration."""
    ridges: list[int] = field(default_factory=list)
    """Number of the ridge it belongs to."""
    errors: list[float] = field(default_factory=list)
    """Largest error of the contact's conditions in each iteration (m), zero where there is nothing to correct."""
    jumped: set[int] = field(default_factory=set)
    """Numbers of the ridges that went past a fold: their gain was above one and their air gap changed by far."""


class Coupling:
    """Solves macroscale and closure together.

    Attributes:
        d_eq: equivalent air gap of each ridge (m); NaN without a closure.
        history: iterations of the last solve.
        gain: d closure(p_c) / d d_eq of each ridge, the last secant of the last solve that moved its air gap;
            NaN where none did yet. Below one the ridge's loop contracts: its state is stable if that of
            frozen air gaps is.
    """

    def __init__(
        self,
        solver: Solver,
        observer: Observer,
        closure: Closure | None,
        tolerance: float = 1e-6,
        cap: int = 30,
        by_gap: bool = False,
    ) -> None:
        """Start from ridges without contact.

        Args:
            solver: the macroscale.
            observer: evaluates its surface.
            closure: the microscale; None where there is never a voltage.
            tolerance: relative error of d_eq, r / (1 - gain), within which the loop ends, gains counting up to 0.99,
                after one more iteration where the error is above a hundredth of it.
            cap: most iterations.
            by_gap: take the length below d_eq, not the length under pressure, as L_R of Eq. 4.

        Raises:
            ValueError: what is no closure; in one sentence.
        """
        if closure is not None:
            check(closure)
        self.solver, self.observer, self.closure = solver, observer, closure
        self.tolerance, self.cap, self.by_gap = tolerance, cap, by_gap
        self.history = CouplingHistory()
        self.d_eq = self.open_gaps()
        self.gain = np.full_like(self.d_eq, np.nan)

    def open_gaps(self) -> Array:
        """Return the air gaps of ridges without contact (m), shape (ridges,); NaN without a closure."""
        ridges = len(self.observer.surface.ridge_numbers)
        return np.full(ridges, np.nan) if self.closure is None else air_gaps(self.closure, np.zeros(ridges))

    def set_air_gaps(self, d_eq: Array) -> None:
        """Impose air gaps (m), shape (ridges,)."""
        self.d_eq = d_eq
        if self.closure is not None:
            self.solver.problem.set_air_gaps(d_eq)

    def _iterate(self, pseudo_transient: bool, stop: StopRule, secants: Secants | None) -> tuple[Array, SurfaceState]:
        """Solve at the current air gaps; return the air gaps by the closure (m), and the surface."""
        if secants is None:
            self.solver.solve(pseudo_transient, stop)
        else:
            self._solve_again(stop, secants)
        with self.solver.timings.phase("coupling"):
            state = self.observer.state()
            if self.closure is None:
                return self.d_eq, state
            d_eq = air_gaps(self.closure, self.observer.ridge_loads(state, self.by_gap).p_c)
        if not np.isfinite(d_eq).all():
            ridge = self.observer.surface.ridge_numbers[int(np.argmin(np.isfinite(d_eq)))]
            raise NotConverged(f"NOT_A_NUMBER in the air gap of ridge {ridge}", False)
        return d_eq, state

    def _solve_again(self, stop: StopRule, secants: Secants) -> None:
        """Solve from the state at other air gaps, or from where a ridge jumps to.

        Without attraction the skin of a ridge that lets go springs back, to a state that full Newton steps find. On the
        way there at its present air gap the tangent is not positive.
        """
        leaving = bool(secants.leaving(self.d_eq).any())
        if self.solver.attempt(replace(stop, patience=_HASTE) if leaving else stop):
            return
        if leaving:
            self.set_air_gaps(secants.without_leaving(self.d_eq))
            if self.solver.attempt(stop):
                return
        self.solver.solve(pseudo_transient=True, tried=True)

    def solve(self, pseudo_transient: bool = False) -> None:
        """Find the state in which air gaps and pressures agree, and the contact's conditions hold.

        Args:
            pseudo_transient: see :meth:`variational.solvers.newton.Solver.solve`.

        Raises:
            ValueError: the closure returns another shape than the pressures'.
            NotConverged: the macroscale's, ``COUPLING_CAP`` with the ridge that moved most or the contact's error, or
                ``NOT_A_NUMBER`` with the ridge of which the closure made one.
        """
        self.history = CouplingHistory()
        self.set_air_gaps(self.d_eq)
        problem = self.solver.problem
        formulation = problem.interface.formulation
        charged = self.closure is not None and float(problem.voltage.value) != 0.0
        contact_history = problem.history.accepted
        free = np.inf if self.closure is None else float(air_gaps(self.closure, np.zeros(1))[0])
        secants, numbers = Secants(self.d_eq, self.gain, free), self.observer.surface.ridge_numbers
        stop, scales = _FIRST if charged else EXACT, False
        for iteration in range(self.cap):
            found, state = self._iterate(pseudo_transient, stop, secants if iteration else None)
            d = self.d_eq
            r = found - d if charged else np.zeros_like(d)  # without attraction the air gaps do not act
            error = formulation.error(state, contact_history, problem.interface.friction)
            self.history.errors.append(problem.mesh.comm.allreduce(error, op=MPI.MAX))
            change = np.abs(r) / d if charged else np.zeros_like(d)
            worst = int(np.argmax(change))
            self.history.changes.append(float(change[worst]))
            self.history.ridges.append(numbers[worst])
            secants.record(d, r)
            self.history.jumped = {numbers[k] for k in np.flatnonzero(secants.jumped())}
            again = scales
            scales = not charged or (stop == EXACT and secants.settled(self.tolerance))
            contact = self.history.errors[-1] <= formulation.tolerance
            last = not charged or again or secants.settled(_SURELY * self.tolerance) or iteration == self.cap - 1
            if scales and contact and last:
                if charged:
                    self.gain = secants.gain
                else:
                    self.set_air_gaps(found)
                return
            if not contact:
                contact_history = formulation.corrected(state, contact_history)
                problem.history.impose(contact_history)
            if charged:
                settled = secants.settled(_SETTLED)
                self.set_air_gaps(secants.step())
                stop = EXACT if settled else _ON_ITS_WAY if secants.closing else _LATER
        ridge, error = self.history.ridges[-1], self.history.errors[-1]
        where = f"a contact error of {error:.2g} m" if scales else f"ridge {ridge}"
        raise NotConverged(f"COUPLING_CAP at {where}", False, cycling=not scales)


@dataclass(frozen=True)
class AcceptedState:
    """Unknowns, history and loads, to which a rejected attempt returns."""

    x: Array
    """This rank's unknowns."""
    bone: Array
    """The bone's translation (m), shape (2,)."""
    history: Values
    """Accepted values of the history's fields."""
    d_eq: Array
    """Equivalent air gaps (m), shape (ridges,)."""
    control: Control
    voltage: float
    reaction: Array
    """On the bone (N/m), shape (2,)."""

    @property
    def height(self) -> float:
        """The bone's height (m, change from unloaded)."""
        return float(self.bone[1]) if self.control.y is None else self.control.y

    @classmethod
    def of(cls, coupling: Coupling) -> "AcceptedState":
        """Return the present state; collective."""
        solver, problem = coupling.solver, coupling.solver.problem
        return cls(
            solver.x.array_r.copy(),
            solver.bone,
            problem.history.accepted,
            coupling.d_eq.copy(),
            replace(solver.control),
            float(problem.voltage.value),
            solver.reaction.copy(),
        )

    def restore(self, coupling: Coupling) -> None:
        """Return to the state; collective."""
        solver, problem = coupling.solver, coupling.solver.problem
        solver.x.array_w[:] = self.x
        solver.equations.to_fields(solver.x)
        coupling.set_air_gaps(self.d_eq.copy())
        problem.history.accept(self.history)
        problem.elapse(0.0)
        solver.control = replace(self.control)
        problem.voltage.value = self.voltage
        solver.reaction = self.reaction.copy()


@dataclass(frozen=True)
class Place:
    """An accepted state of a continuation, on its own mesh."""

    accepted: AcceptedState
    surface: SurfaceState
    slip: tuple[float, bool]
    """See :class:`variational.solvers.continuation.Continuation`."""
    gain: Array
    """See :class:`Coupling`, shape (ridges,)."""
    time: float
    """(s)"""
