"""A body led around a closed cycle of loads without a jump, for the energy balance of :mod:`variational.energy`.

Press, charge while the air gap shrinks, slide forth and back, discharge, lift: over the cycle the bone's work, that of
the voltage and that of the air gap are what friction dissipates, and nothing is stored.
"""

import numpy as np

from variational.energy import Balance, EnergyBook
from variational.resultants import Observer
from variational.solvers.equations import Control
from variational.solvers.newton import Solver

D_EQ, VOLTAGE = 2e-6, 100.0
PHASES = ("press", "charge", "slide", "back", "discharge", "lift")


class Walk:
    """Leads a solver from state to state and keeps its book."""

    def __init__(self, solver: Solver) -> None:
        self.solver, self.observer = solver, Observer(solver.problem)
        self.state = self.observer.state()
        self.book = EnergyBook(solver.problem, self.state, solver.bone, solver.reaction, np.array([D_EQ]))

    def to(self, control: Control, voltage: float = 0.0, d_eq: float = D_EQ) -> Balance:
        """Solve at a bone's position, a voltage (V) and an air gap (m); return the step's balance."""
        solver, problem = self.solver, self.solver.problem
        problem.set_air_gaps(np.array([d_eq]))
        problem.voltage.value, solver.control = voltage, control
        solver.solve(pseudo_transient=True)
        self.state = self.observer.state()
        balance = self.book.step(self.state, solver.bone, solver.reaction, np.array([d_eq]))
        if problem.anchor is not None:
            problem.surface.set_history(problem.anchor, self.state.anchor)
        return balance


def cycle(solver: Solver, depth: float, far: float, steps: int) -> dict[str, list[Balance]]:
    """Press an unloaded body to a depth (m), slide it far (m) and back; return the balances by phase."""
    walk = Walk(solver)
    up = np.arange(1, steps + 1) / steps
    way = far * np.arange(1, 2 * steps + 1) / (2 * steps)
    down, small = 1 - up, 0.7 * D_EQ

    def charge(part: float) -> Balance:
        return walk.to(Control(0.0, -depth), VOLTAGE * np.sqrt(part), D_EQ + part * (small - D_EQ))

    return {
        "press": [walk.to(Control(0.0, -depth * part)) for part in up],
        "charge": [charge(part) for part in up],
        "slide": [walk.to(Control(x, -depth), VOLTAGE, small) for x in way],
        "back": [walk.to(Control(x, -depth), VOLTAGE, small) for x in far - way],
        "discharge": [charge(part) for part in down],
        "lift": [walk.to(Control(0.0, -depth * part)) for part in down],
    }
