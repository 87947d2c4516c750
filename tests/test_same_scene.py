"""Ranks of MPI that are given different scenes are refused; each would wait for the others for ever."""

from types import SimpleNamespace

import pytest
from mpi4py import MPI

import fingerpad as fp
from fingerpad.runs.solve import _refuse_different
from fingerpad.scene import SceneError


@pytest.mark.parametrize(
    ("other", "words"),
    [
        (fp.Scene(voltage=100), "voltage is 200 on rank 0 of MPI and 100 on rank 2"),
        (fp.Scene(history=[{"name": "press", "f_ext": 75}]), "f_ext is 75 on rank 0 of MPI and empty on rank 2"),
    ],
)
def test_first_key_that_differs_is_named(other, words):
    comm = SimpleNamespace(allgather=lambda mine: [mine, mine, flat(other)])
    with pytest.raises(SceneError, match=words):
        _refuse_different(fp.Scene(), comm)


def flat(scene):
    kept = []
    _refuse_different(scene, SimpleNamespace(allgather=lambda mine: kept.append(mine) or [mine]))
    return kept[0]


@pytest.mark.mpi
def test_refused_on_all_ranks():
    rank, size = MPI.COMM_WORLD.rank, MPI.COMM_WORLD.size
    scene = fp.Scene(f_ext=50 + rank, mesh={"contact": 1e-3})  # of which no finger can be meshed
    words = "f_ext is 50 on rank 0 of MPI and 51 on rank 1" if size > 1 else "mesh.contact"
    with pytest.raises(SceneError, match=words):
        fp.run(scene)
