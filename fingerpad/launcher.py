"""Which process of a launcher of MPI this is, from the environment: known before MPI has started, and without it."""

import os

RANKS = ("OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK", "MV2_COMM_WORLD_RANK", "SLURM_PROCID")
"""Variables of the environment in which launchers give the rank of a process."""
_SIZES = ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MV2_COMM_WORLD_SIZE")


def rank() -> int:
    """Return the rank of this process under a launcher of MPI, 0 without one."""
    return _rank() or 0


def ranks() -> int:
    """Return the number of processes that a launcher of MPI has started, 1 without one."""
    given = (os.environ.get(name, "") for name in _SIZES)
    return next((int(text) for text in given if text.isdecimal()), 1)


def launched() -> bool:
    """Return whether a launcher of MPI has started this process."""
    return _rank() is not None


def _rank() -> int | None:
    given = (os.environ.get(name, "") for name in RANKS)
    return next((int(text) for text in given if text.isdecimal()), None)
