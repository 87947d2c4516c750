"""Height maps from files: formats, missing heights, and what is refused."""

import builtins
from typing import get_args

import numpy as np
import pytest

from fingerpad.scene.materials import Topography
from tests.test_topography import grid, wave
from variational.roughness import missing
from variational.roughness.heightfile import UNITS, _matrix, _text, scan
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
    found = scan(path, "m", m.size).map
    np.testing.assert_array_equal(found.heights, m.heights)
    assert found.size == m.size


@pytest.fixture
def other():
    return pytest.importorskip("SurfaceTopography", reason="pip install fingerpad[topography]")


def test_bad_files(tmp_path):
    (tmp_path / "heights.txt").write_text("1 2 3 4\n" * 4)
    np.save(tmp_path / "line.npy", np.zeros(9))
    np.save(tmp_path / "high.npy", np.eye(9) * 1e200)
    small = (1e-3, 1e-3)
    for name, given, message in (
        ("heights.txt", {"unit": "m"}, "has no size; give 'size' or 'pixel'"),
        ("heights.txt", {"unit": "m", "size": small, "pixel": small}, "give 'size' or 'pixel', one of them"),
        ("heights.txt", {"size": small}, "holds numbers without a unit; give 'unit'"),
        ("line.npy", {"unit": "m", "size": small}, r"line.npy: heights have shape \(9,\)"),
        ("high.npy", {"unit": "m", "size": small}, r"heights over 1e\+200 m, at most 1 m is allowed"),
    ):
        with pytest.raises(ValueError, match=message):
            scan(tmp_path / name, **given)


def test_lengths_that_are_exchanged(tmp_path):
    """Four lines of eight heights in square pixels of 1 um; long pixels are taken if they are given as such."""
    path = tmp_path / "map.npy"
    np.save(path, np.zeros((4, 8)))
    assert scan(path, "m", (4e-6, 8e-6)).map.pixel == (1e-6, 1e-6)
    assert scan(path, "m", (4e-6, 16e-6)).map.pixel == (1e-6, 2e-6)
    with pytest.raises(ValueError, match=r"4 x 8 pixels, which are not square where 'size' is 8e-06 m x 4e-06 m; exch"):
        scan(path, "m", (8e-6, 4e-6))
    assert scan(path, unit="m", pixel=(2e-6, 0.5e-6)).map.size == (8e-6, 4e-6)


# -- missing pixels ----------------------------------------------------------------------------------------
def test_numbers_that_mark_missing_pixels(tmp_path):
    """In NumPy's files as in texts."""
    h = np.arange(36).reshape(6, 6)
    h[1, 2] = -32768
    np.save(tmp_path / "map.npy", h)
    np.savetxt(tmp_path / "map.csv", h, delimiter=",")
    found = [scan(tmp_path / name, **PLAIN, missing="-32768") for name in ("map.npy", "map.csv")]
    assert [each.missing for each in found] == [1, 1]
    np.testing.assert_allclose(found[0].map.heights * 1e6, np.arange(36).reshape(6, 6), atol=1e-12)
    np.testing.assert_array_equal(found[0].map.heights, found[1].map.heights)
    with pytest.raises(ValueError, match="'missing' is 'void'; .* has numbers alone"):
        scan(tmp_path / "map.npy", missing="void")


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
        scan(path, **PLAIN)
    assert str(refusal.value) == (
        f"{path} has {text} at {count}, far from all other heights, as a mark of missing pixels; give "
        f"'missing'=\"{text}\", or 'missing'=\"nan\" if it was measured"
    )
    if pixels == 40:
        assert scan(path, **PLAIN, missing=text).missing == pixels
    if value == 32767:
        assert np.ptp(scan(path, **PLAIN, missing="nan").map.heights) > 0.03


def test_both_extreme_values_are_marks():
    """The other one does not hide either: it does not count among the others."""
    h = np.random.default_rng(1).normal(size=(20, 20))
    h[0, :3], h[1, 1] = -9999, 32767
    assert missing.mark(h) == 32767
    h[1, 1] = np.nan
    assert missing.mark(h) == -9999


@pytest.mark.parametrize("width", [1, 3, 20])
def test_deep_grooves_are_no_marks(width):
    """Walls are steep and 1000 interquartile ranges deep, but the floor has heights of its own."""
    h = 0.1 * np.random.default_rng(1).normal(size=(64, 64))
    h[30 : 30 + width] -= 135.0
    assert missing.mark(h) is None


