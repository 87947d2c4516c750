r"""The two scales meet: a fixed point over the ridges' mean contact pressures.

At given air gaps d the macroscale gives each ridge's mean contact pressure, the closure turns it into a new air
gap; with :math:`r(d) = d_{eq}(p_c(d)) - d` the plain loop takes d + r. The screen bears a change of the attraction
mostly where it acts, so ridges hardly feel each other's air gap, and Newton's method is a secant of each ridge
by itself:

.. math:: d \leftarrow d + \frac{r}{1 - g}, \qquad g = \frac{d}{dd} d_{eq}(p_c(d))

A loop starts with the gain g it last ended with, unless that would take it far. The secant needs a few sweeps where
g is -3 or 0.99 and the plain loop diverges or needs hundreds. It is not let converge where g > 1. There the micro
layer is unstable: a gap that opens a little opens on. On a flat ridge, :math:`g = d_{eq}'(p_c) \, \sigma_{el}'(d)`
whatever the body and its loads: no control of the bone's height or force makes such a state stable. (On a round one
the contact's length follows the attraction too.) g = 1 is the ridge's fold; past it the loop leaves in the direction
of r, by ten times r and, as long as the gain stays there, by a hundred and a thousand times, never more than half of
d, for another state of the ridge: down on the screen, or up to where d_eq is held. Such ridges are listed in
:attr:`CouplingHistory.jumped`. (Nothing is stored in the closure: what a jump of the micro layer releases there is not
known, and :mod:`~variational.energy` books what the skin releases.)

On leaving contact a ridge has p_c = 0, and its air gap is the closure's at that end: the bearing area model holds
d_eq at its value at p_floor, some 12 um. It does not keep the gap it was pressed to, and d_eq does not follow
p_c to infinity. A ridge without contact is attracted across its height where that is larger.

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
_AMPLIFIED = np.array([10.0, 10.0, 100.0, 1e3])  # largest 1 / (1 - gain) after so many secants that ask for ten
_SEEN = 1e-6  # of d_eq: what a secant is drawn over, far above the error that a solve leaves, and
_LEADS = 0.1  # of the largest move: else it is the other ridges' air gaps that moved this one's pressure
_FIRST = 0.01  # of d_eq: how far the first step may go beyond r, whose gain is that of another load
_JUMP = 0.1  # of d_eq: how far a ridge past its fold goes at least


@dataclass
class CouplingHistory:
    """Sweeps of one loop."""

    changes: list[float] = field(default_factory=list)
    """Largest |closure(p_c) - d_eq| / d_eq of each sweep."""
    ridges: list[int] = field(default_factory=list)
    """Number of the ridge it belongs to."""
    errors: list[float] = field(default_factory=list)
    """Largest error of the contact's conditions in each sweep (m), zero where there is nothing to correct."""
    jumped: set[int] = field(default_factory=set)
    """Numbers of the ridges that went past a fold: their gain was above one and their air gap changed by far."""


class Coupling:
    """Solves macroscale and closure together.

    Attributes:
        d_eq: equivalent air gap of each ridge (m).
        history: sweeps of the last solve.
        gain: d closure(p_c) / d d_eq of each ridge, the last secant of the last solve that moved its air gap;
            NaN where none did yet. Below one the ridge's loop contracts: its state is stable if that of
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
            tolerance: relative error of d_eq, r / (1 - gain), at which the loop ends; gains count up to 0.99.
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
        previous: tuple[Array, Array] | None = None
        start, gain = self.d_eq, self.gain.copy()
        past = np.zeros(len(gain), dtype=bool)  # whether a gain of one was seen
        steep: NDArray[np.int64] = np.zeros(len(gain), dtype=np.int64)  # secants in a row near a gain of one or above
        for sweep in range(self.cap):
            d = self.d_eq
            found, state = self._sweep(creep or sweep > 0)
            r = found - d if charged else np.zeros_like(d)  # without attraction the air gaps do not act
            error = formulation.error(state, contact_history, problem.interface.mu_f)
            self.history.errors.append(problem.mesh.comm.allreduce(error, op=MPI.MAX))
            worst = int(np.argmax(np.abs(r) / d))
            self.history.changes.append(float(np.abs(r[worst]) / d[worst]))
            self.history.ridges.append(self.observer.surface.names[worst])
            if previous is not None:
                moved = np.abs(d - previous[0]) / d
                seen = moved > max(_SEEN, _LEADS * moved.max())
                gain = np.where(seen, _secant(d, r, previous), gain)
                steep = np.where(seen, np.where(gain > 1 - 1 / _AMPLIFIED[0], steep + 1, 0), steep)
                past |= seen & (gain >= 1)
                jumped = past & (np.abs(d - start) > _JUMP * start)
                self.history.jumped = {self.observer.surface.names[k] for k in np.flatnonzero(jumped)}
            scales = bool((np.abs(r) * _amplification(gain, 2) <= self.tolerance * d).all())
            contact = self.history.errors[-1] <= formulation.tolerance
            if scales and contact:
                if charged:
                    self.gain = gain
                else:
                    self.set_air_gaps(found)
                return
            if not contact:
                contact_history = formulation.corrected(state, contact_history)
                problem.correct_history(contact_history)
            if not scales:
                most = np.inf if previous else np.maximum(np.abs(r), _FIRST * d)
                step = np.clip(r * _amplification(gain, steep), -most, most)
                self.set_air_gaps(d + np.clip(step, -d / 3, d / 2))
                previous = d, r
        ridge, error = self.history.ridges[-1], self.history.errors[-1]
        where = f"a contact error of {error:.2g} m" if scales else f"ridge {ridge}"
        raise NotConverged(f"COUPLING_CAP at {where}", False)


def _secant(d: Array, r: Array, previous: tuple[Array, Array]) -> Array:
    """Return the gain of each ridge from two sweeps' air gaps and what the closure added to them."""
    moved = d - previous[0]
    return 1 + np.divide(r - previous[1], moved, out=np.zeros_like(r), where=moved != 0)


def _amplification(gain: Array, steep: NDArray[np.int64] | int) -> Array:
    """Return 1 / (1 - gain), bounded where the gain is near one or above; no gain known counts as none."""
    most = _AMPLIFIED[np.minimum(steep, len(_AMPLIFIED) - 1)]
    return np.asarray(1 / (1 - np.minimum(np.nan_to_num(gain), 1 - 1 / most)))
