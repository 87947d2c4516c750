"""Folders of results with files that somebody else has written, or that are cut short: one sentence each."""

import json
import os
import shlex
import shutil
import struct
import tomllib
import zlib
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
import xarray
from PIL import Image

import fingerpad as fp
from fingerpad.cli import main
from fingerpad.report.page import picture, recipe
from fingerpad.report.write import write
from fingerpad.results import fields
from fingerpad.results.dataset import content
from fingerpad.results.files import Table, lock_file, read_object, replace
from fingerpad.results.folder import Folder, FolderError, Serial, full_scene
from fingerpad.results.pictures import style
from fingerpad.runs.checkpoint import Checkpoint
from fingerpad.runs.context import RunContext
from fingerpad.runs.solve import find, solved
from fingerpad.scene import Scene, SceneError
from variational.state import ContactState

DEEP = pytest.param("[" * 100_000 + "]" * 100_000, id="deep")
NO_SCENES = ("5", "[]", DEEP)


@pytest.mark.parametrize("text", NO_SCENES)
def test_scene_of_no_run_is_neither_continued_nor_replaced(tmp_path, text):
    (tmp_path / "scene.json").write_text(text)
    with pytest.raises(FolderError, match=r"has no scene\.json of a run"):
        full_scene(tmp_path)
    with pytest.raises(FolderError, match=r"holds scene\.json of an unknown scene"), Folder(tmp_path, {}, Serial()):
        pass
    assert (tmp_path / "scene.json").read_text() == text


def test_files_of_no_run_are_not_deleted(tmp_path):
    """Of a user, under a name that a run uses."""
    (tmp_path / "history.png").write_bytes(b"mine")
    with pytest.raises(FolderError, match=r"holds history\.png of an unknown scene"), Folder(tmp_path, {}, Serial()):
        pass
    assert (tmp_path / "history.png").read_bytes() == b"mine"


@pytest.mark.parametrize("text", ["5", "null", '{"a": ', "", DEEP])
def test_json_of_other_things(tmp_path, text):
    (tmp_path / "a.json").write_text(text)
    with pytest.raises(ValueError, match=r"a\.json holds no object|Expecting"):
        read_object(tmp_path / "a.json")


@pytest.fixture(scope="module")
def answered(tmp_path_factory) -> Path:
    """The folder of a closed form, which has a summary as a run has."""
    folder = tmp_path_factory.mktemp("cylinders") / "out"
    solved(Scene(), find("cylinders"), RunContext(folder))
    return folder


def changed(folder: Path, to: Path, **attributes: object) -> Path:
    """Return a copy of a folder whose dataset has other attributes."""
    copy = Path(shutil.copytree(folder, to))
    data = xarray.load_dataset(copy / "result.nc").assign_attrs(attributes)
    (copy / "result.nc").write_bytes(content(data))
    return copy


@pytest.mark.parametrize("key", ["parameters", "finger", "notes", "record", "outputs", "model", "format"])
@pytest.mark.parametrize("value", [5, "x", "[]", '{"a": [1]}', "[[1]]"])
def test_dataset_with_an_attribute_of_another_kind(answered, tmp_path, key, value):
    """The report is made, or refused in a sentence."""
    copy = changed(answered, tmp_path / "copy", **{key: value})
    try:
        write(copy)
    except SceneError as error:
        assert "copy" in str(error) or "must be" in str(error)


@pytest.mark.timeout(20)
@pytest.mark.parametrize("name", ["result.nc", "steps.csv", "footprint.png", "fields.npz"])
def test_pipes_in_a_folder_are_not_waited_for(answered, tmp_path, name):
    """Results are read without the file, which is no longer one."""
    copy = Path(shutil.copytree(answered, tmp_path / "copy"))
    (copy / name).unlink(missing_ok=True)
    os.mkfifo(copy / name)
    if name == "result.nc":
        with pytest.raises(SceneError, match="copy cannot be read: .* not an ordinary file"):
            fp.Result.load(copy)
    else:
        assert fp.Result.load(copy).full_slip is not None and write(copy).is_file()


@pytest.mark.parametrize("model", ["full --out ~; rm -rf ~ #", "$(rm x)", "`rm x`", "<script>", "a\nb", "", 5])
def test_model_that_is_no_name_is_refused(answered, tmp_path, capsys, model):
    """The report of a folder from elsewhere has a command to copy into a shell."""
    copy = changed(answered, tmp_path / "copy", model=model)
    (copy / "scene.json").write_text(json.dumps(json.loads((copy / "scene.json").read_text()) | {"model": model}))
    with pytest.raises(SceneError, match="model is .*; it must be the name of a model"):
        write(copy)
    assert main(["run", str(copy / "scene.json"), "--out", str(tmp_path / "again")]) == 2
    assert "it must be the name of a model" in capsys.readouterr().err


