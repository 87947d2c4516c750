"""What a run has beside its scene: ranks, folder, console, report, and where it goes on."""

import json
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fingerpad import launcher
from fingerpad.results.files import has_other_format, read_object
from fingerpad.results.folder import Folder, Serial, identity
from fingerpad.results.quantities import Output
from fingerpad.scene import Scene
from variational.state import ContactState

if TYPE_CHECKING:
    from fingerpad.startup import MPI

Summary = dict[str, Any]
OUT_OF_MEMORY = "MUMPS_OUT_OF_MEMORY"
"""Failure caused by the machine; the run can be repeated."""
BEGUN = "begun"
"""Key of a summary that was written before what follows from its states, for runs that end in between."""


@dataclass(frozen=True)
class RunContext:
    """Everything that a run has beside its scene and model; none of it changes a number."""

    folder: Path | None = None
    """Folder of tables, pictures, fields and ``summary.json``; None to write nothing."""
    comm: "MPI.Comm | None" = None
    """Communicator; None for that of all ranks."""
    lines: bool = False
    """Whether steps are printed."""
    bar: bool = True
    """Whether a progress bar is shown where a person watches."""
    report: bool = True
    """Whether ``report.html`` is written beside the results. A model without a path has bands of its friction then."""
    resume: bool = False
    """Whether the run goes on from the checkpoint in its folder."""
    on_step: Callable[[ContactState, float], None] | None = None
    """Called with each accepted state and the part of the run that is done, on every rank; None for nothing."""
    outputs: Sequence[Output] = ()
    """Further quantities, each computed from every state."""

    @property
    def ranks(self) -> "MPI.Comm | Serial":
        """Communicator of the run: of all ranks by default, and of this process alone where there is no MPI."""
        if self.comm is not None:
            return self.comm
        if not launcher.launched():  # nor do the libraries of finite elements start
            return Serial()
        try:
            from fingerpad.startup import MPI
        except ImportError:
            return Serial()
        return MPI.COMM_WORLD

    def place(self, scene: Scene, model: str) -> AbstractContextManager[Folder | None]:
        """Lock the folder for the results of a scene by a model; nothing without a folder; collective.

        Raises:
            FolderError: on entering, the folder is in use, holds other results, or cannot be written to.
        """
        if self.folder is None:
            return nullcontext()
        return Folder(self.folder, scene.parameters(), self.ranks, model)


# -- what an earlier run has left in a folder -------------------------------------------------------------------
def finished(scene: Scene, place: Path) -> Summary | None:
    """Return the summary of a scene that has been run in a folder of its own to its end; None of another scene's."""
    found = ended(summary(place))
    own = json.loads(json.dumps(identity(scene.parameters())))
    return found if found is not None and identity(found.get("parameters", {})) == own else None


def ended(found: Summary | None) -> Summary | None:
    """Return a summary; None of a run that was stopped or killed or had too little memory, and of another format."""
    if found is None or OUT_OF_MEMORY in str(found.get("failure")):
        return None
    return None if found.get("interrupted") or BEGUN in found or has_other_format(found) else found


def summary(place: Path) -> Summary | None:
    """Return the summary in a folder; None without one, or with one that was damaged."""
    try:
        return read_object(place / "summary.json")
    except (OSError, ValueError):
        return None
