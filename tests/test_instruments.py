"""Height maps as instruments and NumPy keep them: what is read, and one sentence for what cannot be."""

import importlib

import numpy as np
import pytest
import scipy.io

from variational.roughness.heightfile import scan


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
        ({"missing": "void"}, "has numbers alone"),
    ):
        with pytest.raises(ValueError, match=sentence):
            scan(path, **given)


def test_instrument_without_them(tmp_path):
    """A format in which SurfaceTopography finds neither: both have to be given."""
    pytest.importorskip("SurfaceTopography", reason="pip install fingerpad[topography]")
    path, h = tmp_path / "map.npz", np.random.default_rng(1).normal(size=(6, 8))
    np.savez(path, h=h)
    found = scan(path, size=(3e-6, 4e-6), unit="um").map
    np.testing.assert_allclose(found.heights, h * 1e-6, rtol=1e-12)
    assert found.size == (3e-6, 4e-6)
    with pytest.raises(ValueError, match="holds numbers without a unit; give 'unit'"):
        scan(path, size=(3e-6, 4e-6))
    with pytest.raises(ValueError, match="has no size; give 'size' or 'pixel'"):
        scan(path, unit="um")


def test_channel_of_heights_is_taken(tmp_path):
    """A phase stands before it in an AFM's file; alone it is refused."""
    surface = pytest.importorskip("SurfaceTopography", reason="pip install fingerpad[topography]")
    reader = importlib.import_module("SurfaceTopography.IO.Reader")
    h = np.random.default_rng(1).normal(size=(6, 8))

    class Two:
        def __init__(self, kinds):
            self.channels = [
                reader.ChannelInfo(self, k, name=kind, dim=2, unit="um", physical_sizes=(3.0, 4.0), data_unit=kind)
                for k, kind in enumerate(kinds)
            ]

        name, format, height_channels = (lambda self: "AFM"), (lambda self: "afm"), reader.ReaderBase.height_channels

        def topography(self, channel_index, **_):
            return surface.Topography((channel_index + 1) * h, (3.0, 4.0), unit="um")

    (tmp_path / "map.afm").write_bytes(b"\0")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(surface, "open_topography", lambda path: Two(["rad", "um"]))
        found = scan(tmp_path / "map.afm")
        np.testing.assert_allclose(found.map.heights, 2e-6 * h)
        assert found.layout == "AFM, channel um, 6 x 8 pixels"
        patch.setattr(surface, "open_topography", lambda path: Two(["rad"]))
        with pytest.raises(ValueError, match="as AFM .it holds no map of heights."):
            scan(tmp_path / "map.afm")


@pytest.mark.parametrize(
    ("name", "content", "sentence"),
    [
        ("gray.tif", "picture", r"read by SurfaceTopography as JPK image scan \(it holds no map of heights\); export"),
        ("cut.mat", "cut", r"cannot be read by SurfaceTopography as MATLAB \(\w+Error: .*\); export"),
        ("empty.x3p", b"", "empty.x3p holds no heights"),
        ("empty.ibw", b"", "empty.ibw holds no heights"),
        ("other.sur", b"DIGITAL SURF", "has no format that SurfaceTopography reads"),
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


@pytest.mark.parametrize("kind", [complex, "<U3", "M8[s]", object, [("z", float)]])
def test_matrix_without_real_numbers(tmp_path, kind):
    """Without its imaginary part a height would be another one."""
    np.save(tmp_path / "map.npy", np.zeros((8, 8)).astype(kind), allow_pickle=True)
    with pytest.raises(ValueError, match="map.npy is no matrix of numbers: "):
        scan(tmp_path / "map.npy", "um", (1e-3, 1e-3))


@pytest.mark.parametrize("header", ["{'descr': '<f8', 'fortran_order': False, 'shape': (10000000, 10000000), }", "["])
def test_matrix_with_a_header_that_cannot_be(tmp_path, header):
    """Of 800 TB in a file of some bytes, and one that is no Python."""
    (tmp_path / "map.npy").write_bytes(b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header.encode())
    with pytest.raises(ValueError, match="map.npy is no matrix of numbers: "):
        scan(tmp_path / "map.npy", "um", (1e-3, 1e-3))
