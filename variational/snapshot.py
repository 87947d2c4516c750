"""The whole body on one rank, as a picture shows it: its vertices, triangles, densities, tensors and lines."""

from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]
_ON_LINE = 1e-9  # m from x = 0, within which a vertex is its own image


@dataclass(frozen=True)
class Snapshot:
    """A state of the whole body on one rank; its lines are parabolas, as the edges of P2 triangles are."""

    x: Array
    """Reference positions of vertices and of the lines' middles (m), shape (points, 2)."""
    u: Array
    """Their displacements (m), shape (points, 2)."""
    triangles: NDArray[np.int64]
    """Vertices of each cell, shape (cells, 3)."""
    sed: Array
    """Mean strain energy density of each cell (J/m^3), shape (cells,)."""
    tag: NDArray[np.int32]
    """Tag of each cell, zero where it has none, shape (cells,)."""
    lines: NDArray[np.int64] = field(default_factory=lambda: np.empty((0, 3), dtype=np.int64))
    """Edges between tags and on the boundary: points where each begins, has its middle and ends, shape (lines, 3)."""
    beside: NDArray[np.int64] = field(default_factory=lambda: np.empty((0, 2), dtype=np.int64))
    """Cells on the left and on the right of each line, -1 outside, shape (lines, 2)."""
    stress: Array = field(default_factory=lambda: np.empty((0, 4)))
    """Mean Cauchy stress of each cell (Pa), components xx, yy, zz and xy, shape (cells, 4)."""
    strain: Array = field(default_factory=lambda: np.empty((0, 3)))
    """Mean Green's strain of each cell, components xx, yy and xy, shape (cells, 3)."""

    def whole(self) -> "Snapshot":
        """Return the body whose half at x >= 0 this is, one body along the line of symmetry."""
        on_line = np.abs(self.x[:, 0]) < _ON_LINE
        image = np.where(on_line, np.arange(len(on_line)), len(on_line) + np.cumsum(~on_line) - 1)
        flip = np.array([-1.0, 1.0])
        off = ~on_line[self.lines].all(axis=1)  # the line of symmetry is none of the whole body
        lines, beside = self.lines[off], self.beside[off]
        other = np.where(beside >= 0, beside + len(self.triangles), -1)
        return Snapshot(
            np.concatenate([self.x, flip * self.x[~on_line]]),
            np.concatenate([self.u, flip * self.u[~on_line]]),
            np.concatenate([self.triangles, image[self.triangles][:, ::-1]]),
            np.concatenate([self.sed, self.sed]),
            np.concatenate([self.tag, self.tag]),
            np.concatenate([lines, image[lines][:, ::-1]]),
            np.concatenate([beside, other]),
            np.concatenate([self.stress, self.stress * [1, 1, 1, -1]]),
            np.concatenate([self.strain, self.strain * [1, 1, -1]]),
        )


class Outline(NamedTuple):
    """Edges between parts and on the boundary; each is named once, and has the first of its cells on its left."""

    ends: Numbers
    """Vertices where each begins and ends, shape (lines, 2)."""
    cells: Numbers
    """Cells on its left and on its right, -1 outside, shape (lines, 2)."""
    edge: Numbers
    """Number of the edge in the cell on its left, that of the opposite vertex, shape (lines,)."""


def outline(x: Array, triangles: Numbers, tag: NDArray[Any]) -> Outline:
    """Return the edges between cells of different tags and those of one cell alone.

    Args:
        x: positions of the vertices (m), shape (vertices, 2).
        triangles: vertices of each cell, either way round, shape (cells, 3).
        tag: of each cell, shape (cells,).
    """
    cells = np.arange(len(triangles))
    (ax, ay), (bx, by), (cx, cy) = np.moveaxis(x[triangles], 0, 2)
    forward = ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax) > 0)[:, None]
    begin, end = triangles[:, [1, 2, 0]], triangles[:, [2, 0, 1]]
    begin, end = np.where(forward, begin, end).ravel(), np.where(forward, end, begin).ravel()
    key = np.minimum(begin, end) * (int(triangles.max(initial=0)) + 1) + np.maximum(begin, end)
    order = np.argsort(key, kind="stable")
    same = np.flatnonzero(np.diff(key[order]) == 0)
    first, second = order[same], order[same + 1]
    alone = np.ones(len(order), dtype=bool)
    alone[first] = alone[second] = False
    between = tag[first // 3] != tag[second // 3]
    mine = np.concatenate([first[between], np.flatnonzero(alone)])
    other = np.concatenate([cells[second[between] // 3], np.full(int(alone.sum()), -1)])
    return Outline(np.stack([begin[mine], end[mine]], 1), np.stack([cells[mine // 3], other], 1), mine % 3)


def loops(lines: Numbers, cells: Numbers, tag: NDArray[Any], part: int) -> list[Numbers]:
    """Return the closed loops of lines around a part, which is on their left.

    Args:
        lines: points at which each line begins, has its middle and ends, shape (lines, 3).
        cells: on their left and on their right, -1 outside, shape (lines, 2).
        tag: of each cell, shape (cells,).
        part: a tag, or 0 for all that is outside.

    Returns:
        The lines of each loop in order and in its direction, shape (lines of the loop, 3).
    """
    left, right = (np.where(side >= 0, tag[side], 0) == part for side in cells.T)
    around = np.concatenate([lines[left & ~right], lines[right & ~left][:, ::-1]])
    onward: dict[int, list[int]] = {}
    for k, begin in enumerate(around[:, 0].tolist()):
        onward.setdefault(begin, []).append(k)
    ends, found = around[:, 2].tolist(), []
    for begin in list(onward):
        while onward[begin]:
            here, loop = begin, list[int]()
            while onward.get(here):
                loop.append(onward[here].pop())
                here = ends[loop[-1]]
            found.append(around[loop])
    return found
