"""The states of a path solved for again: on other meshes, with other steps, over a stiffer screen; and their cost."""

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from mpi4py import MPI
from numpy.typing import ArrayLike, NDArray

from fingerpad.model.options import FingerModel
from fingerpad.model.record import Viewer
from fingerpad.model.simulation import RestartRequired, Simulation
from fingerpad.results.drawing import View
from fingerpad.results.states import WORDS, before_sliding
from fingerpad.scene import Load
from geometry.parameters import MeshSize
from variational.contact.formulation import Formulation
from variational.output import Receptors
from variational.solvers.continuation import StepFailed
from variational.solvers.transfer import StateSnapshot, take_snapshot
from variational.state import ContactState

if TYPE_CHECKING:
    from fingerpad.model.finger import Step

Array = NDArray[np.float64]


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
    views: dict[str, View] = field(default_factory=dict)
    """What tables and pictures show of states that were solved again, by name."""

    def values(self) -> dict[str, float]:
        """Return the quantities of interest, by the prefix of the state and the name of the quantity."""
        return {
            f"{name}_{quantity}": value
            for name, state in self.states.items()
            for quantity, value in quantities(name, state).items()
        }

    def parts(self) -> dict[str, ArrayLike]:
        """Return the same, contact lengths by ridge, shape (ridges,)."""
        lengths = {f"{name}_contact_length": state.lengths for name, state in self.states.items()}
        return {**self.values(), **lengths}


def quantities(name: str, state: State) -> dict[str, float]:
    """Return the quantities of interest of a named state, in SI; friction is that of full slip.

    Without a force that presses the finger there is no coefficient.
    """
    wanted = ("f_t", "mu_app", "contact_length") if name == "full_slip" else ("contact_length",)
    values = {quantity: float(getattr(state.state, quantity)) for quantity in wanted}
    found = {quantity: value for quantity, value in values.items() if not math.isnan(value)}
    return found | {f"sed_{j}": value for j, value in state.sed.items()}


