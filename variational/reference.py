"""Where in the reference triangle a place of the unloaded body is, straight edges or curved."""

import basix
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_NEWTON, _STEP = 12, 0.5  # iterations that find a place in a curved triangle, and the longest step of one
_NEAR = 1e-7  # step after which a place is found to roundoff, by quadratic convergence
_STRAIGHT = 1e-11  # of the triangle's size: what roundoff of the nodes leaves of an edge's bend
_FLAT = 0.05  # of the straight triangle's area: least determinant, outside of the triangle


def reference_places(nodes: Array, places: Array) -> Array:
    """Return the reference coordinates of a place each in triangles of first or second order, shape (n, 2).

    Args:
        nodes: the triangles' nodes (m), in basix' order, shape (n, 3 or 6, 2).
        places: reference positions (m), in the triangle or not far from it, shape (n, 2).
    """
    a, b, c = np.moveaxis(nodes[:, :3], 1, 0)
    X, straight = _solved(b - a, c - a, places - a)
    if nodes.shape[1] == 3:
        return X
    element = basix.create_element(basix.ElementFamily.P, basix.CellType.triangle, 2)
    bend = np.abs(nodes[:, 3:] - (nodes[:, [1, 0, 0]] + nodes[:, [2, 2, 1]]) / 2).max(axis=(1, 2))
    far = np.flatnonzero(bend > _STRAIGHT * np.sqrt(np.abs(straight)))
    for _ in range(_NEWTON):
        basis = np.asarray(element.tabulate(1, X[far]))[:, :, :, 0]
        there, a, b = np.einsum("dnk,nki->dni", basis, nodes[far])
        step = np.clip(_solved(a, b, places[far] - there, _FLAT * straight[far])[0], -_STEP, _STEP)
        X[far] += step
        far = far[np.abs(step).max(axis=1) > _NEAR]
    return X


def _solved(a: Array, b: Array, right: Array, least: Array | float = 0.0) -> tuple[Array, Array]:
    """Return what multiples of a and b, shape (n, 2) each, add up to the right side, and the determinants, (n,)."""
    determinant = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    safe = np.where(np.abs(determinant) > np.abs(least), determinant, least)
    first, second = right[:, 0] * b[:, 1] - right[:, 1] * b[:, 0], a[:, 0] * right[:, 1] - a[:, 1] * right[:, 0]
    return np.stack([first, second], axis=1) / safe[:, None], determinant