def test_values_in_the_recipe_of_a_report_are_quoted():
    """A scene file has them, with lists of tables as a whole; a shell gets the name of the model as one word."""
    text = "a 'b' $(rm x); \"rm x\" & <i>"
    history = [{"name": text, "f_ext": 5.0, "bone_x": None}]
    *lines, command = recipe({"finger": text, "mesh": {"contact": 5e-6}, "history": history}, "my model").splitlines()
    found = tomllib.loads("\n".join(lines))
    assert found == {"finger": text, "mesh": {"contact": 5e-6}, "history": [{"name": text, "f_ext": 5.0}]}
    assert shlex.split(command)[1:] == ["run", "mine.toml", "--model", "my model", "--out", "results/again"]


# -- pictures ------------------------------------------------------------------------------------------
def test_picture_beyond_all_bounds_is_left_out(tmp_path):
    """Its header gives 20 000 x 20 000 pixels, 1.2 GB in colours."""
    out = BytesIO()
    Image.new("RGB", (4, 4)).save(out, "PNG")
    data = out.getvalue()
    head = b"IHDR" + struct.pack(">II", 20_000, 20_000) + data[24:29]
    (tmp_path / "large.png").write_bytes(data[:12] + head + struct.pack(">I", zlib.crc32(head)) + data[33:])
    assert picture(tmp_path / "large.png") == picture(tmp_path / "none.png") == ""


STATE = ContactState(f_ext=1.0, voltage=0.0, f_t=0.0, mu_app=0.0, f_contact=1.0, f_electrostatic=0.0, load="a",
                     ridges_in_contact=1, contact_length=1e-3)  # fmt: skip
FINGER = {
    "x": np.zeros((3, 2)),
    "triangles": np.array([[0, 1, 2]]),
    "tag": np.zeros(1, dtype=np.int32),
    "lines": np.array([[0, 2, 1]]),
    "beside": np.array([[0, -1]]),
}
END = {
    "bone_x": 0.0, "mesh": 0, "u": np.zeros((3, 2)), "sed": np.zeros(1), "stress": np.zeros((1, 4)),
    "strain": np.zeros((1, 3)),
}  # fmt: skip


@pytest.mark.parametrize(
    ("group", "changes"),
    [
        ("meshes/0", {"triangles": np.array([[0, 1, 3]])}),
        ("meshes/0", {"lines": np.array([[0, 3, 1]])}),
        ("meshes/0", {"beside": np.array([[0, 1]])}),
        ("loads/a", {"sed": np.zeros(2)}),
        ("loads/a", {"u": np.zeros(3)}),
        ("loads/a", {"skin": np.zeros((3, 5))}),
    ],
)
def test_arrays_of_no_finger_are_none(tmp_path, group, changes):
    groups = {"meshes/0": FINGER, "loads/a": END}
    fields.write(tmp_path, groups)
    assert fields.views_of(tmp_path, [STATE], {})[0]["a"].snapshot.beside.tolist() == [[0, -1]]
    fields.write(tmp_path, groups | {group: groups[group] | changes})
    assert fields.views_of(tmp_path, [STATE], {}) == ({}, {})


# -- symbolic links --------------------------------------------------------------------------------------------------
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


@pytest.mark.parametrize("name", ["steps.csv", "run.log", "finger_press.png", "scene.json", "checkpoint", "fields.npz"])
@pytest.mark.parametrize("target", ["victim", "none", "."])
def test_link_under_the_name_of_a_result_is_refused(out, victim, name, target):
    (out / name).symlink_to(victim / target)
    with pytest.raises(FolderError, match=f"{name} in .*out is a symbolic link, through which"):
        Folder(out, {}, Serial()).__enter__()


def test_folder_of_the_program_is_no_link(out, victim):
    (out / "full").symlink_to(victim)
    with pytest.raises(SceneError, match="full in .* is a symbolic link"):
        fp.sweep(out=out, voltage=[100], quiet=True)


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
    assert json.loads((out / "checkpoint" / "head.json").read_text())["format"] > 0


def test_sweep_leaves_a_table_of_the_user(out):
    (out / "table.csv").write_text("mine")
    with pytest.raises(SceneError, match=r"holds table\.csv of no sweep; choose another folder"):
        fp.sweep(out=out, model="cylinders", voltage=[100])
    assert (out / "table.csv").read_text() == "mine"
