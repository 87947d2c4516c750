"""The measurements of docs/performance.md, on small bodies, and the sweep as an array of jobs."""

import csv
import os
import subprocess
from pathlib import Path

import pytest

from benchmarks import explicit, performance

pytestmark = pytest.mark.slow
ROOT = Path(__file__).resolve().parents[1]
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


def test_explicit_dynamics_end_in_the_equilibrium():
    """A ridge of facets of 40 um, led along the loads over eight periods: forces and contact lengths within 3 %.

    What is left swings on: the loads are applied in so few periods that the kinetic energy is some percent.
    """
    base = explicit.implicit(40e-6)
    for scaled in (False, True):
        found = explicit.lead(40e-6, scaled, base["frequencies"][scaled], 8.0)
        assert found["ratio"] < 0.1
        assert performance.worst(found, base) < 0.03


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
    with (tmp_path / "table.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["voltage"]) for row in rows] == [50.0, 100.0]
    assert float(rows[1]["full_slip_mu_app"]) > float(rows[0]["full_slip_mu_app"]) > 0.25


def test_lumped_mass_is_that_of_the_body():
    mass = explicit.Ridge(40e-6).mass(scaled=False)
    assert mass.sum() == pytest.approx(483e-6 * 600e-6 - 483e-6 * 50e-6, rel=0.02)  # the skin is a polygon
    assert mass.min() > 0
