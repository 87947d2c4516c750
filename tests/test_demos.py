"""Every demo runs as a user runs it, at small size: its own assertions are the test."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
DEMOS = sorted((ROOT / "demos").glob("*.py"))
BODIES = {"ridge_against_hertz", "pull_off_and_energy", "own_closure", "own_material", "own_friction", "own_mesh"}
LIMIT = 600  # s
STRICT = ["-W", "error", "-W", "ignore::ImportWarning"]  # dolfinx's of what it can do without


def run(demo: Path, out: Path, ranks: int = 1) -> str:
    """Run a demo in a process of its own, in a folder of its own; return what it prints."""
    small = [str(ROOT / "tests" / "small_finger.py"), str(demo)] if demo.stem == "first_run" else [str(demo), str(out)]
    launcher = ["mpirun", "-n", str(ranks)] if ranks > 1 else []
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [*launcher, sys.executable, *STRICT, *small],
        env=environment, cwd=out, capture_output=True, text=True, check=False, timeout=LIMIT,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("demo", DEMOS, ids=lambda demo: demo.stem)
def test_demo(demo, tmp_path):
    """Each but the first run leaves a picture."""
    assert run(demo, tmp_path)
    assert demo.stem == "first_run" or list(tmp_path.glob("*.png"))


@pytest.mark.slow
@pytest.mark.parametrize("demo", [demo for demo in DEMOS if demo.stem in BODIES], ids=lambda demo: demo.stem)
def test_demo_on_two_ranks(demo, tmp_path):
    """Of the demos of small bodies: the assertions hold, and rank 0 alone prints: no line comes twice."""
    lines = [line for line in run(demo, tmp_path, ranks=2).splitlines() if line.strip()]
    assert len(lines) == len(set(lines)) > 0


def test_every_demo_is_listed():
    """The page of the demos names each of them, and no other."""
    page = (ROOT / "demos" / "README.md").read_text(encoding="utf-8")
    listed = [line.split("`")[1] for line in page.splitlines() if line.startswith("| `")]
    assert sorted(listed) == [demo.name for demo in DEMOS]
