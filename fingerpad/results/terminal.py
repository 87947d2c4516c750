"""Who reads what a program prints: one rank of several, and a person or a file.

Launchers of MPI give each rank a number in the environment, so that it is there before MPI has started. mpirun prints
through a terminal of its own, whatever its output goes to: under a launcher, the output of the launcher counts.
"""

import os
import re
import sys
from typing import TextIO

_RANKS = ("OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK", "MV2_COMM_WORLD_RANK", "SLURM_PROCID")
_SIZES = ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MV2_COMM_WORLD_SIZE")
_TERMINAL = r"/dev/(pts/\d+|tty\w*|console)"


def rank() -> int:
    """Return the rank of this process under a launcher of MPI, 0 without one."""
    given = _rank()
    return 0 if given is None else given


def ranks() -> int:
    """Return the number of processes that a launcher of MPI has started, 1 without one."""
    given = (os.environ.get(name, "") for name in _SIZES)
    return next((int(text) for text in given if text.isdecimal()), 1)


def launched() -> bool:
    """Return whether a launcher of MPI has started this process."""
    return _rank() is not None


def watched(stream: TextIO | None = None) -> bool:
    """Return whether a person watches a stream, to whom progress bars and colours may be shown.

    Args:
        stream: standard output if None.
    """
    stream = sys.stdout if stream is None else stream
    if rank() or os.environ.get("NO_COLOR") or os.environ.get("TERM", "dumb") == "dumb" or not stream.isatty():
        return False
    return _rank() is None or _launcher_is_watched()


def _rank() -> int | None:
    given = (os.environ.get(name, "") for name in _RANKS)
    return next((int(text) for text in given if text.isdecimal()), None)


def _launcher_is_watched() -> bool:
    """Return whether the output of the parent process is a terminal; where that cannot be found out, it is none."""
    try:
        return re.fullmatch(_TERMINAL, os.readlink(f"/proc/{os.getppid()}/fd/1")) is not None
    except OSError:
        return False
