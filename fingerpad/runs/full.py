"""The full model of a scene: the whole cross-section with every ridge, along the path of its loads."""

import json
from collections.abc import Sequence
from contextlib import closing
from dataclasses import asdict, dataclass, replace
from typing import Any

import fingerpad.startup  # noqa: F401
from fingerpad.accuracy.estimate import with_errors
from fingerpad.accuracy.refinement import Refinement
from fingerpad.accuracy.solves import StateRecorder
from fingerpad.accuracy.whole_path import WholePath
from fingerpad.model.cautions import examine, lost
from fingerpad.model.finger import Step, meshed
from fingerpad.model.options import FingerModel, by_rule, plan
from fingerpad.model.report import Clock, Report
from fingerpad.model.simulation import RestartRequired, Simulation
from fingerpad.model.slopes import of_run
from fingerpad.model.state import broken, force_error
from fingerpad.results import fields
from fingerpad.results.data import checked, valued
from fingerpad.results.folder import CheckpointError
from fingerpad.results.interrupt import Interrupt, Interrupted, all_together, no_room
from fingerpad.results.provenance import check_options, provenance, refuse_unread
from fingerpad.results.quantities import Output
from fingerpad.results.result import Result
from fingerpad.results.terminal import Console, in_words
from fingerpad.results.writing import Writer
from fingerpad.runs import post
from fingerpad.runs.checkpoint import Checkpoint, checkpoint_of, read
from fingerpad.runs.context import RunContext
from fingerpad.runs.restarts import Restarts, finer, hint
from fingerpad.scene import Scene, SceneError
from fingerpad.scene.reading import DEFAULT_MODEL
from fingerpad.scene.remarks import coefficient, used
from fingerpad.startup import MPI
from geometry.parameters import MeshSize
from geometry.profiles import GeometryError
from variational.solvers.checkpoint import OtherBody
from variational.solvers.continuation import StepFailed

_STEPS = 5  # accepted from one checkpoint to the next, at most; there is one at the end of each load


@dataclass(frozen=True)
class _Session:
    """What all attempts of a run share."""

    comm: MPI.Comm
    writer: Writer
    console: Console
    clock: Clock
    interrupt: Interrupt
    outputs: Sequence[Output]
    restarts: Restarts
    checkpoint: Checkpoint | None
    """None to keep nothing."""


