"""The models by name, and a scene run by one of them: what ``import fingerpad`` gives for that."""

import json
import os
import signal
import sys
import warnings
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fingerpad import launcher
from fingerpad.launcher import needed_by, source, version
from fingerpad.model.cautions import examine
from fingerpad.model.options import check
from fingerpad.reduced.cylinders import Cylinders
from fingerpad.reduced.model import Model
from fingerpad.results.data import FULL_WORDS, MODEL_WORDS
from fingerpad.results.data import checked as checked_outputs
from fingerpad.results.files import replace_json
from fingerpad.results.folder import CheckpointError, FolderError, Serial, on_rank_0
from fingerpad.results.quantities import Output
from fingerpad.results.result import Result
from fingerpad.runs.context import RunContext, finished
from fingerpad.runs.post import Entry, kept, of_outputs
from fingerpad.runs.processes import limit_processor_time
from fingerpad.scene import Scene, from_data
from fingerpad.scene.messages import SceneError, show
from fingerpad.scene.reading import DEFAULT_MODEL, flat
from variational.coefficients import LawError
from variational.state import ContactState

if TYPE_CHECKING:
    from fingerpad.startup import MPI


class _Full(Model):
    """The whole cross-section with every ridge, along the path of its loads (:mod:`fingerpad.runs.full`)."""

    name, words = DEFAULT_MODEL, FULL_WORDS
    traces = "traces of the full model"
    meshes = path = resumes = True

    def check(self, scene: Scene) -> None:
        """Refuse a scene whose finger cannot be built or meshed, see :func:`fingerpad.model.options.check`."""
        check(scene)

    def solve(self, scene: Scene, context: RunContext) -> Result:
        """Reach every load, see :func:`fingerpad.runs.full.run`; collective."""
        from fingerpad.runs import full  # finite elements

        return full.run(scene, context)


MODELS: dict[str, Model] = {
    "cylinders": Cylinders(),
    "full": _Full(),
}
"""The models by name, the cheapest first: where a reduced model of one's own is registered."""


def find(name: str) -> Model:
    """Return a model by its name.

    Raises:
        SceneError: there is none.
    """
    if not (isinstance(name, str) and name in MODELS):
        raise SceneError(f"model is {show(name)}; it must be {' or '.join(map(repr, MODELS))}")
    return MODELS[name]


def run(
    scene: Scene | None = None,
    *,
    out: str | Path | None = None,
    model: str = DEFAULT_MODEL,
    comm: "MPI.Comm | None" = None,
    resume: bool = False,
    outputs: Sequence[Output] = (),
    on_step: Callable[[ContactState, float], None] | None = None,
    **changes: Any,
) -> Result:
    """Return what a model answers to a scene; collective.

    ``fp.run(contact=fp.Nitsche(), voltage=100.0)`` runs the default scene with these changes.

    Args:
        scene: the scene; by default press, charge and slide of the default finger.
        out: folder for tables, pictures, fields and ``summary.json``; without it nothing is written.
        model: a name of :data:`MODELS`: ``"full"``, every ridge along the whole path
            (minutes); ``"cylinders"``, a closed form (at once).
        comm: communicator; by default of all ranks.
        resume: go on from where a run of the same scene in ``out`` was cut short; only of the full model.
        outputs: further quantities, each computed from every state: see :class:`fingerpad.results.quantities.Output`.
        on_step: called after each step of a path with its state and the part of the run that is done, from 0 to 1; on
            every rank. A closed form has no steps.
        changes: values of the scene by key, as :meth:`fingerpad.scene.Scene.replace` takes them.

    Returns:
        The result. A load that could not be reached is its ``failure``, with a warning; the states before are in it.
        A voltage that breaks down air has a warning before the full model's minutes.

    Raises:
        SceneError: the scene cannot be run, in one sentence.
        KeyboardInterrupt: Ctrl-C, after the present step; its attribute ``result`` has the steps accepted before.
        SystemExit: SIGTERM or SIGHUP, after the present step; its attribute ``result`` has the same.
    """
    scene, way = checked(scene), find(model)
    scene = scene.replace(**changes) if changes else scene
    if out is not None and not isinstance(out, str | os.PathLike):
        raise SceneError(f"out is {show(out)}; it must be the path of a folder")
    if resume and (out is None or not way.resumes):
        raise SceneError(
            f"resume is true, out is {show(out)} and model {show(model)}; only a full run in a folder can go on"
        )
    for caution in examine("load", scene.resolved()) if way.path and launcher.rank() == 0 else ():
        warnings.warn(str(caution), stacklevel=2)
    context = RunContext(None if out is None else Path(out), comm, resume=resume, outputs=outputs, on_step=on_step)
    result = solved(scene, way, context)
    if result.interrupted:
        raise stopped(result)
    if result.failure and launcher.rank() == 0:
        warnings.warn(result.failure, stacklevel=2)
    return result


