"""Compiled forms: for which processor, how long to wait for a compile, and what a killed one leaves behind."""

import hashlib
import platform
import time
from pathlib import Path
from typing import Any

import dolfinx.jit
from mpi4py import MPI

_CPU = Path("/proc/cpuinfo")
_DEAD = 180.0  # s after which an unfinished compile is taken for killed; the longest here takes half a minute


def _options() -> dict[str, Any]:
    """Return options that make use of all this processor can do, in a cache of its own."""
    options: dict[str, Any] = {"timeout": 300}  # s; the default of 10 s is too short for large Jacobians
    if platform.machine() != "x86_64" or not _CPU.exists():
        return options
    flags = next(line for line in _CPU.read_text().splitlines() if line.startswith("flags"))
    cache = Path(dolfinx.jit.get_options()["cache_dir"]) / hashlib.sha256(flags.encode()).hexdigest()[:12]
    return options | {"cffi_extra_compile_args": ["-march=native"], "cache_dir": cache}


OPTIONS = _options()


def sweep(comm: MPI.Comm) -> None:
    """Delete unfinished compiles that nobody is at work on: each would block its form for good; collective."""
    if comm.rank == 0:
        folder = Path(OPTIONS.get("cache_dir", dolfinx.jit.get_options()["cache_dir"]))
        for source in folder.glob("*.c"):
            finished = source.with_name(source.name + ".cached").exists()
            if not finished and time.time() - source.stat().st_mtime > _DEAD:
                source.unlink(missing_ok=True)
    comm.barrier()
