"""The mesh of a body's half at x >= 0, put into a gmsh model alone or with its mirror image, which is exact then."""

from collections.abc import Mapping
from dataclasses import dataclass

import gmsh
import numpy as np
from numpy.typing import NDArray

from geometry import tags

Nodes = NDArray[np.int64]
_SLIVER = 0.05  # of the smaller old area: least new one
_ON_LINE = 1e-9  # gmsh's unit from x = 0, within which a node is its own image
_KINDS = {  # by dimension and nodes of an element: gmsh's number, and the nodes' order in the mirror image
    (1, 2): (1, [1, 0]),
    (1, 3): (8, [1, 0, 2]),
    (2, 3): (2, [2, 1, 0]),
    (2, 6): (9, [2, 1, 0, 4, 3, 5]),
}


@dataclass(frozen=True)
class HalfMesh:
    """Facets and triangles by group, of first or second order."""

    points: NDArray[np.float64]
    """Nodes in gmsh's unit, shape (nodes, 3)."""
    groups: dict[tuple[int, int], tuple[NDArray[np.int64], str]]
    """By dimension and tag: nodes of each element, shape (elements, nodes of each), from 1; and the group's name."""

    @classmethod
    def read(cls) -> "HalfMesh":
        """Return the mesh of the current gmsh model, without nodes that belong to no element of a group."""
        groups = {
            (dimension, tag): (_elements(dimension, tag), gmsh.model.getPhysicalName(dimension, tag))
            for dimension, tag in gmsh.model.getPhysicalGroups()
        }
        numbers, coordinates, _ = gmsh.model.mesh.getNodes()
        order = np.argsort(numbers)
        used = np.unique(np.concatenate([elements.ravel() for elements, _ in groups.values()]))
        points = coordinates.reshape(-1, 3)[order[np.searchsorted(numbers[order], used)]]
        found = {key: (1 + np.searchsorted(used, elements), name) for key, (elements, name) in groups.items()}
        return cls(points, found)

    def put(self, name: str, whole: bool) -> None:
        """Make a gmsh model of the mesh, the current one.

        Args:
            name: of the model.
            whole: with the mirror image, under the same groups, where ridge -j is the image of ridge j; the group of
                the line of symmetry is left out then.
        """
        off = np.abs(self.points[:, 0]) > _ON_LINE
        own = np.arange(1, len(off) + 1)
        image = np.where(off, len(off) + np.cumsum(off), own)
        gmsh.model.add(name)
        body = gmsh.model.addDiscreteEntity(2)
        gmsh.model.mesh.addNodes(2, body, own, self.points.ravel())
        if whole:
            gmsh.model.mesh.addNodes(2, body, image[off], (self.points[off] * [-1, 1, 1]).ravel())
        for (dimension, tag), (here, word) in self.groups.items():
            there = image[here - 1][:, _KINDS[dimension, here.shape[1]][1]]
            if not whole:
                _add(dimension, tag, word, here)
            elif tags.is_ridge(tag) and tag != tags.ridge(0):
                j = tags.ridge_index(tag)
                _add(dimension, tags.ridge(-j), f"ridge {-j}", there)
                _add(dimension, tag, word, here)
            elif tag != tags.SYMMETRY:
                _add(dimension, tag, word, np.concatenate([here, there]))


def _elements(dimension: int, tag: int) -> NDArray[np.int64]:
    """Return the nodes of a group's elements, shape (elements, nodes of each)."""
    found = [
        nodes.reshape(-1, gmsh.model.mesh.getElementProperties(kind)[3])
        for entity in gmsh.model.getEntitiesForPhysicalGroup(dimension, tag)
        for kind, _, nodes in zip(*gmsh.model.mesh.getElements(dimension, entity), strict=True)
    ]
    return np.concatenate(found).astype(np.int64)


def _add(dimension: int, tag: int, name: str, elements: NDArray[np.int64]) -> None:
    """Add elements as a group."""
    entity = gmsh.model.addDiscreteEntity(dimension)
    gmsh.model.mesh.addElementsByType(entity, _KINDS[dimension, elements.shape[1]][0], [], elements.ravel())
    gmsh.model.addPhysicalGroup(dimension, [entity], tag, name)


def swap_corners() -> None:
    """Leave straight triangles of the current gmsh model one side on skin that can touch: see :func:`swapped`."""
    numbers, coordinates, _ = gmsh.model.mesh.getNodes()
    points = np.full((int(numbers.max()), 3), np.nan)
    points[numbers - 1] = coordinates.reshape(-1, 3)
    skin = [_elements(1, tag) for _, tag in gmsh.model.getPhysicalGroups(1) if tags.is_ridge(tag)]
    layers = {tag: _elements(2, tag) for _, tag in gmsh.model.getPhysicalGroups(2)}
    for tag, triangles in swapped(points, np.concatenate(skin), layers).items():
        if triangles is not layers[tag]:
            (entity,) = gmsh.model.getEntitiesForPhysicalGroup(2, tag)
            gmsh.model.mesh.removeElements(2, entity)
            gmsh.model.mesh.addElementsByType(entity, 2, [], triangles.ravel())


def swapped(points: NDArray[np.float64], skin: Nodes, layers: Mapping[int, Nodes]) -> dict[int, Nodes]:
    """Return the triangles of each layer, with as few as can be that have two sides on the skin, as at a sharp tip.

    The skin keeps its history by triangle, so that each has one side on it at most. The edge to the triangle below is
    swapped for the other diagonal of the two. Nodes and the outline stay.

    Args:
        points: nodes, shape (nodes, 2) or more columns.
        skin: facets that can touch, shape (facets, 2), numbers of nodes from 1.
        layers: triangles by layer, shape (triangles, 3) each, numbers of nodes from 1.
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
