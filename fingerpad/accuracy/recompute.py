"""States of a path that can be solved again: kept on the way, restored on another mesh, solved for there."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import ArrayLike, NDArray

from fingerpad.io.states import PREFIXES, WORDS, before_sliding
from fingerpad.model.options import ModelOptions
from fingerpad.model.simulation import Simulation
from fingerpad.model.steps import Step
from fingerpad.scene import Scene
from geometry.parameters import MeshSize
from variational.receptors import Receptors
from variational.solvers.transfer import StateSnapshot, take_snapshot
from variational.state import ContactState

Array = NDArray[np.float64]


def words(name: str) -> str:
    """Return a state's name in words."""
    return WORDS.get(name, name)


@dataclass(frozen=True)
class State:
    """A state that can be solved again, the same on every rank."""

    snapshot: StateSnapshot
    direction: int
    """The way the bone slides at full slip, zero in normal contact."""
    state: ContactState
    lengths: Array
    """Length in contact (m) of every ridge of the finger, shape (ridges,)."""
    sed: dict[int, float]
    """Strain energy density (J/m^3) at the Merkel sites of the ridges that can touch."""


@dataclass(frozen=True)
class Solve:
    """States on one mesh, and what they cost."""

    states: dict[str, State]
    """By ``charged`` and ``full_slip``."""
    mesh: MeshSize
    unknowns: int
    factorisations: int
    processor_seconds: float
    """Of this rank."""
    views: dict[str, Any] = field(default_factory=dict)
    """What is to be shown of states that were solved again, by name."""

    def values(self) -> dict[str, float]:
        """Return the quantities of interest, by the prefix of the state and the name of the quantity."""
        return {
            f"{PREFIXES.get(name, name)}_{quantity}": value
            for name, state in self.states.items()
            for quantity, value in quantities(name, state).items()
        }

    def parts(self) -> dict[str, ArrayLike]:
        """Return the same, contact lengths by ridge, shape (ridges,)."""
        lengths = {f"{PREFIXES.get(name, name)}_contact_length": state.lengths for name, state in self.states.items()}
        return {**self.values(), **lengths}


def quantities(name: str, state: State) -> dict[str, float]:
    """Return the quantities of interest of a named state, in SI; friction is that of full slip."""
    wanted = ("f_t", "mu_app", "contact_length") if name == "full_slip" else ("contact_length",)
    found = {quantity: getattr(state.state, quantity) for quantity in wanted}
    return found | {f"sed_{j}": value for j, value in state.sed.items()}


class StateRecorder:
    """Keeps the two states of a path as it goes: normal contact, and the last full slip that was held."""

    def __init__(self, simulation: Simulation) -> None:
        """Find the Merkel sites of the ridges that can touch."""
        self._simulation = simulation
        self._start = time.process_time()
        ridges, profiles = simulation.problem.surface.ridge_numbers, simulation.profiles
        sites = profiles.merkel_sites()[[profiles.ridges.index(j) for j in ridges]]
        self._sites = Receptors(simulation.problem, sites)
        self._begun: State | None = None  # the last full slip, held or not
        self.states: dict[str, State] = {}
        self.views: dict[str, Any] = {}

    def see(self, step: Step) -> None:
        """Take note of an accepted step; collective."""
        states, state = self._simulation.states, step.state
        if state.ridges_in_contact > 0 and len(before_sliding(states)) == len(states):
            self.keep("charged")
        if state.slip_began == state.step:
            self._begun = self._state(1 if state.f_t >= 0 else -1)
        if state.slip_held and self._begun is not None:
            self.states["full_slip"] = self._begun

    def keep(self, name: str) -> None:
        """Keep the present state; collective."""
        self.states[name] = self._state((1 if self._simulation.solver.reaction[0] <= 0 else -1) * (name == "full_slip"))

    def _state(self, direction: int) -> State:
        s = self._simulation
        loads = s.ridge_loads()
        lengths = np.zeros(s.scene.geometry.ridge_count)
        lengths[np.array(s.ridges) + len(lengths) // 2] = loads.length
        sed = {j: float(density) for j, density in zip(s.problem.surface.ridge_numbers, self._sites.sed(), strict=True)}
        present = s.present(loads).state
        return State(take_snapshot(s.coupling, s.continuation.surface_state), direction, present, lengths, sed)

    def solve(self) -> Solve:
        """Return what was kept."""
        s, seconds = self._simulation, time.process_time() - self._start
        return Solve(self.states, s.scene.mesh, s.unknowns, s.solver.counts.factorisations, seconds, self.views)


def solve_again(
    scene: Scene,
    needed: ModelOptions,
    states: Mapping[str, State],
    comm: MPI.Comm,
    look: Callable[[Simulation], Any] | None = None,
) -> Solve:
    """Solve for states of a scene's finger on the scene's mesh; collective.

    Args:
        scene: with the mesh.
        needed: the parts of the model that the states have.
        states: as they were found on another mesh.
        comm: communicator of the mesh.
        look: returns what is to be shown of the state that a simulation is in, for :attr:`Solve.views`.

    Raises:
        StepFailed: see :meth:`fingerpad.model.simulation.Simulation.re_equilibrate`.
    """
    simulation = Simulation(scene, needed, comm, lambda step, done: None, lambda: None)
    keeper = StateRecorder(simulation)
    for name, state in states.items():
        simulation.re_equilibrate(state.snapshot, words(name), state.direction)
        keeper.keep(name)
        if look is not None:
            keeper.views[name] = look(simulation)
    return keeper.solve()
