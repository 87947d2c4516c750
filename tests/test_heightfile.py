"""Height maps from files: formats, missing heights, and what is refused."""

import builtins
from typing import get_args

import numpy as np
import pytest

from fingerpad.scene.materials import LengthUnit
from tests.test_topography import grid, wave
from variational.roughness import unfilled
from variational.roughness.heightfile import scan
from variational.roughness.heightheader import UNITS
from variational.roughness.heighttext import parse
from variational.roughness.missing import filled
from variational.roughness.selfaffine import SelfAffine


@pytest.mark.parametrize("name", ["map.npy", "map.txt", "map.csv"])
def test_plain_files(tmp_path, name):
    """Text keeps 18 digits, so nothing is lost."""
    m, path = wave(), tmp_path / name
    if path.suffix == ".npy":
        np.save(path, m.heights)
    else:
        np.savetxt(path, m.heights, delimiter="," if path.suffix == ".csv" else " ")
    found = scan(path, m.size, "m").map
    np.testing.assert_array_equal(found.heights, m.heights)
    assert found.size == m.size


def test_bad_files(tmp_path):
    (tmp_path / "words.txt").write_text("no numbers")
    (tmp_path / "heights.txt").write_text("1 2 3 4\n" * 4)
    np.save(tmp_path / "line.npy", np.zeros(9))
    with pytest.raises(ValueError, match="give the lengths"):
        scan(tmp_path / "heights.txt", unit="m")
    with pytest.raises(ValueError, match="no matrix of numbers"):
        scan(tmp_path / "words.txt", (1.0, 1.0), "m")
    with pytest.raises(ValueError, match="line.npy: heights have shape"):
        scan(tmp_path / "line.npy", (1.0, 1.0), "m")
    np.save(tmp_path / "high.npy", np.eye(9) * 1e200)
    with pytest.raises(ValueError, match=r"heights over 1e\+200 m, at most 1 m is allowed"):
        scan(tmp_path / "high.npy", (1.0, 1.0), "m")


def test_lengths_that_are_exchanged(tmp_path):
    """Four lines of eight heights in square pixels of 1 um; long pixels are taken if they are given as such."""
    path = tmp_path / "map.npy"
    np.save(path, np.zeros((4, 8)))
    assert scan(path, (4e-6, 8e-6), "m").map.pixel == (1e-6, 1e-6)
    assert scan(path, (4e-6, 16e-6), "m").map.pixel == (1e-6, 2e-6)
    with pytest.raises(ValueError, match=r"4 lines of 8 heights, and x, .* the pixels are not square; exchange"):
        scan(path, (8e-6, 4e-6), "m")
    assert scan(path, unit="m", pixel=(2e-6, 0.5e-6)).map.size == (8e-6, 4e-6)


# -- missing pixels ----------------------------------------------------------------------------------------
def test_numbers_that_mark_missing_pixels(tmp_path):
    """In NumPy's files as in texts."""
    h = np.arange(36).reshape(6, 6)
    h[1, 2] = -32768
    np.save(tmp_path / "map.npy", h)
    np.savetxt(tmp_path / "map.csv", h, delimiter=",")
    found = [scan(tmp_path / name, (1.0, 1.0), "um", missing="-32768") for name in ("map.npy", "map.csv")]
    assert [each.missing for each in found] == [1, 1]
    np.testing.assert_allclose(found[0].map.heights * 1e6, np.arange(36).reshape(6, 6), atol=1e-12)
    np.testing.assert_array_equal(found[0].map.heights, found[1].map.heights)
    with pytest.raises(ValueError, match="missing is 'void'; .* has numbers alone"):
        scan(tmp_path / "map.npy", (1.0, 1.0), missing="void")


@pytest.mark.parametrize("mark", ["NODATA_value  -9999", "nodata_value -9999.0", "# NODATA_value: -9999"])
def test_mark_of_an_esri_grid(mark, tmp_path):
    """The header's mark is a number, and another one may be given beside it."""
    header = f"ncols 4\nnrows 4\nxllcorner 0\nyllcorner 0\ncellsize 1\n{mark}\n"
    (tmp_path / "map.asc").write_text(header + "1 2 3 4\n5 -9999 7 8\n9 1 -9999.0 3\n4 5 6 -1\n")
    found = scan(tmp_path / "map.asc", (4.0, 4.0), "um", missing="-1")
    assert found.missing == 3 and np.ptp(found.map.heights) < 10e-6


