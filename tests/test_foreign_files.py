"""Folders of results with files that somebody else has written, or that are cut short: one sentence each."""

import json
import os
import shutil
import struct
import zlib
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from fingerpad.reduced import cylinders
from fingerpad.reduced.models import find
from fingerpad.report.page import picture
from fingerpad.report.write import write
from fingerpad.results.drawing import finger_of
from fingerpad.results.files import read_object
from fingerpad.results.folder import Folder, FolderError, Serial, full_scene
from fingerpad.runs.context import RunContext
from fingerpad.runs.solve import solved
from fingerpad.scene import Scene, SceneError

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


def test_json_that_never_ends(tmp_path):
    """A pipe that nobody writes to, and a sparse file of a terabyte, are not read at all."""
    os.mkfifo(tmp_path / "pipe")
    with (tmp_path / "sparse").open("wb") as file:
        file.truncate(10**12)
    for name in ("pipe", "sparse"):
        with pytest.raises(ValueError, match=f"{name} is no ordinary file of at most"):
            read_object(tmp_path / name)


@pytest.fixture(scope="module")
def answered(tmp_path_factory) -> Path:
    """The folder of a closed form, which has a summary as a run has."""
    folder = tmp_path_factory.mktemp("cylinders") / "out"
    solved(Scene(), find("cylinders"), RunContext(folder))
    return folder


@pytest.mark.parametrize("key", ["full_slip_mu_app", "parameters", "finger", "notes", "provenance", "asked", "laws"])
@pytest.mark.parametrize("value", [5, "x", [], {"a": [1]}, [[1]]])
def test_summary_with_a_value_of_another_kind(answered, tmp_path, key, value):
    """The report is made, or refused in a sentence; so is a run that another model is to take its contact from."""
    copy = Path(shutil.copytree(answered, tmp_path / "copy"))
    summary = json.loads((copy / "summary.json").read_text()) | {"model": "full", key: value}
    (copy / "summary.json").write_text(json.dumps(summary))
    for read in (write, lambda folder: cylinders.from_run(Scene(), folder)):
        try:
            read(copy)
        except SceneError as error:
            assert str(copy)[-20:] in str(error) or "copy" in str(error)


# -- pictures ------------------------------------------------------------------------------------------
def test_picture_beyond_all_bounds_is_left_out(tmp_path):
    """Its header gives 20 000 x 20 000 pixels, 1.2 GB in colours."""
    out = BytesIO()
    Image.new("RGB", (4, 4)).save(out, "PNG")
    data = out.getvalue()
    head = b"IHDR" + struct.pack(">II", 20_000, 20_000) + data[24:29]
    (tmp_path / "large.png").write_bytes(data[:12] + head + struct.pack(">I", zlib.crc32(head)) + data[33:])
    assert "large.png is left out" in picture(tmp_path / "large.png", "Large")
    assert picture(tmp_path / "none.png", "None") == ""


FINGER = {
    "x": np.zeros((3, 2)),
    "u": np.zeros((3, 2)),
    "triangles": np.array([[0, 1, 2]]),
    "sed": np.zeros(1),
    "tag": np.zeros(1, dtype=np.int32),
}


@pytest.mark.parametrize(
    "changes",
    [{"triangles": np.array([[0, 1, 3]])}, {"sed": np.zeros(2)}, {"u": np.zeros(3)}, {"x": np.array(["a"] * 3)}],
)
def test_arrays_of_no_finger_are_none(tmp_path, changes):
    np.savez(tmp_path / "whole.npz", **FINGER)
    np.savez(tmp_path / "other.npz", **(FINGER | changes))
    assert finger_of(tmp_path / "whole.npz").keys() == FINGER.keys() and finger_of(tmp_path / "other.npz") == {}
