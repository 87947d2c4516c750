"""A force on the whole finger by the full model: traces on coarse elements, corrected on the scene's own.

One simulation has all traces (:mod:`fingerpad.runs.branches`), on the mesh of a run's path, whose elements are twice as
large as the scene's. The state of each trace about at the centre of the finger, and one under a smaller force
(:data:`fingerpad.runs.branches.KEPT`), are solved for again on the scene's own mesh, finest where their contact ends.
These correct the traces (:mod:`fingerpad.slices.correction`); the stability of those at the centre is examined there.

A scene of which a state is not found this way, or that asks for an accuracy, is refused with the reason.
"""

from collections.abc import Sequence
from contextlib import closing
from dataclasses import replace

import fingerpad.startup  # noqa: F401
from fingerpad.accuracy.solves import solve_again
from fingerpad.accuracy.states import State
from fingerpad.model import drive_loads
from fingerpad.model.finger import Step
from fingerpad.model.options import FingerModel, by_rule, plan
from fingerpad.model.report import Clock
from fingerpad.model.state import broken
from fingerpad.results.folder import CheckpointError
from fingerpad.results.interrupt import Interrupt, Interrupted, all_together
from fingerpad.results.provenance import check_options, provenance, refuse_unread
from fingerpad.results.quantities import PENALTY, Output
from fingerpad.results.result import Result
from fingerpad.results.states import WORDS
from fingerpad.results.terminal import Console
from fingerpad.runs.branches import Branches, RestartTraces, TraceStates
from fingerpad.runs.checkpoint import Checkpoint, checkpoint_of, read
from fingerpad.runs.context import RunContext
from fingerpad.runs.post import Entry, cautions_on, kept, of_outputs
from fingerpad.runs.restarts import hint
from fingerpad.scene import Scene, SceneError
from fingerpad.scene.messages import counted
from fingerpad.scene.reading import DEFAULT_MODEL
from fingerpad.scene.remarks import coefficient, used
from fingerpad.slices import errors, traces
from fingerpad.slices.correction import Pair, corrected, correction_errors, mesh_errors, penalty_errors
from fingerpad.slices.total import BeyondTrace, at_force, profile
from fingerpad.slices.trace import TraceError
from fingerpad.slices.traces import Traced
from fingerpad.startup import MPI
from geometry.profiles import GeometryError
from variational.element import ELEMENTS
from variational.solvers.continuation import StepFailed
from variational.solvers.outcome import Counts

_WORDS = "traces of the full model on coarser elements, corrected on those of the scene,"


def run(scene: Scene, context: RunContext) -> Result:
    """Return the result of a force on the whole finger; collective.

    Args:
        scene: with a force.
        context: ranks, folder and console. Traces that an earlier command finished in the folder are taken from there.

    Returns:
        The whole finger, and the section at its centre as named states; neither, with ``interrupted``, where a signal
        stopped it.

    Raises:
        SceneError: an accuracy is asked for, the profile does not fit, no trace reached the force, or a state was not
            found.
    """
    if scene.accuracy is not None:
        raise SceneError(
            f"accuracy is given and force is {scene.force:g} N; the traces of a force have the errors of their own two "
            "meshes, so leave the accuracy out and make mesh.contact smaller, or give f_ext instead"
        )
    comm = context.comm or MPI.COMM_WORLD
    all_together(comm)
    check_options(comm, scene.numerics.element)
    checkpoint = None if context.folder is None else checkpoint_of(scene, context.folder, ())
    with closing(Console(comm, context.lines, context.bar, context.on_step)) as console, Interrupt(comm) as interrupt:
        made = _Newtons(scene, comm, console, interrupt, checkpoint, context.outputs)
        try:
            bare, cautions = made.result()
        except Interrupted as stopped:
            failure = f"{str(stopped).partition(';')[0]} of the {made.doing}; the same command goes on with it"
            bare = Result(scene, DEFAULT_MODEL, None, None, None, failure=failure, interrupted=stopped.signal.name)
            return replace(bare, cost=made.clock.cost(made.branches.counts, 0))
        except GeometryError as error:
            raise SceneError(f"the finger cannot be meshed: {error}") from error
        except (BeyondTrace, TraceError, StepFailed) as error:
            tip = hint(error) if isinstance(error, StepFailed) else ""
            tip = tip or "give f_ext, of the middle section, or use the model 'cylinders'"
            raise SceneError(f"force is {scene.force:g} N, and the {made.doing} failed: {error}; {tip}") from error
        result = kept(bare, context, [cautions, *of_outputs(context.outputs)])
        if checkpoint is not None and comm.rank == 0:
            checkpoint.delete()
        return result