@pytest.mark.parametrize("pixels", [1, 40, 1000])
@pytest.mark.parametrize("value", [-9999.0, 32767.0, -3.4028234663852886e38])
@pytest.mark.parametrize("name", ["map.csv", "map.npy"])
def test_unfilled_value_is_refused(name, value, pixels, tmp_path):
    """Of heights of some µm; 1000 of 2304 pixels are more than the quartiles bear. As a mark it is missing."""
    path, h = tmp_path / name, SelfAffine().surface((48, 48), (300e-6, 300e-6), 3).heights * 1e6
    h.ravel()[:pixels] = value
    if path.suffix == ".npy":
        np.save(path, h)
    else:
        np.savetxt(path, h, delimiter=",")
    count, text = "1 pixel" if pixels == 1 else f"{pixels} pixels", repr(value).removesuffix(".0")
    with pytest.raises(ValueError) as refusal:
        scan(path, (300.0, 300.0), "um")
    assert str(refusal.value) == (
        f"{path} has {text} at {count}, far from all other heights, as a mark of missing pixels; give "
        f'missing="{text}", or missing="nan" if it was measured'
    )
    if pixels == 40:
        assert scan(path, (300.0, 300.0), "um", missing=text).missing == pixels
    if value == 32767:
        assert np.ptp(scan(path, (300.0, 300.0), "um", missing="nan").map.heights) > 0.03


def test_both_extreme_values_are_marks():
    """The other one does not hide either: it does not count among the others."""
    h = np.random.default_rng(1).normal(size=(20, 20))
    h[0, :3], h[1, 1] = -9999, 32767
    assert unfilled.mark(h) == 32767
    h[1, 1] = np.nan
    assert unfilled.mark(h) == -9999


@pytest.mark.parametrize("width", [1, 3, 20])
def test_deep_grooves_are_no_marks(width):
    """Walls are steep and 1000 interquartile ranges deep, but the floor has heights of its own."""
    h = 0.1 * np.random.default_rng(1).normal(size=(64, 64))
    h[30 : 30 + width] -= 135.0
    assert unfilled.mark(h) is None


def test_coarse_steps_are_no_marks():
    """Of heights in whole steps most may be equal, so that the quartiles are."""
    h = np.zeros((20, 20))
    h[3, 3:8] = [1, 2, 3, 4, 5]
    assert unfilled.mark(h) is None
    assert unfilled.mark(np.zeros((4, 4))) is None
    h[4, 4] = -9999
    assert unfilled.mark(h) == -9999


def test_missing_heights_are_those_of_a_plane():
    """A linear map is harmonic, so that a hole inside it is filled exactly, to roundoff of the solve."""
    x, y = grid((12, 9), (1.0, 1.0))
    plane = 3 * x - 2 * y
    holed = plane.copy()
    holed[3:6, 2:5] = np.nan
    holed[8, 6] = np.inf
    np.testing.assert_allclose(filled(holed), plane, rtol=0, atol=1e-12)
    assert np.isnan(holed[4, 4])


def test_missing_edge_of_a_curved_map():
    """Polynomials of degree two go on over a missing strip, to roundoff; measured heights stay to the last bit."""
    x, y = grid((24, 16), (1.0, 1.0))
    curved = 5 * x**2 - 3 * x * y + y**2 - 2 * x + 1
    holed = curved.copy()
    holed[-3:] = np.nan
    holed[:4, :4] = np.nan
    found = filled(holed)
    np.testing.assert_allclose(found, curved, rtol=0, atol=1e-12)
    known = np.isfinite(holed)
    np.testing.assert_array_equal(found[known], curved[known])


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
        ("nan nan nan nan\n1 2 3 4", [[np.nan] * 4, [1, 2, 3, 4]], "separated by spaces"),
        ("z in um\n--;bad;2;1\n1;2;3;4", [[np.nan, np.nan, 2, 1], [1, 2, 3, 4]], "separated by semicolons"),
        ("-99 nan nan nan\n1 2 3 4", [[np.nan] * 4, [1, 2, 3, 4]], "separated by spaces"),
        ("nan,2,3,nan\nnan,6,7,nan", [[np.nan, 2, 3, np.nan], [np.nan, 6, 7, np.nan]], "separated by commas"),
        ('"1","2","3","4"\n"5","6","7","8"', [[1, 2, 3, 4], [5, 6, 7, 8]], "separated by commas"),
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


