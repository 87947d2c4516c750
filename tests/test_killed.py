"""A run that is killed with signal 9 at any moment goes on from its checkpoint, and leaves nothing half-written."""

import random
import signal
from pathlib import Path

import numpy as np
import pytest

from fingerpad.results import fields
from tests.commands import python
from tests.measures import tables

pytestmark = pytest.mark.slow
ROOT = Path(__file__).resolve().parents[1]
WRAPPER = """
import os, sys
kind, number = sys.argv.pop(1), int(sys.argv.pop(1))
from variational.solvers.coupling import Coupling
from fingerpad.results import files
from fingerpad.runs import checkpoint
def kill_at(owner, name, do=lambda *args: None):
    plain, count = getattr(owner, name), [0]
    def call(*args, **more):
        count[0] += 1
        if count[0] == number:
            do(*args)
            os.kill(os.getpid(), 9)
        return plain(*args, **more)
    setattr(owner, name, call)
if kind == "solve":
    kill_at(Coupling, "solve")
elif kind == "part":
    kill_at(checkpoint.np, "savez", lambda stream, *rest: stream.write(b"PK half of it"))
elif kind == "row":
    kill_at(files.Table, "write")
from fingerpad.results.pictures.drawing import Drawing
Drawing.write = lambda *args: None
from fingerpad.cli import main
sys.exit(main(sys.argv[1:]))
"""


def process(kind: str, number: int, *words: str) -> int:
    """Run a command that kills itself at a solve, in writing a part of the checkpoint, or at a row of a table."""
    done = python("-c", WRAPPER, kind, number, *words)
    assert done.returncode in (0, -signal.SIGKILL), done.stderr[-2000:]
    return done.returncode


MOMENTS = [("solve", 9), ("part", 3), ("row", 9), *(("solve", n) for n in random.Random(1).sample(range(2, 21), 7))]


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """Return a file of a scene with an error estimate, and the tables of its run."""
    text = (ROOT / "demos" / "scenes" / "small_finger.toml").read_text(encoding="utf-8")
    return ended(tmp_path_factory.mktemp("undisturbed"), text.replace("contact = 20e-6", "contact = 40e-6"))


def ended(folder: Path, text: str):
    file = folder / "scene.toml"
    file.write_text(text, encoding="utf-8")
    assert process("", 0, "run", str(file), "--quiet", "--out", str(folder / "run")) == 0
    return file, tables(folder / "run"), (folder / "run" / "summary.json").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("kind", "number"), [MOMENTS[0], *(pytest.param(*m, marks=pytest.mark.long) for m in MOMENTS[1:])]
)
def test_kill_9(undisturbed, tmp_path, kind, number):
    """At a solve of the path or of the error estimate, in writing a part, between two rows."""
    killed_and_resumed(undisturbed, tmp_path / "run", kind, number)


def killed_and_resumed(undisturbed, out, kind, number):
    file, whole, summary = undisturbed
    assert process(kind, number, "run", str(file), "--quiet", "--out", str(out)) == -signal.SIGKILL
    resumed = (out / "checkpoint").exists()
    words = ["--resume", str(out)] if resumed else [str(file), "--out", str(out)]
    assert process("", 0, "run", "--quiet", *words) == 0
    assert tables(out) == whole
    moved, expected = (fields.read(place)["motion"] for place in (out, file.parent / "run"))
    assert moved.keys() == expected.keys() and len(moved["step"]) == len(whole["steps"])
    for name, values in expected.items():
        np.testing.assert_array_equal(moved[name], values, err_msg=name)

    def lines(text):
        return [line for line in text.splitlines() if not any(word in line for word in ("seconds", "memory"))]

    assert lines((out / "summary.json").read_text(encoding="utf-8")) == lines(summary)
