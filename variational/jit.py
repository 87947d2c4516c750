"""Compiled forms: for which processor, how long to wait for a compile, and what a killed one leaves behind."""

import contextlib
import hashlib
import platform
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import dolfinx.jit
from mpi4py import MPI

_CPU = Path("/proc/cpuinfo")
# Divisions may become products with the inverse: results differ by roundoff. Sums stay in order: -fassociative-math, a
# part of -ffast-math, may cancel NaN, by which an element turned inside out is found.
_FAST = ["-O3", "-fno-math-errno", "-fno-trapping-math", "-freciprocal-math"]
_DEAD = 300.0  # s after which an unfinished compile that no compiler works on counts as killed; mostly it takes seconds


def _own() -> dict[str, Any]:
    """Return options that make use of all this processor can do, in a cache of its own."""
    # The default timeout of 10 s is too short for large Jacobians.
    options: dict[str, Any] = {"timeout": 300, "cffi_extra_compile_args": _FAST}
    if platform.machine() != "x86_64" or not _CPU.exists():
        return options
    flags = next(line for line in _CPU.read_text().splitlines() if line.startswith("flags"))
    cache = Path(dolfinx.jit.get_options()["cache_dir"]) / hashlib.sha256(flags.encode()).hexdigest()[:12]
    return options | {"cffi_extra_compile_args": ["-march=native", *_FAST], "cache_dir": cache}


OPTIONS = _own()


def options() -> dict[str, Any]:
    """Return all options that forms are compiled with, those of dolfinx's own files included."""
    return dict(dolfinx.jit.get_options(OPTIONS))


def delete_unfinished(comm: MPI.Comm) -> None:
    """Delete unfinished compiles that no process works on: each would block its form for good; collective."""
    if comm.rank == 0:
        folder = Path(OPTIONS.get("cache_dir", dolfinx.jit.get_options()["cache_dir"]))
        for source in folder.glob("*.c"):
            if not source.with_name(source.name + ".cached").exists() and _dead(source):
                source.unlink(missing_ok=True)
    comm.barrier()


def _dead(source: Path) -> bool:
    """Return whether a source is old and no visible process compiles it."""
    try:
        old = time.time() - source.stat().st_mtime > _DEAD
    except FileNotFoundError:  # another process was faster
        return False
    return old and not any(source.name.encode() in command for command in _commands())


def _commands() -> Iterator[bytes]:
    """Yield the command line of each process that can be seen; none where there is no /proc."""
    for process in Path("/proc").glob("[0-9]*/cmdline"):
        with contextlib.suppress(OSError):
            yield process.read_bytes()
