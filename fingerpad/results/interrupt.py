"""How a run ends early: after its present step at a signal, or with one rank's message where it cannot go on.

Everything is on disk then. The signals are SIGINT, SIGTERM and SIGHUP. Open MPI's mpirun kills its ranks a second after
any of these; SIGUSR1 and SIGUSR2 it passes on, and environment/run sends them in place of SIGINT and SIGTERM.
"""

import errno
import os
import signal
import stat
import sys
import threading
import time
from collections.abc import Callable
from types import FrameType, TracebackType
from typing import Any

from mpi4py import MPI

from variational.solvers.continuation import StepFailed

_MEANING: dict[int, signal.Signals] = {
    signal.SIGINT: signal.SIGINT,
    signal.SIGTERM: signal.SIGTERM,
    signal.SIGHUP: signal.SIGHUP,
    signal.SIGUSR1: signal.SIGINT,
    signal.SIGUSR2: signal.SIGTERM,
}
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
_ONE = 1.0  # s within which signals are one: terminals, launchers and batch systems send several


class Interrupted(StepFailed):
    """A run that was stopped by a signal; nothing is wrong with its scene.

    Attributes:
        signal: the signal.
    """

    def __init__(self, number: signal.Signals, step: int, kept: str = "") -> None:
        """Name the signal, the step, and what is kept of the run."""
        super().__init__("; ".join(filter(None, (f"stopped by {number.name} after step {step}", kept))))
        self.signal = number


class Interrupt:
    """Holds signals back until the end of a step; another one, a second later or more, acts at once.

    What the caller has the run ignore (nohup: SIGHUP) stays ignored.
    """

    def __init__(self, comm: MPI.Comm) -> None:
        """Hold nothing back yet; a signal on any rank stops all ranks."""
        self._comm, self._signal, self._time = comm, 0, 0.0
        self._before: dict[int, Any] = {}

    def __enter__(self) -> "Interrupt":
        """Take the signals over, which only the main thread can."""
        if threading.current_thread() is threading.main_thread():
            taken = [number for number in _MEANING if signal.getsignal(number) is not signal.SIG_IGN]
            self._before = {number: signal.signal(number, self._note) for number in taken}
        return self

    def _note(self, number: int, frame: FrameType | None) -> None:
        now = time.monotonic()
        if not self._signal:
            self._signal, self._time = _MEANING[number], now
            if number == signal.SIGHUP:
                _leave_terminal()
            if self._comm.rank == 0:
                name = signal.Signals(self._signal).name
                print(f"fingerpad: {name}: the run ends after its present step; another one ends it at once",
                      file=sys.stderr, flush=True)  # fmt: skip
        elif now - self._time > _ONE:
            signal.signal(number, self._before[number])
            os.kill(os.getpid(), number)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Give the signals back."""
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def stop_if_asked(self, step: int = 0, kept: str = "") -> None:
        """Stop after an accepted step, of which words tell what is kept and how the run goes on; collective.

        Raises:
            Interrupted: a signal came.
        """
        number = int(self._comm.allreduce(self._signal, op=MPI.MAX))
        if number:
            raise Interrupted(signal.Signals(number), step, kept)


def _leave_terminal() -> None:
    """Write no more to a terminal that has hung up: it would be an error."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in (1, 2):
        if stat.S_ISCHR(os.fstat(stream).st_mode):
            os.dup2(nowhere, stream)
    os.close(nowhere)


class DiskFull(OSError):
    """There is no room for results; what was written before is whole. One sentence."""


def no_room(error: BaseException, resumes: bool) -> DiskFull | None:
    """Return the error of a run where a full disk, a quota or a limit of files' sizes is the reason, or None."""
    if not (isinstance(error, OSError) and error.errno in _FULL):
        return None
    how = "fingerpad run --resume FOLDER goes on" if resumes else "the same command starts again"
    words = "no more results can be written; what was written before stays as it is, and"
    return DiskFull(error.errno, f"{error.strerror}: {words} {how} when there is room")


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
