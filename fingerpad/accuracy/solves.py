"""The states of a path solved for again: on other meshes, with other steps, over a stiffer screen; and their cost."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from fingerpad.accuracy.states import Solve, State, StateRecorder, contact_ends, edge_places, together
from fingerpad.model.cautions import adhering, lost
from fingerpad.model.checks import FingerExceeded
from fingerpad.model.finger import Step
from fingerpad.model.options import FingerModel
from fingerpad.model.record import Viewer
from fingerpad.model.schedule import loads_to_normal_contact
from fingerpad.model.simulation import RestartRequired, Simulation
from fingerpad.results.states import SLIDE_ON, WORDS
from geometry.parameters import MeshSize
from geometry.profiles import GeometryError, Profiles
from variational.contact.formulation import Formulation
from variational.solvers.continuation import Attempt, StepFailed
from variational.solvers.transfer import restore

Array = NDArray[np.float64]
_JUMPED = "skin jumped on the way, and roundoff (the number of ranks) may have chosen this state among others"


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
            attempt = self._restored(state, name, again)
        except StepFailed as error:
            raise StepFailed(lost(error, state.state, closure)) from error
        adheres = adhering(self.states[-1], closure)
        if attempt.jump and adheres:
            self.doubts.append(f"{again}: {_JUMPED}: {adheres}")

    def _restored(self, state: State, name: str, again: str) -> Attempt:
        """Return how a state that was put in was solved for."""
        attempt = self._balance(name)
        try:
            steady = not state.direction or self._slip.slides_on(name, state.direction)
        except FingerExceeded as error:
            raise StepFailed(f"{again}: {error}") from error
        if self.restart is not None:
            raise StepFailed(f"{again}: {self.restart.reason}")
        if not steady:
            raise StepFailed(f"{again}, is not steady")
        return attempt

    def over_stiffer_screen(self, formulation: Formulation, name: str, direction: int = 0) -> None:
        """Solve the present state again over springs of twice the stiffness, which bear the same friction; collective.

        Args:
            formulation: the contact over that screen.
            name: of the state.
            direction: the way the bone slides at full slip, 1 or -1; zero for another state.

        Raises:
            StepFailed: no equilibrium was found from there.
        """
        problem = self.finger.problem
        place = problem.history.followed(self.finger.continuation.surface_state.history)["anchor"]
        elastic = problem.history.accepted["anchor"] - place
        problem.history.accept({"anchor": place + elastic / 2 - direction * SLIDE_ON})
        problem.set_formulation(formulation)
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
    normal = {name: state for name, state in states.items() if not state.direction}
    options = replace(model.options, both_halves=model.options.both_halves and not model.options.symmetric_start)
    slips = {name: state for name, state in states.items() if state.direction}
    also = views, stiffer, examined, pause
    solves = [_solve(model.changed(options=options), normal, comm, *also)] if normal else []
    solves += [_solve(model, slips, comm, *also)] if slips else []
    return together(solves)


def _solve(
    model: FingerModel,
    states: Mapping[str, State],
    comm: MPI.Comm,
    views: bool,
    stiffer: Formulation | None,
    examined: Collection[str],
    pause: Callable[[], None],
) -> Solve:
    profiles = Profiles(model.geometry)
    ends = ((contact_ends(state.snapshot, profiles.along_skin, state.facet), state.facet) for state in states.values())
    found = edge_places(ends, model.mesh)
    simulation = StateSolver(model.changed(edges=found), comm)
    recorder, over, finger = StateRecorder(simulation), StateRecorder(simulation), simulation.finger
    springs, soft, viewer = finger.problem.interface.formulation, "", Viewer(finger) if views else None
    for name, state in states.items():
        pause()
        simulation.re_equilibrate(state, WORDS.get(name, name))
        recorder.keep(name, state.direction != 0)
        if name in examined:
            recorder.examine(name)
        if viewer is not None:
            view = viewer.view(simulation.present(finger.ridge_loads()))
            recorder.views[name] = view.at(state.state.bone_x)
        if stiffer is not None:
            try:
                simulation.over_stiffer_screen(stiffer, WORDS.get(name, name), state.direction)
                over.keep(name, state.direction != 0)
            except StepFailed as error:
                soft = str(error)
            finger.problem.set_formulation(springs)
    finger.solver.iteration.free()
    simulation.checks.free()
    stiff = over.solve() if over.states and not soft else None
    return replace(recorder.solve(), stiffer=stiff, soft=soft, doubts=tuple(simulation.doubts))


class Solves:
    """All solves of a path's states, the path's first.

    Attributes:
        model: of the path.
        show: prints a line.
        found: the solves, in order.
        restart: what a path with other steps turned out to need, if anything.
    """

    def __init__(
        self, model: FingerModel, path: Solve, comm: MPI.Comm, show: Callable[[str], None], pause: Callable[[], None]
    ) -> None:
        """Start with the path's states; ``pause`` is called before each solve and may raise to stop."""
        self.model, self.show = model, show
        self._comm, self._pause = comm, pause
        self.found = [path]
        self.restart: RestartRequired | None = None

    def on_mesh(
        self, mesh: MeshSize, states: Mapping[str, State], views: bool = False, stiffer: Formulation | None = None
    ) -> Solve:
        """Return states on a mesh of other element sizes; collective; see :func:`solve_again`.

        Raises:
            GeometryError: the mesh needs too much memory.
            StepFailed: a state was not found.
        """
        self._pause()
        return self._keep(solve_again(self.model.changed(mesh=mesh), states, self._comm, views, stiffer))

    def with_steps(self, step_scale: float) -> Solve:
        """Return normal contact on the first mesh from a path whose largest steps have another scale; collective.

        Raises:
            StepFailed: the path was lost, or needs more of the model (:attr:`restart`).
        """
        numerics = self.model.numerics.model_copy(update={"step_scale": step_scale})
        loads = loads_to_normal_contact(self.model.loads)
        model = self.model.changed(mesh=self.found[0].mesh, loads=loads, numerics=numerics)
        self._pause()
        found = follow(model, self._comm)
        if isinstance(found, RestartRequired):
            more = self.model.changed(mesh=found.model.mesh, options=found.model.options)
            self.restart = replace(found, model=more)
            raise StepFailed(found.reason)
        return self._keep(found)

    def on_coarser_path(self, on_step: Callable[["Simulation", Step, float], None]) -> Solve:
        """Return the named states of the whole path on elements twice as large; collective; see :func:`follow`.

        The loads are gone through again where more of the model turns out to matter on that mesh.

        Raises:
            GeometryError: there is no such mesh.
            StepFailed: the path was lost, or ``on_step`` stopped it.
        """
        mesh = self.model.coarser(self.model.mesh)
        if mesh.contact == self.model.mesh.contact:
            raise GeometryError(f"the ridges have no larger elements than {mesh.contact * 1e6:.3g} µm")
        found = follow(self.model.changed(mesh=mesh), self._comm, on_step)
        while isinstance(found, RestartRequired):
            self.show(f"on elements twice as large: {found.reason}; all loads again")
            found = follow(found.model, self._comm, on_step)
        self.found.append(found)
        return found

    def _keep(self, solve: Solve) -> Solve:
        self.found.append(solve)
        m = solve.mesh
        self.show(
            f"states on another mesh: facets {m.contact * 1e6:.4g} µm, growth {m.growth:.3g}, "
            f"junctions {m.interface * 1e6:.4g} µm, receptors {m.receptor * 1e6:.4g} µm: "
            f"{solve.unknowns} unknowns, {solve.factorisations} factorisations"
        )
        return solve

    def doubts(self) -> list[str]:
        """Return which states roundoff may have chosen among others, a sentence each."""
        return [each for solve in self.found for each in solve.doubts]

    def least(self) -> float:
        """Return the processor time (s) of this rank of the last solve on another mesh; 0 where none was made.

        Those to come have no larger elements, and take as much at least, about.
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
