"""Compile a form in a cache of compiled forms and print the form's value: python3 tests/one_form.py CACHE."""

import sys
from pathlib import Path

import ufl
from dolfinx import fem, mesh
from mpi4py import MPI

from variational import jit


def integral(comm: MPI.Comm = MPI.COMM_SELF) -> float:
    """Compile the form of a line and return its value, which is 2.5; collective."""
    line = mesh.create_unit_interval(comm, 4)
    form = fem.form(fem.Constant(line, 2.5) * ufl.dx, jit_options=jit.OPTIONS)
    return float(comm.allreduce(fem.assemble_scalar(form)))


if __name__ == "__main__":
    jit.OPTIONS["cache_dir"], jit._SILENT = Path(sys.argv[1]), 0.0
    print(integral())
