"""Triangles of a mesh: those of second order, with a node in the middle of each edge, and what is refused.

With straight facets a ridge is a polygon, and the pressure on it a saw: high at both ends of each facet, low in its
middle. An edge inside the body is straight, and so is one of a straight line. The map of a triangle X(xi) is quadratic
then, and the triangle is whole where det dX/dxi, a quadratic function, has one sign throughout.
"""

import gmsh
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from geometry import tags
from geometry.parameters import LEAST_SIZE
from geometry.profiles import GeometryError

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]
TRIANGLE, LINE = 9, 8  # gmsh's numbers of elements of second order
_LEAST_DETERMINANT = 0.2  # of the straight triangle's area: least det dX/dxi of a triangle with curved edges
_PLACES = [(i / 4, j / 4) for i in range(5) for j in range(5 - i)]  # of the reference triangle, its edges included
FLAT = 1e-9  # out of the plane or below the screen, over the body's size
_WIDEST, _NARROWEST = 0.2, 1e-6  # m, of the longer side of a body
_THIN = 1e-6  # double area of a triangle, over the square of its longest side


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
    while len(folded := nodes[least(points[nodes][:, :, :2]) < _LEAST_DETERMINANT]):
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


# -- meshes from elsewhere --------------------------------------------------------------------------------------
def refuse_misplaced(xyz: Array) -> None:
    """Refuse a body of the wrong size or in the wrong place; ``xyz`` (m) are its nodes."""
    if not np.isfinite(xyz).all():
        raise GeometryError("a node has a coordinate that is not finite")
    size = float(np.ptp(xyz[:, :2], axis=0).max())
    if size > _WIDEST:
        raise GeometryError(f"the body is {size:g} m large, which is no finger; lengths are in m: did you mean mm?")
    if size < _NARROWEST:
        raise GeometryError(f"the body is {size:g} m large; it must be at least {_NARROWEST:g} m, and lengths are in m")
    if np.abs(xyz[:, 2]).max() > FLAT * size:
        raise GeometryError("nodes lie out of the plane z = 0; the mesh must be plane")
    lowest = float(xyz[:, 1].min())
    if lowest < -FLAT * size:
        raise GeometryError(
            f"the lowest point is at y = {lowest:g} m, below the screen at y = 0; move the body up by {-lowest:g} m"
        )


def refuse_misshapen(corners: Array) -> None:
    """Refuse triangles without an area, tiny ones and those of both orientations; ``corners`` (m), shape (n, 3, 2)."""
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    double = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    squares = np.sum(np.stack([a, b, b - a]) ** 2, axis=2)
    flat = np.flatnonzero(np.abs(double) < _THIN * np.max(squares, axis=0))
    if len(flat):
        x, y = corners[flat[0]].mean(axis=0)
        raise GeometryError(f"{len(flat)} of {len(corners)} triangles have no area, the first at ({x:g}, {y:g}) m")
    edge = np.sqrt(np.min(squares, axis=0))
    tiny = np.flatnonzero(edge < LEAST_SIZE)
    if len(tiny):
        x, y = corners[tiny[0]].mean(axis=0)
        raise GeometryError(
            f"{len(tiny)} of {len(corners)} triangles have edges that roundoff blurs, the first at ({x:g}, {y:g}) m "
            f"one of {edge[tiny[0]]:.3g} m; edges must be at least {LEAST_SIZE:g} m long"
        )
    turned = int((double < 0).sum())
    if 0 < turned < len(corners):
        raise GeometryError(
            f"{turned} of {len(corners)} triangles are clockwise and the others are not, so that cells may overlap; "
            "give all of them one orientation"
        )


def refuse_corners(xy: Array, triangles: Numbers, skin: Numbers) -> None:
    """Refuse a triangle with two sides on the skin that can touch.

    Args:
        xy: places of all nodes (m), shape (nodes, 2).
        triangles: their nodes by place in ``xy``, shape (triangles, 3).
        skin: nodes of the edges that can touch, shape (edges, 2).
    """

    def keys(edges: Numbers) -> Numbers:
        return np.asarray(np.sort(edges, axis=-1) @ [len(xy), 1])

    sides = np.isin(keys(triangles[:, [[0, 1], [1, 2], [2, 0]]]), keys(skin)).sum(axis=1)
    if (sides > 1).any():
        middle = xy[triangles[sides.argmax()]].mean(axis=0)
        x, y = (round(1e3 * each, 6) + 0.0 for each in middle)  # no minus before a zero
        raise GeometryError(
            f"the triangle at x = {x:g} mm, y = {y:g} mm has two sides on the skin that can touch, and one is allowed; "
            "give smaller elements there, or a skin without a corner"
        )


def refuse_unconnected(xy: Array, triangles: Numbers) -> None:
    """Refuse triangles that are twice in the mesh, and neighbours that do not share their nodes.

    Args:
        xy: places of all nodes (m), shape (nodes, 2).
        triangles: their nodes by place in ``xy``, shape (triangles, 3).
    """
    twice = len(triangles) - len(np.unique(np.sort(triangles, axis=1), axis=0))
    if twice:
        raise GeometryError(f"{twice} of {len(triangles)} triangles are in the mesh twice")
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, counts = np.unique(edges, axis=0, return_counts=True)
    if (counts > 2).any():
        x, y = xy[edges[counts > 2][0]].mean(axis=0)
        raise GeometryError(f"three triangles have the same edge at ({x:g}, {y:g}) m, so that they overlap")
    edges = edges[counts == 1]
    outline, size = np.unique(edges), float(np.ptp(xy[np.unique(triangles)], axis=0).max())
    ends, tree = xy[edges], cKDTree(xy[outline])
    middle, along = ends.mean(axis=1), ends[:, 1] - ends[:, 0]
    near = tree.query_ball_point(middle, np.linalg.norm(along, axis=1) / 2 + FLAT * size)
    for k, places in enumerate(near):
        others = outline[np.setdiff1d(places, np.searchsorted(outline, edges[k]))]
        from_end = xy[others] - ends[k, 0]
        beside = np.abs(along[k, 0] * from_end[:, 1] - along[k, 1] * from_end[:, 0]) / np.linalg.norm(along[k])
        if (beside < FLAT * size).any():
            x, y = xy[others[beside.argmin()]]
            raise GeometryError(
                f"the triangles at ({x:g}, {y:g}) m do not share a node there, as neighbours must; "
                "merge nodes at the same place, and let neighbours have the same nodes on their common edge"
            )
