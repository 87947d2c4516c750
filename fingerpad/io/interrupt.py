"""A run that gets a signal ends after its present step, with everything on disk.

The signals are SIGINT, SIGTERM and SIGHUP. Open MPI's mpirun kills its ranks a second after any of these; SIGUSR1 and
SIGUSR2 it passes on, and environment/run sends them in place of SIGINT and SIGTERM.
"""

import os
import signal
import stat
import sys
import threading
import time
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
        """Stop after an accepted step; collective.

        Args:
            step: its number.
            kept: what is kept of the run, and how it goes on, in words.

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
