"""Sweeps of ``states="full_slip"``: which points are followed in one chain, and the processes that follow them."""

import fcntl
import itertools
import json
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor
from functools import partial
from pathlib import Path
from typing import Any

from fingerpad.results.files import lock_file, replace_json
from fingerpad.runs import batch
from fingerpad.runs.context import Summary
from fingerpad.runs.processes import End, run
from fingerpad.scene import Scene, SceneError, law_name
from fingerpad.scene.law_keys import parameters
from fingerpad.scene.messages import show
from fingerpad.scene.viscosity import viscous_layers

_FREE = ("f_ext", "voltage", "friction", "roughness", "electric", "slide_length")
"""Keys in which neighbours may differ by numbers: they change neither the mesh nor the layers."""
_SHORTEST = 8  # points of a chain, of which the first takes the time of some fifteen others
_LIMIT = 4 * 3600.0  # s of processor time for a chain
_LEFT_OUT = "with states='full_slip' it must be left out, or give states='all'"


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


def sweep(
    scenes: Mapping[str, Scene], folder: Path, jobs: int, quiet: bool, executor: Executor | None = None
) -> dict[str, Summary]:
    """Solve what has not been solved yet, each scene beside the one before; see :func:`fingerpad.runs.batch.sweep`.

    With an executor ``jobs`` is the number of chains, at most.
    """
    folder = folder.absolute()
    folder.mkdir(parents=True, exist_ok=True)
    with lock_file(folder / "lock") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # another sweep may be at it
        missing = {name: scene for name, scene in scenes.items() if batch.result(scene, folder) is None}
        half_arc, tasks, files = _half_arc([*missing.values()]), list[batch.Task](), list[Path]()
        for k, names in enumerate(chains(missing, jobs)):
            files.append(folder / f"chain_{k}.json")
            replace_json(files[-1], {"half_arc": half_arc, "scenes": [missing[name].parameters() for name in names]})
            law_folders = sorted({place for name in names for place in missing[name].law_folders()})
            tasks.append(batch.Task(names, partial(chain, str(files[-1]), str(folder), law_folders)))
        found = batch.finish(scenes, tasks, folder, jobs, quiet, executor)
        for file in files:
            file.unlink(missing_ok=True)
    return found


def chain(file: str, folder: str, law_folders: Sequence[str]) -> End:
    """Follow a chain (a file of its scenes) in a fresh process, which writes each point into its own folder."""
    return run("fingerpad.runs.full_slip", [file, folder, str(_LIMIT)], _LIMIT, law_folders)


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
