"""The folder of results is one scene's and one run's at a time, and no earlier run is lost for nothing."""

import errno
import fcntl
import json
from pathlib import Path

import pytest
from mpi4py import MPI

import fingerpad as fp
from fingerpad.results.folder import LEFT, Folder, FolderError, on_rank_0
from fingerpad.scene import Scene, from_data
from tests.runs import run

MESH = {"contact": 30e-6, "receptor": 80e-6, "interface": 150e-6, "growth": 0.8, "touching_half_arc": 1.3e-3}
LOADS = [{"name": "press", "bone_height": -30e-6}, {"name": "slide", "bone_x": 5e-6}]
PRESS = {"mesh": MESH, "history": LOADS, "geometry": {"ridge_count": 9}, "output": {"errors": False}}


@pytest.fixture
def scene():
    return from_data(PRESS)


@pytest.fixture
def folder(tmp_path) -> Path:
    """A folder that all ranks share."""
    return Path(MPI.COMM_WORLD.bcast(str(tmp_path))) / "results"


@pytest.fixture
def finished(scene, folder) -> dict[str, bytes]:
    """A folder with what an earlier run of the scene may have left."""
    with Folder(folder, scene.parameters(), MPI.COMM_WORLD) as place:
        place.take()
    for name in ("summary.json", "steps.csv", "finger_press.png", "time.png", "footprint.png", "notes of mine.txt"):
        (folder / name).write_text("old")
    return {file.name: file.read_bytes() for file in folder.iterdir() if file.is_file()}


def kept(folder: Path) -> dict[str, bytes]:
    return {file.name: file.read_bytes() for file in folder.iterdir() if file.is_file()}


def test_the_same_scene_may_run_again(scene, folder, finished):
    """What it left goes as a whole when there is something new, and what is no result stays."""
    with Folder(folder, scene.parameters(), MPI.COMM_WORLD) as place:
        assert kept(folder) == finished
        place.take()
    assert set(kept(folder)) == {".lock", "scene.json", "notes of mine.txt"}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"friction": 0.3}, "friction was 0.25, and is 0.3 now"),
        ({"history": [{"name": "press", "bone_height": -31e-6}]}, "history differs"),
    ],
)
def test_another_scene_is_refused(folder, finished, change, words):
    with pytest.raises(FolderError, match="holds the results of another scene") as refusal:
        run(from_data(PRESS | change), folder, MPI.COMM_WORLD)
    assert words in str(refusal.value) and "choose another folder" in str(refusal.value)
    assert kept(folder) == finished


def test_one_run_at_a_time(scene, folder, finished):
    with (folder / ".lock").open() as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        with pytest.raises(FolderError, match="another run is writing to"):
            run(scene, folder, MPI.COMM_WORLD)
        assert kept(folder) == finished
    with Folder(folder, scene.parameters(), MPI.COMM_WORLD), pytest.raises(FolderError, match="another run"):
        Folder(folder, scene.parameters(), MPI.COMM_WORLD).__enter__()
    with Folder(folder, scene.parameters(), MPI.COMM_WORLD):  # it is free again
        pass


@pytest.mark.mpi
def test_refused_on_all_ranks(scene, folder):
    """The folder is a file: the first rank finds out, and all say so."""
    if MPI.COMM_WORLD.rank == 0:
        folder.touch()
    MPI.COMM_WORLD.barrier()
    with pytest.raises(FolderError, match="results cannot be written to .*results: File exists; choose another folder"):
        run(scene, folder, MPI.COMM_WORLD)


@pytest.mark.mpi
def test_full_disk_is_told_on_all_ranks():
    """The first rank writes; the others would wait for it."""

    def write():
        raise OSError(errno.ENOSPC, "No space left on device", "summary.json")

    with pytest.raises(OSError, match="No space left on device") as full:
        on_rank_0(MPI.COMM_WORLD, write)
    assert (full.value.errno, full.value.filename) == (errno.ENOSPC, "summary.json")
    assert on_rank_0(MPI.COMM_WORLD, lambda: 3) == 3


@pytest.mark.mpi
def test_mesh_file_is_known_by_its_content(folder):
    """A project may be moved; other content is another scene."""
    kept = [{"geometry": {"file": file, "file_sha256": sum_}} for file, sum_ in (("a", "1"), ("b", "1"), ("b", "2"))]
    with Folder(folder, kept[0], MPI.COMM_WORLD) as place:
        place.take()
    with Folder(folder, kept[1], MPI.COMM_WORLD):
        pass
    with pytest.raises(FolderError, match=r"its geometry\.file_sha256 was 1, and is 2 now"):
        Folder(folder, kept[2], MPI.COMM_WORLD).__enter__()


@pytest.mark.mpi
def test_model_without_a_path_is_of_all_ranks(folder, monkeypatch):
    """One rank writes, whatever a batch system calls it; all have the same result, and all are refused."""
    monkeypatch.setenv("SLURM_PROCID", "1")
    for given in ({}, {"force": 0.5}):
        out = folder / str(len(given))
        found = fp.run(Scene(**given), model="cylinders", out=out)
        folders = MPI.COMM_WORLD.allgather(found.folder)
        assert folders == [out.absolute()] * MPI.COMM_WORLD.size
        assert (out / "summary.json").exists()
        with pytest.raises(FolderError, match="another scene"):
            fp.run(Scene(friction=0.1, **given), model="cylinders", out=out)


def test_a_crash_before_the_first_step_leaves_the_last_one(scene, folder, finished, monkeypatch):
    def crash(*_):
        raise ZeroDivisionError

    monkeypatch.setattr("fingerpad.runs.full.Simulation", crash)
    with pytest.raises(ZeroDivisionError):
        run(scene, folder, MPI.COMM_WORLD)
    assert kept(folder) == finished


@pytest.mark.slow
def test_a_run_takes_the_folder(scene, folder, finished):
    """Every file of its own is one that the next run deletes, and none of the earlier run's is left."""
    summary = run(scene, folder, MPI.COMM_WORLD)
    left = {file.name for file in folder.iterdir()} - {".lock", "scene.json", "notes of mine.txt"}
    assert left == {file.name for pattern in LEFT for file in folder.glob(pattern)}
    assert {"steps.csv", "summary.json", "run.log", "finger.png"} <= left
    assert json.loads((folder / "scene.json").read_text()) == json.loads(json.dumps(scene.parameters()))
    assert [name for name, data in kept(folder).items() if data == b"old"] == ["notes of mine.txt"]
    assert summary["provenance"]["petsc_options"]["-fingerpad_pc_type"] == "lu"
