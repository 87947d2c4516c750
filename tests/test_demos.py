"""Every demo runs as a user runs it, at small size: its own assertions are the test."""

import importlib.util
import os
import re
import subprocess
from pathlib import Path

import pytest
from mpi4py import MPI

from benchmarks import performance
from tests.commands import python
from tests.measures import rows_of
from tests.pages import alike

pytestmark = pytest.mark.slow
ROOT = Path(__file__).resolve().parents[1]
DEMOS = sorted((ROOT / "demos").glob("*.py"))
OUTPUT = ROOT / "demos" / "output"  # by python3 -m benchmarks.demos
BODIES = ("ridge_against_hertz", "pull_off_and_energy", "own_mesh", "results_with_other_tools")
SPIKES = ("press_hold_slide_spikes", "voltage_step_felt")
OWN = ("own_closure", "own_material", "own_friction")
STRICT = ["-W", "error", "-W", "ignore::ImportWarning"]  # dolfinx's of what it can do without


def run(demo: Path, out: Path) -> str:
    """Run a demo in a process of its own, in a folder of its own; return what it prints."""
    small = [str(ROOT / "tests" / "small_finger.py"), str(demo)] if demo.stem == "first_run" else [str(demo), str(out)]
    done = python(*STRICT, *small, cwd=out)
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
@pytest.mark.parametrize("stem", [*BODIES, *SPIKES, *(pytest.param(stem, marks=pytest.mark.long) for stem in OWN)])
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


# -- measurements of docs/performance.md, and the sweep as an array of jobs ------------------------------------------
SMALL = ROOT / "demos" / "scenes" / "small_finger.toml"


def test_parts_are_all_of_the_processor_time(tmp_path):
    """What is charged to the parts adds up to what the process took, less its last lines; 2 % is a tenth of a second.

    Each step of Newton's method is one back-substitution, and each factorisation on the path has one tangent.
    """
    found = performance.child("run", str(SMALL))
    whole = sum(found["path"].values()) + sum(found["beside"].values())
    assert whole == pytest.approx(found["processor"], rel=0.02)
    assert found["calls"]["back-substitution"] == found["newton"]
    assert found["calls"]["tangent"] == found["calls"]["factorisation"] < found["factorisations"]
    assert found["calls"]["layer at the screen"] > found["calls"]["factorisation"]
    assert performance.unit(found) > 0


def test_sweep_as_an_array_of_jobs(tmp_path):
    """Two tasks run at a time, each its own voltage in the shared folder; the whole sweep then finds both there."""
    environment = {**os.environ, "VOLTAGES": "50 100", "OUT": str(tmp_path)}
    quick = ("--set", "output.errors=false", "--set", "output.each_load=false")
    command = [str(ROOT / "demos" / "slurm_sweep.sh"), str(SMALL), *quick]
    pipe = {"cwd": ROOT, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    tasks = [subprocess.Popen(command, env=environment | {"SLURM_ARRAY_TASK_ID": k}, **pipe) for k in "01"]
    printed = [task.communicate(timeout=300)[0] for task in tasks]
    assert [task.returncode for task in tasks] == [0, 0], printed
    kept = {path: path.stat().st_mtime_ns for path in tmp_path.glob("full/*/summary.json")}
    assert len(kept) == 2
    merged = subprocess.run(command, env=environment, check=True, **pipe)
    assert "done" not in merged.stdout
    assert {path: path.stat().st_mtime_ns for path in kept} == kept
    rows = rows_of(tmp_path, "table")
    assert [float(row["voltage"]) for row in rows] == [50.0, 100.0]
    assert float(rows[1]["full_slip_mu_app"]) > float(rows[0]["full_slip_mu_app"]) > 0.25
