"""Differences between dolfinx 0.9, 0.10 and 0.11, in one place."""

import dolfinx
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def cell_geometry(mesh: dolfinx.mesh.Mesh) -> NDArray[np.int32]:
    """Return the geometry's node numbers, one row a cell."""
    geometry = mesh.geometry
    return np.asarray(geometry.dofmaps[0] if hasattr(geometry, "dofmaps") else geometry.dofmap)


def interpolation_points(element) -> Array:
    """Return the reference points at which an element interpolates."""
    points = element.interpolation_points
    return np.asarray(points() if callable(points) else points)


def evaluate_on_facets(expression: dolfinx.fem.Expression, mesh: dolfinx.mesh.Mesh, pairs: NDArray[np.int32]) -> Array:
    """Evaluate an expression made for facet points; ``pairs`` are (cell, local facet). Shape (facets, -1)."""
    if len(pairs) == 0:
        return np.zeros((0, 0))
    flat = dolfinx.__version__.startswith("0.9")
    entities = np.ascontiguousarray(pairs.reshape(-1) if flat else pairs)
    return np.asarray(expression.eval(mesh, entities)).reshape(len(pairs), -1)


def evaluate_on_cells(expression: dolfinx.fem.Expression, mesh: dolfinx.mesh.Mesh, cells: NDArray[np.int32]) -> Array:
    """Evaluate an expression made for cell points. Shape (cells, -1)."""
    if len(cells) == 0:
        return np.zeros((0, 0))
    return np.asarray(expression.eval(mesh, cells)).reshape(len(cells), -1)
