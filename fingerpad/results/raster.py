"""Cells of a body as pixels: a picture of some thousand cells costs what its pixels do.

A cell beside a curved line is cut into triangles from its middle to points along its edges.
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]
_PARTS = 8  # of each edge of a cell with a curved one


def cells_at(triangles: Array, x: Array, y: Array) -> Numbers:
    """Return which triangle each point of a grid is in, -1 in none, shape (rows, columns).

    Args:
        triangles: corners, shape (triangles, 3, 2).
        x: of the columns, at equal distances, ascending.
        y: of the rows, likewise.
    """
    place = (triangles - [x[0], y[0]]) / [x[1] - x[0], y[1] - y[0]]
    place = np.take_along_axis(place, np.argsort(place[:, :, 1], axis=1)[:, :, None], axis=1)
    (ax, ay), (bx, by), (cx, cy) = np.moveaxis(place, 0, 2)
    k, row = _counted(ay, cy, len(y))
    upper = row >= by[k]  # of the two shorter sides
    fx, fy = np.where(upper, bx[k], ax[k]), np.where(upper, by[k], ay[k])
    tx, ty = np.where(upper, cx[k], bx[k]), np.where(upper, cy[k], by[k])
    one = ax[k] + (row - ay[k]) * _over(cx[k] - ax[k], cy[k] - ay[k])
    other = fx + (row - fy) * _over(tx - fx, ty - fy)
    j, column = _counted(np.minimum(one, other), np.maximum(one, other), len(x))
    found = np.full(len(y) * len(x), -1)
    found[row[j] * len(x) + column] = k[j]
    return found.reshape(len(y), len(x))


def _over(a: Array, b: Array) -> Array:
    return a / np.where(b > 0, b, np.inf)


def _counted(first: Array, last: Array, most: int) -> tuple[Numbers, Numbers]:
    """Return the whole numbers from 0 to ``most`` - 1 within ranges: the range of each, and the numbers."""
    least = np.maximum(np.ceil(first), 0).astype(int)
    count = np.maximum(np.minimum(np.floor(last), most - 1).astype(int) - least + 1, 0)
    which = np.repeat(np.arange(len(count)), count)
    before = np.cumsum(count) - count
    return which, np.arange(len(which)) - (before - least)[which]


def pieces(xy: Array, triangles: Numbers, lines: Numbers, beside: Numbers, near: float) -> tuple[Array, Numbers]:
    """Return cells as triangles, those beside curved lines in pieces.

    Args:
        xy: points, shape (points, 2).
        triangles: vertices of each cell, shape (cells, 3).
        lines: points where each line begins, has its middle and ends, shape (lines, 3).
        beside: cells on either side of each, -1 where there is none, shape (lines, 2).
        near: distance from its middle to its chord up to which a line is straight.

    Returns:
        Corners, shape (pieces, 3, 2), and the cell of each piece, shape (pieces,).
    """
    curved = bend(xy, lines) > near
    sides = beside[curved].ravel()
    line, cell = np.repeat(lines[curved], 2, axis=0)[sides >= 0], sides[sides >= 0]
    cut, place = np.unique(cell, return_inverse=True)
    corners = xy[triangles[cut]]
    middles = (corners[:, [1, 2, 0]] + corners[:, [2, 0, 1]]) / 2
    opposite = ((triangles[cell][:, :, None] == line[:, None, ::2]).any(axis=2)).argmin(axis=1)
    middles[place, opposite] = xy[line[:, 1]]
    edges = np.stack([corners[:, [1, 2, 0]], middles, corners[:, [2, 0, 1]]], axis=2)
    points = np.einsum("sp,cesi->cepi", _parabola(_PARTS), edges)
    centre = np.broadcast_to(corners.mean(axis=1)[:, None, None], points[:, :, 1:].shape)
    parts = np.stack([centre, points[:, :, :-1], points[:, :, 1:]], axis=3).reshape(-1, 3, 2)
    whole = np.setdiff1d(np.arange(len(triangles)), cut)
    return np.concatenate([xy[triangles[whole]], parts]), np.concatenate([whole, np.repeat(cut, 3 * _PARTS)])


def bend(xy: Array, lines: Numbers) -> Array:
    """Return the distance of the middle of each line from that of its chord, shape (lines,)."""
    begin, middle, end = xy[lines].swapaxes(0, 1)
    return np.asarray(np.hypot(*(middle - (begin + end) / 2).T))


def along(xy: Array, lines: Numbers, near: float) -> Array:
    """Return straight segments along lines, shape (segments, 2, 2): more where a line is more curved.

    Args:
        xy: points, shape (points, 2).
        lines: points where each line begins, has its middle and ends, shape (lines, 3).
        near: distance between a line and its segments, at most; a line has eight segments at most.
    """
    parts = np.ceil(np.sqrt(bend(xy, lines) / near)).clip(1, _PARTS).astype(int)
    found = []
    for n in np.unique(parts):
        points = np.einsum("sp,lsi->lpi", _parabola(n), xy[lines[parts == n]])
        found.append(np.stack([points[:, :-1], points[:, 1:]], axis=2).reshape(-1, 2, 2))
    return np.concatenate(found) if found else np.empty((0, 2, 2))


def _parabola(parts: int) -> Array:
    """Return weights of begin, middle and end of a line at the ends of its parts, shape (3, parts + 1)."""
    t = np.linspace(0, 1, parts + 1)
    return np.stack([(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)])
