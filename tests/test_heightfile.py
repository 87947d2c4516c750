"""Height maps from files: formats, missing heights, and what is refused."""

import builtins

import numpy as np
import pytest

from tests.test_topography import grid, wave
from variational.roughness.heightfile import read
from variational.roughness.heighttext import parse
from variational.roughness.missing import filled


@pytest.mark.parametrize("name", ["map.npy", "map.txt", "map.csv"])
def test_plain_files(tmp_path, name):
    """Text keeps 18 digits, so nothing is lost."""
    m, path = wave(), tmp_path / name
    if path.suffix == ".npy":
        np.save(path, m.heights)
    else:
        np.savetxt(path, m.heights, delimiter="," if path.suffix == ".csv" else " ")
    found = read(path, m.size)
    np.testing.assert_array_equal(found.heights, m.heights)
    assert found.size == m.size


def test_bad_files(tmp_path):
    (tmp_path / "words.txt").write_text("no numbers")
    (tmp_path / "heights.txt").write_text("1 2 3 4\n" * 4)
    np.save(tmp_path / "line.npy", np.zeros(9))
    with pytest.raises(ValueError, match="give the lengths"):
        read(tmp_path / "heights.txt")
    with pytest.raises(ValueError, match="no matrix of numbers"):
        read(tmp_path / "words.txt", (1.0, 1.0))
    with pytest.raises(ValueError, match="line.npy: heights have shape"):
        read(tmp_path / "line.npy", (1.0, 1.0))
    with pytest.raises(ValueError, match="has its own size"):
        read(tmp_path / "scan.vk4", (1.0, 1.0))


def test_missing_heights_are_those_of_a_plane():
    """A linear map is harmonic, so that a hole inside it is filled exactly, to roundoff of the solve."""
    x, y = grid((12, 9), (1.0, 1.0))
    plane = 3 * x - 2 * y
    holed = plane.copy()
    holed[3:6, 2:5] = np.nan
    holed[8, 6] = np.inf
    np.testing.assert_allclose(filled(holed), plane, rtol=0, atol=1e-12)
    assert np.isnan(holed[4, 4])


def test_hole_at_the_edge_is_filled():
    """Without a slope across the edge, a map that varies along the edge alone goes on unchanged."""
    _, y = grid((12, 9), (1.0, 1.0))
    holed = 0 * y + 1.0
    holed[:3, :2] = np.nan
    np.testing.assert_allclose(filled(holed), 1.0, rtol=1e-12)


def test_too_much_is_missing():
    holed = np.ones((4, 4))
    holed[:, 0] = np.nan
    filled(holed)
    holed[0, 1] = np.nan
    with pytest.raises(ValueError, match="5 of 16 heights are missing or infinite; at most a quarter may be"):
        filled(holed)


@pytest.mark.parametrize(
    ("text", "rows", "layout"),
    [
        ("1 2 3 4\n5 6 7 8", [[1, 2, 3, 4], [5, 6, 7, 8]], "separated by spaces"),
        ("1,2,3,4\n5,6,7,8", [[1, 2, 3, 4], [5, 6, 7, 8]], "separated by commas"),
        ("1.5, 2, 3, 4\n5, 6, 7, 8", [[1.5, 2, 3, 4], [5, 6, 7, 8]], "separated by commas"),
        ("1,5 2 3 4\n5 6 7 8,25", [[1.5, 2, 3, 4], [5, 6, 7, 8.25]], "separated by spaces, decimal commas"),
        ("1,5;2;3;4;\n5;6;7;8;\n", [[1.5, 2, 3, 4], [5, 6, 7, 8]], "separated by semicolons, decimal commas"),
        ("1\t2\t\t4\n5\t6\tbad\t8", [[1, 2, np.nan, 4], [5, 6, np.nan, 8]], "separated by tabs"),
        ("# made by x\nheight\n1 2 *** 4\n5 6 7 -99", [[1, 2, np.nan, 4], [5, 6, 7, np.nan]], "separated by spaces"),
    ],
)
def test_text_in_any_layout(text, rows, layout):
    found = parse(text, missing="-99")
    np.testing.assert_array_equal(found.heights, rows)
    assert found.layout.endswith(layout) and found.size is None


def test_points_in_any_order():
    """Points of a grid of 4 x 3 pixels of 2 x 3, one of them absent."""
    x, y = np.meshgrid(np.arange(4) * 2.0, 5 + np.arange(3) * 3.0, indexing="ij")
    points = np.stack([x, y, x + 10 * y], axis=-1).reshape(-1, 3)[:-1]
    order = np.random.default_rng(1).permutation(len(points))
    found = parse("\n".join(" ".join(map(str, p)) for p in points[order]))
    assert found.size == (8.0, 9.0)
    assert np.isnan(found.heights[3, 2])
    np.testing.assert_array_equal(found.heights.ravel()[:-1], points[:, 2])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1,5;2.5;3\n1;2;3", "it has points and commas in them"),
        ("1 2 3 4\n1 2 3", "line 2 has 3 of them, the first one 4"),
        ("1 2 3 4\n1 2 x 4", "line 2 has 'x'"),
        ("0 0 1\n1 0 1\n0 1 1\n1.4 1.3 1\n2 2 2", "not on a regular grid along x"),
    ],
)
def test_text_that_is_no_map(text, message):
    with pytest.raises(ValueError, match=message):
        parse(text)


def test_without_the_optional_package(monkeypatch, tmp_path):
    original = builtins.__import__

    def missing(name, *args, **kwargs):
        if name.startswith("SurfaceTopography"):
            raise ImportError(name)
        return original(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", missing)
    with pytest.raises(ImportError, match=r"pip install fingerpad\[topography\]"):
        read(tmp_path / "scan.vk4")
