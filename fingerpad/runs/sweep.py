"""A scene over values of some of its keys: every combination, as one table, kept on disk and taken up again."""

import itertools
import math
import os
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from numbers import Integral
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fingerpad import launcher
from fingerpad.launcher import source, version
from fingerpad.model.cautions import examine
from fingerpad.report.write import attempt
from fingerpad.results.data import checked as checked_outputs
from fingerpad.results.files import FORMAT, below, check_folder, replace_json
from fingerpad.results.quantities import Output
from fingerpad.results.result import Result
from fingerpad.runs import batch
from fingerpad.runs.context import RunContext
from fingerpad.runs.post import applied, of_kept
from fingerpad.runs.solve import MODELS, checked, find, solved
from fingerpad.runs.sweep_results import FILE, Sweep
from fingerpad.scene import Scene, value_of, with_values
from fingerpad.scene.messages import SceneError, clip, show
from fingerpad.scene.reading import DEFAULT_MODEL, plain
from variational.state import PATH

if TYPE_CHECKING:
    from fingerpad.reduced.model import Model

FILES = ("table.csv", FILE, "report.html", "sweep.json")
"""What a sweep writes into its folder beside its points."""
STATES = ("all", "full_slip")
"""Of the points of a sweep: the first is the default."""
MAX_POINTS = 10_000
_LIMIT = 4 * 3600.0  # s of processor time for one point


def sweep(
    scene: Scene | None = None,
    out: str | Path | None = "results/sweep",
    *,
    jobs: int = 1,
    model: str = DEFAULT_MODEL,
    quiet: bool = False,
    outputs: Sequence[Output] = (),
    states: str = STATES[0],
    executor: Executor | None = None,
    **axes: Sequence[Any],
) -> Sweep:
    """Return what a model answers to a scene over values of some of its keys.

    Each point is run in a process of its own, here or by the workers of an executor. Its results are kept in ``out``,
    and the same sweep, or another one that shares points with it, computes only those that are missing. A point that
    fails has its ``failure`` in the table, and the others go on.

    Args:
        scene: the scene; by default press, charge and slide of the default finger.
        out: folder of the results, of ``table.csv`` and of ``report.html``; None to write nothing, of a model without
            finite elements alone.
        jobs: points that are run at a time.
        model: a name of :data:`fingerpad.runs.solve.MODELS`, ``"full"`` or ``"cylinders"``.
        quiet: whether to print no line for each point, and show no progress bar.
        outputs: further quantities, each computed from every state; the folders of the points do not have them.
        states: ``"all"``, each point by its own path; or ``"full_slip"``, full slip alone, which the full model solves
            for from point to point (:mod:`fingerpad.runs.full_slip`): some four times as fast, and without
            ``output.errors`` some sixteen times.
        executor: any of ``concurrent.futures`` whose workers share ``out``: a ``ProcessPoolExecutor``,
            ``mpi4py.futures.MPIPoolExecutor`` or dask's ``client.get_executor()``. It decides how many points are run
            at a time, and stays open. A point whose worker is lost has that as its ``failure``, and the same sweep
            computes it. A model that answers at once does not need it.
        **axes: values by key: ``voltage=[0, 100, 200]``, or ``**{"roughness.h_rms": [2e-6, 3e-6]}``.
            With ``force`` tables and arrays are of the whole finger.

    Raises:
        SceneError: a key or a value that a scene cannot have, no values, a law that only this program knows and other
            processes cannot import, more than one rank of MPI, or a folder that holds a run.
        KeyboardInterrupt: Ctrl-C, after the present step of each running point; the same sweep goes on from there.
        SystemExit: SIGTERM or SIGHUP, after the present step of each running point.
    """
    scene, way = checked(scene), find(model)
    if states not in STATES:
        raise SceneError(f"states is {show(states)}; it must be {' or '.join(map(repr, STATES))}")
    if states != STATES[0] and not way.path:
        raise SceneError(f"states is {states!r} and model {model!r}; full slip alone is of the model 'full'")
    if executor is not None and not hasattr(executor, "submit"):
        raise SceneError(f"executor is {show(executor)}; it must be one of concurrent.futures, such as a process pool")
    if launcher.ranks() > 1 and not (executor is not None and way.meshes):
        raise SceneError("a sweep runs its points in processes of its own; start it without mpirun, and use jobs")
    if not isinstance(jobs, Integral) or jobs < 1:
        raise SceneError(f"jobs is {show(jobs)}; it must be a whole number, at least 1")
    if not (isinstance(out, str | os.PathLike) or (out is None and not way.meshes)):
        raise SceneError(f"out is {show(out)}; it must be the path of a folder")
    checked_outputs(outputs)
    _refuse_axes(axes)
    scene = scene.resolved()
    scenes = [with_values(scene, point) for point in _points(axes)]
    values = _values(scenes, axes)
    if states != STATES[0]:
        for each in scenes:
            batch.check_supported(each)
    for each in scenes if way.meshes else ():
        each.refuse_laws_of_program("the processes of a sweep")
    folder = None if out is None else Path(out)
    if folder is not None:
        _claim(folder)
    if way.meshes and folder is not None:
        kept = _in_processes(scenes, values, folder, jobs, way, quiet, states, executor)
        found = [applied(each, of_kept(outputs)) for each in kept]
    else:
        found = [_here(each, way, outputs) for each in scenes]
    leaks = list(dict.fromkeys(str(note) for each in found for note in examine("note", each.scene)))
    notes = [f"{'First point: ' * (len(leaks) > 1)}{note}" for note in leaks[:1]]
    done = Sweep(values, tuple(found), folder, tuple(notes))
    if folder is None:
        return done
    about: dict[str, Any] = {"format": FORMAT, "version": version(), "model": model, "parameters": scene.parameters()}
    return _written(done, folder, about, folder / (model if states == STATES[0] else states))


