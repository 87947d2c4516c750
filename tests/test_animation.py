"""The moving picture of a run: its frames, what they are drawn from, and what is left of one that is stopped."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from fingerpad.cli import main
from fingerpad.results import fields
from fingerpad.results.pictures import animation
from fingerpad.results.result import Result
from fingerpad.runs.context import RunContext
from fingerpad.runs.solve import find, solved
from tests.small_finger import small

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """The folder of a run of the small finger to full slip."""
    place = tmp_path_factory.mktemp("moved") / "run"
    scene = small(output={"errors": False, "receptors": False})
    solved(scene, find("full"), RunContext(place, report=False))
    return place


@pytest.fixture
def copy(folder, tmp_path) -> Path:
    """A copy of the run's folder, to be spoilt."""
    return Path(shutil.copytree(folder, tmp_path / "copy", ignore=shutil.ignore_patterns("*.png")))


@pytest.mark.parametrize("ending", animation.ENDINGS)
def test_animation_has_a_frame_for_each_state(folder, tmp_path, capsys, ending):
    """And some between states, each load at least as many as it is said to have; the last frame stands longest."""
    file = tmp_path / f"run{ending}"
    assert main(["report", str(folder), "--animate", "--out", str(file)]) == 0 and str(file) in capsys.readouterr().out
    with Image.open(file) as shown:
        assert shown.size == (810, 540) and shown.n_frames > len(Result.load(folder).steps)
        first = shown.convert("RGB").tobytes()
        shown.seek(shown.n_frames - 1)
        assert shown.convert("RGB").tobytes() != first
    assert file.stat().st_size < 3e6


def test_motion_ends_in_the_last_state(folder):
    """Its skin is that of the last step, in single precision, and its places are the reference plus displacements."""
    kept, state = animation.motion_of(folder), Result.load(folder).steps[-1]
    assert kept.step[-1] == state.step and len(kept.step) == len(Result.load(folder).steps)
    xy, skin = kept.between(len(kept.step) - 1, 0.0)
    last = dict(zip(fields.ALONG, fields.read(folder)["loads/slide"]["skin"], strict=True))
    assert skin == pytest.approx(np.stack([last[name] for name in animation.ROWS]), rel=1e-6, abs=1e-9, nan_ok=True)
    assert xy.min(axis=0)[1] == pytest.approx(0.0, abs=1e-6), "the skin is not on the screen"


def test_long_run_keeps_some_of_its_states():
    """The first and the last are among them, and there are never more than a few hundred."""
    kept: dict[int, animation.Moved] = {}
    for step in range(1, 2001):
        kept[step] = {}
        animation.thin(kept)
        assert list(kept) == sorted(kept) and step in kept and len(kept) <= 160
    assert len(kept) > 50


@pytest.mark.parametrize(
    ("name", "words"),
    [("a.mp4", "must end with one of .webp, .gif"), ("a.webp", "has no motion of a run in fields")],
)
def test_animation_that_cannot_be_made_is_refused(copy, capsys, name, words):
    (copy / fields.FILE).unlink()
    assert main(["report", str(copy), "--animate", "--out", str(copy / name)]) == 2
    printed, said = capsys.readouterr()
    assert words in said and said.count("\n") == 1 and printed == ""


@pytest.mark.parametrize("where", ["fingerpad.results.pictures.animation._words", "pathlib.Path.replace"])
def test_animation_that_is_stopped_leaves_what_was_there(copy, capsys, monkeypatch, where):
    """By Ctrl-C while a frame is drawn, and before the file is put in place; one sentence, and no part of a file."""

    def stop(*args):
        raise KeyboardInterrupt

    (file := copy / "animation.webp").write_bytes(b"earlier")
    there = set(copy.iterdir())
    frames = animation._frames
    monkeypatch.setattr(animation, "_frames", lambda states: frames(states)[:2])
    monkeypatch.setattr(where, stop)
    assert main(["report", str(copy), "--animate"]) == 130
    said = capsys.readouterr().err
    assert said.startswith("fingerpad: stopped by Ctrl-C") and said.count("\n") == 1
    assert file.read_bytes() == b"earlier" and set(copy.iterdir()) == there


def test_animation_counts_its_frames(folder, tmp_path, monkeypatch):
    """Each of them once, after it is drawn."""
    frames, seen = animation._frames, list[tuple[int, int]]()
    monkeypatch.setattr(animation, "_frames", lambda states: frames(states)[:3])
    animation.animate(Result.load(folder), tmp_path / "run.gif", lambda *each: seen.append(each))
    assert seen == [(1, 3), (2, 3), (3, 3)]
