"""No symbolic link in a folder of results leads to a file or a folder elsewhere that is written, emptied or deleted."""

import json
import os
from pathlib import Path

import numpy as np
import pytest

import fingerpad as fp
from fingerpad.cli import main
from fingerpad.results import style
from fingerpad.results.checkpoint import Checkpoint
from fingerpad.results.files import Table, lock_file, replace
from fingerpad.results.folder import Folder, FolderError, Serial
from fingerpad.scene import SceneError


@pytest.fixture
def victim(tmp_path) -> Path:
    """A folder of a user with a file; nothing in it changes."""
    folder = tmp_path / "home"
    folder.mkdir()
    (folder / "victim").write_text("mine")
    yield folder
    assert [(file.name, file.read_text()) for file in folder.iterdir()] == [("victim", "mine")]


@pytest.fixture
def out(tmp_path) -> Path:
    (tmp_path / "out").mkdir()
    return tmp_path / "out"


def test_lock_keeps_what_it_opens(out, victim):
    """Neither a link, nor a link to nothing, nor a pipe is opened; an ordinary file keeps its content."""
    (out / ".lock").symlink_to(victim / "victim")
    with pytest.raises(FolderError, match=r"out: \.lock in it is no ordinary file; choose another"):
        Folder(out, {}, Serial()).__enter__()
    (out / "lock").symlink_to(victim / "none")
    os.mkfifo(out / "pipe")
    for name in ("lock", "pipe"):
        with pytest.raises(OSError, match=f"{name} in it is no ordinary file"):
            lock_file(out / name)
    (out / "mine").write_text("mine")
    lock_file(out / "mine").close()
    assert (out / "mine").read_text() == "mine"


@pytest.mark.parametrize("name", ["steps.csv", "run.log", "finger_press.png", "scene.json", "checkpoint", "sed.bp"])
@pytest.mark.parametrize("target", ["victim", "none", "."])
def test_link_under_the_name_of_a_result_is_refused(out, victim, name, target):
    (out / name).symlink_to(victim / target)
    with pytest.raises(FolderError, match=f"{name} in .*out is a symbolic link, through which"):
        Folder(out, {}, Serial()).__enter__()


@pytest.mark.parametrize(
    ("name", "start"),
    [
        ("full", lambda out: fp.sweep(out=out, voltage=[100], quiet=True)),
        ("full", lambda out: main(["compare", "--out", str(out), "--model", "full", "--quiet"]) and None),
    ],
)
def test_folder_of_the_program_is_no_link(out, victim, name, start, capsys):
    (out / name).symlink_to(victim)
    try:
        start(out)
        said = capsys.readouterr().out
    except SceneError as error:
        said = str(error)
    assert f"{name} in " in said and "is a symbolic link" in said


def test_point_of_a_sweep_is_no_link(out, victim, monkeypatch):
    from fingerpad.runs import batch

    scene = fp.Scene()
    (out / batch.key(scene)).symlink_to(victim)
    with pytest.raises(SceneError, match="is a symbolic link, and results are to be in the folder itself"):
        batch.sweep({"a": scene}, out, quiet=True)


def test_writers_take_the_place_of_a_link(out, victim):
    """Where one comes after the folder was taken, or has another name: a table, a picture, a page, a checkpoint."""
    for name in ("a.csv", "a.png", "a.html", "checkpoint"):
        (out / name).symlink_to(victim / ("victim" if "." in name else ""))
    Table(out / "a.csv", {"x": 1}).close()
    style.save(style.figure(1.0), out / "a.png")
    replace(out / "a.html", "page")
    Checkpoint(out, {}, {}).write({"x": np.zeros(1)})
    assert not any((out / name).is_symlink() for name in ("a.csv", "a.png", "a.html", "checkpoint"))
    assert json.loads((out / "checkpoint" / "head.json").read_text())["format"] == 1


def test_mesh_of_a_check_is_written_through_no_link(out, victim):
    (out / "mesh.png").symlink_to(victim / "victim")
    assert main(["check", "demos/scenes/small_finger.toml", "--out", str(out)]) == 0
    assert not (out / "mesh.png").is_symlink()


def test_sweep_leaves_a_table_of_the_user(out):
    (out / "table.csv").write_text("mine")
    with pytest.raises(SceneError, match=r"holds table\.csv of no sweep; choose another folder"):
        fp.sweep(out=out, model="cylinders", voltage=[100])
    assert (out / "table.csv").read_text() == "mine"


def test_folder_may_be_reached_by_a_link(out, tmp_path):
    """Of the user; and its other links are no concern of a run."""
    (tmp_path / "link").symlink_to(out)
    (out / "latest").symlink_to(tmp_path)
    fp.run(model="cylinders", out=tmp_path / "link")
    assert (out / "summary.json").exists()
