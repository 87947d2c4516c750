"""A gmsh mesh and its mirror image at x = 0 as one: exactly symmetric, for the price of the half."""

import gmsh
import numpy as np
from numpy.typing import NDArray

from geometry import tags

_ON_LINE = 1e-9  # gmsh's unit from x = 0, within which a node is its own image
_NODES = {1: 2, 2: 3}  # of a straight facet and of a triangle, by dimension


def complete() -> None:
    """Put the whole body in the place of the current model, which is its half at x >= 0, under the same groups.

    Ridge -j is the image of ridge j. The group of the line of symmetry is gone.
    """
    groups = {
        (dimension, tag): (_elements(dimension, tag), gmsh.model.getPhysicalName(dimension, tag))
        for dimension, tag in gmsh.model.getPhysicalGroups()
        if tag != tags.SYMMETRY
    }
    numbers, coordinates, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(numbers)
    used = np.unique(np.concatenate([elements.ravel() for elements, _ in groups.values()]))  # others guide the size
    points = coordinates.reshape(-1, 3)[order[np.searchsorted(numbers[order], used)]]
    off = np.abs(points[:, 0]) > _ON_LINE
    own = np.arange(1, len(used) + 1)  # without gaps
    image = np.where(off, len(used) + np.cumsum(off), own)
    half = gmsh.model.getCurrent()
    gmsh.model.add(f"{half}, whole")
    body = gmsh.model.addDiscreteEntity(2)
    gmsh.model.mesh.addNodes(2, body, own, points.ravel())
    gmsh.model.mesh.addNodes(2, body, image[off], (points[off] * [-1, 1, 1]).ravel())
    for (dimension, tag), (elements, name) in groups.items():
        here = np.searchsorted(used, elements)
        there = image[here][:, ::-1]
        if tags.is_ridge(tag) and tag != tags.ridge(0):
            j = -tags.ridge_index(tag)
            _add(dimension, tags.ridge(j), f"ridge {j}", there)
            _add(dimension, tag, name, own[here])
        else:
            _add(dimension, tag, name, np.concatenate([own[here], there]))


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
