"""What a program does before anything else: start the libraries without their configuration files.

MPI (``ucx.conf``), PETSc (``.petscrc``, ``petscrc``, ``petsc.cfg``), dolfinx (``dolfinx_jit_options.json``), FFCx
(``ffcx_options.json``) and Matplotlib (``matplotlibrc``) read files of the current folder when they start, and some
of these files name code that is loaded. A scene in a folder of unknown origin must not run code, so that all of them
are started elsewhere. Files in the user's home were written for other programs and would change results without a
trace in the scene: PETSc, dolfinx and FFCx read none, pictures have :mod:`fingerpad.io.style`, meshes
:mod:`geometry.session`. PETSc's options come from the command line and from ``PETSC_OPTIONS``. Importing this module
starts MPI, :func:`start` the rest: both come before any other import of these libraries.
"""

import contextlib
import os
import sys
from collections.abc import Iterator, Sequence

from fingerpad.installed import need_compiler

_ELSEWHERE = "/"  # belongs to the system; nothing is configured there

# What PETSc did not read is found by fingerpad.io.petsc_options, not listed when everything is over; its handlers of
# signals would end a run that the caller has ignore SIGHUP. Its files are those of the home.
_QUIET = ("-options_left", "no", "-no_signal_handler", "-skip_petscrc")

with contextlib.chdir(_ELSEWHERE):
    with contextlib.suppress(ModuleNotFoundError):
        import dolfinx_solver  # noqa: F401  # dolfinx from PyPI, which has to find its MPI before anything else
    from mpi4py import MPI

__all__ = ["MPI", "start"]


def start(options: Sequence[str] = ()) -> None:
    """Start the libraries, or give PETSc further options where they have been started.

    Args:
        options: PETSc's, as on a command line; they override those of the environment.

    Raises:
        ImportError: the forms cannot be compiled, in one sentence.
    """
    need_compiler()
    with contextlib.chdir(_ELSEWHERE):
        import petsc4py

        petsc4py.init([sys.argv[0], *_QUIET, *options])
        from petsc4py import PETSc

        PETSc.Options().insertString(" ".join(options))  # for the case that PETSc had been started
        import dolfinx.fem.petsc  # loads the library that a petsc.cfg of the current folder names
        import dolfinx.jit
        import ffcx.options
        import matplotlib  # noqa: F401

        with _no_home():
            dolfinx.jit.get_options()  # both keep what they have read
            ffcx.options.get_options()


@contextlib.contextmanager
def _no_home() -> Iterator[None]:
    """Have libraries look for the user's configuration where there is none."""
    name = "XDG_CONFIG_HOME"
    before = os.environ.get(name)
    os.environ[name] = _ELSEWHERE
    try:
        yield
    finally:
        del os.environ[name]
        if before is not None:
            os.environ[name] = before
