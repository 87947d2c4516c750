"""The folder of results is one scene's and one run's at a time; checkpoints, and ranks of different scenes."""

import errno
import fcntl
import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from mpi4py import MPI

import fingerpad as fp
from fingerpad.results.folder import LEFT, CheckpointError, Folder, FolderError, on_rank_0
from fingerpad.runs.checkpoint import Checkpoint
from fingerpad.runs.solve import _refuse_different
from fingerpad.scene import Scene, SceneError, from_data
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


# -- ranks of MPI that are given different scenes are refused; each would wait for the others for ever ---------------
@pytest.mark.parametrize(
    ("other", "words"),
    [
        (fp.Scene(voltage=100), "voltage is 200 on rank 0 of MPI and 100 on rank 2"),
        (fp.Scene(history=[{"name": "press", "f_ext": 75}]), "f_ext is 75 on rank 0 of MPI and empty on rank 2"),
    ],
)
def test_first_key_that_differs_is_named(other, words):
    comm = SimpleNamespace(allgather=lambda mine: [mine, mine, flat(other)])
    with pytest.raises(SceneError, match=words):
        _refuse_different(fp.Scene(), comm)


def flat(scene):
    kept = []
    _refuse_different(scene, SimpleNamespace(allgather=lambda mine: kept.append(mine) or [mine]))
    return kept[0]


@pytest.mark.mpi
def test_different_scenes_are_refused_on_all_ranks():
    rank, size = MPI.COMM_WORLD.rank, MPI.COMM_WORLD.size
    scene = fp.Scene(f_ext=50 + rank, mesh={"contact": 1e-3})  # of which no finger can be meshed
    words = "f_ext is 50 on rank 0 of MPI and 51 on rank 1" if size > 1 else "mesh.contact"
    with pytest.raises(SceneError, match=words):
        fp.run(scene)


# -- checkpoints of a list that grows: what was written is not written again, and each of the last two has all of it -
HEAD = {"source": "a"}


def checkpoint(folder: Path) -> Checkpoint:
    return Checkpoint(folder, {}, HEAD)


def items(first: int, count: int) -> list[np.ndarray]:
    return [np.arange(1000.0) + k for k in range(first, first + count)]


def read(folder: Path) -> tuple[int, list[int]]:
    """The number that was kept, and the items by their first values."""
    from_there = checkpoint(folder)
    found = from_there.read()
    return found["number"], [int(each[0]) for each in found["items"]]


def test_items_are_written_once(tmp_path):
    """The file of what is new has the size of what is new, however long the list is."""
    kept, grown = checkpoint(tmp_path), list[np.ndarray]()
    for number in range(1, 6):
        grown += items(2 * len(grown), 2)
        kept.write({"number": number}, grown)
    sizes = [file.stat().st_size for file in sorted((tmp_path / "checkpoint").glob("*.more.npz"))]
    assert len(sizes) == 5
    assert max(sizes) < 2.2 * 8000
    assert max(file.stat().st_size for file in (tmp_path / "checkpoint").glob("????.npz")) < 2000
    assert read(tmp_path) == (5, [int(each[0]) for each in grown])


def test_goes_on_from_the_one_before(tmp_path):
    """The last one is gone; what follows is written over what it had."""
    kept, grown = checkpoint(tmp_path), items(0, 2)
    for number in (1, 2, 3):
        kept.write({"number": number}, grown)
        grown = [*grown, *items(10 * number, 1)]
    (tmp_path / "checkpoint" / "0003.npz").unlink()
    again = checkpoint(tmp_path)
    found = again.read()
    assert [int(each[0]) for each in found["items"]] == [0, 1, 10]
    again.write({"number": 3}, [*found["items"], *items(70, 1)])
    assert read(tmp_path) == (3, [0, 1, 10, 70])


def test_damaged_items(tmp_path):
    """Of the last checkpoint, and of an earlier one."""
    kept, grown = checkpoint(tmp_path), items(0, 2)
    kept.write({"number": 1}, grown)
    kept.write({"number": 2}, [*grown, *items(5, 1)])
    more = tmp_path / "checkpoint" / "0002.more.npz"
    whole = more.read_bytes()
    more.write_bytes(whole[:100])
    with pytest.raises(CheckpointError, match=r"0002\.more\.npz cannot be read .*; delete the last checkpoint"):
        read(tmp_path)
    more.write_bytes(whole)
    (tmp_path / "checkpoint" / "0001.more.npz").unlink()
    with pytest.raises(CheckpointError, match=r"0001\.more\.npz cannot be read .* run again without --resume"):
        read(tmp_path)