def _written(done: Sweep, folder: Path, about: dict[str, Any], place: Path) -> Sweep:
    """Write the files of a sweep, whose points are in ``place``; return it with notes on them."""
    for name in FILES[:-1]:  # else that of an earlier sweep may stay beside this one's
        (folder / name).unlink(missing_ok=True)
    about |= {"axes": list(done.axes), "rows": done.table(), "outputs": [each.to_dict() for each in done.outputs]}
    replace_json(folder / FILES[-1], about | {"cautions": done.cautions(), "notes": list(done.notes)})
    done.to_csv(folder / FILES[0])
    notes = (*done.notes, *filter(None, (_reached(done), done.save(), _older(done, place))))
    attempt(folder)
    return replace(done, notes=notes)


def _reached(done: Sweep) -> str:
    """Return a note on how the states of a sweep of full slip alone were reached; empty for another one."""
    alone = [each.full_slip.reached for each in done.results if "reached" in each.record and each.full_slip is not None]
    direct = len(alone) - alone.count(PATH)
    words = f"{direct} of {len(alone)} full-slip states were continued from the neighbouring point"
    return f"{words}, {alone.count(PATH)} computed along the load path." if alone else ""


def _older(done: Sweep, folder: Path) -> str:
    """Return a note on points that another state of the program has computed; empty without one."""
    kept = (each.record.get("provenance", {}).get("versions", {}) for each in done.results)
    found = [versions["source"] for versions in kept if "source" in versions]
    count = len(found) - found.count(source())
    if not count:
        return ""
    return f"{count} of {len(done)} points are of another state of the program; delete {folder} to compute them again."


def _claim(folder: Path) -> None:
    """Make the folder; refuse one that cannot be one, or holds a run."""
    check_folder(folder, "out")
    run = next((name for name in ("scene.json", "summary.json", "steps.csv") if (folder / name).exists()), None)
    if run is not None:
        raise SceneError(f"out {clip(str(folder), 80)} holds the results of a run ({run}); choose another folder")
    theirs = next((name for name in FILES if (folder / name).exists()), None)
    if theirs is not None and not any((folder / name).exists() for name in (FILES[-1], *MODELS, *STATES)):
        raise SceneError(f"out {clip(str(folder), 80)} holds {theirs} of no sweep; choose another folder")
    folder.mkdir(parents=True, exist_ok=True)


def _points(axes: Mapping[str, Sequence[Any]]) -> list[dict[str, Any]]:
    """Return the values of each point by key, the last axis fastest."""
    return [dict(zip(axes, point, strict=True)) for point in itertools.product(*axes.values())]


