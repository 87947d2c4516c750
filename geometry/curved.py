"""Triangles of second order: a node in the middle of each edge, on the curve that the edge is of.

With straight facets a ridge is a polygon, and the pressure on it a saw: high at both ends of each facet, low in its
middle. An edge inside the body is straight, and so is one of a straight line. The map of a triangle X(xi) is quadratic
then, and the triangle is whole where det dX/dxi, a quadratic function, has one sign throughout.
"""

import gmsh
import numpy as np
from numpy.typing import NDArray

from geometry import tags
from geometry.profiles import GeometryError

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]
TRIANGLE, LINE = 9, 8  # gmsh's numbers of elements of second order
_LEAST = 0.2  # of the straight triangle's area: least det dX/dxi of a triangle with curved edges
_PLACES = [(i / 4, j / 4) for i in range(5) for j in range(5 - i)]  # of the reference triangle, its edges included


def _slopes() -> Array:
    """Return the derivatives of the six nodes' functions, in gmsh's order, shape (places, 6, 2)."""
    s, t = np.array(_PLACES).T
    r, zero = 1 - s - t, np.zeros_like(s)
    along_s = [1 - 4 * r, 4 * s - 1, zero, 4 * (r - s), 4 * t, -4 * t]
    along_t = [1 - 4 * r, zero, 4 * t - 1, -4 * s, 4 * s, 4 * (r - t)]
    return np.moveaxis(np.array([along_s, along_t]), 0, 2).swapaxes(0, 1)


def least(nodes: Array) -> Array:
    """Return the least det dX/dxi of triangles over that of the straight ones; 1 where all edges are straight.

    Args:
        nodes: places of their nodes in gmsh's order, shape (triangles, 6, 2).
    """
    J = np.einsum("pka,nki->npia", _slopes(), nodes)
    straight = nodes[:, 1:3] - nodes[:, :1]
    return np.asarray((np.linalg.det(J) / np.linalg.det(straight)[:, None]).min(axis=1))


def curve_edges() -> None:
    """Give the mesh of the current gmsh model nodes in the middle of its edges, on its curves."""
    gmsh.model.mesh.setOrder(2)
    unfold()


def unfold() -> None:
    """Leave no triangle of second order of the current gmsh model folded, or nearly.

    Where an edge is too curved for a triangle beside it, as in a layer that is much thinner than the edge is long or at
    a tip that is much sharper, the edges of that triangle are less curved.
    """
    numbers, coordinates, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(numbers)
    points = np.asarray(coordinates).reshape(-1, 3)[order]
    nodes = np.searchsorted(numbers[order], second_order())
    straight, given = points.copy(), points.copy()
    straight[nodes[:, 3:]] = (points[nodes[:, :3]] + points[nodes[:, [1, 2, 0]]]) / 2
    while len(folded := nodes[least(points[nodes][:, :, :2]) < _LEAST]):
        middles = np.unique(folded[:, 3:])
        points[middles] = (points[middles] + straight[middles]) / 2
    for node in np.flatnonzero((points != given).any(axis=1)):
        gmsh.model.mesh.setNode(int(numbers[order[node]]), points[node], [])


def second_order() -> Numbers:
    """Return the nodes of the triangles of second order of the current gmsh model, shape (triangles, 6)."""
    return np.asarray(gmsh.model.mesh.getElementsByType(TRIANGLE)[1], dtype=np.int64).reshape(-1, 6)


def triangles_and_skin() -> tuple[Numbers, Numbers]:
    """Return the corners of the current gmsh model's triangles, shape (n, 3), and of edges that can touch, (m, 2)."""
    found: list[Numbers] = []
    for dim, chosen in ((2, lambda tag: True), (1, tags.is_ridge)):
        parts = [
            nodes.astype(np.int64).reshape(len(elements), -1)[:, : dim + 1]
            for _, tag in gmsh.model.getPhysicalGroups(dim)
            if chosen(tag)
            for entity in gmsh.model.getEntitiesForPhysicalGroup(dim, tag)
            for _, elements, nodes in zip(*gmsh.model.mesh.getElements(dim, entity), strict=True)
        ]
        found.append(np.concatenate([np.empty((0, dim + 1), dtype=np.int64), *parts]))
    return found[0], found[1]


def refuse_folded(triangles: Numbers, unit: float = 1.0) -> None:
    """Refuse triangles that the nodes in the middle of their edges invert, and middles that neighbours do not share.

    Args:
        triangles: nodes of those of the current gmsh model, shape (triangles, 3 or 6).
        unit: of its lengths (m).

    Raises:
        GeometryError: where the first is.
    """
    if triangles.shape[1] < 6 or not len(triangles):
        return
    numbers, coordinates, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(numbers)
    points = unit * np.asarray(coordinates).reshape(-1, 3)[order, :2]
    places = np.searchsorted(numbers[order], triangles)
    edges, middles = np.sort(places[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), places[:, 3:].ravel()
    _, first, same = np.unique(edges, axis=0, return_index=True, return_inverse=True)
    others = np.flatnonzero(middles != middles[first][same.ravel()])
    if len(others):
        x, y = points[middles[others[0]]]
        raise GeometryError(
            f"two triangles do not share the node at ({x:g}, {y:g}) m in the middle of their edge, as neighbours must"
        )
    folded = np.flatnonzero(least(points[places]) <= 0)
    if len(folded):
        x, y = points[places[folded[0], :3]].mean(axis=0)
        raise GeometryError(
            f"{len(folded)} of {len(places)} triangles are inverted by nodes in the middle of their edges, the first "
            f"at ({x:g}, {y:g}) m; give smaller elements there, or nodes nearer to the middles"
        )
