"""Files of a user, at every door: ordinary, bounded, and read with nothing beside them."""

import os
from functools import partial
from pathlib import Path

import gmsh
import numpy as np
import pytest

from fingerpad.measurements.table import read as measurements
from fingerpad.scene import SceneError, from_data, load
from geometry.meshfile import file as mesh
from geometry.profiles import GeometryError
from geometry.shape import session
from tests.test_meshfile import write
from variational import files
from variational.roughness.heightfile import scan

ROOT = Path(__file__).resolve().parents[1]


def voltages(path: Path) -> None:
    from_data({"history": [{"name": "hold", "duration": 0.1, "voltage": {"waveform": "file", "file": str(path)}}]})


def topography(path: Path) -> None:
    from_data({"roughness": {"topography": {"file": str(path), "unit": "um", "size": [1e-3, 1e-3]}}})


DOORS = {
    "scene": (load, "a.toml"),
    "scene.json": (load, "scene.json"),
    "voltages": (voltages, "a.csv"),
    "measurements": (measurements, "a.csv"),
    "topography": (topography, "a.csv"),
    "matrix": (scan, "a.npy"),
    "text": (scan, "a.csv"),
    "instrument": (scan, "a.sur"),
    "mesh": (mesh, "a.msh"),
    "geometry.file": (lambda path: from_data({"geometry": {"file": str(path)}}), "a.msh"),
}


@pytest.fixture(params=DOORS)
def door(request, tmp_path):
    """A function that reads a file, and a path for it."""
    call, name = DOORS[request.param]
    return partial(_sentence, call), tmp_path / name


def _sentence(call, path) -> str:
    with pytest.raises((SceneError, GeometryError, OSError)) as refused:
        (call(path) if call is not mesh else call(path)())
    return str(refused.value)


@pytest.mark.timeout(20)
def test_pipes_and_devices_are_refused_at_once(door):
    """Nobody writes into the pipe, and /dev/zero has no end."""
    sentence, path = door
    os.mkfifo(path)
    assert "it is not an ordinary file" in sentence(path)
    path.unlink()
    path.symlink_to("/dev/zero")
    assert "it is not an ordinary file" in sentence(path)


@pytest.mark.timeout(20)
def test_large_files_are_refused_unread(door):
    """20 GB of nothing, of which no memory could hold a copy."""
    sentence, path = door
    with path.open("wb") as file:
        file.truncate(20 * 10**9)
    assert "it has 20000 MB, and at most" in sentence(path)


def test_copy_is_alone_and_goes(tmp_path):
    """Its folder is the user's, and the one that is worked in; afterwards all is as before."""
    before = Path.cwd()
    with files.alone(b"12", "a.b") as path:
        assert (path.read_bytes(), os.listdir()) == (b"12", ["a.b"])
        assert path.parent == Path.cwd() and path.parent.stat().st_mode & 0o777 == 0o700
    assert not path.exists() and Path.cwd() == before


# -- what libraries would read by themselves ---------------------------------------------------------------
@pytest.mark.parametrize("name", ["mine.msh.opt", ".gmsh-options", ".gmshrc"])
def test_neighbours_of_a_mesh_are_not_run(tmp_path, monkeypatch, name):
    """gmsh merges NAME.msh.opt with NAME.msh; the control shows that it does."""
    path, script = write(tmp_path / "mine.msh"), tmp_path / name
    script.write_text(f'SystemCall "touch {tmp_path}/run";\nMesh.MeshSizeFactor = 2;\n', encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    with session("file"):
        mesh(path)()
        assert gmsh.option.getNumber("Mesh.MeshSizeFactor") == 1
        assert not (tmp_path / "run").exists()
        if name == "mine.msh.opt":
            gmsh.merge(str(path))
            assert (tmp_path / "run").exists()


@pytest.mark.parametrize("code", ["import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", "while True: pass"])
def test_damaged_mesh_does_not_end_the_program(tmp_path, monkeypatch, code):
    """Wrong numbers may end the process in which gmsh reads them, or keep it; which ones depends on its version."""
    path = write(tmp_path / "mine.msh")
    monkeypatch.setattr("geometry.meshfile._TRY", code)
    monkeypatch.setattr("geometry.meshfile._SECONDS", (0.5, 0.0))
    with session("file"), pytest.raises(GeometryError, match="gmsh cannot read the mesh, which is damaged"):
        mesh(path)()


def test_links_of_a_map_lead_nowhere(tmp_path, monkeypatch):
    """Heights of an HDF5 file may be kept in another one, which HDF5 looks for in the current folder."""
    h5py = pytest.importorskip("h5py", reason="pip install fingerpad[topography]")
    pytest.importorskip("SurfaceTopography", reason="pip install fingerpad[topography]")
    monkeypatch.chdir(tmp_path)
    np.arange(64.0).tofile("beside.raw")
    with h5py.File("map.h5", "w") as file:
        file.create_dataset("z", (8, 8), float, external=[("beside.raw", 0, 512)])
    with h5py.File("map.h5") as file:
        assert file["z"][7, 7] == 63  # HDF5 by itself
    with pytest.raises(ValueError, match=r"map\.h5"):
        scan("map.h5", (1.0, 1.0), "um")
