"""The accepted state of a coupled problem, to which a rejected attempt returns."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from variational.solvers.target import Control

if TYPE_CHECKING:
    from variational.history import Values
    from variational.solvers.coupling import Coupling

Array = NDArray[np.float64]


@dataclass(frozen=True)
class AcceptedState:
    """Unknowns, history and loads."""

    x: Array
    """This rank's unknowns."""
    bone: Array
    """The bone's translation (m), shape (2,)."""
    history: "Values"
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
    def of(cls, coupling: "Coupling") -> "AcceptedState":
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

    def restore(self, coupling: "Coupling") -> None:
        """Return to the state; collective."""
        solver, problem = coupling.solver, coupling.solver.problem
        solver.x.array_w[:] = self.x
        solver.equations.to_fields(solver.x)
        coupling.set_air_gaps(self.d_eq.copy())
        problem.history.accept(self.history)
        solver.control = replace(self.control)
        problem.voltage.value = self.voltage
        solver.reaction = self.reaction.copy()
