"""Run a scene, or many: what ``import fingerpad`` gives for that."""

import os
import signal
import warnings
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fingerpad.installed import needed_by, source, version
from fingerpad.io import dataset, terminal
from fingerpad.io.files import replace_json
from fingerpad.io.place import Place, Serial, on_rank_0
from fingerpad.io.result import Result
from fingerpad.model.check import check
from fingerpad.scene import Scene, SceneError
from fingerpad.scene.messages import show
from fingerpad.scene.reading import flat
from variational.coefficients import LawError

if TYPE_CHECKING:
    from fingerpad.startup import MPI
    from variational.contact.friction import Friction
    from variational.materials.material import Material
    from variational.roughness.closure import Closure

MODELS = ("cylinders", "full")
"""The cheapest first; see :mod:`fingerpad.runs.compare`."""


def run(
    scene: Scene | None = None,
    *,
    out: str | Path | None = None,
    model: str = "full",
    force: float | str | None = None,
    closure: "Closure | None" = None,
    materials: "Mapping[str, Material] | None" = None,
    friction: "Friction | float | None" = None,
    mesh: str | Path | None = None,
    comm: "MPI.Comm | None" = None,
    resume: bool = False,
) -> Result:
    """Return what a model answers to a scene; collective.

    Args:
        scene: the scene; by default press, charge and slide of the default finger.
        out: folder for tables, pictures, fields and ``summary.json``; without it nothing is written.
        model: ``"full"``, every ridge along the whole path (minutes); ``"cylinders"``, a closed form (at
            once).
        force: external force on the whole finger, in N, as a text such as ``"0.5 N"`` or as a quantity of pint, in
            place of the scene's ``f_ext``. The result's ``finger`` is then summed over traces of the model
            (:mod:`fingerpad.slices.traces`): three runs of the full one, some 25 scenes of the closed form. States in
            N/m: for the full model, those at the end of its last trace; for the closed form, those under the force on
            the centre slice.
        closure: microscale model in place of the bearing area model, see :mod:`variational.roughness.closure`.
        materials: materials by layer (``{"dermis": NeoHooke(2.5e3)}``), see :mod:`variational.materials.material`.
        friction: friction law, see :mod:`variational.contact.friction`.
        mesh: file of a gmsh mesh in place of the finger's own, see :mod:`geometry.meshfile`.
        comm: communicator; by default of all ranks.
        resume: go on from where a run of the same scene in ``out`` was cut short; only of the full model.

    Returns:
        The result. A load that could not be reached is its ``failure``, with a warning; the states before are in it.

    Raises:
        SceneError: the scene cannot be run, in one sentence.
        KeyboardInterrupt: Ctrl-C, after the present step; its attribute ``result`` has the steps accepted before.
        SystemExit: SIGTERM or SIGHUP, likewise.
    """
    scene = checked(scene)
    if out is not None and not isinstance(out, str | os.PathLike):
        raise SceneError(f"out is {show(out)}; it must be the path of a folder")
    if closure is not None or materials or friction is not None or mesh is not None:
        scene = scene.with_laws(closure=closure, materials=materials, friction=friction, mesh=mesh)
    if resume and (out is None or model != "full" or force is not None):
        raise SceneError(
            f"resume is true, out is {show(out)}, model {show(model)} and force {show(force)}; "
            "only a full run in a folder, of one scene, can go on"
        )
    result = solved(scene, model, None if out is None else Path(out), comm, force=force, resume=resume)
    if result.interrupted:
        raise _ended(result)
    if result.failure and terminal.rank() == 0:
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


def _ended(result: Result) -> BaseException:
    """Return what a signal is to a Python program, with the result of the steps before as its attribute ``result``."""
    number = signal.Signals[result.interrupted]
    error = KeyboardInterrupt(result.failure) if number == signal.SIGINT else SystemExit(128 + number)
    error.result = result  # type: ignore[union-attr]
    return error


def solved(
    scene: Scene,
    model: str,
    out: Path | None = None,
    comm: "MPI.Comm | None" = None,
    lines: bool = False,
    bar: bool = True,
    report: bool = True,
    force: float | str | None = None,
    resume: bool = False,
) -> Result:
    """Return what a model answers to a scene with all its laws; collective; arguments as of :func:`run`.

    Args:
        scene: the scene.
        model: one of :data:`MODELS`.
        out: folder of results.
        comm: communicator.
        lines: whether the full model prints its steps.
        bar: whether it shows a progress bar.
        report: whether ``report.html`` is written beside the results.
        force: on the whole finger, as of :func:`run`.
        resume: whether the full model goes on from where a run in the folder was cut short.
    """
    if model not in MODELS:
        raise SceneError(f"model is {show(model)}; it must be {' or '.join(map(repr, MODELS))}")
    scene.laws.refuse_kept()
    try:
        if force is None:
            result = _solved(scene, model, out, comm, lines, bar, resume)
        else:
            result = _whole(scene, force, model, out, comm, lines, bar)
    except LawError as error:
        raise SceneError(str(error)) from error
    whole = not (result.interrupted and force is not None)  # a force without all of its traces is no result
    if report and whole and out is not None and _ranks(comm).rank == 0:
        from fingerpad.report.write import attempt, draw_footprint

        draw_footprint(result)
        attempt(out)
    return result