def _refuse_axes(axes: Mapping[str, Sequence[Any]]) -> None:
    """Refuse a sweep over what cannot be one."""
    if not axes:
        raise SceneError("the sweep has no axis; give values of at least one key, such as voltage=[0, 100, 200]")
    for key, values in axes.items():
        single = isinstance(values, str) or not isinstance(values, Sequence | Mapping)
        if single and np.ndim(getattr(values, "magnitude", values)) == 0:
            given = show(plain(values))
            raise SceneError(f"{key} of the sweep is {given}; it must be a list, such as [{given}]")
        listed = isinstance(values, Sequence | np.ndarray) and len(values)
        if not listed or any(np.iterable(value) and not isinstance(value, str | Mapping) for value in values):
            raise SceneError(
                f"{key} of the sweep is {show(values)}; it must be a list of at least one value, none a list"
            )
    if (count := math.prod(len(values) for values in axes.values())) > MAX_POINTS:
        raise SceneError(f"the sweep has {count} points; at most {MAX_POINTS} are allowed")


def _values(scenes: Sequence[Scene], axes: Mapping[str, Sequence[Any]]) -> dict[str, tuple[Any, ...]]:
    """Return the values of each axis in SI, from the scenes of the grid, the last axis fastest."""
    found, apart = {}, len(scenes)  # points from one value of an axis to the next
    for key, values in axes.items():
        apart //= len(values)
        found[key] = tuple(value_of(scenes[k * apart], key) for k in range(len(values)))
        if len(set(map(repr, found[key]))) < len(values):
            raise SceneError(f"{key} of the sweep is {show(values)}; each value must be there once")
    return found


def _failed(scene: Scene, model: "Model", why: str) -> Result:
    """Return a result without any number."""
    return Result(scene, model.name, None, None, None, failure=why)


def _here(scene: Scene, model: "Model", outputs: Sequence[Output]) -> Result:
    try:
        return solved(scene, model, RunContext(report=False, outputs=outputs))
    except SceneError as error:
        return _failed(scene, model, str(error))


def _in_processes(
    scenes: Sequence[Scene],
    axes: Mapping[str, Sequence[Any]],
    folder: Path,
    jobs: int,
    model: "Model",
    quiet: bool,
    states: str,
    executor: Executor | None,
) -> list[Result]:
    """Return the results of points, those that can be run in processes of their own, kept by their parameters."""
    chained = states != STATES[0]
    place = below(folder, states if chained else model.name)
    names, named, found = list[str](), dict[str, Scene](), dict[str, dict[str, Any]]()
    for scene, point in zip(scenes, _points(axes), strict=True):
        names.append(f"{', '.join(f'{name} {show(value)}' for name, value in point.items())} ({batch.key(scene)})")
        try:
            model.check(scene)
            if chained and scene.friction_law() is None:
                raise SceneError("friction is 0; with states='full_slip' it must be greater than 0")
            named[names[-1]] = scene
        except SceneError as error:
            found[names[-1]] = {"failure": str(error)}
    if chained:
        along = [names[k] for k in _neighbours(axes) if names[k] in named]
        found |= batch.sweep_chains({name: named[name] for name in along}, place, jobs, quiet, executor)
    else:
        found |= batch.sweep(named, place, jobs, _LIMIT, model.name, quiet, executor)
    results = list[Result]()
    for name, scene in zip(names, scenes, strict=True):
        try:
            lost = found[name]["failure"] if set(found[name]) == {"failure"} else ""
            results.append(_failed(scene, model, lost) if lost else Result.load(place / batch.key(scene)))
        except SceneError as error:  # of files that are not whole
            results.append(_failed(scene, model, str(error)))
    return results


def _neighbours(axes: Mapping[str, Sequence[Any]]) -> list[int]:
    """Return the places of a grid in an order in which each is beside the one before, the easiest first.

    Voltages are the fastest. Voltages, forces and friction begin with the least: a ridge that comes down takes a third
    of the work of one that snaps off, and the first point is the end of a short path. Other keys begin with the most.
    """
    places = np.arange(math.prod(len(values) for values in axes.values())).reshape([len(v) for v in axes.values()])
    for k, (key, values) in enumerate(axes.items()):
        if all(isinstance(value, int | float) for value in values):
            sign = 1 if key in ("f_ext", "voltage", "friction") else -1
            places = np.take(places, np.argsort([sign * abs(value) for value in values], kind="stable"), axis=k)
    places = places.transpose(sorted(range(len(axes)), key=lambda k: [*axes][k] == "voltage"))
    along = [places]
    while along[0].ndim:  # there and back along each axis
        along = [line[k] for j, line in enumerate(along) for k in range(len(line))[:: 1 - 2 * (j % 2)]]
    return [int(place) for place in along]
