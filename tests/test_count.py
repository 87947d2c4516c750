"""The estimate of triangles against meshes, and what it is for: a scene beyond its memory is refused before meshing."""

import re
from functools import partial

import pytest
from mpi4py import MPI

from fingerpad.accuracy.refinement import Refinement
from fingerpad.model import memory
from fingerpad.model.check import check
from fingerpad.model.options import FingerModel, plan
from fingerpad.scene import SceneError, from_data
from geometry import count, fingertip
from geometry.mesh import load
from geometry.parameters import Fingertip, MeshSize
from tests.test_accuracy import known

FINE = {"contact": 10e-6, "receptor": 10e-6, "touching_half_arc": 1.0e-3}
COARSE = {"contact": 30e-6, "receptor": 60e-6, "interface": 120e-6, "growth": 0.5, "touching_half_arc": 2.0e-3}
EVEN = {"contact": 100e-6, "receptor": 100e-6, "interface": 150e-6, "coarsest": 150e-6, "touching_half_arc": 1.0e-3}
STEEP = {"contact": 100e-6, "receptor": 100e-6, "interface": 100e-6, "growth": 1.0, "touching_half_arc": 1.0e-3}


@pytest.mark.parametrize(
    ("finger", "size", "receptors", "half"),
    [
        ({}, COARSE, True, False),
        ({}, FINE, True, True),
        ({"ridge_count": 21}, FINE, False, True),
        ({}, EVEN, True, True),
        ({}, STEEP, True, True),
        ({"ridge_profile": (1.0, -0.6), "ridge_count": 15}, FINE, True, True),
    ],
)
def test_triangles_of_a_mesh(finger, size, receptors, half):
    """Within a factor of 1.5, of meshes fine at the crests, at the sites, everywhere and nowhere."""
    finger, size = Fingertip(**finger), MeshSize(**size)
    body = load(MPI.COMM_SELF, partial(fingertip.build, finger, size, receptors, half))
    triangles = body.mesh.topology.index_map(2).size_global
    assert triangles / 1.5 < count.triangles(finger, size, receptors, half) < 1.5 * triangles


@pytest.mark.parametrize(("unknowns", "gigabytes"), [(27258, 0.354), (73208, 0.561), (186302, 1.171), (873366, 5.729)])
def test_memory_of_runs(monkeypatch, unknowns, gigabytes):
    """Measured, in GB, of runs with quadratic elements; the fit is within a fifth."""
    monkeypatch.setattr(memory.count, "triangles", lambda *arguments: unknowns / 4)
    found = memory.estimate(from_data({}))
    assert found.unknowns == unknowns
    assert found.memory / 1e9 == pytest.approx(gigabytes, rel=0.2)


def test_two_million_unknowns_are_allowed(monkeypatch):
    monkeypatch.setattr(memory.count, "triangles", lambda *arguments: 2e6 / 4)
    check(from_data({}))
    monkeypatch.setattr(memory.count, "triangles", lambda *arguments: 3e6 / 4)
    with pytest.raises(SceneError, match="3 000 000 unknowns"):
        check(from_data({}))


@pytest.mark.parametrize(
    ("mesh", "key"),
    [
        ({"contact": 1e-8}, "contact"),
        ({"growth": 1e-4}, "growth"),
    ],
)
def test_too_fine_a_mesh(mesh, key):
    """The size that would help most is named, and a larger bound lets the scene pass."""
    with pytest.raises(SceneError, match=f"numerics.memory allows 16 GB: raise it, or make mesh.{key} larger"):
        check(from_data({"mesh": mesh}))
    if key == "contact":
        check(from_data({"mesh": mesh, "numerics": {"memory": 1e12}}))


@pytest.mark.parametrize(
    "unknowns",
    [
        1000,
        40_000,
        3e6,
    ],
)
def test_memory_needed_is_above_that_allowed_as_printed(monkeypatch, unknowns):
    """Also where the two differ by less than the digits shown."""
    monkeypatch.setattr(memory.count, "triangles", lambda *arguments: unknowns / 4)
    allowed = memory.estimate(from_data({})).memory * (1 - 1e-4)
    with pytest.raises(SceneError) as refusal:
        check(from_data({"numerics": {"memory": allowed}}))
    needed, least = re.search(
        r"need about ([\d.]+) GB; numerics.memory allows ([\d.]+) GB", str(refusal.value)
    ).groups()
    assert float(needed) > float(least) == pytest.approx(allowed / 1e9, rel=1e-5)


def test_refinement_ends_where_memory_does():
    """A search says that the accuracy could not be established, and meshes nothing."""
    scene = from_data({"accuracy": {"mu_app": 0.01}, "mesh": COARSE, "contact": {"formulation": "nitsche"}})
    numerics = scene.numerics.model_copy(update={"memory": 3e8})
    scene = scene.model_copy(update={"numerics": numerics})
    model = FingerModel(scene, plan(scene))
    search = Refinement(model, known(model, {}, MPI.COMM_SELF), MPI.COMM_SELF, lambda line: None, lambda: None)
    search.run()
    assert search.failure.startswith("the accuracy asked for could not be established: the mesh would have some ")
