"""Height maps from files: formats, missing heights, and what is refused."""

import builtins
import re
from pathlib import Path

import numpy as np
import pytest
import scipy.io

from tests.test_topography import grid
from variational.roughness.heightfile import _refuse_mark, scan
from variational.roughness.spectrum import SelfAffine
from variational.roughness.topography import filled


@pytest.fixture
def other():
    return pytest.importorskip("SurfaceTopography", reason="pip install fingerpad[topography]")


# -- missing pixels ----------------------------------------------------------------------------------------
@pytest.mark.parametrize("pixels", [1, 40, 1000])
@pytest.mark.parametrize("value", [-9999.0, -3.4028234663852886e38])
def test_unfilled_value_is_refused(value, pixels, tmp_path):
    """Of heights of some µm; 1000 of 1440 pixels are more than the quartiles bear. As a mark it is missing."""
    path, h = tmp_path / "map.csv", smooth()
    h.ravel()[:pixels] = value
    np.savetxt(path, h, delimiter=",")
    text = repr(value).removesuffix(".0")
    with pytest.raises(ValueError, match=re.escape(f"has {text} at {pixels} pixels, far from all other heights")):
        scan(path, **PLAIN)
    if pixels == 40:
        assert scan(path, **PLAIN, missing=text).missing == pixels


@pytest.mark.parametrize("width", [1, 20])
def test_deep_grooves_are_no_marks(width):
    """Walls are steep and 1000 interquartile ranges deep, but the floor has heights of its own."""
    h = 0.1 * np.random.default_rng(1).normal(size=(64, 64))
    h[30 : 30 + width] -= 135.0
    _refuse_mark(Path("map"), h)
    _refuse_mark(Path("map"), np.zeros((4, 4)))


@pytest.mark.parametrize("turn", [False, True])
@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (
            lambda h: np.vstack([np.append([40, 36, 2.5, 2.5], np.zeros(32)), h]),
            "from {} 1 to 2, .* the first {} seems",
        ),
        (lambda h: np.vstack([h, np.arange(36)]), "from {} 40 to 41, .* the last {} seems"),
        (
            lambda h: h + np.where(np.arange(40) < 21, 0, 20.0)[:, None],
            "from {} 21 to 22, .* stitched",
        ),
    ],
)
def test_lines_that_are_no_part_of_the_surface_are_refused(tmp_path, wrong, words, turn):
    """Of 2.6 µm each makes an rms height of 3 to 10 µm."""
    h = wrong(smooth())
    np.save(tmp_path / "map.npy", h.T if turn else h)
    with pytest.raises(ValueError, match=words.replace("{}", "column" if turn else "line")):
        scan(tmp_path / "map.npy", **PLAIN)
    assert scan(tmp_path / "map.npy", **PLAIN, missing="nan").map.h_rms > 3e-6


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


@pytest.mark.parametrize(
    ("text", "rows"),
    [
        ("1 2 3 4\n5 6 7 8\n9 9 9 9", [[1, 2, 3, 4], [5, 6, 7, 8], [9, 9, 9, 9]]),
        ("1.5, 2, 3, 4\r\n5, 6, 7, 8\r\n9,9,9,9", [[1.5, 2, 3, 4], [5, 6, 7, 8], [9, 9, 9, 9]]),
        ("1\t2\t\t4\n5\t6\tnan\t8\n9\t9\t9\t9", [[1, 2, np.nan, 4], [5, 6, np.nan, 8], [9, 9, 9, 9]]),
    ],
)
@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
def test_plain_matrix(text, rows, encoding, tmp_path):
    """A pixel is missing where the place is empty or holds nan; it is filled."""
    (tmp_path / "map.txt").write_bytes(text.encode(encoding))
    found, known = scan(tmp_path / "map.txt", "um", pixel=(1e-6, 1e-6)), np.isfinite(rows)
    np.testing.assert_array_equal(found.map.heights[known], 1e-6 * np.array(rows)[known])
    assert found.missing == np.count_nonzero(~known)


