"""Where in the reference triangle a place of the unloaded body is, straight edges or curved."""

import basix
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_NEWTON, _STEP = 12, 0.5  # iterations that find a place in a curved triangle, and the longest step of one
_NEAR = 1e-7  # step after which a place is found to roundoff, by quadratic convergence
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
    for _ in range(_NEWTON):
        there, a, b = np.einsum("dnk,nki->dni", np.asarray(element.tabulate(1, X))[:, :, :, 0], nodes)
        step = np.clip(_solved(a, b, places - there, _FLAT * straight)[0], -_STEP, _STEP)
        X = X + step
        if np.abs(step).max(initial=0) < _NEAR:
            break
    return X


def _solved(a: Array, b: Array, right: Array, least: Array | float = 0.0) -> tuple[Array, Array]:
    """Return what multiples of a and b, shape (n, 2) each, add up to the right side, and the determinants, (n,)."""
    determinant = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    safe = np.where(np.abs(determinant) > np.abs(least), determinant, least)
    first, second = right[:, 0] * b[:, 1] - right[:, 1] * b[:, 0], a[:, 0] * right[:, 1] - a[:, 1] * right[:, 0]
    return np.stack([first, second], axis=1) / safe[:, None], determinant
