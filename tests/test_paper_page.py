"""The paper's page: runs are read, missing ones are named, and the page is drawn from the kept numbers alone."""

import csv
import json
from dataclasses import asdict
from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.harness import DOCS, keep, kept
from benchmarks.limits import Limit
from benchmarks.paper import __main__ as command
from benchmarks.paper import page, scenes
from benchmarks.paper.statement import BUILT, HOLDS, NOT, Statement
from benchmarks.runs import FORCES, VOLTAGES, Run
from fingerpad.runs.batch import key
from fingerpad.scene import Scene
from tests.test_paper import MADE, judged, state


# -- runs ----------------------------------------------------------------------------------------------
def leave(out, scene, columns, **summary):
    """Leave a run's tables in a sweep's folder."""
    folder = out / key(scene)
    folder.mkdir(parents=True)
    (folder / "summary.json").write_text(json.dumps({"full_slip": True} | summary), encoding="utf-8")
    for name, table in columns.items():
        with (folder / f"{name}.csv").open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(table)
            writer.writerows(zip(*table.values(), strict=True))


def test_run_is_read(tmp_path):
    scene = Scene()
    steps = {
        "step": [1, 2, 3, 4, 5],
        "load": ["press", "charge", "slide", "slide", "slide"],
        "bone_x": [0, 0, 1e-4, 2e-4, 4e-4],
        "ridges_in_contact": [5, 5, 5, 4, 4],
        "all_slip": [False, False, False, True, True],
    }
    ridges = {
        "step": [1, 2, 2, 4],
        "ridge": [0, 0, 1, 1],
        "d_eq": [3e-6, 2e-6, 2.5e-6, 2.6e-6],
        "note": ["", "", "", ""],
    }
    receptors = {"step": [1, 1, 2, 2], "ridge": [0, 1, 0, 1], "merkel_sed": [1.0, 2.0, 3.0, 4.0]}
    leave(tmp_path, scene, {"steps": steps, "ridges": ridges, "receptors": receptors}, charged_step=2, full_slip_step=4)
    run = Run(scene, tmp_path)
    assert (run.charged, run.full_slip) == (1, 3)
    assert [list(found) for found in run.on_ridges(1, "d_eq")] == [[0, 1], [2e-6, 2.5e-6]]
    assert run.receptors["merkel_sed"].tolist() == [[1.0, 2.0], [3.0, 4.0]]
    assert run.receptors["ridge"].tolist() == [0, 1]


@pytest.mark.parametrize("summary", [{"failure": "stuck"}, {"interrupted": True}])
def test_unfinished_run_is_refused(tmp_path, summary):
    leave(tmp_path, Scene(), {}, **summary)
    with pytest.raises(FileNotFoundError, match=key(Scene())):
        Run(Scene(), tmp_path)


def test_missing_runs_are_named(tmp_path, capsys):
    """Without a run the statements on the microscale are made all the same, and the page lists what is missing."""
    numbers = command.collect(tmp_path / "runs")
    assert [s["figure"] for s in numbers["statements"]] == ["4, Eq. 14", "5, Eq. 15"]
    keep("paper", numbers, MADE, tmp_path)
    assert "**Not run yet:** Fig. 2, Figs. 6 to 8" in page.draw(tmp_path).read_text(encoding="utf-8")
    assert "missing: Fig. 2, run" in capsys.readouterr().out


