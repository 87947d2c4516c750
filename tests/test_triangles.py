"""Triangles with curved edges: how far they are from being folded, and that none of a finger's is."""

import gmsh
import numpy as np
import pytest
from mpi4py import MPI

from fingerpad.scene import Scene
from geometry import fingertip, sizing, tags, triangles
from geometry.mesh import load
from geometry.profiles import GeometryError
from geometry.shape import session
from tests.small_finger import SMALL

# In gmsh's order: ends, then the middles of 01, 12, 20.
PLAIN = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]])


@pytest.mark.parametrize(("height", "expected"), [(0.0, 1.0), (-0.2, 1.0), (0.1, 0.6), (0.25, 0.0), (0.3, -0.2)])
def test_least_determinant(height, expected):
    """With the middle of an edge moved inwards by h it is 1 - 4h, at that edge's ends; up to roundoff."""
    nodes = PLAIN.copy()
    nodes[3, 1] = height
    turned = nodes[[2, 1, 0, 4, 3, 5]]
    np.testing.assert_allclose(triangles.least(np.stack([nodes, turned])), expected, atol=1e-14)


FINGERS = {
    "sharp crests": ({"ridge_profile": [0, 0, 0, 0, 1]}, {"contact": 40e-6}),
    "thin layer": ({"sc_thickness": 5e-6}, {}),
    "long edges at sharp tips": ({}, {"interface": 120e-6}),
}


@pytest.mark.parametrize("case", FINGERS)
def test_no_triangle_is_folded(case, monkeypatch):
    """Where gmsh's own would be; whichever way the triangles turn. Facets turn by more than they may in a scene."""
    monkeypatch.setattr(sizing, "_TURN", 10.0)
    shape, sizes = FINGERS[case]
    scene = Scene.load(SMALL).replace(geometry=shape, mesh=sizes)
    size = scene.mesh.model_copy(update={"touching_half_arc": 0.5e-3})
    with session("finger"):
        fingertip.build(scene.geometry, size)
        numbers, places, _ = gmsh.model.mesh.getNodes()
        at = np.empty((int(numbers.max()) + 1, 2))
        at[numbers] = places.reshape(-1, 3)[:, :2]
        assert triangles.least(at[triangles.second_order()]).min() >= 0.2


def folded() -> float:
    """Mesh a triangle that is inverted, in mm."""
    body, skin = gmsh.model.addDiscreteEntity(2), gmsh.model.addDiscreteEntity(1)
    places = np.pad(PLAIN + [2.0, 1.0], [(0, 0), (0, 1)])
    places[4, :2] = 2.0, 1.0
    gmsh.model.mesh.addNodes(2, body, range(1, 7), places.ravel())
    gmsh.model.mesh.addElementsByType(body, 9, [], range(1, 7))
    gmsh.model.mesh.addElementsByType(skin, 8, [], [1, 2, 4])
    gmsh.model.addPhysicalGroup(2, [body], tags.STRATUM_CORNEUM)
    gmsh.model.addPhysicalGroup(1, [skin], tags.ridge(0))
    return 1e-3


@pytest.mark.mpi
def test_folded_triangle_is_refused():
    """Of a model that somebody else made, on every rank, with its place in m."""
    message = r"1 of 1 triangles are inverted .* the first at \(0.00233333, 0.00133333\) m; give smaller elements"
    with pytest.raises(GeometryError, match=message):
        load(MPI.COMM_WORLD, folded)
