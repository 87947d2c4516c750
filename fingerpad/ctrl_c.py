"""Ctrl-C in a program that is not at a run yet, or no longer: the process ends at once and prints nothing.

Libraries that are being imported lose a KeyboardInterrupt, or turn it into another error; Python prints a traceback of
one that comes before the program's first line or at its end. SIGINT that the caller has ignored stays ignored.
"""

import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


def ends_at_once() -> None:
    """End the process with exit code 130 at SIGINT, in place of raising KeyboardInterrupt; for programs alone."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _end)


@contextmanager
def raises() -> Iterator[None]:
    """Let Ctrl-C raise KeyboardInterrupt inside the block, so that the block can clean up."""
    ends = signal.getsignal(signal.SIGINT) is _end
    try:
        if ends:
            signal.signal(signal.SIGINT, signal.default_int_handler)
        yield
    finally:
        if ends:
            signal.signal(signal.SIGINT, _end)


def _end(number: int, frame: FrameType | None) -> None:
    os._exit(128 + number)
