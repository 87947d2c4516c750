"""Every demo runs as a user runs it, at small size: its own assertions are the test."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
DEMOS = sorted((ROOT / "demos").glob("*.py"))
ALONE = {"first_run", "roughness_without_dolfinx"}  # starts processes of its own; has no finite elements
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
@pytest.mark.parametrize("demo", [demo for demo in DEMOS if demo.stem not in ALONE], ids=lambda demo: demo.stem)
def test_demo_on_two_ranks(demo, tmp_path):
    """The assertions hold, and rank 0 alone prints: no line comes twice."""
    lines = [line for line in run(demo, tmp_path, ranks=2).splitlines() if line.strip()]
    assert len(lines) == len(set(lines)) > 0


def test_every_demo_is_listed():
    """The page of the demos names each of them, and no other."""
    page = (ROOT / "demos" / "README.md").read_text(encoding="utf-8")
    listed = [line.split("`")[1] for line in page.splitlines() if line.startswith("| `")]
    assert sorted(listed) == [demo.name for demo in DEMOS]


def test_first_run_is_the_one_of_the_readme():
    """The first block of Python in the README is in the demo, line by line."""
    _, _, rest = (ROOT / "README.md").read_text(encoding="utf-8").partition("```python\n")
    block, _, _ = rest.partition("```")
    assert block and block in (ROOT / "demos" / "first_run.py").read_text(encoding="utf-8")
