"""The full model of a scene: the whole cross-section with every ridge, along the path of its loads."""

import json
import signal
from contextlib import closing
from typing import Any

import fingerpad.startup  # noqa: F401
from fingerpad.model.cautions import examine
from fingerpad.model.options import FingerModel, by_rule, plan
from fingerpad.model.report import Clock
from fingerpad.results.data import checked
from fingerpad.results.interrupt import Interrupt, all_together, no_room
from fingerpad.results.provenance import check_options
from fingerpad.results.result import Result
from fingerpad.results.terminal import Console
from fingerpad.results.writing import Writer
from fingerpad.runs.attempt import Attempt, Session
from fingerpad.runs.checkpoint import checkpoint_of, read
from fingerpad.runs.context import RunContext
from fingerpad.runs.post import in_words
from fingerpad.runs.restarts import Restarts
from fingerpad.scene import Scene, SceneError
from fingerpad.scene.reading import DEFAULT_MODEL
from fingerpad.scene.remarks import coefficient
from fingerpad.startup import MPI
from geometry.parameters import MeshSize
from geometry.profiles import GeometryError


def run(scene: Scene, context: RunContext) -> Result:
    """Reach every load of a scene; refine where it asks for an accuracy; collective.

    Where the scene does not give the number of ridges that can touch, a rule of thumb does. All loads are gone through
    again where an omitted part of the model turns out to matter: ridges that come near the screen and could not touch,
    the other half of a finger that may not stay symmetric, or smaller elements where no equilibrium is found without
    them. A scene that asks for an accuracy starts coarse.

    Args:
        scene: what is run.
        context: ranks, folder, console, and whether to go on from the checkpoint in the folder.

    Returns:
        The result, the same on every rank. It has a ``failure`` if a load or an accuracy could not be reached; every
        step before is in it and in the folder all the same. It has ``interrupted``, the name of the signal, if the run
        was asked to stop.

    Raises:
        FolderError: the folder is in use, holds another scene's results, or cannot be written to.
        CheckpointError: the run cannot go on from what is in the folder.
        OptionError: PETSc refuses an option.
        SceneError: the finger cannot be meshed; on every rank.
        DiskFull: there is no more room for results; on the ranks that found out, which end the others.
    """
    comm = context.comm or MPI.COMM_WORLD
    outputs = checked(context.outputs)
    all_together(comm)
    check_options(comm, scene.numerics.element)
    try:
        with (
            closing(Console(comm, context.lines, context.bar, context.on_step)) as console,
            context.place(scene, DEFAULT_MODEL) as place,
        ):
            checkpoint = None if place is None else checkpoint_of(scene, place.folder, outputs)
            kept = read(checkpoint, comm) if context.resume and checkpoint is not None else None
            writer = Writer(place, comm)
            restarts = Restarts(writer.log, console)
            session = Session(comm, writer, console, Clock(comm), Interrupt(comm), outputs, restarts, checkpoint)
            return _run(scene, session, kept, context)
    except GeometryError as error:
        what = "the finger cannot be meshed" if scene.geometry.file is None else "mesh"
        raise SceneError(f"{what}: {error}") from error


def _run(scene: Scene, session: Session, kept: dict[str, Any] | None, context: RunContext) -> Result:
    """Run a scene until nothing must be added to its model; go on from what an earlier run kept, if it did."""
    comm, writer, console = session.comm, session.writer, session.console
    clock, restarts, checkpoint = session.clock, session.restarts, session.checkpoint
    writer.log.info("scene %s", json.dumps(scene.parameters()))
    for caution in examine("load", scene):
        writer.log.warning("%s", caution)
    model = FingerModel(by_rule(scene), plan(scene)).of_path()
    if kept is not None:
        clock.earlier(*kept["seconds"])
        restarts.resume(kept["restarts"])
        more = kept["both_halves"] and not model.options.both_halves
        options = model.options.with_both_halves() if more else model.options
        model = model.changed(mesh=MeshSize(**kept["mesh"]), options=options)
        writer.log.info("goes on after step %d of an earlier run", len(kept["items"]))
        console.show(f"fingerpad: going on with a run of {kept['seconds'][0]:.0f} s; its steps are listed again")
    try:
        with session.interrupt:
            while True:
                attempt = Attempt(model, session)
                _expect(scene, console)
                if kept is not None:
                    attempt.resume(kept)
                    kept = None
                restart = attempt.follow()
                if restart is None:
                    break
                restarts.record(restart, attempt.report.record.states, attempt.simulation.finger, clock)
                writer.restart()
                model = restart.model
            result = attempt.result(scene, context)
            console.show(f"\n{in_words(result)}\n{_work(result)}")
            writer.close()
            if checkpoint is not None and comm.rank == 0 and not result.interrupted:
                checkpoint.delete()
            return result
    except BaseException as error:
        full = no_room(error, checkpoint is not None and checkpoint.number > 0)
        writer.close()
        if full is None:
            raise
        raise full from error


def _expect(scene: Scene, console: Console) -> None:
    """Describe the path to the console: its loads, which end with full slip, and the first over time."""
    loads = scene.loads()
    slipping = [load.name for load in loads if load.until_full_slip]
    first = next((k for k, load in enumerate(loads) if load.wave is not None), 0)
    console.expect(len(loads), slipping, coefficient(scene) or 0.0, first)


def exit_code(result: Result) -> int:
    """Return what a program ends with after a run: 0, 1 after a failure, or what the shell calls a signal."""
    if result.interrupted:
        return 128 + signal.Signals[result.interrupted]
    return 1 if result.failure else 0


def _work(result: Result) -> str:
    """Return the line that ends a run."""
    cost = result.cost
    work = f"{cost.newton_iterations} Newton iterations, {cost.factorisations} factorisations, {cost.memory_mb:.0f} MB"
    where = "" if result.folder is None else f"; results in {result.folder}"
    return f"  Work: {work}, {cost.wall_seconds:.0f} s{where}"
