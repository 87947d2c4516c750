"""Many scenes, each run in a process of its own and kept by what it is made of.

A scene's folder is named by a hash of all its parameters: run again, a sweep computes only what has changed, and runs
that were cut short go on from their checkpoints. The hash does not depend on the program: after a change of the
mechanics the folder must be deleted. A process is ``python3 -m fingerpad.runs.batch SCENE.json FOLDER LIMIT MODEL``.
"""

import fcntl
import hashlib
import json
import os
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from fingerpad.reduced.registry import find
from fingerpad.results.files import below, lock_file, replace_json
from fingerpad.results.folder import FolderError, identity
from fingerpad.results.terminal import between, watched
from fingerpad.runs.context import RunContext
from fingerpad.runs.processes import End, Pool, limit_processor_time, run
from fingerpad.runs.solve import OF_THE_MACHINE, Summary, ended, gone_on, summary
from fingerpad.scene import Scene, SceneError, from_data
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
    """Return the least and the longest time left (s), by the runs until now.

    Args:
        took: times of the runs until now (s), at least one.
        left: number of runs that are left, those in hand included.
        jobs: runs at a time.
    """
    rounds = left / min(jobs, left)
    low, high = min(took), max(took)
    return (rounds - 1) * low + low / 2, rounds * max(high, 1.25 * low)


def _said(summary: Summary) -> str:
    """Return what became of a run that did not fail, in words; of a whole finger where the force is on it."""
    mu_app = summary.get(f"full_slip_{'finger_' * ('force' in summary.get('parameters', {}))}mu_app")
    return "done" if mu_app is None else f"done, µ_app {mu_app:.4f}"


def sweep(
    scenes: Mapping[str, Scene],
    folder: Path,
    jobs: int = 2,
    limit: float = _LIMIT,
    model: str = DEFAULT_MODEL,
    quiet: bool = False,
) -> dict[str, Summary]:
    """Run what has not been run yet, with a progress bar.

    Args:
        scenes: by name.
        folder: of all results.
        jobs: processes at a time.
        limit: seconds of processor time for one scene.
        model: a name of :data:`fingerpad.reduced.registry.MODELS`, of one that meshes.
        quiet: whether to print nothing, and show no bar.

    Returns:
        The summaries by name. That of a run that crashed, took too long, had too little memory or was asked to stop
        holds ``failure`` alone, and it goes on the next time; what it left is in its folder.
    """

    def kept(name: str) -> Summary | None:
        return result(scenes[name], folder)

    broken: dict[str, Summary] = {}
    took: list[float] = []  # s, of each run

    def job(name: str) -> End:
        place = below(folder, key(scenes[name]))
        place.mkdir(parents=True, exist_ok=True)
        with lock_file(place / "lock") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)  # another sweep may be at it
            if kept(name) is not None:
                return End(0, "", "", "")
            (place / "summary.json").unlink(missing_ok=True)  # of a run that says nothing of this one
            replace_json(place / "asked.json", scenes[name].parameters())
            start = time.monotonic()
            given = [str(place / "asked.json"), str(place), str(limit), model]
            end = run("fingerpad.runs.batch", given, limit, scenes[name].law_folders())
            took.append(time.monotonic() - start)
            return end

    def done(name: str, end: End, left: int) -> None:
        found = kept(name)
        if found is None:
            crashed = f"{end.reason}: {end.message}" if end.reason else "INTERRUPTED"
            said = (summary(folder / key(scenes[name])) or {}).get("failure", "")
            of_process = end.message if end.code == os.EX_TEMPFAIL else crashed
            broken[name] = {"failure": said if OF_THE_MACHINE in said else of_process}
        if quiet:
            return
        words = (found or broken[name]).get("failure") or _said(found or {})
        rest = f"; {between(*times_left(took, left, jobs))} left" if left and took else ""
        text = f"{name}: {words} ({len(missing) - left} of {len(missing)}{rest})"
        bar.console.print(text, highlight=False, markup=False, soft_wrap=True)
        bar.update(task, advance=1, description=f"scenes{rest.replace(';', ',')}")

    missing = [name for name in scenes if kept(name) is None]
    with progress(quiet) as bar:
        task = bar.add_task("scenes", total=len(missing))
        Pool[str, End](job, jobs).run(missing, done)
    return {name: kept(name) or broken[name] for name in scenes}


def main(scene: Path, folder: Path, model: str) -> None:
    """Run a scene into a folder, from its checkpoint where it has one.

    Args:
        scene: file of its parameters in JSON.
        folder: of the results.
        model: a name of :data:`fingerpad.reduced.registry.MODELS`.
    """
    asked, way = from_data(json.loads(scene.read_text(encoding="utf-8"))), find(model)
    try:
        gone_on(asked, way, RunContext(folder, lines=way.path, bar=way.path, report=False))
    except FolderError as error:  # another run is at it, or the disk is full: it may be gone the next time
        print(error, file=sys.stderr)
        sys.exit(os.EX_TEMPFAIL)
    except SceneError as error:  # it would be the same the next time
        replace_json(folder / "summary.json", {"failure": str(error)})


if __name__ == "__main__":
    limit_processor_time(float(sys.argv[3]))
    main(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[4])