def points(header: str, x_unit: float) -> str:
    """Return a text of 4 x 3 points at distances of 2 µm and 3 µm, in a unit (m); the heights are from 0 to 3."""
    places = [(2e-6 * i / x_unit, 3e-6 * j / x_unit, i) for i in range(4) for j in range(3)]
    return "\n".join([header, *(f"{x:.6g},{y:.6g},{z}" for x, y, z in places)])


@pytest.mark.parametrize(
    ("header", "unit"),
    [
        ("x (mm),y (mm),z (µm)", 1e-3),
        ("# X [nm], Y [nm], Height [um]", 1e-9),
        ("x/mm,y/mm,z/µm", 1e-3),
        ("x_mm,y_mm,z_um", 1e-3),
        ("filtered (10x) in y\nx,y,z (um)", 1e-6),
        ("x (millimeters), y (millimeters), z (microns)", 1e-3),
    ],
)
def test_units_of_points_in_a_header(header, unit, tmp_path):
    """Coordinates are in the header's unit, whatever that of the heights; places are rounded to six digits."""
    path = tmp_path / "map.csv"
    path.write_text(points(header, unit), encoding="utf-8")
    for given in ("um", None):
        found = scan(path, unit=given).map
        assert found.size == pytest.approx((8e-6, 9e-6), rel=1e-5)
        assert np.ptp(found.heights) == pytest.approx(3e-6)


@pytest.mark.parametrize("header", ["# scan of x, y and z (2024-01-01)\nx,y,z", "x (along finger), y (across), z (up)"])
def test_words_in_brackets_are_no_units(header, tmp_path):
    path = tmp_path / "map.csv"
    path.write_text(points(header, 1e-3), encoding="utf-8")
    assert scan(path, unit="um", size_unit="mm").map.size == pytest.approx((8e-6, 9e-6), rel=1e-5)
    with pytest.raises(ValueError, match="holds numbers without a unit"):
        scan(path)


@pytest.mark.parametrize(
    ("header", "given", "message"),
    [
        ("x (mm),y (mm),z (µm)", {"unit": "mm"}, "has z in µm by its header, and unit is mm; give the header's unit"),
        ("x (mm),y (mm),z", {"unit": "um", "size_unit": "um"}, "has x in mm by its header, and size_unit is um"),
        ("x (px),y (px),z (um)", {"unit": "um"}, "map.csv: its header gives x in 'px'; a unit of length must be of m,"),
    ],
)
def test_units_against_a_header(header, given, message, tmp_path):
    path = tmp_path / "map.csv"
    path.write_text(points(header, 1e-3), encoding="utf-8")
    with pytest.raises(ValueError, match=message):
        scan(path, **given)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1,5;2.5;3\n1;2;3", "it has points and commas in them"),
        ("1 2 3 4\n1 2 3", "line 2 has 3 of them, the first one 4"),
        ("1 2 3 4\n1 2 x 4", "line 2 has 'x'"),
        ("void 2 3 4\n1 2 3 4", "line 1 has 'void'; a mark of missing pixels must be given"),
        ("nan nan nan\nnan nan nan", "no line of numbers"),
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
    (tmp_path / "scan.vk4").write_bytes(b"")
    with pytest.raises(ImportError, match=r"pip install fingerpad\[topography\]"):
        scan(tmp_path / "scan.vk4")


def test_units_of_a_scene_are_those_of_the_reader():
    assert get_args(LengthUnit) == tuple(UNITS)