class _Newtons:
    """A force on the whole finger while it is worked on: ``branches`` are its traces, ``doing`` is in words."""

    def __init__(
        self,
        scene: Scene,
        comm: MPI.Comm,
        console: Console,
        interrupt: Interrupt,
        checkpoint: Checkpoint | None,
        outputs: Sequence[Output],
    ) -> None:
        self._scene, self._comm, self._console, self._interrupt = scene, comm, console, interrupt
        self._checkpoint, self.clock, self.doing = checkpoint, Clock(comm), "light press"
        self._restarts, self._steps = list[str](), 0
        self.branches = Branches(scene, comm, self._on_step, self._on_trace, self._earlier(), self._pause, outputs)

    def result(self) -> tuple[Result, Entry]:
        """Return the result, and the entry of the cautions on all of its states; collective."""
        section, states = self.branches.section, traces.states(self._scene)
        model = FingerModel(by_rule(section), replace(plan(section), receptors=False, errors=False))
        loads = model.loads[: 1 + bool(self._scene.volts) + ("full_slip" in states)]
        model = model.changed(loads=loads, share=drive_loads.gap_factor(self._scene))
        model = model.changed(mesh=model.coarser(model.mesh), final=model.mesh)
        self._console.expect(1 + len(states))
        self._console.head()
        while True:
            self._console.phase("meshing the finger and setting up its equations")
            try:
                self.branches.follow(model)
                break
            except RestartTraces as again:
                self._restarts.append(again.restart.reason)
                self._console.show(f"fingerpad: {again.restart.reason}; all traces again")
                self.branches.kept, model = {}, again.restart.model
        return self._corrected(model)

    # -- on the way ------------------------------------------------------------------------------------
    def _on_step(self, step: Step, done: float) -> None:
        refuse_unread()
        self._steps = step.state.step
        self._console.step(step.state, min(len(self.branches.found) / (1 + len(traces.states(self._scene))), 1.0))
        self._pause()

    def _pause(self) -> None:
        self._interrupt.stop_if_asked(self._steps)

    def _on_trace(self, name: str) -> None:
        self.doing = f"trace of {WORDS[name]}" if name else "way to the next trace"
        if name:
            self._console.show(f"\nTrace of the cross-section, {name.replace('_', ' ')}")
            return
        seconds = self.clock.present()
        if self._checkpoint is not None and self._comm.rank == 0:
            self._checkpoint.write({"traces": self.branches.kept, "seconds": seconds})

    def _earlier(self) -> dict[str, TraceStates]:
        """Return the traces that an earlier command finished; collective."""
        if self._checkpoint is None:
            return {}
        try:
            kept = read(self._checkpoint, self._comm, (TraceStates,))
        except CheckpointError:  # nothing to go on from
            return {}
        self.clock.earlier(*kept["seconds"])
        found: dict[str, TraceStates] = kept["traces"]
        return found

    # -- on the scene's own mesh -----------------------------------------------------------------------
    def _corrected(self, model: FingerModel) -> tuple[Result, Entry]:
        """Return :meth:`result` of the traces on a model's mesh; collective."""
        self.doing = "correction of the traces"
        self._console.phase("states of the traces, on the scene's own mesh")
        branches, degree = self.branches, ELEMENTS[model.numerics.element].degree
        anchors = {
            f"{WORDS[name]} under {state.state.f_ext:.4g} N/m": (name, state)
            for name in branches.found
            for state in branches.kept[name].anchors
        }
        coarse = {words: state for words, (_, state) in anchors.items()}
        centre = {name: words for words, (name, _) in anchors.items()}  # the last of each
        final, stiffer = model.changed(mesh=model.final), model.contact.over_stiffer_screen()
        fine = solve_again(final, coarse, self._comm, stiffer=stiffer, examined=centre.values(), pause=self._pause)
        over = {} if fine.stiffer is None else fine.stiffer.states
        branches.counts.add(Counts(fine.newton, fine.factorisations))
        pairs: dict[str, list[Pair]] = {name: [] for name in branches.found}
        for words, (name, state) in anchors.items():
            own = fine.states[words]
            pairs[name].append(Pair(state.state, own.state, (state.facet, own.facet)))
        found = {
            name: self._total(branches.found[name], each, degree, over.get(centre[name]))
            for name, each in pairs.items()
        }
        notes = [text for name, each in pairs.items() for text in _differences(name, each)]
        least = branches.force_error
        states = [state for each in found.values() for state in each.states]
        slip = found["full_slip"].end if "full_slip" in found else None
        result = Result(
            self._scene,
            DEFAULT_MODEL,
            **traces.sections(self._scene, found),
            cost=self.clock.cost(branches.counts, fine.unknowns),
            failure=broken(slip, least, coefficient(self._scene)),
            notes=tuple(notes),
            record={
                "path_mesh": model.mesh.model_dump(),
                "restarts": self._restarts,
                "laws": used(self._scene),
                "provenance": provenance(),
                "force_error": least,
            },
            finger=traces.summed(self._scene, _WORDS, found),
        )
        return result, cautions_on(states)

    def _total(self, each: Traced, pairs: Sequence[Pair], degree: int, stiffer: State | None) -> Traced:
        """Return a trace as on the scene's own mesh, with the finger on it and its errors.

        ``stiffer`` is the last state over a screen of twice the stiffness, None over a rigid one.
        """
        scene, wavelength = self._scene, self._scene.geometry.ridge_wavelength
        finger, force, count = profile(scene.slices), scene.force, scene.slices.count
        assert force is not None
        made = corrected(each.trace, pairs, wavelength)
        carried = {
            errors.MESH: mesh_errors(pairs[-1], wavelength, degree, made.own),
            errors.COARSE: correction_errors(finger, each.trace, pairs, wavelength, force, count),
        }
        if stiffer is not None:
            carried[PENALTY] = penalty_errors(pairs[-1].fine, stiffer.state, wavelength, made.own)
        return Traced(made, each.states, at_force(finger, made, force, count), pairs[-1].fine, carried)


def _differences(name: str, pairs: Sequence[Pair]) -> list[str]:
    """Return notes on states in which other ridges touch on the two meshes."""
    return [
        f"{WORDS[name].capitalize()} at {fine.f_ext:.3g} N/m has {counted(fine.ridges_in_contact, 'ridge')} in contact "
        f"on the scene's mesh, and {coarse.ridges_in_contact} on that of the traces."
        for coarse, fine in ((pair.coarse, pair.fine) for pair in pairs)
        if fine.ridges_in_contact != coarse.ridges_in_contact
    ]
