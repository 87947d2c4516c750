"""Many scenes, each run in a process of its own and kept by what it is made of.

A scene's folder is named by a hash of all its parameters: run again, a sweep computes only what has changed, and runs
that were cut short go on from their checkpoints. The hash does not depend on the program: after a change of the
mechanics the folder must be deleted. A process is ``python3 -m fingerpad.runs.solve SCENE.json FOLDER LIMIT MODEL``.
"""

import fcntl
import hashlib
import json
import os
from collections.abc import Callable, Mapping, Sequence
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
from fingerpad.scene import Scene
from fingerpad.scene.reading import DEFAULT_MODEL

if TYPE_CHECKING:
    from rich.progress import Progress

_LIMIT = 900.0  # s of processor time for one scene


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

    Args:
        parameters: of the scene, ready for JSON.
        folder: of the scene's results.
        limit: processor time (s).
        model: a name of :data:`fingerpad.runs.solve.MODELS`.
        law_folders: of laws of one's own.
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


class Task(NamedTuple):
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
            tasks.append(Task([name], partial(point, scene.parameters(), place, limit, model, scene.law_folders())))
    return finish(scenes, tasks, folder, jobs, quiet, executor)


def finish(
    scenes: Mapping[str, Scene],
    tasks: Sequence[Task],
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
