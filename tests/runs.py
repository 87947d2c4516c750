"""A run of the full model as tests look at it: its summary, as it is on disk."""

from pathlib import Path
from typing import Any
from unittest.mock import patch

from matplotlib.figure import Figure
from mpi4py import MPI

from fingerpad.runs import full
from fingerpad.scene import Scene


def run(scene: Scene, folder: Path, comm: MPI.Comm = MPI.COMM_WORLD) -> dict[str, Any]:
    """Return the summary of a run into a folder; its pictures are built, and their files left empty.

    To draw them takes two seconds, more than a small finger does. Commands and demos draw theirs.
    """
    with patch.object(Figure, "savefig", lambda figure, path, **options: Path(path).touch()):
        return full.run(scene, folder, comm).to_dict()
