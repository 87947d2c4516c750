"""Triangles with two sides on the skin that can touch, as at a sharp tip: one of the two goes to their neighbour.

The skin keeps its history by triangle, so that each has one side on it at most. The edge to the triangle below is
swapped for the other diagonal of the two. Nodes and the outline stay.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

Nodes = NDArray[np.int64]
_SLIVER = 0.05  # of the smaller old area: least new one


def swapped(points: NDArray[np.float64], skin: Nodes, layers: Mapping[int, Nodes]) -> dict[int, Nodes]:
    """Return the triangles of each layer, with as few as can be that have two sides on the skin.

    Args:
        points: nodes, shape (nodes, 2) or more columns.
        skin: facets that can touch, shape (facets, 2), numbers of nodes from 1.
        layers: triangles by layer, shape (triangles, 3) each, likewise.
    """
    sides = {frozenset(map(int, side)) for side in skin}
    return {tag: _swapped(points, sides, triangles) for tag, triangles in layers.items()}


def _swapped(points: NDArray[np.float64], sides: set[frozenset[int]], triangles: Nodes) -> Nodes:
    on_skin = np.array(sorted({node for side in sides for node in side}))
    near = np.flatnonzero(np.isin(triangles, on_skin).sum(axis=1) > 2)
    corners = [int(k) for k in near if _count([int(node) for node in triangles[k]], sides) > 1]
    if not corners:
        return triangles
    found = [[int(node) for node in nodes] for nodes in triangles]
    inside = _by_edge(found)
    for k in corners:
        a, b, c = _from_the_inner_edge(found[k], sides)
        other = next((m for m in inside.get(frozenset((a, c)), ()) if m != k), None)
        if other is None:  # of another layer
            continue
        (d,) = set(found[other]) - {a, c}
        two = [a, b, d], [b, c, d]
        old = [abs(_area(points, nodes)) for nodes in (found[k], found[other])]
        sign = np.sign(_area(points, [a, b, c]))
        whole = all(sign * _area(points, nodes) > _SLIVER * min(old) for nodes in two)
        if whole and max(_count(nodes, sides) for nodes in two) < 2:
            found[k], found[other] = two
            inside = _by_edge(found)
    return np.array(found, dtype=triangles.dtype)


def _by_edge(triangles: list[list[int]]) -> dict[frozenset[int], list[int]]:
    """Return the places of the triangles on either side of each edge."""
    found: dict[frozenset[int], list[int]] = {}
    for k, nodes in enumerate(triangles):
        for side in _sides(nodes):
            found.setdefault(side, []).append(k)
    return found


def _sides(nodes: list[int]) -> list[frozenset[int]]:
    return [frozenset((nodes[i], nodes[(i + 1) % 3])) for i in range(3)]


def _count(nodes: list[int], sides: set[frozenset[int]]) -> int:
    return sum(side in sides for side in _sides(nodes))


def _from_the_inner_edge(nodes: list[int], sides: set[frozenset[int]]) -> list[int]:
    """Return the nodes of a triangle in their order, the one between its two sides on the skin in the middle."""
    inner = next(i for i, side in enumerate(_sides(nodes)) if side not in sides)
    middle = (inner + 2) % 3
    return [nodes[(middle + 2) % 3], nodes[middle], nodes[(middle + 1) % 3]]


def _area(points: NDArray[np.float64], nodes: list[int]) -> float:
    """Return twice the area, positive anticlockwise."""
    (ax, ay), (bx, by), (cx, cy) = (points[node - 1][:2] for node in nodes)
    return float((bx - ax) * (cy - ay) - (cx - ax) * (by - ay))
