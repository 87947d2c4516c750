"""Memory by the unknowns of a mesh, its refusal, and the bound that refuses element sizes before gmsh meets them."""

from functools import partial

import pytest
from mpi4py import MPI

from fingerpad.model.options import check, memory
from fingerpad.scene import SceneError, from_data
from geometry import fingertip
from geometry.mesh import load
from geometry.parameters import Fingertip, MeshSize
from geometry.sizing import least_triangles

FINE = {"contact": 10e-6, "receptor": 10e-6, "touching_half_arc": 1.0e-3}
COARSE = {"contact": 30e-6, "receptor": 60e-6, "interface": 120e-6, "growth": 0.5, "touching_half_arc": 2.0e-3}
EVEN = {"contact": 100e-6, "receptor": 100e-6, "interface": 150e-6, "coarsest": 150e-6, "touching_half_arc": 1.0e-3}


@pytest.mark.parametrize(
    ("finger", "size", "receptors", "half"),
    [
        ({}, COARSE, True, False),
        ({}, EVEN, True, True),
        ({"ridge_profile": (1.0, -0.6), "ridge_count": 15}, FINE, True, True),
    ],
)
@pytest.mark.slow
def test_triangles_are_bounded_before_meshing(finger, size, receptors, half):
    """By a third of them or more: of meshes fine at the crests, at the sites, everywhere and nowhere."""
    finger, size = Fingertip(**finger), MeshSize(**size)
    body = load(MPI.COMM_SELF, partial(fingertip.build, finger, size, receptors, half))
    triangles = body.mesh.topology.index_map(2).size_global
    assert triangles / 3 < least_triangles(finger, size, receptors, half) <= triangles


@pytest.mark.parametrize(("number", "gigabytes"), [(27258, 0.354), (73208, 0.561), (186302, 1.171), (873366, 5.729)])
def test_memory_of_runs(number, gigabytes):
    """Measured, in GB, of runs with quadratic elements: never more than by the constant, and a fifth less at most."""
    assert 0.995 * gigabytes < memory(number) / 1e9 < gigabytes / 0.8


@pytest.mark.parametrize(("mesh", "key"), [({"contact": 1e-8}, "contact"), ({"interface": 1e-8}, "interface")])
def test_too_fine_a_mesh(mesh, key):
    """The size that would help most is named, and a larger bound lets the scene pass."""
    with pytest.raises(SceneError, match=f"numerics.memory allows 16 GB: raise it, or make mesh.{key} larger"):
        check(from_data({"mesh": mesh}))
    if key == "contact":
        check(from_data({"mesh": mesh, "numerics": {"memory": 1e12}}))
