"""Many scenes, each run in a process of its own and kept by what it is made of.

A scene's folder is named by a hash of all its parameters: run again, a sweep computes only what has changed, and runs
that were cut short go on from their checkpoints. The hash does not depend on the program: after a change of the
mechanics the folder must be deleted. A process is ``python3 -m fingerpad.runs.solve SCENE.json FOLDER LIMIT MODEL``.

Sweeps of ``states="full_slip"`` follow points in chains instead, each in a process of :mod:`fingerpad.runs.full_slip`.
"""

import fcntl
import hashlib
import itertools
import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from fingerpad.results.files import below, lock_file, replace_json
from fingerpad.results.folder import identity
from fingerpad.results.terminal import in_words, watched
from fingerpad.runs import processes
from fingerpad.runs.context import OUT_OF_MEMORY, Summary, ended, summary
from fingerpad.runs.processes import End, run
from fingerpad.scene import Scene, SceneError, law_name
from fingerpad.scene.law_keys import parameters
from fingerpad.scene.messages import show
from fingerpad.scene.reading import DEFAULT_MODEL
from fingerpad.scene.viscosity import viscous_layers

if TYPE_CHECKING:
    from rich.progress import Progress

_LIMIT = 900.0  # s of processor time for one scene
_FREE = ("f_ext", "voltage", "friction", "roughness", "electric", "slide_length")
"""Keys in which neighbours may differ by numbers: they change neither the mesh nor the layers."""
_SHORTEST = 8  # points of a chain, of which the first takes the time of some fifteen others
_LIMIT_OF_CHAIN = 4 * 3600.0  # s of processor time
_LEFT_OUT = "with states='full_slip' it must be left out, or give states='all'"


def key(scene: Scene) -> str:
    """Return the name under which a scene's results are kept."""
    return hashlib.sha256(json.dumps(identity(scene.parameters()), sort_keys=True).encode()).hexdigest()[:16]


def result(scene: Scene, folder: Path) -> Summary | None:
    """Return the summary of a scene that has been run in a sweep's folder to its end, whatever that was."""
    return ended(summary(folder / key(scene)))


def progress(quiet: bool = False) -> "Progress":
    """Return a bar of things done and time taken; nothing of it where the output is no terminal, or ``quiet`` is given.

    A quiet one has no console either, to which others print their lines.
    """
    from rich.console import Console  # where it is shown
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
    )

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
    console = Console(quiet=True) if quiet else None  # else a bar that is not shown prints an empty line at its end
    return Progress(*columns, TimeElapsedColumn(), transient=True, disable=quiet or not watched(), console=console)


def times_left(took: Sequence[float], left: int, jobs: int) -> tuple[float, float]:
    """Return the least and the longest time left (s), by the times of the runs until now (s) and the number left."""
    rounds = left / min(jobs, left)
    low, high = min(took), max(took)
    return (rounds - 1) * low + low / 2, rounds * max(high, 1.25 * low)


def _description(summary: Summary) -> str:
    """Return what became of a run that did not fail, in words; of a whole finger where the force is on it."""
    mu_app = summary.get(f"full_slip_{'finger_' * ('force' in summary.get('parameters', {}))}mu_app")
    return "done" if mu_app is None else f"done, µ_app {mu_app:.4f}"


def point(parameters: Mapping[str, Any], folder: str, limit: float, model: str, law_folders: Sequence[str] = ()) -> End:
    """Run a scene in a fresh process into its own folder, unless it is done; any machine with that folder can do it.

    Arguments are as of :func:`sweep`; ``law_folders`` are those of laws of one's own.
    """
    place = Path(folder)
    place.mkdir(parents=True, exist_ok=True)
    with lock_file(place / "lock") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # another sweep may be at it
        if ended(summary(place)) is not None:
            return End(0, "", "", "")
        (place / "summary.json").unlink(missing_ok=True)  # of a run that says nothing of this one
        replace_json(place / "asked.json", dict(parameters))
        return run("fingerpad.runs.solve", [str(place / "asked.json"), folder, str(limit), model], limit, law_folders)


class _Task(NamedTuple):
    """Points of a sweep that one process computes."""

    points: Sequence[str]
    """Their names, in order."""
    call: Callable[[], End]
    """Starts the process and waits for it."""


def sweep(
    scenes: Mapping[str, Scene],
    folder: Path,
    jobs: int = 2,
    limit: float = _LIMIT,
    model: str = DEFAULT_MODEL,
    quiet: bool = False,
    executor: Executor | None = None,
) -> dict[str, Summary]:
    """Run what has not been run yet, each scene by :func:`point`; see :func:`finish`.

    Args:
        scenes: by name.
        folder: of all results.
        jobs: processes at a time, without an executor.
        limit: processor time for one scene (s).
        model: a name of :data:`fingerpad.runs.solve.MODELS`, of one that meshes.
        quiet: whether to print nothing, and show no bar.
        executor: of ``concurrent.futures``, whose workers share the folder.
    """
    tasks = []
    for name, scene in scenes.items():
        if result(scene, folder) is None:
            place = str(below(folder, key(scene)).absolute())
            tasks.append(_Task([name], partial(point, scene.parameters(), place, limit, model, scene.law_folders())))
    return finish(scenes, tasks, folder, jobs, quiet, executor)


