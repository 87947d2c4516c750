"""A run of the full model as tests look at it: its summary, as it is on disk."""

from pathlib import Path
from typing import Any

from mpi4py import MPI

from fingerpad.runs import full
from fingerpad.scene import Scene


def run(scene: Scene, folder: Path, comm: MPI.Comm = MPI.COMM_WORLD) -> dict[str, Any]:
    """Return the summary of a run into a folder."""
    return full.run(scene, folder, comm).to_dict()