def run(scene: Scene, context: RunContext) -> Result:
    """Reach every load of a scene; refine where it asks for an accuracy; collective.

    Where the scene does not give the number of ridges that can touch, a rule of thumb does. Where ridges come near the
    screen that could not, the path goes on with them; with viscous layers all loads are gone through again. So they are
    where the other half of a finger turns out to matter, which may not stay symmetric, or smaller elements, without
    which no equilibrium is found. A scene that asks for an accuracy starts coarse.

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
    comm, outputs = context.comm or MPI.COMM_WORLD, checked(context.outputs)
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
            session = _Session(comm, writer, console, Clock(comm), Interrupt(comm), outputs, restarts, checkpoint)
            return _run(scene, session, kept, context)
    except GeometryError as error:
        what = "the finger cannot be meshed" if scene.geometry.file is None else "mesh"
        raise SceneError(f"{what}: {error}") from error


def _run(scene: Scene, session: _Session, kept: dict[str, Any] | None, context: RunContext) -> Result:
    """Run a scene until nothing must be added to its model; go on from what an earlier run kept, if it did."""
    writer, console, restarts, checkpoint = session.writer, session.console, session.restarts, session.checkpoint
    writer.log.info("scene %s", json.dumps(scene.parameters()))
    for caution in examine("load", scene):
        writer.log.warning("%s", caution)
    model, loads = FingerModel(by_rule(scene), plan(scene)).of_path(), scene.loads()
    slipping = [load.name for load in loads if load.until_full_slip]
    first = next((k for k, load in enumerate(loads) if load.wave is not None), 0)  # over time
    if kept is not None:
        session.clock.earlier(*kept["seconds"])
        restarts.resume(kept["restarts"])
        more = kept["both_halves"] and not model.options.both_halves
        options = model.options.with_both_halves() if more else model.options
        model = model.changed(mesh=MeshSize(**kept["mesh"]), options=options)
        writer.log.info("goes on after step %d of an earlier run", len(kept["items"]))
        console.show(f"fingerpad: going on with a run of {kept['seconds'][0]:.0f} s; its steps are listed again")
    try:
        with session.interrupt:
            while True:
                attempt = _Attempt(model, session)
                console.expect(len(loads), slipping, coefficient(scene) or 0.0, first)
                restart = attempt.follow() if kept is None else attempt.resume(kept) or attempt.follow()
                if restart is None:
                    break
                states, seconds = attempt.report.record.states, session.clock.processor_seconds()
                restarts.record(restart, states, attempt.simulation.finger, seconds)
                model, kept = restart.model, attempt.carried() if restart.carries else None
                if kept is None:
                    writer.restart()
            result = attempt.result(scene, context)
            cost, where = result.cost, "" if result.folder is None else f"; results in {result.folder}"
            work = f"{cost.newton_iterations} Newton iterations, {cost.factorisations} factorisations"
            spent = f"{cost.memory_mb:.0f} MB, {cost.wall_seconds:.0f} s{where}"
            console.show(f"\n{post.in_words(result)}\n  Work: {work}, {spent}")
            writer.close()
            if checkpoint is not None and session.comm.rank == 0 and not result.interrupted:
                checkpoint.delete()
            return result
    except BaseException as error:
        full = no_room(error, checkpoint is not None and checkpoint.number > 0)
        writer.close()
        if full is None:
            raise
        raise full from error


class _Attempt:
    """The path of a model (``simulation``), its states as they are written (``report``), and their errors."""

    def __init__(self, model: FingerModel, session: _Session) -> None:
        """Mesh the finger; collective."""
        self._model, self._session, self._comm, self._console = model, session, session.comm, session.console
        with session.clock.phase("setup"):
            self._console.phase("meshing the finger and setting up its equations")
            self.simulation = Simulation(model, self._comm, self._on_step, self._on_load)
        written = [load.name for load in model.loads], session.writer, session.console, session.clock
        self.report = Report(self.simulation, model.omitted, *written, session.outputs)
        self._recorder = StateRecorder(self.simulation) if model.options.errors else None
        self._estimate: Refinement | WholePath | None = None
        self._ended, self._has_kept = dict[str, str](), False  # whether there is a checkpoint
        self._solves, self._tenths = 0, -1  # for the error estimate: solves, and what is done of the coarser path
        self._steps, self._done = 0, 0.0  # accepted since the last checkpoint; part of the history that is done

    def _on_step(self, step: Step, done: float) -> None:
        refuse_unread()
        self.report.step(step, done)
        if self._recorder is not None:
            self._recorder.record(step)
        self._steps, self._done = self._steps + 1, done
        if self._steps >= _STEPS:
            self._keep()
        self._session.interrupt.stop_if_asked(step.state.step, self._kept())

    def _kept(self) -> str:
        """Return what is kept of a run that is stopped, and how it goes on, in words."""
        if self._session.checkpoint is None:
            return ""
        goes_on = (
            "fingerpad run --resume FOLDER goes on from there" if self._has_kept else "the same command starts again"
        )
        return f"every accepted step is in the folder of results, and {goes_on}"

    def _on_load(self) -> None:
        self.report.load_reached()
        self._keep()

    def _keep(self) -> None:
        """Have the next solve use nothing but the accepted state, and keep that if there is a folder; collective."""
        self.simulation.forget()
        self._steps = 0
        if self._session.checkpoint is None:
            return
        with self._session.clock.phase("output"):
            state = self._state(self.simulation.kept()) | {
                "restarts": self._session.restarts.kept(),
                "mesh": self._model.mesh.model_dump(),
                "both_halves": self._model.options.both_halves,
                "seconds": self._session.clock.present(),
            }
            if self._comm.rank == 0:
                self._session.checkpoint.write(state, self.report.record.states)
        self._has_kept = True

    def _state(self, simulation: dict[str, Any]) -> dict[str, Any]:
        recorder = self._recorder and self._recorder.kept()
        return {"simulation": simulation, "report": self.report.kept(), "recorder": recorder, "done": self._done}

    def carried(self) -> dict[str, Any]:
        """Return what the attempt on a wider mesh goes on from; collective."""
        return self._state(self.simulation.carried()) | {"items": self.report.record.states, "kept": self._has_kept}

    def resume(self, kept: dict[str, Any]) -> RestartRequired | None:
        """Go on from a checkpoint or another mesh; return that all loads must be gone through again if in vain."""
        self._has_kept, self._done = kept.get("kept", True), kept["done"]
        try:
            self.simulation.resume(kept["simulation"], [*kept["items"]])
        except OtherBody as error:
            raise CheckpointError(f"the checkpoint is of another mesh: {error}") from error
        except (StepFailed, ValueError) as error:
            return RestartRequired(str(error), self._model)
        self.report.resume(kept["items"], kept["report"], self._done, listed="kept" in kept)
        if self._recorder is not None:
            self._recorder.resume(kept["recorder"])
        return None

    def _before_solve(self) -> None:
        """Stop if asked to, or tell how far the error estimate is."""
        self._session.interrupt.stop_if_asked(self.simulation.finger.continuation.steps, self._kept())
        self._solves += 1
        text = "named states on the final mesh, and their discretisation errors"
        if self._model.asked:  # until it is met
            assert isinstance(self._estimate, Refinement)
            number, least = self._estimate.to_come, self._estimate.least()
            text = f"states on other meshes, to the accuracy asked for: solve {self._solves}, {number} or more to come"
            text += f"; {in_words(number * least)} or more left" * bool(least)
        self._console.phase(text)

    def _on_coarser(self, done: float) -> None:
        """Stop if asked to, or tell how far the coarser path is, at each tenth."""
        self._session.interrupt.stop_if_asked(self.simulation.finger.continuation.steps, self._kept())
        tenths = int(10 * done)
        if tenths != self._tenths:
            begins, self._tenths = tenths < max(self._tenths, 1), tenths
            words = f"path on elements twice as large, for the discretisation errors: {10 * tenths} % done"
            self._console.phase(words, 0 if begins else done)

    def follow(self) -> RestartRequired | None:
        """Reach every load, and estimate or refine; return what must be added to the model, if anything; collective."""
        reached, restart = False, None
        try:
            restart = self.simulation.run()
            reached = True
            if restart is None and self._recorder is not None:
                of_path = self._model, self._recorder.solve(), self._comm, self._console.show
                if self._model.options.past:
                    self._estimate = WholePath(*of_path, self.report.record.states, self._on_coarser)
                else:
                    self._estimate = Refinement(*of_path, self._before_solve)
                restart = self._estimate.run()
            if restart is not None:
                meshed(restart.model, self._comm)
            return restart
        except GeometryError as error:
            assert restart is not None
            self._ended["failure"] = f"{restart.reason}; all loads again would need more memory: {error}"
            return None
        except StepFailed as error:
            tip = hint(error) if self._model.mesh_file is None else ""
            why, states = str(error), self.report.record.states
            if isinstance(error, Interrupted):
                self._ended["interrupted"] = error.signal.name
            elif states:
                why = lost(error, states[-1], self._model.closure)
            self._ended["failure"] = why if why != str(error) or not tip else f"{why}; {tip}"
            return None if reached else finer(self._model, error, self._comm, why)

    def result(self, scene: Scene, context: RunContext) -> Result:
        """Return the result of a scene, as it was given, with all that follows from it, and write it; collective."""
        session, estimate = self._session, self._estimate
        finger, record = self.simulation.finger, self.report.record
        final = {} if estimate is None else estimate.base.views
        named = record.named(final, [load.name for load in scene.loads()])
        unknowns, more = finger.unknowns, dict[str, Any]()
        if estimate is not None:
            unknowns, more["accuracy"] = estimate.base.unknowns, estimate.summary()
        self.report.load_reached()
        mu_0, totals = coefficient(scene), record.totals()
        left = max(self._model.numerics.tolerance, totals["floor"])
        error = force_error(unknowns, left, finger.solver.force_scale)
        path_mesh = None if self._model.mesh_file else self._model.mesh.model_dump()
        more |= {"unknowns_path": finger.unknowns, "path_mesh": path_mesh}
        more |= {"omitted": [asdict(omission) for omission in self._model.omitted]}
        more |= of_run(self._model, self.simulation, {} if estimate is None else estimate.base.states)
        seconds = finger.solver.timings.seconds | session.clock.seconds
        timed = {f"seconds_{phase}": value for phase, value in seconds.items()}
        more |= self._comm.bcast(timed | totals | {"force_error": error})
        more |= {"restarts": session.restarts.table, "laws": used(scene), "provenance": provenance()}
        bare = Result(
            scene,
            DEFAULT_MODEL,
            *(named.get("uncharged"), named.get("charged"), named.get("full_slip")),
            steps=tuple(record.states),
            loads=tuple(record.loads(scene.loads(), mu_0)),
            cost=session.clock.cost(finger.solver.counts, unknowns),
            failure=self._ended.get("failure", "" if estimate is None else estimate.failure),
            interrupted=self._ended.get("interrupted", ""),
            notes=tuple(session.restarts.notes),
            record=more,
            drawing=record.drawing(mu_0, final, self._model.mesh.contact if final else None, named),
            outputs=tuple(session.outputs),
        )
        motion = self.report.motion() if session.writer.folder is not None and scene.output.each_load else {}

        def with_estimate(result: Result) -> Result:
            found = result.named if estimate is None else with_errors(estimate, result.named, session.outputs)
            drawing = None if result.drawing is None else replace(result.drawing, named=found)
            result = replace(result, drawing=drawing, **found)  # type: ignore[arg-type]
            failure = result.failure or broken(result.full_slip, error, mu_0)
            notes = (*result.notes, *([] if estimate is None else estimate.notes))
            cautions = [] if estimate is None else estimate.doubts()
            return post.with_cautions(replace(result, failure=failure, notes=notes), cautions)

        def with_outputs(result: Result) -> Result:
            lost = self.report.lost
            states = {name: valued(state, session.outputs, lost) for name, state in result.named.items()}
            return replace(result, notes=(*result.notes, *lost.values()), **states)  # type: ignore[arg-type]

        def with_pictures(result: Result) -> Result:
            with session.clock.phase("output"):
                self.report.final(final)
                if result.folder is not None and result.drawing is not None:
                    fields.write(result.folder, {**result.drawing.groups(scene.output.each_load), **motion})
                    result.drawing.write(result.folder)
            return result

        def with_cost(result: Result) -> Result:  # collective, and never fails on one rank alone
            cost, seconds = session.clock.cost(finger.solver.counts, unknowns), session.clock.seconds["output"]
            return replace(result, cost=cost, record=result.record | {"seconds_output": self._comm.bcast(seconds)})

        own = [
            post.Entry("errors of the named states", with_estimate),
            post.Entry("outputs", with_outputs),
            post.Entry("pictures", with_pictures),
            post.Entry("cost", with_cost),
        ]
        return post.completed(bare, context, session.writer, own)