def _solved(
    scene: Scene,
    model: str,
    out: Path | None,
    comm: "MPI.Comm | None",
    lines: bool,
    bar: bool,
    resume: bool = False,
    asked: Mapping[str, Any] | None = None,
) -> Result:
    """Return what a model answers, its results written into a folder; collective; arguments as of :func:`solved`.

    Args:
        scene: the scene.
        model: one of :data:`MODELS`.
        out: folder of results.
        comm: communicator.
        lines: whether to print.
        bar: whether to show a bar.
        resume: whether to go on.
        asked: of which the scene is a trace, see :class:`fingerpad.io.place.Place`.
    """
    if model == "cylinders":
        from fingerpad.reduced import cylinders

        found = with_versions(cylinders.solve(scene), {"versions": {"fingerpad": version(), "source": source()}})
        return found if out is None else kept(found, out, _ranks(comm))
    with needed_by(f"the model {model!r}"):
        import fingerpad.started  # noqa: F401  # with the configuration of the user alone, before any other import
        from fingerpad.startup import MPI

        comm = comm or MPI.COMM_WORLD
        _refuse_different(scene, comm)
        check(scene)
        from fingerpad.runs import full

        return full.run(scene, out, comm, lines, bar, resume, asked)


def _refuse_different(scene: Scene, comm: "MPI.Comm") -> None:
    """Refuse scenes that differ from rank to rank, whose solves would wait for each other for ever; collective.

    Laws of one's own are left out: those without a source are another one in each process.

    Raises:
        SceneError: the first key that differs, on every rank.
    """
    first, *others = comm.allgather({k: v for k, v in flat(scene.parameters()).items() if not k.startswith("laws.")})
    for rank, other in enumerate(others, start=1):
        for key in sorted(first.keys() | other.keys()):
            if (one := first.get(key)) != (two := other.get(key)):
                raise SceneError(
                    f"{key} is {show(one)} on rank 0 of MPI and {show(two)} on rank {rank}; all ranks must be given "
                    "the same scene"
                )


def _whole(
    scene: Scene,
    force: float | str,
    model: str,
    out: Path | None,
    comm: "MPI.Comm | None",
    lines: bool,
    bar: bool,
) -> Result:
    """Return the result of a force on the whole finger, its sums written beside the files of the last trace."""
    from fingerpad.slices import traces
    from fingerpad.slices.force import newtons

    value = newtons(force)
    asked = {"force": value, "parameters": scene.parameters()}
    if model != "full":
        _refuse_other_results(scene, model, out, _ranks(comm), asked)
    own = out if model == "full" else None

    def solve(each: Scene, name: str) -> Result:
        return _solved(each, model, traces.folder_of(own, name), comm, lines and model == "full", bar, asked=asked)

    found = traces.whole(scene, value, model, solve)
    if found.interrupted:
        return found
    found = replace(found, record={**found.record, "asked": asked})
    if out is None:
        return found
    if model != "full":
        return kept(found, out, _ranks(comm), asked)
    return _written(found, _ranks(comm))


def with_versions(result: Result, provenance: Mapping[str, Any]) -> Result:
    """Return the result of a model without a path with the versions that computed it, as a full run has them."""
    return replace(result, record={**result.record, "provenance": provenance})


def _refuse_other_results(
    scene: Scene, model: str, out: Path | None, comm: "MPI.Comm | Serial", asked: Mapping[str, Any] | None = None
) -> None:
    """Refuse a folder of other results before the work, not after it; collective; see :func:`kept`."""
    if out is not None:
        with Place(out, scene.parameters(), comm, model, asked):
            pass


def _ranks(comm: "MPI.Comm | None") -> "MPI.Comm | Serial":
    """Return the communicator of a run: of all ranks by default, and of this process alone where there is no MPI."""
    if comm is not None:
        return comm
    try:
        from fingerpad.startup import MPI
    except ImportError:
        return Serial()
    return MPI.COMM_WORLD


def kept(result: Result, out: Path | None, comm: "MPI.Comm | Serial", asked: Mapping[str, Any] | None = None) -> Result:
    """Return the result of a model without a path, its summary written into a folder if there is one; collective.

    Args:
        result: of the model.
        out: folder of results.
        comm: communicator of the model.
        asked: the force on the whole finger that the result is of, see :class:`fingerpad.io.place.Place`.

    Raises:
        PlaceError: the folder is in use, holds results of another scene or model, or cannot be written to.
    """
    if out is None:
        return result
    result = replace(result, folder=out)
    with Place(out, result.scene.parameters(), comm, result.model, asked) as place:
        place.take()
        return _written(result, comm)


def _written(result: Result, comm: "MPI.Comm | Serial") -> Result:
    """Write summary and dataset of a result into its folder; return the result with a note on what is missing."""

    def write() -> str:
        assert result.folder is not None
        replace_json(result.folder / "summary.json", result.to_dict())
        return dataset.save(result)

    missing = on_rank_0(comm, write)
    return replace(result, notes=(*result.notes, missing)) if missing else result
