"""Expressions that differ from solid to solid, evaluated at reference points of the cells a rank owns."""

from collections.abc import Mapping
from typing import Any

import dolfinx
import numpy as np
from dolfinx import fem
from numpy.typing import NDArray

from variational import compat, jit

Array = NDArray[np.float64]


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
