"""What a program does before anything else: take the libraries' configuration from its user.

MPI (``ucx.conf``), PETSc (``.petscrc``, ``petscrc``, ``petsc.cfg``), dolfinx (``dolfinx_jit_options.json``), FFCx
(``ffcx_options.json``) and Matplotlib (``matplotlibrc``) read files of the current folder when they start, and some
of these files name code that is loaded. A scene in a folder of unknown origin must not run code, so that all of them
are started elsewhere; files in the user's home and variables of the environment are obeyed as ever. Importing this
module starts MPI, :func:`start` the rest: both come before any other import of these libraries.
"""

import contextlib
import sys
from collections.abc import Sequence

from fingerpad.installed import need_compiler

_ELSEWHERE = "/"  # belongs to the system; nothing is configured there

# What PETSc did not read is found by fingerpad.io.petsc_options, not listed when everything is over; its handlers of
# signals would end a run that the caller has ignore SIGHUP.
_QUIET = ("-options_left", "no", "-no_signal_handler")

with contextlib.chdir(_ELSEWHERE):
    with contextlib.suppress(ModuleNotFoundError):
        import dolfinx_solver  # noqa: F401  # dolfinx from PyPI, which has to find its MPI before anything else
    from mpi4py import MPI

__all__ = ["MPI", "start"]


def start(options: Sequence[str] = ()) -> None:
    """Start the libraries, or give PETSc further options where they have been started.

    Args:
        options: PETSc's, as on a command line; they override those of the environment and of the user's home.

    Raises:
        ImportError: the forms cannot be compiled, in one sentence.
    """
    need_compiler()
    with contextlib.chdir(_ELSEWHERE):
        import petsc4py

        petsc4py.init([sys.argv[0], *_QUIET, *options])
        from petsc4py import PETSc

        PETSc.Options().insertString(" ".join(options))  # for the case that PETSc had been started
        import dolfinx.jit
        import ffcx.options
        import matplotlib  # noqa: F401

        dolfinx.jit.get_options()  # both keep what they have read
        ffcx.options.get_options()
