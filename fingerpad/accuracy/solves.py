"""The states of a path solved for again: on other meshes, with other steps, over a stiffer screen; and their cost."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from fingerpad.accuracy import edges
from fingerpad.accuracy.state_solver import StateSolver
from fingerpad.accuracy.states import Solve, State, StateRecorder
from fingerpad.model.options import FingerModel
from fingerpad.model.record import Viewer
from fingerpad.model.simulation import RestartRequired, Simulation
from fingerpad.results.states import WORDS
from fingerpad.scene import Load
from geometry.parameters import MeshSize
from geometry.profiles import GeometryError, Profiles
from variational.contact.formulation import Formulation
from variational.solvers.continuation import StepFailed

if TYPE_CHECKING:
    from fingerpad.model.finger import Step

Array = NDArray[np.float64]


def follow(
    model: FingerModel,
    comm: MPI.Comm,
    on_step: Callable[[Simulation, "Step", float], None] = lambda simulation, step, done: None,
) -> Solve | RestartRequired:
    """Return the named states of a model's path, or what must be added to the model; collective.

    Args:
        model: the finger and its loads.
        comm: communicator of the mesh.
        on_step: called after each accepted step with the path, the step and the part of the history that is done; may
            raise to stop.

    Raises:
        GeometryError: the finger cannot be meshed.
        StepFailed: a load could not be reached.
    """

    def record(step: "Step", done: float) -> None:
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

    Raises:
        StepFailed: see :meth:`StateSolver.re_equilibrate`.
    """
    normal = {name: state for name, state in states.items() if not state.direction}
    options = replace(model.options, both_halves=model.options.both_halves and not model.options.symmetric_start)
    slips = {name: state for name, state in states.items() if state.direction}
    also = views, stiffer, examined
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
) -> Solve:
    profiles = Profiles(model.geometry)
    ends = ((edges.ends(state.snapshot, profiles.along_skin, state.facet), state.facet) for state in states.values())
    found = edges.about(ends, model.mesh)
    simulation = StateSolver(model.changed(edges=found), comm)
    recorder, over, finger = StateRecorder(simulation), StateRecorder(simulation), simulation.finger
    springs, soft, viewer = finger.problem.interface.formulation, "", Viewer(finger) if views else None
    for name, state in states.items():
        simulation.re_equilibrate(state, WORDS.get(name, name))
        recorder.keep(name, state.direction != 0)
        if name in examined:
            recorder.examine(name)
        if viewer is not None:
            recorder.views[name] = viewer.view(simulation.present(finger.ridge_loads()))
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


def together(solves: Sequence[Solve]) -> Solve:
    """Return the states of solves on meshes of the same sizes as those of one."""
    first, *others = solves
    if not others:
        return first
    over = [solve.stiffer for solve in solves if solve.stiffer is not None]
    return replace(
        first,
        states={name: state for solve in solves for name, state in solve.states.items()},
        views={name: view for solve in solves for name, view in solve.views.items()},
        unknowns=max(solve.unknowns for solve in solves),
        factorisations=sum(solve.factorisations for solve in solves),
        processor_seconds=sum(solve.processor_seconds for solve in solves),
        newton=sum(solve.newton for solve in solves),
        stiffer=together(over) if len(over) == len(solves) else None,
        soft=next((solve.soft for solve in solves if solve.soft), ""),
        doubts=tuple(each for solve in solves for each in solve.doubts),
    )


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

    def on_mesh(
        self, mesh: MeshSize, states: Mapping[str, State], views: bool = False, stiffer: Formulation | None = None
    ) -> Solve:
        """Return states on a mesh; collective.

        Args:
            mesh: element sizes.
            states: as they were found on another mesh.
            views: whether tables and pictures are to show the states.
            stiffer: see :func:`solve_again`.

        Raises:
            GeometryError: the mesh needs too much memory.
            StepFailed: a state was not found.
        """
        self._pause()
        return self._keep(solve_again(self.model.changed(mesh=mesh), states, self._comm, views, stiffer))

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
        found = follow(model, self._comm)
        if isinstance(found, RestartRequired):
            more = self.model.changed(mesh=found.model.mesh, options=found.model.options)
            self.restart = replace(found, model=more)
            raise StepFailed(found.reason)
        return self._keep(found)

    def on_coarser_path(self, on_step: Callable[["Simulation", "Step", float], None]) -> Solve:
        """Return the named states of the whole path on elements twice as large; collective.

        The loads are gone through again where more of the model turns out to matter on that mesh.

        Args:
            on_step: see :func:`follow`.

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
