"""Checkpoints of runs of the full model: of which scene and program, and what they hold."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import fingerpad.startup  # noqa: F401
from fingerpad.accuracy.states import State
from fingerpad.results.checkpoint import Checkpoint, CheckpointError
from fingerpad.results.fields import View
from fingerpad.results.provenance import provenance
from fingerpad.results.quantities import Output
from fingerpad.scene import Scene
from fingerpad.startup import MPI
from variational.snapshot import Snapshot
from variational.solvers.outcome import Counts
from variational.solvers.state_snapshot import SkinState, StateSnapshot
from variational.solvers.target import Control, Progress
from variational.state import ContactState, Errors, RidgeStates, Sites, Skin, StepRecord, Stimuli

_KEPT = (
    *(ContactState, RidgeStates, Sites, Stimuli, StepRecord, Errors, Skin, Control, Counts, Progress),
    *(State, StateSnapshot, SkinState, View, Snapshot),
)
"""Classes of what a checkpoint holds."""


def read(checkpoint: Checkpoint, comm: MPI.Comm, classes: Sequence[type] = ()) -> dict[str, Any]:
    """Return what the last checkpoint holds, on every rank; collective.

    Args:
        checkpoint: in a folder.
        comm: communicator of the run.
        classes: that it may hold besides those of a run.

    Raises:
        CheckpointError: a run cannot go on from there; on every rank.
    """
    kept: dict[str, Any] | CheckpointError | None = None
    if comm.rank == 0:
        try:
            checkpoint.check()
            kept = checkpoint.read((*_KEPT, *classes))
        except CheckpointError as error:
            kept = error
    kept = comm.bcast(kept)
    if isinstance(kept, CheckpointError):
        raise kept
    assert kept is not None
    return kept


def checkpoint_of(scene: Scene, folder: Path, outputs: Sequence[Output]) -> Checkpoint:
    """Return the checkpoint of a scene by the present program."""
    versions = provenance()["versions"]
    names = ", ".join(each.name for each in outputs) or "none"
    same = {"source": versions["source"], "dolfinx": versions["dolfinx"], "list of outputs": names}
    return Checkpoint(folder, scene.parameters(), same)
