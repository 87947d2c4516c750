"""One ridge led around a closed cycle of loads without a jump: the energy balance of :mod:`variational.energy`.

Press, charge while the air gap shrinks, slide forth and back, discharge, lift: over the cycle the bone's work, that of
the voltage and that of the air gap are what friction dissipates, and nothing is stored. Work is summed over steps by
the trapezoidal rule, whose error falls with the square of the step, but for points that touch, part or start to slip
somewhere inside a step.
"""

import numpy as np
from mpi4py import MPI

from benchmarks.verification.case import Case, Curves, Outcome, Row
from benchmarks.verification.microscale import H_0, MU_F
from geometry import tags
from geometry.bodies import ridge
from geometry.mesh import load
from variational.body import Body
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
_WORKS = ("external", "voltage", "air_gap")


class Walk:
    """Leads a solver from state to state and keeps its book."""

    def __init__(self, solver: Solver) -> None:
        self.solver, self.observer = solver, Observer(solver.problem)
        self.state = self.observer.state()
        self.book = EnergyBook(solver.problem, self.state, solver.bone, solver.reaction, np.array([D_EQ]))

    def to(self, control: Control, voltage: float = 0.0, d_eq: float = D_EQ) -> Balance:
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
    """Lead a body around the cycle; the balances by phase.

    Args:
        solver: of the unloaded body.
        depth: to which it is pressed (m).
        far: to where it is slid (m).
        steps: of a phase; twice as many of one that slides.
    """
    walk = Walk(solver)
    up = np.arange(1, steps + 1) / steps
    way = far * np.arange(1, 2 * steps + 1) / (2 * steps)
    down, back = 1 - up, far - way
    small = 0.7 * D_EQ

    def charge(part: float) -> Balance:
        return walk.to(Control(0.0, -depth), VOLTAGE * np.sqrt(part), D_EQ + part * (small - D_EQ))

    return {
        "press": [walk.to(Control(0.0, -depth * part)) for part in up],
        "charge": [charge(part) for part in up],
        "slide": [walk.to(Control(x, -depth), VOLTAGE, small) for x in way],
        "back": [walk.to(Control(x, -depth), VOLTAGE, small) for x in back],
        "discharge": [charge(part) for part in down],
        "lift": [walk.to(Control(0.0, -depth * part)) for part in down],
    }


def _ridge() -> Solver:
    body = load(MPI.COMM_WORLD, ridge(_SIZE))
    skin = {tags.STRATUM_CORNEUM: Ogden(86.76e3, -14.53, 0.48)}
    law = Interface(Penalty(1e11, 1e10), MU_F, H_0)
    return Body(body, skin, law).solver


def closed_cycle(small: bool) -> Outcome:
    """The cycle with ever smaller steps."""
    counts = (8, 16, 32) if small else (8, 16, 32, 64, 128)
    cycles = [cycle(_ridge(), _DEPTH, _FAR, steps) for steps in counts]
    balances = [[b for phase in c.values() for b in phase] for c in cycles]
    work = np.array([sum(getattr(b, name) for b in found for name in _WORKS) for found in balances])
    spent = np.array([sum(b.dissipation for b in found) for found in balances])
    errors = np.array([sum(abs(b.released) for b in found) for found in balances]) / spent
    order = float(np.log2(errors[0] / errors[-1]) / (len(counts) - 1))
    turned_over = sum(abs(b.change) for b in cycles[-1]["press"])
    mesh = f"one ridge, P2, {_SIZE * 1e6:g} µm, {counts[-1]} steps a phase"

    left, imbalance = balances[-1][-1].stored / turned_over, "the imbalances at which solves end"
    inside = "points touch, part and start to slip somewhere inside a step"
    phases = f"{counts[0]} to {counts[-1]} steps a phase"
    why = "some four times the steps' errors, which fall with their square: a drift shows"
    rows = (
        Row("work over dissipation of the cycle", work[-1] / spent[-1], 1.0, 2e-4 if small else 2e-5, why, mesh),
        Row("order of the steps' unexplained energies", order, 2.0, 0.25, inside, phases, order=order, absolute=True),
        Row("energy left in the body over that of the press", left, 0.0, 1e-9, imbalance, mesh, absolute=True),
    )
    known = {"order 2": (counts, errors[0] * (counts[0] / np.array(counts)) ** 2)}
    computed = {"sum over all steps": (counts, errors)}
    curves = Curves("steps a phase (–)", "unexplained over dissipated energy (–)", known, computed, logarithmic=True)
    return Outcome(rows, curves)


CASES = (Case("Closed cycle", "first law: work = dissipation over a closed cycle", closed_cycle),)
