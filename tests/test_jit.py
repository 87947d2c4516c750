"""The cache of compiled forms."""

import os
import subprocess
import sys
import time

import numpy as np
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI

from variational import jit


def test_sweep_takes_what_a_killed_compile_left(tmp_path, monkeypatch):
    """Old and unfinished goes; finished, or young enough to be at work on, stays."""
    monkeypatch.setitem(jit.OPTIONS, "cache_dir", tmp_path)
    for name in ("dead.c", "done.c", "done.c.cached", "young.c"):
        (tmp_path / name).touch()
    for name in ("dead.c", "done.c"):
        os.utime(tmp_path / name, times=(time.time() - 600,) * 2)
    jit.delete_unfinished(MPI.COMM_SELF)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["done.c", "done.c.cached", "young.c"]


def test_sweep_leaves_what_a_compiler_is_at(tmp_path, monkeypatch):
    """However old: on a machine with much to do a compile takes minutes."""
    monkeypatch.setitem(jit.OPTIONS, "cache_dir", tmp_path)
    source = tmp_path / "slow_form.c"
    source.touch()
    os.utime(source, times=(time.time() - 6000,) * 2)
    command = [sys.executable, "-c", "input(print(flush=True))", str(source)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as compiler:
        assert compiler.stdout.readline()  # it runs, so that its command line is its own
        jit.delete_unfinished(MPI.COMM_SELF)
        assert source.exists()
        compiler.communicate(b"\n")
    jit.delete_unfinished(MPI.COMM_SELF)
    assert not source.exists()


def test_compiled_forms_keep_what_is_no_number():
    """The logarithm of a negative Jacobian determinant is NaN, in each cell that is inside out and in no other."""
    square = mesh.create_unit_square(MPI.COMM_SELF, 2, 2)
    cells = fem.functionspace(square, ("Discontinuous Lagrange", 0))
    J, v = fem.Function(cells), ufl.TestFunction(cells)
    J.x.array[:] = np.linspace(-1.0, 2.0, len(J.x.array))
    form = fem.form((ufl.ln(J) - ufl.ln(J) + J / J) * v * ufl.dx, jit_options=jit.OPTIONS)
    assert np.array_equal(np.isnan(fem.assemble_vector(form).array), J.x.array < 0)
