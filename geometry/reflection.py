"""The mesh of a body's half at x >= 0, put into a gmsh model alone or with its mirror image, which is exact then."""

from dataclasses import dataclass

import gmsh
import numpy as np
from numpy.typing import NDArray

from geometry import tags
from geometry.corner_cells import swapped

_ON_LINE = 1e-9  # gmsh's unit from x = 0, within which a node is its own image
_NODES = {1: 2, 2: 3}  # of a straight facet and of a triangle, by dimension


@dataclass(frozen=True)
class HalfMesh:
    """Straight facets and triangles by group."""

    points: NDArray[np.float64]
    """Nodes in gmsh's unit, shape (nodes, 3)."""
    groups: dict[tuple[int, int], tuple[NDArray[np.int64], str]]
    """By dimension and tag: nodes of each element, shape (elements, nodes of each), from 1; and the group's name."""

    @classmethod
    def read(cls) -> "HalfMesh":
        """Return the mesh of the current gmsh model, without nodes that belong to no element of a group.

        No triangle has two sides on the skin that can touch, where that can be (:mod:`geometry.corner_cells`).
        """
        groups = {
            (dimension, tag): (_elements(dimension, tag), gmsh.model.getPhysicalName(dimension, tag))
            for dimension, tag in gmsh.model.getPhysicalGroups()
        }
        numbers, coordinates, _ = gmsh.model.mesh.getNodes()
        order = np.argsort(numbers)
        used = np.unique(np.concatenate([elements.ravel() for elements, _ in groups.values()]))
        points = coordinates.reshape(-1, 3)[order[np.searchsorted(numbers[order], used)]]
        found = {key: (1 + np.searchsorted(used, elements), name) for key, (elements, name) in groups.items()}
        skin = [elements for (dimension, tag), (elements, _) in found.items() if dimension == 1 and tags.is_ridge(tag)]
        layers = {tag: elements for (dimension, tag), (elements, _) in found.items() if dimension == 2}
        if skin:
            layers = swapped(points, np.concatenate(skin), layers)
        return cls(
            points, {key: (layers[key[1]] if key[0] == 2 else here, name) for key, (here, name) in found.items()}
        )

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
            there = image[here - 1][:, ::-1]
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
        nodes
        for entity in gmsh.model.getEntitiesForPhysicalGroup(dimension, tag)
        for nodes in gmsh.model.mesh.getElements(dimension, entity)[2]
    ]
    return np.concatenate(found).astype(np.int64).reshape(-1, _NODES[dimension])


def _add(dimension: int, tag: int, name: str, elements: NDArray[np.int64]) -> None:
    """Add elements as a group."""
    entity = gmsh.model.addDiscreteEntity(dimension)
    gmsh.model.mesh.addElementsByType(entity, dimension, [], elements.ravel())
    gmsh.model.addPhysicalGroup(dimension, [entity], tag, name)
