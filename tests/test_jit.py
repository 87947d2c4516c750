"""The cache of compiled forms."""

import os
import time

from mpi4py import MPI

from variational import jit


def test_sweep_takes_what_a_killed_compile_left(tmp_path, monkeypatch):
    """Old and unfinished goes; finished, or young enough to be at work on, stays."""
    monkeypatch.setitem(jit.OPTIONS, "cache_dir", tmp_path)
    for name in ("dead.c", "done.c", "done.c.cached", "young.c"):
        (tmp_path / name).touch()
    for name in ("dead.c", "done.c"):
        os.utime(tmp_path / name, times=(time.time() - 600,) * 2)
    jit.sweep(MPI.COMM_SELF)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["done.c", "done.c.cached", "young.c"]
