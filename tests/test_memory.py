"""Memory by the unknowns of a mesh, its refusal, and the bound that refuses element sizes before gmsh meets them."""

from functools import cache, partial

import pytest
from dolfinx import fem
from mpi4py import MPI

from fingerpad.accuracy.refinement import Refinement
from fingerpad.accuracy.solves import Solves
from fingerpad.model.finger import meshed
from fingerpad.model.options import FingerModel, check, memory, plan, unknowns
from fingerpad.scene import SceneError, from_data
from geometry import fingertip
from geometry.mesh import load
from geometry.parameters import Fingertip, MeshSize
from geometry.profiles import GeometryError
from geometry.sizing import least_triangles
from tests.test_accuracy import known
from variational.element import ELEMENTS

FINE = {"contact": 10e-6, "receptor": 10e-6, "touching_half_arc": 1.0e-3}
COARSE = {"contact": 30e-6, "receptor": 60e-6, "interface": 120e-6, "growth": 0.5, "touching_half_arc": 2.0e-3}
EVEN = {"contact": 100e-6, "receptor": 100e-6, "interface": 150e-6, "coarsest": 150e-6, "touching_half_arc": 1.0e-3}


@cache
def coarse():
    """Return a default finger on a coarse mesh, with receptors."""
    return load(MPI.COMM_SELF, partial(fingertip.build, Fingertip(), MeshSize(**COARSE), True, False)).mesh


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


@pytest.mark.parametrize(
    ("size", "triangles"),
    [
        ({}, 26152),
        ({"contact": 60e-6, "receptor": 60e-6, "interface": 60e-6, "coarsest": 60e-6}, 123404),
        ({"contact": 0.5e-6, "growth": 0.1}, 268528),
    ],
)
def test_triangles_of_larger_meshes_are_bounded(size, triangles):
    """The same for numbers that gmsh 4.13 gave, which are not made again here."""
    found = least_triangles(Fingertip(), MeshSize(**({"touching_half_arc": 5e-3} | size)))
    assert triangles / 3 < found <= triangles


@pytest.mark.parametrize("element", sorted(ELEMENTS))
def test_unknowns_are_counted(element):
    """As those of the function spaces, on a mesh with a hole; of the half without one it is an edge less."""
    mesh, kind = coarse(), ELEMENTS[element]
    spaces = [fem.functionspace(mesh, ("Lagrange", kind.degree, (2,)))]
    spaces += [fem.functionspace(mesh, ("Lagrange", 1))] if kind.mixed else []
    number = sum(space.dofmap.index_map.size_global * space.dofmap.index_map_bs for space in spaces)
    points, triangles = (mesh.topology.index_map(d).size_global for d in (0, 2))
    assert unknowns(points, triangles, element) == number


@pytest.mark.parametrize(("number", "gigabytes"), [(27258, 0.354), (73208, 0.561), (186302, 1.171), (873366, 5.729)])
def test_memory_of_runs(number, gigabytes):
    """Measured, in GB, of runs with quadratic elements: never more than by the constant, and a fifth less at most."""
    assert 0.995 * gigabytes < memory(number) / 1e9 < gigabytes / 0.8


@pytest.mark.slow
def test_mesh_that_needs_too_much_memory_is_refused_when_it_is_made():
    """The bound lets it pass; on every rank, by the triangles that it has."""
    scene = from_data({"mesh": COARSE})
    triangles = least_triangles(scene.geometry, scene.mesh)
    allowed = memory(unknowns(int(0.6 * triangles), int(1.2 * triangles), "P2"))
    scene = from_data({"mesh": COARSE, "numerics": {"memory": allowed}})
    check(scene)
    words = r"the mesh has [\d ]+ triangles and [\d ]+ unknowns, which need about .* GB; numerics.memory allows "
    with pytest.raises(GeometryError, match=words):
        meshed(FingerModel(scene, plan(scene)), MPI.COMM_WORLD)


@pytest.mark.parametrize(("mesh", "key"), [({"contact": 1e-8}, "contact"), ({"interface": 1e-8}, "interface")])
def test_too_fine_a_mesh(mesh, key):
    """The size that would help most is named, and a larger bound lets the scene pass."""
    with pytest.raises(SceneError, match=f"numerics.memory allows 16 GB: raise it, or make mesh.{key} larger"):
        check(from_data({"mesh": mesh}))
    if key == "contact":
        check(from_data({"mesh": mesh, "numerics": {"memory": 1e12}}))


def test_refinement_ends_where_memory_does():
    """A search says that the accuracy could not be established, and solves nothing."""
    scene = from_data({"accuracy": {"mu_app": 0.01}, "mesh": COARSE, "contact": {"formulation": "nitsche"}})
    numerics = scene.numerics.model_copy(update={"memory": 3e8})
    scene = scene.model_copy(update={"numerics": numerics})
    model = FingerModel(scene, plan(scene))
    search = Refinement(Solves(model, known(model, {}, MPI.COMM_SELF), MPI.COMM_SELF, lambda line: None, lambda: None))
    search.run()
    assert search.failure.startswith("the accuracy asked for could not be established: the mesh ")
