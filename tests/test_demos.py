"""Every demo runs as a user runs it, at small size: its own assertions are the test."""

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from mpi4py import MPI

from tests.pages import alike

pytestmark = pytest.mark.slow
ROOT = Path(__file__).resolve().parents[1]
DEMOS = sorted((ROOT / "demos").glob("*.py"))
OUTPUT = ROOT / "demos" / "output"  # by python3 -m benchmarks.demos
BODIES = ("ridge_against_hertz", "pull_off_and_energy", "own_mesh", "results_with_other_tools")
OWN_LAWS = ("own_closure", "own_material", "own_friction")
LIMIT = 600  # s
STRICT = ["-W", "error", "-W", "ignore::ImportWarning"]  # dolfinx's of what it can do without


def run(demo: Path, out: Path) -> str:
    """Run a demo in a process of its own, in a folder of its own; return what it prints."""
    small = [str(ROOT / "tests" / "small_finger.py"), str(demo)] if demo.stem == "first_run" else [str(demo), str(out)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, *STRICT, *small],
        env=environment, cwd=out, capture_output=True, text=True, check=False, timeout=LIMIT,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


LONG = "accuracy_and_reduced_models"


@pytest.mark.parametrize(
    "demo",
    [pytest.param(demo, marks=pytest.mark.long) if demo.stem == LONG else demo for demo in DEMOS],
    ids=lambda demo: demo.stem,
)
def test_demo(demo, tmp_path):
    """Each but the first run leaves a picture, and prints what its page shows: numbers within 2 %, times left out."""
    printed = run(demo, tmp_path)
    if demo.stem == "first_run":
        assert printed
        # results/mine may hold the default finger of the README
        assert {folder.name for folder in (tmp_path / "results").iterdir()} == {"mine_small", "sweep"}
        return
    kept = OUTPUT / f"{demo.stem}.txt"
    assert alike(*(re.sub(r"[\d.]+ s$", "s", text, flags=re.M) for text in (kept.read_text("utf-8"), printed)), 0.02)
    pictures = {f"{demo.stem}_{path.name}" for path in tmp_path.glob("*.png")}
    assert pictures and pictures == {path.name for path in OUTPUT.glob(f"{demo.stem}_*.png")}


@pytest.mark.mpi
@pytest.mark.skipif(MPI.COMM_WORLD.size == 1, reason="test_demo runs it on one rank")
@pytest.mark.parametrize("stem", [*BODIES, *(pytest.param(stem, marks=pytest.mark.long) for stem in OWN_LAWS)])
def test_demo_on_two_ranks(stem, tmp_path, capfd):
    """Of the demos of small bodies: the assertions hold, and rank 0 alone prints: no line comes twice."""
    spec = importlib.util.spec_from_file_location(stem, ROOT / "demos" / f"{stem}.py")
    spec.loader.exec_module(demo := importlib.util.module_from_spec(spec))
    demo.main(MPI.COMM_WORLD.bcast(str(tmp_path)))
    printed = MPI.COMM_WORLD.allgather(capfd.readouterr().out.splitlines())
    lines = [line for rank in printed for line in rank if line.strip()]
    assert len(lines) == len(set(lines)) > 0


def test_every_demo_is_listed():
    """The page of the demos names each of them, and no other."""
    page = (ROOT / "demos" / "README.md").read_text(encoding="utf-8")
    listed = [line.split("`")[1] for line in page.splitlines() if line.startswith("| [`")]
    assert sorted(listed) == [demo.name for demo in DEMOS]
