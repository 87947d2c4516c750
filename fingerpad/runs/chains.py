"""Sweeps of ``states="full_slip"``: which points are followed in one chain, and the processes that follow them."""

import fcntl
import itertools
import json
import threading
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from fingerpad.results.files import lock_file, replace_json
from fingerpad.runs import batch
from fingerpad.runs.processes import End, Pool, run
from fingerpad.runs.solve import Summary
from fingerpad.scene import Scene, SceneError, law_name
from fingerpad.scene.law_keys import parameters
from fingerpad.scene.messages import show
from fingerpad.scene.viscosity import viscous_layers

_FREE = ("f_ext", "voltage", "friction", "roughness", "electric", "slide_length")
"""Keys in which neighbours may differ by numbers: they change neither the mesh nor the layers."""
_SHORTEST = 8  # points of a chain, of which the first takes the time of some fifteen others
_LIMIT = 4 * 3600.0  # s of processor time for a chain
_LEFT_OUT = "with states='full_slip' it must be left out, or give states='all'"
_LOOK = 1.0  # s between two looks for points that are finished


def refuse_others(scene: Scene) -> None:
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


def sweep(scenes: Mapping[str, Scene], folder: Path, jobs: int, quiet: bool) -> dict[str, Summary]:
    """Solve what has not been solved yet, with a progress bar.

    Args:
        scenes: by name, each beside the one before.
        folder: of all results.
        jobs: processes at a time.
        quiet: whether to print nothing, and show no bar.

    Returns:
        The summaries by name; of a point whose process ended before, with its ``failure`` alone.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with lock_file(folder / "lock") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # another sweep may be at it
        missing = [name for name in scenes if batch.result(scenes[name], folder) is None]
        asked = list(chains({name: scenes[name] for name in missing}, jobs))
        ends = _followed(scenes, asked, missing, folder, jobs, quiet)
    lost = {"failure": next((f"{end.reason}: {end.message}" for end in ends if end.reason), "INTERRUPTED")}
    return {name: batch.result(scene, folder) or lost for name, scene in scenes.items()}


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


def _followed(
    scenes: Mapping[str, Scene], asked: list[list[str]], missing: list[str], folder: Path, jobs: int, quiet: bool
) -> list[End]:
    """Follow chains in processes of their own; return how these ended."""
    ends: list[End] = []
    files = [folder / f"chain_{k}.json" for k in range(len(asked))]
    half_arc = _half_arc([scenes[name] for name in missing])
    for file, names in zip(files, asked, strict=True):
        replace_json(file, {"half_arc": half_arc, "scenes": [scenes[name].parameters() for name in names]})

    def job(k: int) -> End:
        folders = sorted({place for name in asked[k] for place in scenes[name].law_folders()})
        return run("fingerpad.runs.chain", [str(files[k]), str(folder), str(_LIMIT)], _LIMIT, folders)

    stop = threading.Event()
    with batch.progress(quiet) as bar:
        task, left = bar.add_task("states of full slip", total=len(missing)), list(missing)

        def look() -> None:
            for name in [*left]:
                found = batch.result(scenes[name], folder)
                if found is None:
                    continue
                left.remove(name)
                if not quiet:
                    words = found.get("failure") or f"µ_app {found['full_slip_mu_app']:.4f}"
                    bar.console.print(f"{name}: {words}", highlight=False, markup=False, soft_wrap=True)
                bar.update(task, advance=1)

        def watch() -> None:
            while not stop.wait(_LOOK):
                look()

        watcher = threading.Thread(target=watch, daemon=True)
        watcher.start()
        try:
            Pool[int, End](job, jobs).run(range(len(asked)), lambda k, end, left: ends.append(end))
        finally:
            stop.set()
            watcher.join()
        look()
    for file in files:
        file.unlink(missing_ok=True)
    return ends


def _half_arc(scenes: Sequence[Scene]) -> float | None:
    """Return the ``mesh.touching_half_arc`` (m) of all scenes of a sweep that give none, that of the widest contact."""
    from fingerpad.model.options import by_rule

    free = [scene for scene in scenes if scene.geometry.file is None and scene.mesh.touching_half_arc is None]
    return max((by_rule(scene).mesh.touching_half_arc or 0.0 for scene in free), default=None)
