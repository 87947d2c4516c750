"""Lines of a body and its cells as pixels, beside closed forms: loops, areas, parabolas."""

import numpy as np
import pytest
from matplotlib.tri import Triangulation

from fingerpad.results.raster import along, bend, cells_at, pieces
from variational.snapshot import Snapshot, loops, outline


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


def test_pixels_are_of_the_cells_they_are_in():
    """As Matplotlib finds them, beside the middle of each pixel."""
    random = np.random.default_rng(3)
    x, y = random.random((2, 60))
    grid = Triangulation(x, y)
    columns, rows = np.linspace(-0.1, 1.1, 173), np.linspace(0.2, 1.3, 91)
    found = cells_at(np.column_stack([x, y])[grid.triangles], columns, rows)
    assert (found == grid.get_trifinder()(*np.meshgrid(columns, rows))).all()


def disc(parts: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return points, triangles, lines and the cells beside them of a disc whose edge has curved lines."""
    angles = 2 * np.pi * np.arange(2 * parts) / (2 * parts)
    points = np.concatenate([[[0, 0]], np.column_stack([np.cos(angles), np.sin(angles)])])
    begin = 1 + 2 * np.arange(parts)
    lines = np.stack([begin, begin + 1, 1 + (2 * np.arange(parts) + 2) % (2 * parts)], axis=1)
    triangles = np.stack([np.zeros(parts, dtype=int), lines[:, 0], lines[:, 2]], axis=1)
    return points, triangles, lines, np.stack([np.arange(parts), np.full(parts, -1)], axis=1)


def test_cells_beside_curved_lines_are_round():
    """Six parabolas have 0.6 % less than the disc, six triangles 17 %; eight parts of each parabola 0.3 % less again.

    Tolerance of the image: pixels of a fiftieth along the edge.
    """
    points, triangles, lines, beside = disc(6)
    parabolas = 6 * (np.sin(np.pi / 3) / 2 + 2 / 3 * (1 - np.cos(np.pi / 6)))
    corners, cells = pieces(points, triangles, lines, beside, 0.01)
    assert sum(map(area, corners)) == pytest.approx(parabolas, rel=4e-3) == pytest.approx(np.pi, rel=1e-2)
    assert sorted(set(cells)) == list(range(6))
    straight, cells = pieces(points, triangles, lines, beside, 0.2)
    assert len(cells) == 6 and sum(map(area, straight)) == pytest.approx(6 * np.sin(np.pi / 3) / 2)
    pixels = np.linspace(-1.02, 1.02, 103)
    shown = (cells_at(corners, pixels, pixels) >= 0).sum() * 0.02**2
    assert shown == pytest.approx(np.pi, rel=0.02)


@pytest.mark.parametrize("near", [1.0, 1e-1, 1e-2])
def test_segments_are_near_their_line(near):
    """A parabola of the bend s in n parts is s / n^2 away from the middles of its parts."""
    points, lines, s = np.array([[0, 0], [1, 0.3], [2, 0]]), np.array([[0, 1, 2]]), 0.3
    segments = along(points, lines, near)
    x, y = segments.mean(axis=1).T
    n = np.ceil(np.sqrt(s / near))
    assert s * (1 - (x - 1) ** 2) - y == pytest.approx(s / n**2) and s / n**2 <= near
    assert len(segments) == n
    assert bend(points, lines) == pytest.approx(s)


def test_mirrored_lines_are_those_of_the_whole_body():
    """The line of symmetry is none of it, and each part is still on the left of its lines."""
    x = np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]])
    triangles, tag = np.array([[0, 1, 2], [0, 2, 3]]), np.array([5, 5], dtype=np.int32)
    ends, beside, _ = outline(x, triangles, tag)
    points = np.concatenate([x, x[ends].mean(axis=1) + 0.1 * (x[ends].mean(axis=1) == [1, 0.5])])
    lines = np.stack([ends[:, 0], 4 + np.arange(len(ends)), ends[:, 1]], axis=1)
    whole = Snapshot(points, 0 * points, triangles, np.ones(2), tag, lines, beside).whole()
    assert len(whole.lines) == 6 and (whole.beside[:, 1] == -1).all()
    (loop,) = loops(whole.lines, whole.beside, whole.tag, 5)
    assert area(whole.x[loop[:, :2]].reshape(-1, 2)) == pytest.approx(2 + 2 * 0.5 * 0.1)
