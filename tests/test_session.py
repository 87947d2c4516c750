"""Meshes made beside a caller's own gmsh session: both stay what they are."""

import gmsh
import numpy as np
import pytest
from mpi4py import MPI

from geometry.bodies import ridge
from geometry.mesh import load


def coordinates() -> np.ndarray:
    return load(MPI.COMM_SELF, ridge(30e-6)).mesh.geometry.x.copy()


@pytest.fixture
def session():
    """A session with a meshed model and options of its own."""
    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.MeshSizeFactor", 0.5)
    gmsh.model.add("mine")
    gmsh.model.occ.addRectangle(0, 0, 0, 1, 1)
    gmsh.model.occ.synchronize()
    gmsh.model.mesh.generate(2)
    gmsh.model.add("other")
    gmsh.model.setCurrent("mine")
    yield
    gmsh.finalize()


def test_callers_session_and_ours_are_apart(session):
    before = gmsh.model.mesh.getNodes()[1]
    beside = coordinates()
    assert gmsh.model.getCurrent() == "mine" and gmsh.model.list()[-2:] == ["mine", "other"]
    np.testing.assert_array_equal(gmsh.model.mesh.getNodes()[1], before)
    assert gmsh.option.getNumber("Mesh.MeshSizeFactor") == 0.5
    gmsh.finalize()
    np.testing.assert_array_equal(coordinates(), beside)
    assert not gmsh.isInitialized()
    gmsh.initialize(interruptible=False)


def test_callers_session_outlives_a_failure(session):
    def fail() -> float:
        raise ValueError("no body")

    with pytest.raises(ValueError, match="no body"):
        load(MPI.COMM_SELF, fail)
    assert gmsh.model.getCurrent() == "mine" and gmsh.model.getEntities(2) == [(2, 1)]
