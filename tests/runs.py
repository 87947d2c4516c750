"""A run of the full model as tests look at it: its summary, as it is on disk."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any
from unittest.mock import patch

from mpi4py import MPI

from fingerpad.model.options import FingerModel, by_rule, plan
from fingerpad.model.simulation import Simulation
from fingerpad.results.pictures import curves, style
from fingerpad.results.pictures import finger as finger_picture
from fingerpad.results.pictures.drawing import Drawing
from fingerpad.runs import full
from fingerpad.runs.context import RunContext
from fingerpad.scene import Scene

PICTURES = ((finger_picture, "finger"), (curves, "surface"), (curves, "history"))


@contextmanager
def no_pictures() -> Iterator[None]:
    """Leave the files of a run's pictures empty: to draw them takes a second, as much as a small finger does."""
    with ExitStack() as stack:
        for module, name in PICTURES:
            stack.enter_context(patch.object(module, name, touch))
        yield


@contextmanager
def tables_alone() -> Iterator[None]:
    """Write a run's tables and dataset, and neither pictures nor report: they are half of its time."""
    with ExitStack() as stack:
        stack.enter_context(patch.object(Drawing, "write", lambda *args: None))
        stack.enter_context(patch("fingerpad.report.write.write", lambda folder: None))
        yield


def path_of(scene: Scene, *reports: Any, comm: MPI.Comm = MPI.COMM_WORLD) -> Simulation:
    """Return the path of a scene, still to be followed; ``reports`` are called at steps and at loads."""
    asked = by_rule(scene)
    return Simulation(FingerModel(asked, plan(asked)), comm, *reports)


def followed(scene: Scene, *reports: Any, comm: MPI.Comm = MPI.COMM_WORLD) -> Simulation:
    """Return the path of a scene after its last load."""
    path = path_of(scene, *reports, comm=comm)
    assert path.run() is None, "a run would start again"
    return path


def touch(path: Path, *args: Any, **options: Any) -> None:
    Path(path).touch()


def run(scene: Scene, folder: Path, comm: MPI.Comm = MPI.COMM_WORLD, pictures: bool = False) -> dict[str, Any]:
    """Return the summary of a run into a folder; the files of its pictures are empty.

    Commands and demos draw theirs. With ``pictures`` they are built, and not written.
    """
    built = patch.object(style, "save", lambda figure, path: figure if path is None else touch(path))
    with built if pictures else no_pictures():
        return full.run(scene, RunContext(folder, comm, lines=True)).to_dict()
