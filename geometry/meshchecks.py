"""What a mesh from elsewhere is refused for, by the places of its nodes and the nodes of its triangles alone."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from geometry.parameters import LEAST_SIZE
from geometry.profiles import GeometryError

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]
FLAT = 1e-9  # out of the plane or below the screen, over the body's size
_LARGEST, _LEAST = 0.2, 1e-6  # m, of the longer side of a body
_THIN = 1e-6  # double area of a triangle, over the square of its longest side


def refuse_misplaced(xyz: Array) -> None:
    """Refuse a body of the wrong size or in the wrong place; ``xyz`` (m) are its nodes."""
    if not np.isfinite(xyz).all():
        raise GeometryError("a node has a coordinate that is not finite")
    size = float(np.ptp(xyz[:, :2], axis=0).max())
    if size > _LARGEST:
        raise GeometryError(f"the body is {size:g} m large, which is no finger; lengths are in m: did you mean mm?")
    if size < _LEAST:
        raise GeometryError(f"the body is {size:g} m large; it must be at least {_LEAST:g} m, and lengths are in m")
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
