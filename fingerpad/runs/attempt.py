"""One attempt at a run: the path of its loads on one mesh, and the errors of its states."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from fingerpad.accuracy.estimate import with_errors
from fingerpad.accuracy.refinement import Refinement
from fingerpad.accuracy.solves import Solves
from fingerpad.accuracy.states import StateRecorder
from fingerpad.accuracy.whole_path import WholePath
from fingerpad.model.cautions import lost
from fingerpad.model.finger import Step, meshed
from fingerpad.model.options import FingerModel
from fingerpad.model.report import Clock, Report
from fingerpad.model.simulation import RestartRequired, Simulation
from fingerpad.model.state import broken, force_error
from fingerpad.results import fields
from fingerpad.results.data import valued
from fingerpad.results.folder import CheckpointError
from fingerpad.results.interrupt import Interrupt, Interrupted
from fingerpad.results.provenance import provenance, refuse_unread
from fingerpad.results.quantities import Output
from fingerpad.results.result import Result
from fingerpad.results.terminal import Console, in_words
from fingerpad.results.writing import Writer
from fingerpad.runs import post
from fingerpad.runs.checkpoint import Checkpoint
from fingerpad.runs.context import RunContext
from fingerpad.runs.restarts import Restarts, finer, hint
from fingerpad.scene import Scene
from fingerpad.scene.reading import DEFAULT_MODEL
from fingerpad.scene.remarks import coefficient, used
from fingerpad.startup import MPI
from geometry.profiles import GeometryError
from variational.caution import Caution
from variational.solvers.checkpoint import OtherBody
from variational.solvers.continuation import StepFailed

STEPS = 5
"""Accepted steps from one checkpoint to the next, at most; there is one at the end of each load."""


@dataclass(frozen=True)
class Session:
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


class Attempt:
    """A model's path and the errors of its states.

    Attributes:
        simulation: the path.
        report: its states, as they are written.
    """

    def __init__(self, model: FingerModel, session: Session) -> None:
        """Mesh the finger; collective."""
        self._model, self._outputs = model, session.outputs
        self._comm, self._interrupt = session.comm, session.interrupt
        self._checkpoint, self._restarts = session.checkpoint, session.restarts
        self._writer, self._console, self._clock = session.writer, session.console, session.clock
        self._console.phase("meshing the finger and setting up its equations")
        with self._clock.phase("setup"):
            self.simulation = Simulation(model, self._comm, self._on_step, self._on_load)
        loads = [load.name for load in model.loads]
        writer, console, clock = self._writer, self._console, self._clock
        self.report = Report(self.simulation, model.omitted, loads, writer, console, clock, self._outputs)
        self._recorder = StateRecorder(self.simulation) if model.options.errors else None
        self._estimate: Refinement | WholePath | None = None
        self._ended: dict[str, str] = {}
        self._has_kept = False  # whether there is a checkpoint
        self._solves, self._tenths = 0, -1  # for the error estimate: solves, and what is done of the coarser path
        self._steps, self._done = 0, 0.0  # accepted since the last checkpoint; part of the history that is done

    def _on_step(self, step: Step, done: float) -> None:
        refuse_unread()
        self.report.step(step, done)
        if self._recorder is not None:
            self._recorder.record(step)
        self._steps, self._done = self._steps + 1, done
        if self._steps >= STEPS:
            self._keep()
        self._interrupt.stop_if_asked(step.state.step, self._kept())

    def _kept(self) -> str:
        """Return what is kept of a run that is stopped, and how it goes on, in words."""
        if self._writer.folder is None:
            return ""
        steps = "every accepted step is in the folder of results"
        if self._checkpoint is None:
            return steps
        resumes = "fingerpad run --resume FOLDER goes on from there"
        return f"{steps}, and {resumes if self._has_kept else 'the same command starts again'}"

    def _on_load(self) -> None:
        self.report.load_reached()
        self._keep()

    def _keep(self) -> None:
        """Have the next solve use nothing but the accepted state, and keep that if there is a folder; collective."""
        self.simulation.forget()
        self._steps = 0
        if self._checkpoint is None:
            return
        with self._clock.phase("output"):
            recorder = None if self._recorder is None else self._recorder.kept()
            state = {
                "simulation": self.simulation.kept(),
                "report": self.report.kept(),
                "recorder": recorder,
                "restarts": self._restarts.kept(),
                "mesh": self._model.mesh.model_dump(),
                "both_halves": self._model.options.both_halves,
                "done": self._done,
                "seconds": self._clock.present(),
            }
            if self._comm.rank == 0:
                self._checkpoint.write(state, self.report.record.states)
        self._has_kept = True

    def resume(self, kept: dict[str, Any]) -> None:
        """Go on from a checkpoint, as :func:`fingerpad.runs.checkpoint.read` gives it; collective.

        Raises:
            CheckpointError: it is of another mesh.
        """
        self._has_kept, self._done = True, kept["done"]
        states = kept["items"]
        try:
            self.simulation.resume(kept["simulation"], [*states])
        except OtherBody as error:
            raise CheckpointError(f"the checkpoint is of another mesh: {error}") from error
        self.report.resume(states, kept["report"], self._done)
        if self._recorder is not None:
            self._recorder.resume(kept["recorder"])

    def _before_solve(self) -> None:
        """Stop if asked to, or tell how far the error estimate is."""
        self._interrupt.stop_if_asked(self.simulation.finger.continuation.steps, self._kept())
        self._solves += 1
        if self._model.asked:  # until it is met
            assert isinstance(self._estimate, Refinement)
            number, least = self._estimate.to_come, self._estimate.solves.least()
            text = f"states on other meshes, to the accuracy asked for: solve {self._solves}, {number} or more to come"
            self._console.phase(f"{text}; {in_words(number * least)} or more left" if least else text)
            return
        self._console.phase("named states on the final mesh, and their discretisation errors")

    def _on_coarser(self, done: float) -> None:
        """Stop if asked to, or tell how far the coarser path is, at each tenth."""
        self._interrupt.stop_if_asked(self.simulation.finger.continuation.steps, self._kept())
        tenths = int(10 * done)
        if tenths != self._tenths:
            begins, self._tenths = tenths < max(self._tenths, 1), tenths
            words = f"path on elements twice as large, for the discretisation errors: {10 * tenths} % done"
            self._console.phase(words, 0 if begins else done)

    def follow(self) -> RestartRequired | None:
        """Reach every load, and estimate or refine; return what must be added to the model, if anything; collective."""
        reached = False
        try:
            restart = self.simulation.run()
            reached = True
            if restart is not None or self._recorder is None:
                return self._affordable(restart)
            path, show = self._recorder.solve(), self._console.show
            solves = Solves(self._model, path, self._comm, show, self._before_solve)
            if self._model.options.past:
                self._estimate = whole = WholePath(solves, self.report.record.states, self._on_coarser)
                whole.run()
                return None
            self._estimate = refinement = Refinement(solves)
            return self._affordable(refinement.run())
        except StepFailed as error:
            tip = hint(error) if self._model.mesh_file is None else ""
            why, states = str(error), self.report.record.states
            if isinstance(error, Interrupted):
                self._ended["interrupted"] = error.signal.name
            elif states:
                why = lost(error, states[-1], self._model.closure)
            self._ended["failure"] = why if why != str(error) or not tip else f"{why}; {tip}"
            return None if reached else finer(self._model, error, self._comm, why)

    def _affordable(self, restart: RestartRequired | None) -> RestartRequired | None:
        """Return a restart within the memory allowed; None, with a failure, for another one."""
        if restart is None:
            return None
        try:
            meshed(restart.model, self._comm)
        except GeometryError as error:
            self._ended["failure"] = f"{restart.reason}; all loads again would need more memory: {error}"
            return None
        return restart

    def result(self, scene: Scene, context: RunContext) -> Result:
        """Return the result with all that follows from it, and write it; collective.

        Args:
            scene: as it was given.
            context: of the run.
        """
        estimate, finger, record = self._estimate, self.simulation.finger, self.report.record
        final = {} if estimate is None else estimate.base.views
        named = record.named(final, [load.name for load in scene.loads()])
        unknowns, more = finger.unknowns, dict[str, Any]()
        if estimate is not None:
            unknowns, more["accuracy"] = estimate.base.unknowns, estimate.summary()
        self.report.load_reached()
        mu_0, totals = coefficient(scene), record.totals()
        left = max(self._model.numerics.tolerance, totals["floor"])
        error = force_error(unknowns, left, finger.solver.force_scale)
        more |= self._comm.bcast(self._path() | totals | {"force_error": error})
        more |= {"restarts": self._restarts.table, "laws": used(scene), "provenance": provenance()}
        bare = Result(
            scene,
            DEFAULT_MODEL,
            named.get("uncharged"),
            named.get("charged"),
            named.get("full_slip"),
            steps=tuple(record.states),
            loads=tuple(record.loads(scene.loads(), mu_0)),
            cost=self._clock.cost(finger.solver.counts, unknowns),
            failure=self._ended.get("failure", "" if estimate is None else estimate.failure),
            interrupted=self._ended.get("interrupted", ""),
            notes=tuple(self._restarts.notes),
            record=more,
            drawing=record.drawing(mu_0, final, self._model.mesh.contact if final else None, named),
            outputs=tuple(self._outputs),
        )
        motion = self.report.motion() if self._writer.folder is not None and scene.output.each_load else {}

        def with_estimate(result: Result) -> Result:
            found = result.named if estimate is None else with_errors(estimate, result.named, self._outputs)
            drawing = None if result.drawing is None else replace(result.drawing, named=found)
            result = replace(result, drawing=drawing, **found)  # type: ignore[arg-type]
            failure = result.failure or broken(result.full_slip, error, mu_0)
            notes = (*result.notes, *([] if estimate is None else estimate.notes))
            cautions = [] if estimate is None else [Caution("roundoff", each) for each in estimate.solves.doubts()]
            return post.with_cautions(replace(result, failure=failure, notes=notes), cautions)

        def with_outputs(result: Result) -> Result:
            states = {name: valued(state, self._outputs, self.report.lost) for name, state in result.named.items()}
            return replace(result, notes=(*result.notes, *self.report.lost.values()), **states)  # type: ignore[arg-type]

        def with_pictures(result: Result) -> Result:
            with self._clock.phase("output"):
                self.report.final(final)
                if result.folder is not None and result.drawing is not None:
                    fields.write(result.folder, {**result.drawing.groups(scene.output.each_load), **motion})
                    result.drawing.write(result.folder)
            return result

        def with_cost(result: Result) -> Result:  # collective, and never fails on one rank alone
            cost, seconds = self._clock.cost(finger.solver.counts, unknowns), self._clock.seconds["output"]
            return replace(result, cost=cost, record=result.record | {"seconds_output": self._comm.bcast(seconds)})

        own = {
            "errors of the named states": with_estimate,
            "outputs": with_outputs,
            "pictures": with_pictures,
            "cost": with_cost,
        }
        entries = [post.Entry(name, lambda *_: True, compute) for name, compute in own.items()]
        return post.completed(bare, context, self._writer, entries)

    def _path(self) -> dict[str, Any]:
        """Return what the summary holds of the mesh, the options and the times of the path, ready for JSON."""
        finger, model = self.simulation.finger, self._model
        seconds = finger.solver.timings.seconds | self._clock.seconds
        return {
            "unknowns_path": finger.unknowns,
            "path_mesh": None if model.mesh_file else model.mesh.model_dump(),
            "omitted": [asdict(omission) for omission in model.omitted],
            **{f"seconds_{phase}": value for phase, value in seconds.items()},
        }