def test_coarse_steps_are_no_marks():
    """Of heights in whole steps most may be equal, so that the quartiles are."""
    h = np.zeros((20, 20))
    h[3, 3:8] = [1, 2, 3, 4, 5]
    assert missing.mark(h) is None
    assert missing.mark(np.zeros((4, 4))) is None
    h[4, 4] = -9999
    assert missing.mark(h) == -9999


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
    ("text", "rows"),
    [
        ("1 2 3 4\n5 6 7 8", [[1, 2, 3, 4], [5, 6, 7, 8]]),
        ("1,2,3,4\n5,6,7,8", [[1, 2, 3, 4], [5, 6, 7, 8]]),
        ("1.5, 2, 3, 4\r\n5, 6, 7, 8\r\n", [[1.5, 2, 3, 4], [5, 6, 7, 8]]),
        ("1;2;3;4;\n5;6;7;8;\n", [[1, 2, 3, 4], [5, 6, 7, 8]]),
        ("1\t2\t\t4\n5\t6\tbad\t8", [[1, 2, np.nan, 4], [5, 6, np.nan, 8]]),
        (" 1 nan  3 4\n\n 5 6 NaN 8 ", [[1, np.nan, 3, 4], [5, 6, np.nan, 8]]),
        ('"1","2","3","4"\n"5","6","","8"', [[1, 2, 3, 4], [5, 6, np.nan, 8]]),
    ],
)
@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
def test_plain_matrix(text, rows, encoding):
    """A pixel is missing where the place is empty, holds nan or the mark that is given, a word here."""
    np.testing.assert_array_equal(_matrix(_text(text.encode(encoding)), "bad")[0], rows)


PLAIN = {"unit": "um", "pixel": (1e-6, 1e-6)}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1 2 3 4\n1 2 3", "line 2 has 3 numbers and the first one 4"),
        ("1;2;3;4\n1;2;x;4", "line 2 has 'x'"),
        ("1,5;2,5;3;4\n1;2;3;4", "with decimal points .line 1 has '1,5'."),
        ("1,5 2,5 3,5\n1 2 3 4\n1 2 3 4\n1 2 3 4", "'1,5 2,5 3,5' in line 1 and no unit of heights"),
        ("1 2 3 4\n1 2 x 4\n1 2 3 4\n1 2 3 4", "'1 2 x 4' in line 2 among its numbers"),
        ("# height in um\n1;2;3;4\n1;2;3;4", "line 1 has '#'"),
        ("no numbers", "line 1 has 'no'"),
        ("a,0,1,2\n0,5,6,3\n1,7,8,9", "save the heights alone, without names and numbers of lines and columns"),
    ],
)
def test_text_that_is_no_plain_matrix(text, message, other, tmp_path):
    (tmp_path / "map.csv").write_text(text)
    with pytest.raises(ValueError, match=message):
        scan(tmp_path / "map.csv", **PLAIN)


@pytest.mark.parametrize("save", [np.savetxt, np.save])
def test_numbers_of_lines_and_columns_are_refused(save, tmp_path):
    """As pandas writes index and header, and instruments coordinates; whether or not the corner has a number."""
    h = SelfAffine().surface((40, 36), (100e-6, 90e-6), 3).heights * 1e6
    across, along = 2.5 * np.arange(36), np.arange(40)
    both = np.block([[np.full((1, 1), np.nan), np.arange(36)[None]], [along[:, None], h]])
    name = tmp_path / ("map.npy" if save is np.save else "map.txt")
    for heights, words in (
        (np.vstack([across, h]), "first line, from 2.5 to 87.5"),
        (np.column_stack([along, h]), "first column, from 1 to 39"),
        (both, "first line, from 0 to 35"),
        (np.column_stack([np.append(np.nan, 1e3 + along), np.vstack([-across, h])]), "first line, from -0 to -87.5"),
    ):
        save(name, heights)
        with pytest.raises(ValueError, match=f"at equal steps in its {words}, which number or place the others"):
            scan(name, **PLAIN)
    x, y = grid((40, 36), (100, 90))
    save(name, 0.2 * x - 0.1 * y)  # a plane has equal steps everywhere
    assert scan(name, **PLAIN).missing == 0
    save(name, h)
    assert np.ptp(scan(name, **PLAIN).map.heights) == pytest.approx(1e-6 * np.ptp(h))


# -- text that SurfaceTopography reads -----------------------------------------------------------------------
def gwyddion(h: np.ndarray, unit: str = "µm", sizes: str = "# Width: 90 µm\n# Height: 0.1 mm\n") -> str:
    rows = "\n".join(" ".join(f"{z:.6f}" for z in row) for row in h)
    return f"# Channel: Height\n{sizes}# Value units: {unit}\n{rows}\n"


