"""The full model of a scene: the whole cross-section with every ridge, along the path of its loads."""

import signal
from functools import partial
from pathlib import Path
from typing import Any

import fingerpad.started  # noqa: F401
from fingerpad.accuracy.recompute import StateRecorder
from fingerpad.accuracy.refinement import Refinement
from fingerpad.io import petsc_options
from fingerpad.io.abort import all_together, no_room
from fingerpad.io.console import Console
from fingerpad.io.interrupt import Interrupt, Interrupted
from fingerpad.io.place import Place
from fingerpad.io.result import Result
from fingerpad.model.contact_zone import RestartRequired
from fingerpad.model.hints import advice, finer_mesh_may_help
from fingerpad.model.memory import refuse_beyond
from fingerpad.model.options import plan
from fingerpad.model.report import Report
from fingerpad.model.simulation import Simulation
from fingerpad.model.steps import Step
from fingerpad.model.touching import by_rule
from fingerpad.scene import Scene, SceneError
from fingerpad.startup import MPI
from geometry.profiles import GeometryError
from variational import jit
from variational.solvers.continuation import StepFailed

FINEST = 5e-6
"""Contact size (m) down to which a run starts again by itself where the path of its loads cannot be followed."""


def run(scene: Scene, folder: Path | None, comm: MPI.Comm, lines: bool = True) -> Result:
    """Reach every load of a scene; refine where it asks for an accuracy; collective.

    Where no equilibrium is found and smaller elements may help, the run starts again with half the contact size, down
    to :data:`FINEST`, and says so. A scene that asks for an accuracy starts coarse.

    Where the scene does not give the number of ridges that can touch, a rule of thumb does. Where what was left out
    turns out to matter, all loads are gone through again with it: ridges that come near the screen and could not
    touch, the other half of a finger that may not stay symmetric.

    Args:
        scene: what is run.
        folder: of tables, plots and fields; None to write nothing.
        comm: communicator of the run.
        lines: whether to print the steps.

    Returns:
        The result, the same on every rank. It has a ``failure`` if a load or an accuracy could not be reached; every
        step before is in it and in the folder all the same. It has ``interrupted``, the name of the signal, if the run
        was asked to stop.

    Raises:
        PlaceError: the folder is in use, holds another scene's results, or cannot be written to.
        OptionError: PETSc refuses an option.
        SceneError: the finger cannot be meshed; on every rank.
        DiskFull: there is no more room for results; on the ranks that found out, which end the others.
    """
    all_together(comm)
    petsc_options.check()
    try:
        if folder is None:
            return _refine_start(scene, None, comm, lines)
        with Place(folder, scene, comm) as place:
            return _refine_start(scene, place, comm, lines)
    except GeometryError as error:
        what = "the finger cannot be meshed" if scene.laws.mesh is None else "mesh"
        raise SceneError(f"{what}: {error}") from error


def exit_code(result: Result) -> int:
    """Return what a program ends with after a run: 0, 1 after a failure, or what the shell calls a signal."""
    if result.interrupted:
        return 128 + signal.Signals[result.interrupted]
    return 1 if result.failure else 0


def _refine_start(scene: Scene, place: Place | None, comm: MPI.Comm, lines: bool) -> Result:
    """Run a scene, from a finer mesh again where the path of its loads cannot be followed."""
    starts: list[dict[str, Any]] = []
    while True:
        result, again = _run(scene, place, comm, lines, starts)
        finer = scene.mesh.contact / 2
        if not (again and finer >= FINEST):
            return result
        smaller = scene.model_copy(update={"mesh": scene.mesh.model_copy(update={"contact": finer})})
        try:
            refuse_beyond(smaller)
        except GeometryError:  # more than the memory allowed
            return result
        cost = result.cost
        starts.append(
            {
                "contact": scene.mesh.contact,
                "failure": result.failure,
                "unknowns": cost.unknowns,
                "factorisations": cost.factorisations,
                "processor_seconds": cost.processor_seconds,
            }
        )
        scene = smaller


def _run(
    scene: Scene, place: Place | None, comm: MPI.Comm, lines: bool, failed_starts: list[dict[str, Any]]
) -> tuple[Result, bool]:
    """Run a scene once, from the mesh that it gives.

    Returns:
        The result, and whether a finer mesh may help where the path of the loads was lost.
    """
    console = Console(comm, lines)
    report = Report(scene, place, comm, console)
    tried = [
        f"No equilibrium was found with a contact size of {start['contact'] * 1e6:g} µm; "
        "the run started again with half of it."
        for start in failed_starts
    ]
    for note in tried:
        report.say(note)
    ended: dict[str, Any] = {}
    again = False
    jit.sweep(comm)
    try:
        with Interrupt(comm) as interrupt:
            keeper: StateRecorder | None = None

            def on_step(step: Step, done: float) -> None:
                petsc_options.refuse_unread()
                report.step(step, done)
                if keeper is not None:
                    keeper.see(step)
                interrupt.stop_if_asked(step.state.step)

            present, needed, waking = by_rule(scene), plan(scene), True
            while waking:
                search: Refinement | None = None  # one that was woken from is of another finger
                simulation = Simulation(present, needed, comm, on_step, report.load_reached)
                report.open(simulation)
                keeper = StateRecorder(simulation) if needed.errors else None
                waking, reached = False, False
                try:
                    simulation.run()
                    reached = True
                    if keeper is not None:
                        pause = partial(interrupt.stop_if_asked, simulation.continuation.steps)
                        look = report.look if present.accuracy is not None else None
                        search = Refinement(present, needed, keeper.solve(), comm, report.say, pause, look)
                        search.run()
                except RestartRequired as wake:
                    present, needed, waking = wake.scene, wake.needed, True
                    report.restart(wake)
                except StepFailed as error:
                    remedy = advice(error) if scene.laws.mesh is None else ""
                    ended = {"failure": "; ".join(filter(None, (str(error), remedy)))}
                    if isinstance(error, Interrupted):
                        ended["interrupted"] = error.signal.name
                    own = scene.laws.mesh is None and not reached
                    again = own and finer_mesh_may_help(error, scene.accuracy is not None)
            named = report.named()
            if search is not None:
                notes, found = _found(search)
                named, ended = search.states(named), found | ended
                tried += notes
                report.finer(search.base.views)
                named = report.on_final_mesh(named)
            ended |= {"notes": tried}
            if failed_starts:
                ended["failed_starts"] = failed_starts
            report.load_reached()
            result = report.result(named, ended)
            if result.failure:
                report.log.error(result.failure)
            _tell(result, report, place)
            report.close()
            return result, again
    except BaseException as error:
        # On more ranks than this, or not: what waits for the others would never return.
        report.close(whole=comm.size == 1 and no_room(error) is None)
        full = no_room(error)
        if full is None:
            raise
        raise full from error


def _found(search: Refinement) -> tuple[list[str], dict[str, Any]]:
    """Return the notes of a search for errors, and what a result takes from it; collective."""
    found: dict[str, Any] = {"accuracy": search.summary(), "unknowns": search.base.unknowns}
    return search.notes, found | ({"failure": search.failure} if search.failure else {})


def _tell(result: Result, report: Report, place: Place | None) -> None:
    """Print the block of results, the failure and the work."""
    report.say(f"\n{result}")
    cost = result.cost
    work = f"{cost.newton_iterations} Newton iterations, {cost.factorisations} factorisations, {cost.memory_mb:.0f} MB"
    where = "" if place is None else f"; results in {place.folder}"
    report.say(f"  Work: {work}, {cost.wall_seconds:.0f} s{where}")
