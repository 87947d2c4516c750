"""Importing this module starts the libraries of finite elements without their configuration files.

A scene in a folder of unknown origin must not run code. But files of the current folder are read by MPI (``ucx.conf``),
PETSc (``.petscrc``, ``petscrc``), dolfinx (``dolfinx_jit_options.json``, and the library that a ``petsc.cfg`` names),
FFCx (``ffcx_options.json``) and Matplotlib (``matplotlibrc``) when they start. PETSc alone has an option against it. So
all of them are started in a folder of the system, where nothing is configured. Files in the user's home were written
for other programs and would change results without a trace in the scene: PETSc, dolfinx and FFCx read none, pictures
have :mod:`fingerpad.results.pictures.style`, meshes :mod:`geometry.shape`.

PETSc's options come from the environment, ``PETSC_OPTIONS``, and from :func:`start`. This module comes before any other
import of these libraries.

Raises:
    ImportError: the forms cannot be compiled, in one sentence.
"""

import contextlib
import os
import sys
from collections.abc import Sequence

from fingerpad.launcher import need_compiler

__all__ = ["MPI", "start"]

# What PETSc did not read is found by fingerpad.results.provenance, not listed when everything is over; its handlers
# of signals would end a run that the caller has ignore SIGHUP.
_QUIET = ("-options_left", "no", "-no_signal_handler", "-skip_petscrc")
_HOME = "XDG_CONFIG_HOME"  # which libraries look into for the user's configuration

with contextlib.chdir("/"):
    with contextlib.suppress(ModuleNotFoundError):
        import dolfinx_solver  # noqa: F401  # dolfinx from PyPI, which has to find its MPI before anything else
    from mpi4py import MPI

    need_compiler()
    import petsc4py

    petsc4py.init([sys.argv[0], *_QUIET])
    import dolfinx.fem.petsc
    import dolfinx.jit
    import ffcx.options
    import matplotlib  # noqa: F401
    from petsc4py import PETSc

    _before = os.environ.pop(_HOME, None)
    os.environ[_HOME] = "/"
    dolfinx.jit.get_options()  # both keep what they have read
    ffcx.options.get_options()
    del os.environ[_HOME]
    if _before is not None:
        os.environ[_HOME] = _before


def start(options: Sequence[str] = ()) -> None:
    """Give PETSc options, as on a command line; they override those of the environment."""
    PETSc.Options().insertString(" ".join(options))
