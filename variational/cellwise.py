"""Expressions that differ from solid to solid, evaluated at reference points of the cells a rank owns."""

from collections.abc import Mapping
from typing import Any

import basix
import dolfinx
import numpy as np
from dolfinx import fem
from numpy.typing import NDArray

from variational import compat, jit

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


def owned_cells(mesh: dolfinx.mesh.Mesh) -> NDArray[np.int32]:
    """Return the numbers of this rank's own cells."""
    return np.arange(mesh.topology.index_map(mesh.topology.dim).size_local, dtype=np.int32)


class Cellwise:
    """One expression for each group of cell tags, each valid on the cells with those tags only.

    Attributes:
        shape: shape of the expressions' values.
    """

    def __init__(
        self,
        mesh: dolfinx.mesh.Mesh,
        cell_tags: dolfinx.mesh.MeshTags,
        expressions: Mapping[tuple[int, ...], Any],
        points: Array,
    ) -> None:
        """Compile the expressions.

        Args:
            mesh: the body (m).
            cell_tags: tags of its cells.
            expressions: UFL expressions of one shape, by the tags of the cells on which they hold.
            points: reference points of a cell, shape (points, 2), the same on every rank.
        """
        self.mesh, self._points = mesh, len(points)
        self.shape = next(iter(expressions.values())).ufl_shape
        self._compiled = [fem.Expression(e, points, jit_options=jit.OPTIONS) for e in expressions.values()]
        self._group = np.full(len(owned_cells(mesh)), -1)
        for k, tags in enumerate(expressions):
            for tag in tags:
                cells = cell_tags.find(tag)
                self._group[cells[cells < len(self._group)]] = k

    def evaluate(self, cells: NDArray[np.int32] | None = None) -> Array:
        """Return values on own cells, by default all, shape (cells, points, components); NaN without expression."""
        if cells is None:
            cells = owned_cells(self.mesh)
        values = np.full((len(cells), self._points, int(np.prod(self.shape, dtype=int))), np.nan)
        for k, compiled in enumerate(self._compiled):
            mine = self._group[cells] == k
            found = compat.evaluate_on_cells(compiled, self.mesh, np.ascontiguousarray(cells[mine]))
            values[mine] = found.reshape((int(mine.sum()), *values.shape[1:]))
        return values
