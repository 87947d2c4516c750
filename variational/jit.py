"""Compiled forms: for which processor, one process at a time, and what a killed compile leaves behind.

FFCx takes a source file without a result for a compile at work, so that a killed process blocks its form for good. Here
a process holds a lock on the source file while it compiles, which the kernel frees when the process ends. The compile
is in a private folder, and the finished module is put in its place whole. So the lock only saves work: without locks,
or where the process with the lock was stopped, another process compiles the form as well, and either result serves.
Caches of other programs are left to FFCx.
"""

import contextlib
import fcntl
import functools
import hashlib
import importlib.util
import platform
import shutil
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path
from typing import Any

import cffi
import dolfinx.jit
import ffcx.codegeneration.jit as ffcx_jit
from mpi4py import MPI

_CPU = Path("/proc/cpuinfo")
# Divisions may become products with the inverse: results differ by roundoff. Sums stay in order: -fassociative-math, a
# part of -ffast-math, may cancel NaN, by which an element turned inside out is found.
_FAST = ["-O3", "-fno-math-errno", "-fno-trapping-math", "-freciprocal-math"]
_SILENT = 5.0  # s of waiting for another process until a line says so
# What setuptools says of a compiler that got a signal, as of Ctrl-C, which the run holds back.
_SIGNALLED = ("failed with exit code -", "died with <Signals.")


class CompileError(ImportError):
    """A form that cannot be compiled, and why, in one sentence."""

    def __init__(self, message: str) -> None:
        """Name what is missing in effect, as for other libraries: a C compiler that works."""
        super().__init__(message, name="C compiler")


def _own() -> dict[str, Any]:
    """Return options that make use of all this processor can do, in a cache of its own."""
    cache = Path(dolfinx.jit.get_options()["cache_dir"])
    # Seconds to wait for another process; the default of 10 s is too short for large Jacobians.
    options: dict[str, Any] = {"timeout": 300, "cffi_extra_compile_args": _FAST, "cache_dir": cache / "fingerpad"}
    if platform.machine() != "x86_64" or not _CPU.exists():
        return options
    flags = next(line for line in _CPU.read_text().splitlines() if line.startswith("flags"))
    cache /= hashlib.sha256(flags.encode()).hexdigest()[:12]
    return options | {"cffi_extra_compile_args": ["-march=native", *_FAST], "cache_dir": cache}


OPTIONS = _own()


# -- in the place of FFCx's functions --------------------------------------------------------------------
_get_cached_module, _compile_objects = ffcx_jit.get_cached_module, ffcx_jit._compile_objects


def _finished(module: str, names: Sequence[str], folder: Path, timeout: int = 0) -> tuple[Any, Any]:
    """Return the objects of a compiled module, and the module; None for both where it must be compiled."""
    if Path(folder) != OPTIONS["cache_dir"]:
        return _get_cached_module(module, names, folder, timeout)
    # FFCx lists the cache, which may have thousands of files.
    libraries = [path for suffix in EXTENSION_SUFFIXES if (path := folder / f"{module}{suffix}").exists()]
    if (folder / f"{module}.c.cached").exists() and libraries:
        spec: Any = importlib.util.spec_from_file_location(module, libraries[0])
        with contextlib.suppress(ImportError):  # the library is no longer whole
            loaded = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(loaded)
            return [getattr(loaded.lib, name) for name in names], loaded
    return None, None


def _compile(
    decl: str, forms: Any, names: Sequence[str], module: str, how: Any, folder: Path, *args: Any, **more: Any
) -> str:
    """Compile a module unless another process does, and return its source.

    Raises:
        CompileError: the compiler fails, or a file cannot be written.
    """

    def compile_in(place: Path) -> str:
        return str(_compile_objects(decl, forms, names, module, how, place, *args, **more))

    if folder != OPTIONS["cache_dir"]:
        return compile_in(folder)
    try:
        with _turn(folder / f"{module}.c") as begun:
            if _finished(module, names, folder)[1] is not None:
                return ""
            if begun:
                _print(f"an earlier compile of the form {module[-12:]} did not finish; compiling again")
            try:
                return _apart(compile_in, folder)
            except cffi.VerificationError as error:
                if not any(words in str(error) for words in _SIGNALLED):
                    raise
                return _apart(compile_in, folder)
    except (cffi.VerificationError, OSError) as error:
        places = f"in {tempfile.gettempdir()} and kept in {folder}"
        raise CompileError(f"a form cannot be compiled {places}: {error}") from error


def _apart(compile_in: Callable[[Path], str], folder: Path) -> str:
    """Compile in a private folder; move the library, and then the file that marks it as finished, each whole."""
    with tempfile.TemporaryDirectory(prefix="fingerpad-form-") as private:
        source = compile_in(Path(private))
        for file in (*Path(private).glob("*.so"), *Path(private).glob("*.cached")):
            part = folder / f"{file.name}.{Path(private).name}"
            try:
                shutil.copyfile(file, part)
                part.replace(folder / file.name)
            finally:
                part.unlink(missing_ok=True)
    return source


@contextlib.contextmanager
def _turn(source: Path) -> Iterator[bool]:
    """Wait while another process compiles a form, and let others wait; yield whether a compile had been begun."""
    source.parent.mkdir(parents=True, exist_ok=True)
    begun = source.exists() or source.with_suffix(".c.cached").exists()
    start, silent = time.monotonic(), True
    with source.open("a") as file:  # closing it undoes the lock
        while time.monotonic() - start < OPTIONS["timeout"]:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except BlockingIOError:
                if silent and time.monotonic() - start > _SILENT:
                    silent = False
                    most = f"for {OPTIONS['timeout']} s at most"
                    _print(f"waiting for another process that compiles the same form, {most}")
                time.sleep(0.05)
            except OSError:  # a file system without locks
                break
        yield begun


def _print(what: str) -> None:
    print(f"fingerpad: {what}", file=sys.stderr, flush=True)


ffcx_jit.get_cached_module, ffcx_jit._compile_objects = _finished, _compile


# -- in the place of dolfinx's function ------------------------------------------------------------------
_on_each_rank = dolfinx.jit.ffcx_jit


@functools.wraps(_on_each_rank)
def _on_all_ranks(comm: MPI.Comm, *args: Any, **more: Any) -> Any:
    """Compile a form; collective.

    Raises:
        CompileError: on every rank, with the cause on the first rank that failed.
    """
    if comm.size == 1:
        return _on_each_rank(comm, *args, **more)
    found, error = None, None
    try:
        found = _on_each_rank(comm, *args, **more)
    except Exception as caught:
        error = caught
    causes = [cause for cause in comm.allgather(error and str(error)) if cause is not None]
    if causes:
        raise CompileError(causes[0]) from error
    return found


dolfinx.jit.ffcx_jit = _on_all_ranks
