"""One ridge led around a closed cycle of loads without a jump: the energy balance of :mod:`variational.energy`.

Press, charge while the air gap shrinks, slide forth and back, discharge, lift: over the cycle the bone's work, that of
the voltage and that of the air gap are what friction dissipates, and nothing is stored. Work is summed over steps by
the trapezoidal rule, whose error falls with the square of the step, but for points that touch, part or start to slip
somewhere inside a step.
"""

import numpy as np

from benchmarks.verification.bodies import over_screen
from benchmarks.verification.case import Case, Row, order, order_row
from benchmarks.verification.microscale import H_0, MU_F
from geometry.bodies import ridge
from variational.contact.penalty import Penalty
from variational.energy import Balance, EnergyBook
from variational.materials.ogden import Ogden
from variational.problem import Interface
from variational.quantities import Observer
from variational.solvers.equations import Control
from variational.solvers.newton import Solver

D_EQ, VOLTAGE = 2e-6, 100.0
PHASES = ("press", "charge", "slide", "back", "discharge", "lift")
_SIZE, _DEPTH, _FAR = 20e-6, 20e-6, 150e-6  # m


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
    """Lead an unloaded body around the cycle; return the balances by phase.

    Args:
        solver: of the body.
        depth: to which it is pressed (m).
        far: to where it is slid (m).
        steps: of a phase; twice as many of one that slides.
    """
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


def closed_cycle(small: bool) -> list[Row]:
    """The cycle with ever smaller steps."""
    counts = (8, 16, 32) if small else (8, 16, 32, 64, 128)
    skin, interface = Ogden(86.76e3, -14.53, 0.48), Interface(Penalty(1e11, 1e10), MU_F, H_0)
    solvers = [over_screen(ridge(_SIZE), skin, interface, 1.0).solver for _ in counts]
    cycles = [cycle(solver, _DEPTH, _FAR, steps) for solver, steps in zip(solvers, counts, strict=True)]
    balances = [[b for phase in c.values() for b in phase] for c in cycles]
    spent = [sum(b.dissipation for b in found) for found in balances]
    errors = [sum(abs(b.released) for b in found) / d for found, d in zip(balances, spent, strict=True)]
    work = sum(getattr(b, name) for b in balances[-1] for name in ("external", "voltage", "air_gap"))
    left = balances[-1][-1].stored / sum(abs(b.change) for b in cycles[-1]["press"])
    mesh, phases = f"one ridge, P2, {_SIZE * 1e6:g} µm, {counts[-1]} steps a phase", f"{counts[0]} to {counts[-1]}"
    why = "some four times the steps' errors, which fall with their square: a drift shows"
    inside = "points touch, part and start to slip somewhere inside a step"
    imbalance, observed = "the imbalances at which solves end", order((errors[0], errors[-1]), (counts[0], counts[-1]))
    return [
        Row("work over dissipation of the cycle", work / spent[-1], 1.0, 2e-4 if small else 2e-5, why, mesh),
        order_row("order of the steps' unexplained energies", observed, 2.0, 0.25, inside, f"{phases} steps a phase"),
        Row("energy left in the body over that of the press", left, 0.0, 1e-9, imbalance, mesh, absolute=True),
    ]


CASES = (Case("Closed cycle", "first law: work = dissipation over a closed cycle", closed_cycle),)
