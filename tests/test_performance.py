"""The measurements of docs/performance.md, on small bodies, and the sweep as an array of jobs."""

import csv
import importlib
import os
import subprocess
from pathlib import Path

import pytest

from benchmarks import explicit, linear, performance, tried
from benchmarks.harness import DOCS
from benchmarks.targets import Target, reasons, rows, targets

ROOT = Path(__file__).resolve().parents[1]
SMALL = ROOT / "demos" / "scenes" / "small_finger.toml"


def test_exponent_of_a_power():
    n = [1e4, 1e5, 1e6]
    assert performance.exponent(n, [3 * x**1.25 for x in n]) == pytest.approx(1.25)


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


def test_busy_machine_is_refused(monkeypatch, tmp_path, capsys):
    """Two ranks are not timed beside other work, and nothing is kept of them."""
    monkeypatch.setattr(os, "getloadavg", lambda: (2.0, 2.0, 2.0))
    performance.measure(["ranks"], tmp_path)
    assert "the load average is 2.00" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_linear_solvers_that_are_compared_solve_the_same_system():
    """On a coarse finger: direct ones to roundoff, the kept factorisation to what GMRES is asked for."""
    found = performance.child("solvers", "6")
    ways = found["ways"]
    assert {linear.NOW, "GMRES, kept LU"} <= set(ways) <= set(linear.WAYS)
    for name, numbers in ways.items():
        assert min(numbers[part] for part in ("first", "set-up", "solve")) > 0
        if numbers["iterations"] is None:
            assert numbers["rest"] < 1e-9, name
    assert ways["GMRES, kept LU"]["iterations"] > 1 and ways["GMRES, kept LU"]["rest"] < 1e-6
    assert ways["its AMF ordering"]["entries"] != ways[linear.NOW]["entries"] > found["unknowns"]
    first = linear.rows(ways).splitlines()[2]
    assert first.startswith(f"| {linear.NOW} | 1.00 |")


def test_what_is_tried_are_other_values_of_constants_that_there_are():
    """A constant that is renamed would end the measurement; one that takes the value tried would be no trial."""
    for words, constants in tried.VARIANTS.items():
        assert bool(constants) == (words != tried.NOW)
        for constant in constants:
            place, value = constant.split("=")
            module, *names = place.split(".")
            now = importlib.import_module(f"variational.solvers.{module}")
            for name in names:
                now = getattr(now, name)
            assert float(value) != now


def test_tried_constants_are_shown_beside_the_solver_as_it_is():
    counts = {"factorisations": 10, "newton": 30, "rounds": 5, "steps": 4}
    now = counts | {"answers": {"friction force": 2.0}}
    other = counts | {"answers": {"friction force": 2.001}, "newton": 31}
    first, second = tried.rows({tried.NOW: now, "other": other}).splitlines()[2:]
    assert first.split(" | ")[-1] == "– |"
    assert second.split(" | ")[2:] == ["31", "5", "4", "+0.05 % |"]


@pytest.mark.parametrize(
    ("sign", "measured", "reached"),
    [("≤", 120, True), ("≤", 121, False), ("≥", 120, True), ("≥", 119, False), ("≤", None, False), ("≥", None, False)],
)
def test_target(sign, measured, reached):
    """A number that was not measured is not reached."""
    target = Target("what", sign, 120, measured)
    assert target.reached == reached
    assert rows([target]).endswith("| yes |" if reached else "| no |")


def test_targets_are_judged_by_the_kept_numbers():
    """Twice the factorisations miss theirs, and nothing else changes."""
    of = {name: part["found"] for name, part in performance.kept("performance", DOCS).numbers.items()}
    path = {"seconds": 1.0, "units": 1.0, "time": 1.0, "memory": 1.0}
    found = targets(of, path, DOCS)
    more = targets(of | {"run": of["run"] | {"factorisations": 241}}, path, DOCS)
    assert found[0].reached
    assert [t.what for t, o in zip(found, more, strict=True) if t != o] == [found[0].what]
    unmeasured = targets({name: part for name, part in of.items() if name != "ranks"}, path, DOCS)
    assert [t.what for t in unmeasured] == [t.what for t in found]
    assert [t.what for t in unmeasured if t.measured is None] == [t.what for t in found if t.why == "missed-ranks"]


def test_a_missed_target_is_explained_and_a_reached_one_is_not():
    missed, reached = (Target("what", "≤", 1, measured, why) for measured, why in ((2, "missed-a"), (1, "missed-b")))
    assert reasons([missed, reached, missed, Target("what", "≤", 1, 2)]) == ["missed-a"]


def test_pair_of_the_median_ratio_is_shown():
    pairs = [{"1": {"wall": {"LU": 3.0}}, "2": {"wall": {"LU": two}}} for two in (1.5, 3.0, 2.0)]
    found = performance._middle(pairs)
    assert found["2"] == pairs[2]["2"]
    assert found["ratios"] == [1.0, 1.5, 2.0]


def test_explicit_dynamics_end_in_the_equilibrium():
    """A ridge of facets of 40 um, led along the loads over eight periods: forces and contact lengths within 3 %.

    What is left swings on: the loads are applied in so few periods that the kinetic energy is some percent.
    """
    base = explicit.implicit(40e-6)
    for scaled in (False, True):
        found = explicit.lead(40e-6, scaled, base["frequencies"][scaled], 8.0)
        assert found["ratio"] < 0.1
        assert performance.worst(found, base) < 0.03


def test_lumped_mass_is_that_of_the_body():
    mass = explicit.Ridge(40e-6).mass(scaled=False)
    assert mass.sum() == pytest.approx(483e-6 * 600e-6 - 483e-6 * 50e-6, rel=0.02)  # the skin is a polygon
    assert mass.min() > 0


def test_task_of_an_array_without_a_voltage_is_told():
    environment = {**os.environ, "VOLTAGES": "50 100", "SLURM_ARRAY_TASK_ID": "2"}
    command = [str(ROOT / "demos" / "slurm_sweep.sh")]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False, cwd=ROOT)
    assert done.returncode == 2 and "task 2 has no voltage: VOLTAGES has 2; give --array=0-1" in done.stderr


def test_sweep_as_an_array_of_jobs(tmp_path):
    """Two tasks run at a time, each its own voltage in the shared folder; the whole sweep then finds both there."""
    environment = {**os.environ, "VOLTAGES": "50 100", "OUT": str(tmp_path)}
    command = [str(ROOT / "demos" / "slurm_sweep.sh"), str(SMALL), "--set", "output.errors=false"]
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
    assert float(rows[1]["slip_mu_app"]) > float(rows[0]["slip_mu_app"]) > 0.25
