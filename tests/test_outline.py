"""Lines of a body, beside closed forms: loops and areas."""

import numpy as np
import pytest
from matplotlib.tri import Triangulation

from variational.snapshot import loops, outline


def square(n: int = 6) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices and triangles, either way round, of a square of two units with a hole of a third of its side."""
    x, y = (a.ravel() for a in np.meshgrid(np.linspace(-1, 1, n + 1), np.linspace(-1, 1, n + 1)))
    triangles = Triangulation(x, y).triangles.astype(np.int64)
    centre = np.abs(np.column_stack([x, y])[triangles].mean(axis=1)).max(axis=1)
    triangles = triangles[centre > 1 / 3]
    triangles[::2] = triangles[::2, ::-1]
    return np.column_stack([x, y]), triangles


def area(points: np.ndarray) -> float:
    """Return the area inside a polygon, positive where it is counterclockwise."""
    x, y = points.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def test_loops_go_around_each_part():
    """A part is on their left: its outer loop is counterclockwise and that of a hole is clockwise."""
    x, triangles = square()
    tag = np.where(x[triangles].mean(axis=1)[:, 1] > 0, 7, 5).astype(np.int32)
    ends, cells, edge = outline(x, triangles, tag)
    apart = triangles[cells[:, 0]] != triangles[cells[:, 0], edge][:, None]
    assert (np.sort(triangles[cells[:, 0]][apart].reshape(-1, 2)) == np.sort(ends)).all()
    lines = np.stack([ends[:, 0], ends[:, 0], ends[:, 1]], axis=1)
    areas = {part: sorted(area(x[loop[:, 0]]) for loop in loops(lines, cells, tag, part)) for part in (5, 7, 0)}
    assert areas[5] == pytest.approx([2 - 2 / 9]) == areas[7]
    assert areas[0] == pytest.approx([-4, 4 / 9])
