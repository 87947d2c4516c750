"""A run that is asked to stop ends after the step it is at, with everything on disk."""

import signal
import threading
from types import FrameType, TracebackType
from typing import Any

from mpi4py import MPI

from variational.continuation import StepFailed


class Interrupted(StepFailed):
    """A run that was asked to stop; nothing is wrong with its scene."""


class Interrupt:
    """Holds SIGTERM and SIGINT back until the run asks; a second signal acts at once."""

    def __init__(self, comm: MPI.Comm) -> None:
        """Remember whom to ask: any rank's signal stops them all."""
        self._comm, self._signal = comm, 0
        self._before: dict[int, Any] = {}

    def __enter__(self) -> "Interrupt":
        """Take the signals over, which only the main thread can."""
        if threading.current_thread() is threading.main_thread():
            self._before = {number: signal.signal(number, self._note) for number in (signal.SIGTERM, signal.SIGINT)}
        return self

    def _note(self, number: int, frame: FrameType | None) -> None:
        self._signal = number
        signal.signal(number, self._before[number])

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Give the signals back."""
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def stop_if_asked(self, step: int) -> None:
        """Stop after an accepted step; collective.

        Raises:
            Interrupted: a signal came.
        """
        number = int(self._comm.allreduce(self._signal, op=MPI.MAX))
        if number:
            raise Interrupted(
                f"stopped by {signal.Signals(number).name} after step {step}; every accepted step is in the folder of "
                "results, and the same command starts again from the first"
            )