def checked(scene: Scene | None) -> Scene:
    """Return a scene, by default press, charge and slide of the default finger.

    Raises:
        SceneError: it is something else.
    """
    if scene is None:
        return Scene()
    if not isinstance(scene, Scene):
        raise SceneError(f"scene is {show(scene)}; it must be a Scene, and a file is read by Scene.load(path)")
    return scene


def stopped(result: Result) -> BaseException:
    """Return what a signal is to a Python program, with the result of the steps before as its attribute ``result``."""
    number = signal.Signals[result.interrupted]
    error = KeyboardInterrupt(result.failure) if number == signal.SIGINT else SystemExit(128 + number)
    error.result = result  # type: ignore[union-attr]
    return error


def solved(scene: Scene, model: Model, context: RunContext) -> Result:
    """Return what a model answers to a scene with all its laws; collective."""
    context = replace(context, outputs=checked_outputs(context.outputs))
    scene = scene.resolved()
    if context.resume:
        scene.refuse_laws_of_program("a run that goes on")
    try:
        return _section(scene, model, context) if scene.force is None else _whole(scene, model, context)
    except LawError as error:
        raise SceneError(str(error)) from error


def _section(scene: Scene, model: Model, context: RunContext) -> Result:
    """Return what a model answers to a scene without a force, with its finger and band, in a folder; collective."""
    result, here = _solved(scene, model, context), replace(context, folder=None)
    if model.path:
        return result

    def with_sum(result: Result) -> Result:
        return model.with_sum(result, lambda each: _solved(each, model, here), context.outputs)

    own = [Entry("newtons of the whole finger", with_sum, lambda *_: model.sums), *of_outputs(context.outputs)]
    return kept(result, context, own)


def _solved(scene: Scene, model: Model, context: RunContext) -> Result:
    """Return what a model answers to a scene without a force; one with a path writes into a folder; collective."""
    with needed_by(f"the model {model.name!r}"):
        if model.meshes:
            from fingerpad.startup import MPI  # before any other import of the libraries that it starts

            context = replace(context, comm=context.comm or MPI.COMM_WORLD)
            _refuse_different(scene, context.ranks)
        model.check(scene)
        result = model.solve(scene, context)
    if model.path:
        return result
    versions = {"versions": {"fingerpad": version(), "source": source()}}
    return replace(result, record=result.record | {"provenance": versions, MODEL_WORDS: model.words})


def _refuse_different(scene: Scene, comm: "MPI.Comm | Serial") -> None:
    """Refuse scenes that differ from rank to rank, whose solves would wait for each other for ever; collective.

    Hashes of laws are left out: those without a file are another one in each process.
    """
    if isinstance(comm, Serial):
        return
    first, *others = comm.allgather({k: v for k, v in flat(scene.parameters()).items() if not k.endswith(".sha256")})
    for rank, other in enumerate(others, start=1):
        for key in sorted(first.keys() | other.keys()):
            if (one := first.get(key)) != (two := other.get(key)):
                raise SceneError(
                    f"{key} is {show(one)} on rank 0 of MPI and {show(two)} on rank {rank}; all ranks must be given "
                    "the same scene"
                )


def _whole(scene: Scene, model: Model, context: RunContext) -> Result:
    """Return the result of a force on the whole finger; what an earlier run has finished is taken from its folder."""
    with context.place(scene, model.name) as place:
        if place is not None and model.path:
            if on_rank_0(context.ranks, lambda: finished(scene, place.folder) is not None):
                return Result.load(place.folder)
            place.take()  # the scene is then there for those who go on with it
    if model.path:
        with needed_by(f"the model {model.name!r}"):
            from fingerpad.runs import newtons  # finite elements
        _refuse_different(scene, context.ranks)
        model.check(scene)
        return newtons.run(scene, context)
    model.check(scene)
    here = replace(context, folder=None)
    found = model.whole(scene, lambda each: _solved(each, model, here), context.outputs)
    return kept(found, context, of_outputs(context.outputs))


def continued(scene: Scene, model: Model, context: RunContext) -> Result:
    """Return the result of a scene that its folder may have, whole or in part; collective."""
    folder = context.folder
    if folder is None:
        return _solved(scene, model, context)
    if on_rank_0(context.ranks, lambda: finished(scene, folder) is not None):
        return Result.load(folder)
    try:
        return solved(scene, model, replace(context, resume=model.resumes))
    except CheckpointError:  # nothing to go on from
        return solved(scene, model, replace(context, resume=False))


def main(file: Path, folder: Path, model: str) -> None:
    """Run a point of a sweep (parameters of a scene in JSON) into its folder, from its checkpoint where it has one."""
    scene, way = from_data(json.loads(file.read_text(encoding="utf-8"))), find(model)
    try:
        continued(scene, way, RunContext(folder, lines=way.path, bar=way.path, report=False))
    except FolderError as error:  # another run is at it, or the disk is full: it may be gone the next time
        print(error, file=sys.stderr)
        sys.exit(os.EX_TEMPFAIL)
    except SceneError as error:  # it would be the same the next time
        replace_json(folder / "summary.json", {"failure": str(error)})


if __name__ == "__main__":
    limit_processor_time(float(sys.argv[3]))
    main(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[4])