@pytest.mark.parametrize("encoding", ["utf-8", "latin-1", "utf-16"])
def test_text_with_units_in_its_header(encoding, other, tmp_path):
    """Gwyddion's: 36 pixels a line, 40 lines; heights in µm, lengths in µm and mm."""
    h = SelfAffine().surface((40, 36), (100e-6, 90e-6), 3).heights * 1e6
    path = tmp_path / "map.txt"
    path.write_bytes(gwyddion(h).encode(encoding))
    found = scan(path)
    assert found.map.size == pytest.approx((90e-6, 100e-6)) and "channel Height, 36 x 40 pixels" in found.layout
    np.testing.assert_allclose(found.map.heights, 1e-6 * h.T, atol=1e-12)
    for given, words in (({"unit": "mm"}, "a unit of its own; give no 'unit'"), ({"pixel": (1, 1)}, "a size of its")):
        with pytest.raises(ValueError, match=words):
            scan(path, **given)
    path.write_bytes(gwyddion(h, "nm", sizes="").encode(encoding))
    assert scan(path, size=(90e-6, 100e-6)).map.pixel == pytest.approx((2.5e-6, 2.5e-6))
    with pytest.raises(ValueError, match="has no size; give 'size' or 'pixel'"):
        scan(path)


def test_koala_phase_map(other, tmp_path):
    """Radians with a conversion to m are heights; without it they are refused, whatever is given."""
    h = SelfAffine().surface((40, 36), (100e-6, 90e-6), 3).heights
    rows = "\n".join(" ".join(f"{z:.7g}" for z in row) for row in h / 1.06e-7)
    head = "h=40 w=36\npixel size=2.5e-006 m\ndata unit=rad\n"
    path = tmp_path / "phase.txt"
    path.write_text(f"{head}height conversion factor (-> m)=1.06e-007\n{rows}")
    found = scan(path).map
    assert found.size == pytest.approx((90e-6, 100e-6))
    np.testing.assert_allclose(found.heights, h.T, atol=1e-12)
    path.write_text(head + rows)
    with pytest.raises(ValueError, match="'h=40 w=36' in line 1 and no unit of heights .*; delete the lines above"):
        scan(path, **PLAIN)
    path.write_text(gwyddion(h, "rad"))
    with pytest.raises(ValueError, match="has no format that SurfaceTopography reads"):
        scan(path, **PLAIN)


def test_lines_that_a_reader_would_skip_are_refused(other, tmp_path):
    """SurfaceTopography reads a damaged line as a header, and points below it alone."""
    h = SelfAffine().surface((40, 36), (100e-6, 90e-6), 3).heights * 1e6
    lines = gwyddion(h).splitlines()
    lines[9] = lines[9].replace(" ", " x", 1)
    (tmp_path / "map.txt").write_text("\n".join(lines))
    with pytest.raises(ValueError, match="in line 10 among its numbers; export one map of numbers alone"):
        scan(tmp_path / "map.txt")
    (tmp_path / "map.xyz").write_text("# x (mm), y (mm), z (um)\n" + points())
    with pytest.raises(ValueError, match=r"'# x \(mm\), y \(mm\), z \(um\)' in line 1 and no unit of heights"):
        scan(tmp_path / "map.xyz", **PLAIN)
    (tmp_path / "map.xyz").write_text("0 0 1\n0 1 void\n" + points())
    with pytest.raises(ValueError, match="'0 1 void' in line 2 among its numbers"):
        scan(tmp_path / "map.xyz", **PLAIN)


def points() -> str:
    """Return a text of 4 x 3 points of which the heights are from 0 to 3."""
    return "\n".join(f"{0.002 * i:g} {0.003 * j:g} {i}" for i in range(4) for j in range(3))


def test_points(other, tmp_path):
    """Their coordinates have no unit, so that the lengths are given."""
    path = tmp_path / "map.xyz"
    path.write_text(points())
    with pytest.raises(ValueError, match="has no size; give 'size' or 'pixel'"):
        scan(path, unit="um")
    found = scan(path, unit="um", pixel=(2e-6, 3e-6)).map
    assert found.size == pytest.approx((8e-6, 9e-6)) and np.ptp(found.heights) == pytest.approx(3e-6)
    path.write_text("# Lateral units: mm\n# Value units: µm\n" + points(), encoding="utf-8")
    found = scan(path).map
    assert found.size == pytest.approx((8e-6, 9e-6)) and np.ptp(found.heights) == pytest.approx(3e-6)


def test_without_the_optional_package(monkeypatch, tmp_path):
    original = builtins.__import__

    def missing(name, *args, **kwargs):
        if name.startswith("SurfaceTopography"):
            raise ImportError(name)
        return original(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", missing)
    (tmp_path / "scan.vk4").write_bytes(b"\0")
    (tmp_path / "scan.txt").write_text("# Value units: nm\n1 2 3 4\n")
    for name, why in (("scan.vk4", "it is no text"), ("scan.txt", "line 1 has '#'")):
        with pytest.raises(ImportError, match=rf"no plain matrix of .* \({why}\).*install fingerpad\[topography\]"):
            scan(tmp_path / name)
    np.savetxt(tmp_path / "map.txt", np.eye(4))
    assert scan(tmp_path / "map.txt", **PLAIN).map.size == pytest.approx((4e-6, 4e-6))


def test_units_of_a_scene_are_those_of_the_reader():
    annotation = Topography.model_fields["unit"].annotation
    assert get_args(get_args(annotation)[0]) == tuple(UNITS)