def test_grid_of_runs_is_collected(monkeypatch, tmp_path):
    """Friction and lengths of all runs, and the waves of the path; runs without their fields are named."""

    class Fields(SimpleNamespace):
        def arrays(self, name):
            raise FileNotFoundError(name)

        receptors = property(lambda self: self.arrays("receptors"))

    def run(scene, out):
        found = state(scene.f_ext, scene.voltage, lost=0.03)
        return Fields(scene=scene, **vars(found), loads=["slide"] * 3)

    monkeypatch.setattr(command, "Run", run)
    numbers = command.collect(tmp_path)
    assert np.shape(numbers["grid"]["full_slip_f_t"]) == (len(FORCES), len(VOLTAGES))
    assert {s["figure"] for s in numbers["statements"]} == {
        "2, section 3.2",
        "4, Eq. 14",
        "5, Eq. 15",
        "6",
        "9A, 6B",
        "2C",
        "7",
        "8",
        "8A",
    }
    wavy = next(s for s in numbers["statements"] if "wavy" in s["paper"])
    assert {f"rise_{u:g}" for u in VOLTAGES} <= set(wavy["numbers"])
    assert numbers["missing"] == ["Fig. 2", "Fig. 9A", "Fig. 9B", "section 5"]


# -- scenes, page - ------------------------------------------------------------------------------
def test_sine_is_a_valid_scene():
    """From 0 V over the peak and back to 0 V, each reached before the finger slides on to full slip, ever farther."""
    loads = scenes.sine().loads()[1:]
    voltages = [load.voltage for load in loads if load.voltage is not None]
    assert voltages == pytest.approx([scenes.PEAK * np.sin(np.pi * k / 12) for k in range(1, 13)], abs=1e-9)
    assert np.all(np.diff([load.bone_x for load in loads]) > 0)
    assert [load.until_full_slip for load in loads] == [True] + [False, True] * 12


def numbers_with(*statements):
    return {"missing": [], "statements": [asdict(s) for s in statements]}


def test_page(tmp_path):
    sites = {"enter": 1.0, "highest 2": 0.8, "enters 5": 3.0}
    built = Statement("9B", "it repeats", "by 2", {"mu_app": 0.5214} | sites, BUILT, "of U²")
    good = Statement("6", "it rises", "by 3 %", {"rise": 0.03}, HOLDS, "never shown")
    bad = Statement("7", "it falls", "by 1 %", {"fall": 0.01}, NOT, "it is flat")
    keep("paper", numbers_with(built, good, bad), MADE, tmp_path)
    text = page.draw(tmp_path).read_text(encoding="utf-8")
    assert "Of 3 statements of the paper, 1 hold in this model, 1 more by construction, 0 in part" in text
    assert "75 N/m and 200 V is 0.5214 in the limit" in text
    assert "**holds by construction**: of U²" in text
    assert "**does not hold**: it is flat" in text
    assert "never shown" not in text
    assert "| highest at 0 V | M22 | +0 | 2 | +0 | 0.8 |\n| enters | M27 | +5 | 5 | +3 | 3 |\n" in text
    assert "| equivalent air gap | 1.5e-6 | 2.5e-6 | m | Guo" in text
    assert "version 0.1.0 before 2026-11-21" in text
    assert kept("paper", tmp_path).numbers["statements"][2]["numbers"] == {"fall": 0.01}


def test_page_in_git_is_of_its_numbers(tmp_path):
    """Drawn anew from the kept numbers, text and statements on the grid are those of the page; none without a grid.

    Tolerance: a fit of 40 runs by least squares has the roundoff of the processor, some 1e-15.
    """
    (tmp_path / "paper.json").write_bytes((DOCS / "paper.json").read_bytes())
    numbers, again = kept("paper", tmp_path).numbers, []
    if "grid" in numbers:
        of = {key: next(s["numbers"] for s in numbers["statements"] if key in s["paper"]) for key in ("wavy", "0.55")}
        limit = Limit(of["0.55"]["mu_app"], of["0.55"]["bar"], None)
        again = judged({name: np.array(values) for name, values in numbers["grid"].items()}, of["wavy"], limit)
    of_grid = ("2, section 3.2", "6", "9A, 6B", "2C", "7", "8", "8A")
    for found, told in zip(again, [s for s in numbers["statements"] if s["figure"] in of_grid], strict=True):
        assert asdict(found) | {"numbers": None} == told | {"numbers": None}
        assert found.numbers == pytest.approx(told["numbers"], rel=1e-9)
    assert page.draw(tmp_path).read_text(encoding="utf-8").count("| **") == len(numbers["statements"])
