"""The named states of a path: kept as it goes, and solved for again on other meshes and over a stiffer screen."""

import math
import time
from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from mpi4py import MPI

from fingerpad.accuracy.states import Solve, State, contact_ends, edge_places, together
from fingerpad.model.cautions import adhering, lost
from fingerpad.model.checks import FingerExceeded
from fingerpad.model.finger import Step, both_sides
from fingerpad.model.options import FingerModel
from fingerpad.model.record import Viewer
from fingerpad.model.simulation import RestartRequired, Simulation
from fingerpad.model.slopes import state_slopes
from fingerpad.results.fields import View
from fingerpad.results.states import SLIDE_ON, WORDS, before_sliding
from geometry.profiles import Profiles
from variational.contact.formulation import Formulation
from variational.output import Receptors
from variational.solvers.continuation import Attempt, StepFailed
from variational.solvers.state_snapshot import take_snapshot
from variational.solvers.transfer import restore
from variational.state import ContactState

_JUMPED = "skin jumped on the way, and roundoff (the number of ranks) may have chosen this state among others"


class StateRecorder:
    """Keeps the named states of a path as it goes; of full slips the last one that was held."""

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

    def record(self, step: Step) -> None:
        """Record an accepted step; collective."""
        state = step.state
        if not step.touches and (step.ends or not math.isnan(state.time)):
            self._normal_contact(state)
        if state.slip_began == state.step:
            self._begun = self._state(1 if state.f_t >= 0 else -1)
        if state.slip_held and self._begun is not None:
            self.states["full_slip"] = self._begun

    def _normal_contact(self, state: ContactState) -> None:
        states = self._simulation.states
        if state.ridges_in_contact > 0 and len(before_sliding(states)) == len(states):
            self.keep("charged")
            if not any(each.voltage for each in states):
                self.states["uncharged"] = self.states["charged"]

    def kept(self) -> dict[str, Any]:
        """Return what another process needs to go on with the path."""
        return {"states": self.states, "begun": self._begun}

    def resume(self, kept: Mapping[str, Any]) -> None:
        """Go on from what another process kept."""
        self.states, self._begun = dict(kept["states"]), kept["begun"]
        pair = [self.states[name] for name in ("uncharged", "charged") if name in self.states]
        if len(pair) == 2 and pair[0].state.step == pair[1].state.step:  # at 0 V one state
            self.states["uncharged"] = pair[1]

    def keep(self, name: str, slips: bool | None = None) -> None:
        """Keep the present state; collective.

        Args:
            name: of the state.
            slips: whether it is a full slip; by default one of that name is.
        """
        direction = 1 if self._simulation.finger.solver.reaction[0] <= 0 else -1
        self.states[name] = self._state(direction * (name == "full_slip" if slips is None else slips))

    def examine(self, name: str) -> None:
        """Add the stability of the present state, which was kept; collective."""
        kept, checked = self.states[name], self._simulation.checks.check(name)
        self.states[name] = replace(kept, state=checked.of(kept.state))

    def keep_slopes(self, name: str, number: int) -> None:
        """Add the slopes of the present state, which was kept, of the load of a number; collective."""
        simulation = self._simulation
        if simulation.model.given:
            found = state_slopes(simulation.model, simulation.finger, number)
            self.states[name] = replace(self.states[name], slopes=found)

    def _state(self, direction: int) -> State:
        f = self._simulation.finger
        loads = f.ridge_loads()
        peaks = f.observer.highest_pressures(f.continuation.surface_state)
        if not f.options.both_halves:
            peaks = both_sides(peaks)
        by_ridge = np.zeros((3, f.profiles.finger.ridge_count))
        by_ridge[:, np.array(f.ridges) + by_ridge.shape[1] // 2] = loads.length, loads.f_friction, peaks
        lengths, frictions, peaks = by_ridge
        sed = {j: float(density) for j, density in zip(f.problem.surface.ridge_numbers, self._sites.sed(), strict=True)}
        if not f.options.both_halves:
            sed |= {-j: density for j, density in sed.items()}
        present = self._simulation.present(loads).state
        snapshot = take_snapshot(f.coupling, f.continuation.surface_state)
        facet = f.size.edge if self._simulation.model.edges else f.contact_size
        return State(snapshot, direction, present, lengths, frictions, peaks, sed, facet)

    def solve(self) -> Solve:
        """Return what was kept."""
        f, seconds = self._simulation.finger, time.process_time() - self._start
        alike = self.states.get("uncharged") is self.states.get("charged")
        states = {name: state for name, state in self.states.items() if name != "uncharged" or not alike}
        counts = f.solver.counts
        return Solve(states, f.size, f.unknowns, counts.factorisations, seconds, counts.newton, views=self.views)


class StateSolver(Simulation):
    """A finger on a mesh of its own, on which states from elsewhere are solved for, without a path.

    Where ridges adhere without a load, or nearly do, a mesh can have several states, which differ in the facets in
    contact at the end of a ridge. If skin jumps as one is solved for, roundoff can decide to which of them.

    Attributes:
        doubts: states that roundoff may have chosen among others, in words.
    """

    def __init__(self, model: FingerModel, comm: MPI.Comm) -> None:
        """Mesh the finger and set the solver up; collective."""
        super().__init__(model, comm)
        self.doubts: list[str] = []

    def re_equilibrate(self, state: State, name: str) -> None:
        """Solve again for a state that was reached on another mesh of the same finger; collective.

        Raises:
            StepFailed: no equilibrium was found from there, or forces are out of balance, or skin touches where it was
                not expected to, or full slip is no longer full or not steady. It names a ridge that adheres.
        """
        again = f"{name}, solved again with a contact size of {self.finger.contact_size:g} m"
        closure = self.model.closure
        try:
            restore(state.snapshot, self.finger.coupling, state.direction * SLIDE_ON)
        except ValueError as error:  # meshes so coarse that one does not have the shape of the other
            raise StepFailed(f"{again}: {error}") from error
        try:
            attempt = self._balance(name)
            steady = not state.direction or self._slip.slides_on(name, state.direction)
            if self.restart is not None:
                raise StepFailed(f"{again}: {self.restart.reason}")
            if not steady:
                raise StepFailed(f"{again}, is not steady")
        except (FingerExceeded, StepFailed) as error:
            why = error if isinstance(error, StepFailed) else f"{again}: {error}"
            raise StepFailed(lost(why, state.state, closure)) from error
        adheres = adhering(self.states[-1], closure)
        if attempt.jump and adheres:
            self.doubts.append(f"{again}: {_JUMPED}: {adheres}")

    def over_stiffer_screen(self, formulation: Formulation, name: str, direction: int = 0) -> None:
        """Solve the present state again over springs of twice the stiffness, which bear the same friction; collective.

        Args:
            formulation: the contact over that screen.
            name: of the state.
            direction: see :attr:`fingerpad.accuracy.states.State.direction`.
        """
        problem = self.finger.problem
        place = problem.history.followed(self.finger.continuation.surface_state.history)["anchor"]
        elastic = problem.history.accepted["anchor"] - place
        problem.history.accept({"anchor": place + elastic / 2 - direction * SLIDE_ON})
        problem.set_interface(replace(problem.interface, formulation=formulation))
        self._balance(name)

    def _balance(self, name: str) -> Attempt:
        """Solve for an equilibrium from the present fields, and accept it; return how it was solved for."""
        finger = self.finger
        self._load = name
        attempt = finger.continuation.re_equilibrate(name)
        self.energy = finger.book()  # what was dissipated on the way is not known
        loads = finger.ridge_loads()
        finger.check_balance(loads, name)
        self.states.append(self._slip.placed(self.states, self.present(loads).state, probe=False))
        try:
            self.restart = self._zone_exceeded(loads)
        except FingerExceeded as error:
            raise StepFailed(f"{name}: {error}") from error
        if self.restart is not None:
            raise StepFailed(f"{name}: {self.restart.reason}")
        return attempt


def follow(
    model: FingerModel,
    comm: MPI.Comm,
    on_step: Callable[[Simulation, Step, float], None] = lambda simulation, step, done: None,
) -> Solve | RestartRequired:
    """Return the named states of a model's path, or what must be added to the model; collective.

    Args:
        model: the finger and its loads.
        comm: communicator of the mesh.
        on_step: called after each accepted step with the path, the step and the part that is done; may raise to stop.

    Raises:
        GeometryError: the finger cannot be meshed.
        StepFailed: a load could not be reached.
    """

    def record(step: Step, done: float) -> None:
        recorder.record(step)
        on_step(simulation, step, done)

    simulation = Simulation(model, comm, record)
    recorder = StateRecorder(simulation)
    restart = simulation.run()
    simulation.finger.solver.iteration.free()
    return recorder.solve() if restart is None else restart


def solve_again(
    model: FingerModel,
    states: Mapping[str, State],
    comm: MPI.Comm,
    views: bool = False,
    stiffer: Formulation | None = None,
    examined: Collection[str] = (),
    pause: Callable[[], None] = lambda: None,
) -> Solve:
    """Solve for states of a finger on meshes that are finest where their contact ends; collective.

    Normal contact and full slip have a mesh each, that of a normal contact which is symmetric is of half the finger.

    Args:
        model: with the element sizes, and the parts that the states have.
        states: as they were found on another mesh.
        comm: communicator of the mesh.
        views: whether tables and pictures are to show the states (:attr:`Solve.views`).
        stiffer: the contact over a screen of twice the stiffness, where the states are wanted over that too.
        examined: names of the states whose stability is to be examined.
        pause: called before each state; may raise to stop.

    Raises:
        StepFailed: see :meth:`StateSolver.re_equilibrate`.
    """
    halves = model.options.both_halves and not model.options.symmetric_start
    normal = model.changed(options=replace(model.options, both_halves=halves))
    also = comm, views, stiffer, examined, pause
    kinds = (
        (each, {name: state for name, state in states.items() if bool(state.direction) is slips})
        for each, slips in ((normal, False), (model, True))
    )
    return together([_solve(each, mine, *also) for each, mine in kinds if mine])


def _solve(
    model: FingerModel,
    states: Mapping[str, State],
    comm: MPI.Comm,
    views: bool,
    stiffer: Formulation | None,
    examined: Collection[str],
    pause: Callable[[], None],
) -> Solve:
    along = Profiles(model.geometry).along_skin
    ends = ((contact_ends(state.snapshot, along, state.facet), state.facet) for state in states.values())
    simulation = StateSolver(model.changed(edges=edge_places(ends, model.mesh)), comm)
    recorder, over, finger = StateRecorder(simulation), StateRecorder(simulation), simulation.finger
    interface, soft, viewer = finger.problem.interface, "", Viewer(finger) if views else None
    for name, state in states.items():
        words = WORDS.get(name, name)
        pause()
        simulation.re_equilibrate(state, words)
        recorder.keep(name, state.direction != 0)
        if name in examined:
            recorder.examine(name)
        if viewer is not None:
            recorder.views[name] = viewer.view(simulation.present(finger.ridge_loads())).at(state.state.bone_x)
            recorder.keep_slopes(name, state.state.load_number)
        if stiffer is not None:
            try:
                simulation.over_stiffer_screen(stiffer, words, state.direction)
                over.keep(name, state.direction != 0)
            except StepFailed as error:
                soft = str(error)
            finger.problem.set_interface(interface)
    finger.solver.iteration.free()
    simulation.checks.free()
    stiff = over.solve() if over.states and not soft else None
    return replace(recorder.solve(), stiffer=stiff, soft=soft, doubts=tuple(simulation.doubts))