class StateRecorder:
    """Keeps the two states of a path as it goes: normal contact, and the last full slip that was held."""

    def __init__(self, simulation: Simulation) -> None:
        """Find the Merkel sites of the ridges that can touch."""
        self._simulation = simulation
        self._start = time.process_time()
        finger = simulation.finger
        ridges, profiles = finger.problem.surface.ridge_numbers, finger.profiles
        sites = profiles.merkel_sites()[[profiles.ridges.index(j) for j in ridges]]
        self._sites = Receptors(finger.problem, sites)
        self._begun: State | None = None  # the last full slip, held or not
        self.states: dict[str, State] = {}
        self.views: dict[str, View] = {}

    def record(self, step: "Step") -> None:
        """Record an accepted step; collective."""
        states, state = self._simulation.states, step.state
        if state.ridges_in_contact > 0 and not step.touches and len(before_sliding(states)) == len(states):
            self.keep("charged")
        if state.slip_began == state.step:
            self._begun = self._state(1 if state.f_t >= 0 else -1)
        if state.slip_held and self._begun is not None:
            self.states["full_slip"] = self._begun

    def kept(self) -> dict[str, Any]:
        """Return what another process needs to go on with the path."""
        return {"states": self.states, "begun": self._begun}

    def resume(self, kept: Mapping[str, Any]) -> None:
        """Go on from what another process kept."""
        self.states, self._begun = kept["states"], kept["begun"]

    def keep(self, name: str) -> None:
        """Keep the present state; collective."""
        direction = 1 if self._simulation.finger.solver.reaction[0] <= 0 else -1
        self.states[name] = self._state(direction * (name == "full_slip"))

    def _state(self, direction: int) -> State:
        f = self._simulation.finger
        loads = f.ridge_loads()
        lengths = np.zeros(f.profiles.finger.ridge_count)
        lengths[np.array(f.ridges) + len(lengths) // 2] = loads.length
        sed = {j: float(density) for j, density in zip(f.problem.surface.ridge_numbers, self._sites.sed(), strict=True)}
        present = self._simulation.present(loads).state
        return State(take_snapshot(f.coupling, f.continuation.surface_state), direction, present, lengths, sed)

    def solve(self) -> Solve:
        """Return what was kept."""
        f, seconds = self._simulation.finger, time.process_time() - self._start
        return Solve(self.states, f.size, f.unknowns, f.solver.counts.factorisations, seconds, self.views)


def over_stiffer(snapshot: StateSnapshot) -> StateSnapshot:
    """Return a state whose springs, of twice the stiffness, bear the same friction."""
    halved = {j: {**ridge.history, "anchor": ridge.history["anchor"] / 2} for j, ridge in snapshot.skin.items()}
    skin = {j: replace(ridge, history=halved[j]) for j, ridge in snapshot.skin.items()}
    return replace(snapshot, skin=skin)


def solve_again(model: FingerModel, states: Mapping[str, State], comm: MPI.Comm, views: bool = False) -> Solve:
    """Solve for states of a finger on a model's mesh; collective.

    Args:
        model: with the mesh, and the parts that the states have.
        states: as they were found on another mesh.
        comm: communicator of the mesh.
        views: whether tables and pictures are to show the states (:attr:`Solve.views`).

    Raises:
        StepFailed: see :meth:`fingerpad.model.simulation.Simulation.re_equilibrate`.
    """
    simulation = Simulation(model, comm)
    recorder, finger = StateRecorder(simulation), simulation.finger
    for name, state in states.items():
        simulation.re_equilibrate(state.snapshot, WORDS[name], state.direction)
        recorder.keep(name)
        if views:
            recorder.views[name] = Viewer(finger).view(simulation.present(finger.ridge_loads()))
    finger.solver.iteration.free()
    return recorder.solve()


class Solves:
    """All solves of a path's states, the path's first.

    Attributes:
        model: of the path.
        show: prints a line.
        found: the solves, in order.
        restart: what a path with other steps turned out to need, if anything.
    """

    def __init__(
        self,
        model: FingerModel,
        path: Solve,
        comm: MPI.Comm,
        show: Callable[[str], None],
        pause: Callable[[], None],
    ) -> None:
        """Start with the path's states.

        Args:
            model: of the path.
            path: its states.
            comm: communicator of the meshes.
            show: prints a line.
            pause: called before each solve; may raise to stop.
        """
        self.model, self.show = model, show
        self._comm, self._pause = comm, pause
        self.found = [path]
        self.restart: RestartRequired | None = None

    def on_mesh(self, mesh: MeshSize, states: Mapping[str, State]) -> Solve:
        """Return states on a mesh; collective.

        Args:
            mesh: element sizes.
            states: as they were found on another mesh.

        Raises:
            GeometryError: the mesh needs too much memory.
            StepFailed: a state was not found.
        """
        return self._again(self.model.changed(mesh=mesh), states)

    def over_stiffer_screen(self, base: Solve, contact: Formulation) -> Solve:
        """Return states over a screen of twice the stiffness; collective.

        Args:
            base: the states.
            contact: over that screen.

        Raises:
            StepFailed: a state was not found.
        """
        model = self.model.changed(mesh=base.mesh, contact=contact)
        states = {name: replace(s, snapshot=over_stiffer(s.snapshot)) for name, s in base.states.items()}
        return self._again(model, states)

    def _again(self, model: FingerModel, states: Mapping[str, State]) -> Solve:
        self._pause()
        return self._keep(solve_again(model, states, self._comm, bool(model.asked)))

    def with_steps(self, step_scale: float) -> Solve:
        """Return normal contact on the first mesh from a path with other steps; collective.

        Args:
            step_scale: factor on the largest steps.

        Raises:
            StepFailed: the path was lost, or needs more of the model (:attr:`restart`).
        """
        numerics = self.model.numerics.model_copy(update={"step_scale": step_scale})
        loads = loads_to_normal_contact(self.model.loads)
        model = self.model.changed(mesh=self.found[0].mesh, loads=loads, numerics=numerics)
        self._pause()
        recorder: StateRecorder | None = None

        def on_step(step: "Step", done: float) -> None:
            assert recorder is not None
            recorder.record(step)

        simulation = Simulation(model, self._comm, on_step)
        recorder = StateRecorder(simulation)
        restart = simulation.run()
        if restart is not None:
            more = self.model.changed(mesh=restart.model.mesh, options=restart.model.options)
            self.restart = replace(restart, model=more)
            raise StepFailed(restart.reason)
        return self._keep(recorder.solve())

    def _keep(self, solve: Solve) -> Solve:
        self.found.append(solve)
        m = solve.mesh
        self.show(
            f"states on another mesh: facets {m.contact * 1e6:.4g} µm, growth {m.growth:.3g}, "
            f"junctions {m.interface * 1e6:.4g} µm, receptors {m.receptor * 1e6:.4g} µm: "
            f"{solve.unknowns} unknowns, {solve.factorisations} factorisations"
        )
        return solve

    def least(self) -> float:
        """Return the processor time (s) of this rank that a solve to come takes at least, about; 0 where not known.

        It is that of the last solve on another mesh than the path's, since those to come have no larger elements.
        """
        return next((s.processor_seconds for s in reversed(self.found) if s.mesh != self.found[0].mesh), 0.0)

    def cost(self) -> dict[str, Any]:
        """Return what each solve and all of them took, ready for JSON; collective."""
        seconds = [float(np.sum(self._comm.allgather(solve.processor_seconds))) for solve in self.found]
        return {
            "solves": [
                {
                    "mesh": solve.mesh.model_dump(),
                    "unknowns": solve.unknowns,
                    "factorisations": solve.factorisations,
                    "processor_seconds": spent,
                }
                for solve, spent in zip(self.found, seconds, strict=True)
            ],
            "factorisations": sum(solve.factorisations for solve in self.found),
            "unknowns_times_factorisations": sum(s.unknowns * s.factorisations for s in self.found),
            "processor_seconds": sum(seconds),
        }


def loads_to_normal_contact(loads: tuple[Load, ...]) -> tuple[Load, ...]:
    """Return the loads before the bone first moves sideways with the finger pressed."""
    pressed, place = False, 0.0
    for k, load in enumerate(loads):
        to = load.place(place)
        x = place if to is None else to
        if load.f_ext is not None or load.bone_height is not None:
            pressed = (load.f_ext or 0.0) > 0 or (load.bone_height or 0.0) < 0
        if pressed and x != place:
            return loads[:k]
        place = x
    return loads
