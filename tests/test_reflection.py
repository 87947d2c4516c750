"""Triangles with two sides on the skin: swapped away where that can be, told where it cannot."""

from functools import partial

import numpy as np
import pytest
from mpi4py import MPI

from fingerpad.scene import Scene
from geometry import fingertip, tags
from geometry.mesh import load
from geometry.profiles import GeometryError
from geometry.reflection import HalfMesh, swapped
from tests.small_finger import SMALL

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


@pytest.mark.parametrize("turn", [0, 1, 2])
def test_corner_of_a_square_goes_to_its_neighbour(turn):
    """Whatever node a triangle begins with: same area, same sense, one side each."""
    triangles = np.array([np.roll([1, 2, 3], turn), [1, 3, 4]])
    found = swapped(SQUARE, np.array([[1, 2], [3, 2]]), {7: triangles})[7]
    assert {frozenset(nodes) for nodes in found.tolist()} == {frozenset((1, 2, 4)), frozenset((2, 3, 4))}
    a, b, c = (SQUARE[found[:, k] - 1] for k in range(3))
    np.testing.assert_allclose(np.linalg.det(np.stack([b - a, c - a], axis=1)), 1.0)


@pytest.mark.parametrize(
    ("skin", "layers"),
    [
        ([[1, 2]], {7: [[1, 2, 3], [1, 3, 4]]}),  # one side alone
        ([[1, 2], [2, 3]], {7: [[1, 2, 3]], 8: [[1, 3, 4]]}),  # the neighbour is of another layer
        ([[1, 2], [2, 3], [3, 4]], {7: [[1, 2, 3], [1, 3, 4]]}),  # the neighbour has a side of its own
    ],
)
def test_what_cannot_or_need_not_be_swapped_stays(skin, layers):
    given = {tag: np.array(nodes) for tag, nodes in layers.items()}
    found = swapped(SQUARE, np.array(skin), given)
    assert all(np.array_equal(found[tag], nodes) for tag, nodes in given.items())


def test_concave_pair_stays():
    """The other diagonal would lie outside of it."""
    points = np.array([[0.0, 0.0], [1.0, -0.2], [2.0, 0.0], [5.0, 0.1]])
    given = np.array([[1, 2, 3], [1, 3, 4]])
    found = swapped(points, np.array([[1, 2], [2, 3]]), {7: given})[7]
    assert np.array_equal(found, given)


@pytest.mark.slow
@pytest.mark.parametrize("half", [True, False])
def test_sharp_tips_are_meshed(half):
    """Of the fifth harmonic alone; a mesh of gmsh's own has such triangles, on either side of the mirror."""
    scene = Scene.load(SMALL).replace(geometry={"ridge_profile": [0, 0, 0, 0, 1]}, mesh={"contact": 40e-6})
    size = scene.mesh.model_copy(update={"touching_half_arc": 0.5e-3})
    body = load(MPI.COMM_WORLD, partial(fingertip.build, scene.geometry, size, half=half))
    facets = np.concatenate([body.facets(tag) for tag in body.ridge_tags().values()])
    body.mesh.topology.create_connectivity(1, 2)
    links = body.mesh.topology.connectivity(1, 2)
    cells = [int(links.links(facet)[0]) for facet in facets]
    assert len(cells) == len(set(cells))


@pytest.mark.mpi
def test_corner_that_stays_is_told():
    """A square with two sides on the skin, of two triangles; on every rank, and where it is."""

    def build() -> float:
        triangles, skin = np.array([[1, 2, 3], [1, 3, 4]]), np.array([[1, 2], [2, 3], [3, 4], [4, 1]])
        groups = {(2, tags.STRATUM_CORNEUM): (triangles, "skin"), (1, tags.ridge(0)): (skin, "ridge 0")}
        HalfMesh(np.pad(SQUARE, ((0, 0), (0, 1))), groups).put("square", whole=False)
        return 1e-3

    with pytest.raises(
        GeometryError, match=r"^the triangle at x = .* mm, y = .* mm has two sides on the skin that can"
    ):
        load(MPI.COMM_WORLD, build)
