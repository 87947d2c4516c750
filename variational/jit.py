"""The cache of compiled forms: how long to wait for a compile, and what a killed one leaves behind."""

import time
from pathlib import Path

import dolfinx.jit
from mpi4py import MPI

OPTIONS = {"timeout": 120}  # s; the default of 10 s is too short for large Jacobians on a busy machine
_DEAD = 180.0  # s after which an unfinished compile is taken for killed; the longest here takes half a minute


def sweep(comm: MPI.Comm) -> None:
    """Delete unfinished compiles that nobody is at work on: each would block its form for good; collective."""
    if comm.rank == 0:
        folder = Path(dolfinx.jit.get_options()["cache_dir"])
        for source in folder.glob("*.c"):
            finished = source.with_name(source.name + ".cached").exists()
            if not finished and time.time() - source.stat().st_mtime > _DEAD:
                source.unlink(missing_ok=True)
    comm.barrier()