def finish(
    scenes: Mapping[str, Scene],
    tasks: Sequence[_Task],
    folder: Path,
    jobs: int,
    quiet: bool = False,
    executor: Executor | None = None,
) -> dict[str, Summary]:
    """Do tasks with a line for each point and a progress bar; ``scenes`` are those of all tasks and the finished ones.

    Returns:
        The summaries by name. That of a point that crashed, took too long, had too little memory or was asked to stop
        holds ``failure`` alone, and it goes on the next time; what it left is in its folder.
    """
    left = {k: [*task.points] for k, task in enumerate(tasks)}
    total = sum(map(len, left.values()))
    timed = executor is None and total == len(tasks)
    lost, took = dict[str, Summary](), list[float]()

    def report(name: str, found: Summary) -> None:
        if not quiet:
            count = sum(map(len, left.values()))
            rest = f"; {in_words(*times_left(took, count, jobs))} left" if timed and count and took else ""
            words = found.get("failure") or _description(found)
            text = f"{name}: {words} ({total - count} of {total}{rest})"
            bar.console.print(text, highlight=False, markup=False, soft_wrap=True)
            bar.update(shown, advance=1, description=f"points{rest.replace(';', ',')}")

    def look() -> None:
        for names in left.values():  # the end of a task tells of its last point
            while len(names) > 1 and (found := result(scenes[names[0]], folder)) is not None:
                report(names.pop(0), found)

    def done(k: int, end: End, _: int) -> None:
        took.extend([end.seconds] if end.seconds else [])
        while left[k]:
            name = left[k].pop(0)
            found = result(scenes[name], folder)
            if found is None:
                failure = f"{end.reason}: {end.message}" if end.reason else "INTERRUPTED"
                failure = end.message if end.code == os.EX_TEMPFAIL else failure
                before = (summary(folder / key(scenes[name])) or {}).get("failure", "")
                found = lost[name] = {"failure": before if OUT_OF_MEMORY in before else failure}
            report(name, found)

    with progress(quiet) as bar:
        shown = bar.add_task("points", total=total)
        processes.finish({k: task.call for k, task in enumerate(tasks)}, done, jobs, executor, look)
    return {name: result(scene, folder) or lost[name] for name, scene in scenes.items()}


# -- chains of full slip ----------------------------------------------------------------------------------------
def check_supported(scene: Scene) -> None:
    """Refuse a scene of which full slip is not that of press, charge and slide under a force per length, or has a past.

    Raises:
        SceneError: in one sentence.
    """
    for key in ("history", "force", "accuracy"):
        if (value := getattr(scene, key)) is not None:
            given = show(value) if key == "force" else "given"
            raise SceneError(f"{key} is {given}; {_LEFT_OUT}")
    for layer in viscous_layers(scene.materials):
        raise SceneError(f"{layer}.viscosity is given, and a state needs the past of its layers; {_LEFT_OUT}")
    law = scene.friction_law()
    if law is not None and law.memory is not None:
        raise SceneError(
            f"friction has the law {show(law_name(law))}, on whose memory full slip depends; with states='full_slip' "
            "it must have none, or give states='all'"
        )


def sweep_chains(
    scenes: Mapping[str, Scene], folder: Path, jobs: int, quiet: bool, executor: Executor | None = None
) -> dict[str, Summary]:
    """Solve what has not been solved yet, each scene beside the one before; see :func:`sweep`.

    With an executor ``jobs`` is the number of chains, at most.
    """
    folder = folder.absolute()
    folder.mkdir(parents=True, exist_ok=True)
    with lock_file(folder / "lock") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # another sweep may be at it
        missing = {name: scene for name, scene in scenes.items() if result(scene, folder) is None}
        half_arc, tasks, files = _half_arc([*missing.values()]), list[_Task](), list[Path]()
        for k, names in enumerate(chains(missing, jobs)):
            files.append(folder / f"chain_{k}.json")
            replace_json(files[-1], {"half_arc": half_arc, "scenes": [missing[name].parameters() for name in names]})
            law_folders = sorted({place for name in names for place in missing[name].law_folders()})
            tasks.append(_Task(names, partial(chain, str(files[-1]), str(folder), law_folders)))
        found = finish(scenes, tasks, folder, jobs, quiet, executor)
        for file in files:
            file.unlink(missing_ok=True)
    return found


def chain(file: str, folder: str, law_folders: Sequence[str]) -> End:
    """Follow a chain (a file of its scenes) in a fresh process, which writes each point into its own folder."""
    return run("fingerpad.runs.full_slip", [file, folder, str(_LIMIT_OF_CHAIN)], _LIMIT, law_folders)


def chains(scenes: Mapping[str, Scene], jobs: int) -> Iterator[list[str]]:
    """Yield the names of the scenes of each chain: those of one mesh and laws, in as many parts as there are jobs.

    Scenes of two closures, or with and without a field in contact, are no neighbours: their states are far apart,
    and from there full slip may be another one than by a path.
    """
    groups = dict[str, list[str]]()
    for name, scene in scenes.items():
        fixed = {key: value for key, value in scene.parameters().items() if key not in _FREE}
        laws = [_kind(law) for law in (scene.friction_law(), scene.closure())]
        groups.setdefault(json.dumps([fixed, laws], sort_keys=True), []).append(name)
    for names in groups.values():
        parts = max(1, min(jobs, len(names) // _SHORTEST))
        ends = [len(names) * k // parts for k in range(parts + 1)]
        yield from (names[a:b] for a, b in itertools.pairwise(ends))


def _kind(law: Any) -> tuple[str, dict[str, Any]]:
    """Return a law's name and its parameters that are no numbers."""
    return type(law).__name__, {name: value for name, value in parameters(law).items() if isinstance(value, bool | str)}


def _half_arc(scenes: Sequence[Scene]) -> float | None:
    """Return the ``mesh.touching_half_arc`` (m) of all scenes of a sweep that give none, that of the widest contact."""
    from fingerpad.model.options import by_rule

    free = [scene for scene in scenes if scene.geometry.file is None and scene.mesh.touching_half_arc is None]
    return max((by_rule(scene).mesh.touching_half_arc or 0.0 for scene in free), default=None)
