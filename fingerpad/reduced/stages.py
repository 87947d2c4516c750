"""What there is to do for an answer of the smooth finger, one after the other, and how long it takes."""

from collections.abc import Sequence
from pathlib import Path

from mpi4py import MPI

from fingerpad.io.console import Console
from fingerpad.reduced import ridge_cell
from fingerpad.scene import Scene

_CHARGED, _UNCHARGED, FINGER = 4.0, 2.5, 8.0
"""Expected processor time (s) of a ridge's tables at facets of 5 um, with a voltage and without, and of the finger's
loads: of default scenes between 20 and 75 N/m and 100 and 200 V, known to a factor of two."""
_FINER = 0.4  # power of one over the facets with which the time of a table grows: from 5 to 2.5 um
_SIZE = 5e-6  # m, those facets


class Stages:
    """What there is to do, one after the other, and how much of its time is over."""

    def __init__(self, scenes: Sequence[Scene], folder: Path, comm: MPI.Comm, console: Console | None) -> None:
        """Find what there is to do; collective.

        Args:
            scenes: of the fingers, in order.
            folder: of the ridges' tables.
            comm: communicator of the mesh.
            console: shows it; None for nothing.
        """
        self._console, self._seconds, self._done = console, list[float](), 0
        for scene in scenes:
            self._seconds += _expected(scene, folder, comm)
        if console is not None:
            console.expect({}, sum(self._seconds))

    def begin(self, what: str) -> None:
        """Show what begins, unless it takes no time."""
        if self._console is not None and self._seconds[self._done]:
            self._console.phase(what, sum(self._seconds[: self._done]) / sum(self._seconds))
        self._done += 1

    def again(self, scene: Scene, folder: Path, comm: MPI.Comm, deeper: int) -> None:
        """Add a finger whose ridges are pressed more deeply; collective."""
        self._seconds[self._done : self._done] = _expected(scene, folder, comm, deeper)


def _expected(scene: Scene, folder: Path, comm: MPI.Comm, deeper: int = 1) -> list[float]:
    """Return the processor times (s) of a finger's tables, zero of those that are kept, and of its loads."""
    found = []
    for each in ridges(scene):
        time = (_CHARGED if each.voltage else _UNCHARGED) * (_SIZE / each.mesh.contact) ** _FINER
        found.append(0.0 if ridge_cell.are_kept(each, folder, comm, deeper) else time)
    return [*found, FINGER]


def ridges(scene: Scene) -> list[Scene]:
    """Return the scenes whose ridges the finger of a scene has: charged and uncharged, or one without a voltage."""
    return [scene, scene.model_copy(update={"voltage": 0.0})] if scene.voltage else [scene]
