"""How a run ends that cannot go on: with one rank's message, and with all ranks."""

import errno
import sys
from collections.abc import Callable
from types import TracebackType

from mpi4py import MPI

_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


class DiskFull(OSError):
    """There is no room for results; what was written before is whole. One sentence."""


def no_room(error: BaseException) -> DiskFull | None:
    """Return the error of a run where a full disk, a quota or a limit of files' sizes is the reason, or None."""
    if isinstance(error, OSError) and error.errno in _FULL:
        return DiskFull(
            error.errno,
            f"{error.strerror}: no more results can be written; what was written before stays as it is, and fingerpad "
            "run --resume FOLDER goes on when there is room",
        )
    return None


def all_together(comm: MPI.Comm) -> None:
    """From now on, what any rank raises and nobody catches ends every rank, with that rank's message.

    Others would wait for the one that raised, for ever. A run has its reasons to raise on one rank alone: the first
    writes the files.
    """
    sys.excepthook = _Hook(comm, sys.excepthook.before if isinstance(sys.excepthook, _Hook) else sys.excepthook)


class _Hook:
    """Takes the place of :data:`sys.excepthook`."""

    def __init__(self, comm: MPI.Comm, before: Callable[..., object]) -> None:
        self.before, self._comm = before, comm

    def __call__(self, kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        if isinstance(error, DiskFull):
            print(f"fingerpad: {error.strerror}", file=sys.stderr)
        else:
            self.before(kind, error, trace)
        sys.stdout.flush()
        sys.stderr.flush()
        if self._comm.size > 1:
            self._comm.Abort(130 if isinstance(error, KeyboardInterrupt) else 1)
