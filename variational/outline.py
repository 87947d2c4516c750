"""The lines of a body that a picture shows: edges between parts of different tags, and on the boundary."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]


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