PLAIN = {"unit": "um", "pixel": (1e-6, 1e-6)}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1 2 3 4\n1 2 3", "line 2 has 3 numbers and the first one 4"),
        ("1,5;2,5;3;4\n1;2;3;4", "with decimal points .line 1 has '1,5'."),
        ("a,0,1,2\n0,5,6,3\n1,7,8,9", "save the heights alone, without names and numbers of lines and columns"),
    ],
)
def test_text_that_is_no_plain_matrix(text, message, other, tmp_path):
    (tmp_path / "map.csv").write_text(text)
    with pytest.raises(ValueError, match=message):
        scan(tmp_path / "map.csv", **PLAIN)


def smooth(shape=(40, 36), seed: int = 3) -> np.ndarray:
    """Heights (µm) of a self-affine surface, in pixels of 2.5 µm."""
    return SelfAffine().surface(shape, (2.5e-6 * shape[0], 2.5e-6 * shape[1]), seed).heights * 1e6


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


# -- Height maps as instruments and NumPy keep them: what is read, and one sentence for what cannot  ---
def test_instrument_with_a_size_and_unit_of_its_own(tmp_path):
    """Heights in um over 3 x 4 um; what the file has is not to be given too."""
    surface = pytest.importorskip("SurfaceTopography", reason="pip install fingerpad[topography]")
    path, h = tmp_path / "map.nc", np.random.default_rng(1).normal(size=(6, 8))
    surface.Topography(h, (3.0, 4.0), unit="um").to_netcdf(path)
    found = scan(path).map
    np.testing.assert_allclose(found.heights, h * 1e-6, rtol=1e-12)
    assert found.size == pytest.approx((3e-6, 4e-6), rel=1e-12)
    for given, sentence in (
        ({"size": (3e-6, 4e-6)}, "has a size of its own; give none"),
        ({"unit": "um"}, "has a unit of its own; give no 'unit'"),
        ({"missing": "void"}, "it must be a number"),
    ):
        with pytest.raises(ValueError, match=sentence):
            scan(path, **given)


@pytest.mark.parametrize(
    ("name", "content", "sentence"),
    [
        ("gray.tif", "picture", r"read by SurfaceTopography as JPK image scan \(it holds no map of heights\); export"),
        ("cut.mat", "cut", r"cannot be read by SurfaceTopography as MATLAB \(\w+Error: .*\); export"),
        ("words.vk4", b"no map", "no format that SurfaceTopography reads"),
    ],
)
def test_instrument_that_is_none(tmp_path, capfd, name, content, sentence):
    """One sentence, whatever a reader raises, and no word of a library beside it."""
    pytest.importorskip("SurfaceTopography", reason="pip install fingerpad[topography]")
    path = tmp_path / name
    if content == "picture":
        image = pytest.importorskip("PIL.Image")
        image.fromarray(np.arange(1500, dtype=np.uint16).reshape(30, 50)).save(path)
    elif content == "cut":
        scipy.io.savemat(path, {"z": np.eye(8)}, format="4")
        path.write_bytes(path.read_bytes()[:100])
    else:
        path.write_bytes(content)
    with pytest.raises(ValueError, match=sentence) as refused:
        scan(path, "um", (3e-6, 5e-6))
    assert "\n" not in str(refused.value) and capfd.readouterr() == ("", "")


@pytest.mark.parametrize("kind", [complex, object, "a header of 800 TB"])
def test_matrix_without_real_numbers(tmp_path, kind):
    """Without its imaginary part a height would be another one; in a file of some bytes there are no 800 TB."""
    if isinstance(kind, str):
        header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (10000000, 10000000), }"
        (tmp_path / "map.npy").write_bytes(b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header)
    else:
        np.save(tmp_path / "map.npy", np.zeros((8, 8)).astype(kind), allow_pickle=True)
    with pytest.raises(ValueError, match="map.npy is no matrix of numbers: "):
        scan(tmp_path / "map.npy", "um", (1e-3, 1e-3))
