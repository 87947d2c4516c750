"""What follows from the states of a result can fail, and never costs the result: a line, a note, and the traceback."""

import json
from pathlib import Path

import pytest

import fingerpad as fp
from fingerpad.results.result import Result
from fingerpad.runs import post
from fingerpad.runs.context import RunContext, ended, summary
from fingerpad.runs.solve import find, solved
from fingerpad.scene import from_data
from tests.commands import python
from tests.runs import tables_alone
from tests.small_finger import NINE

FULL = NINE | {"f_ext": 1.0, "voltage": 60.0, "output": {"receptors": False, "errors": False}}
WHY = "ZeroDivisionError: division by zero"
PARTS = {
    "newtons of the whole finger": "fingerpad.slices.estimate.with_newtons",
    "bands of friction": "fingerpad.reduced.closure_band.with_band",
    "cautions": "fingerpad.model.cautions.on_states",
    "headline": "fingerpad.results.result.headline",
    "pictures": "fingerpad.results.pictures.drawing.Drawing.write",
    "footprint.png": "fingerpad.results.pictures.solid.draw",
    "report": "fingerpad.report.run_page.page",
}
"""What fails, by the name of the entry that has it."""


def fail(*args, **more):
    return 1 / 0


@pytest.fixture(scope="module")
def broken(tmp_path_factory):
    """A run of the command in which all that follows fails: its exit code, its folder and what it printed."""
    folder = tmp_path_factory.mktemp("broken")
    (scene := folder.with_suffix(".json")).write_text(json.dumps(FULL), encoding="utf-8")
    code = f"import sys, unittest.mock as m\ndef fail(*args, **more): return 1 / 0\nfor name in {[*PARTS.values()]}:\n"
    code += "    m.patch(name, fail).start()\nfrom fingerpad.cli import main\nsys.exit(main(sys.argv[1:]))"
    return python("-c", code, "run", scene, "--out", folder), folder


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(PARTS.keys() - {"footprint.png"}))  # of the newtons, which it does not have
def test_failure_is_a_line_a_note_and_a_traceback(broken, name):
    done, folder = broken
    note = next(each for each in summary(folder)["notes"] if each.startswith(f"{name}: "))
    assert (done.returncode, "Traceback" in done.stderr) == (0, False)
    assert f"fingerpad: {note}\n" in done.stderr
    assert (folder / "run.log").read_text(encoding="utf-8").count(f"WARNING {note}\nTraceback") == 1


@pytest.mark.slow
def test_states_survive_all_failures(broken):
    """They are those of a run in which nothing fails, and read as such."""
    found, expected = Result.load(broken[1]), fp.run(from_data(FULL))
    assert found.full_slip.mu_app == expected.full_slip.mu_app
    assert [state.f_t for state in found.steps] == [state.f_t for state in expected.steps]


@pytest.mark.parametrize("name", ["bands of friction", "footprint.png", "report"])
def test_failure_of_one_costs_no_other(tmp_path, monkeypatch, name):
    """Of the closed form, with a folder."""
    monkeypatch.setattr(PARTS[name], fail)
    result = solved(fp.Scene(), find("cylinders"), RunContext(tmp_path))
    assert [each for each in result.notes if WHY in each] == [each for each in result.notes if each.startswith(name)]
    files = {"summary.json", "result.nc", "footprint.png", "report.html", "run.log"}
    assert files - {file.name for file in tmp_path.iterdir()} == {name, f"{name}.html"} & files


@pytest.mark.slow
def test_output_that_fails_in_some_states_has_none_there(tmp_path):
    """Pressure on skin that does not touch yet; the states in contact have it, and a note says why others have none."""
    outputs = [fp.Output("late", "Pa", lambda state: 1 / (state.voltage > 0))]
    with tables_alone():
        result = fp.run(from_data(FULL), out=tmp_path, outputs=outputs)
    assert result.full_slip.late == 1.0 and not result.steps[0].late == 1.0
    assert [each for each in result.notes if "the output late of step 1 cannot be computed" in each]


def test_run_that_ends_before_its_entries_has_not_ended(tmp_path, monkeypatch):
    """A kill in between leaves the states, and another sweep does not take them for all."""
    monkeypatch.setattr(post, "_tried", fail)
    with pytest.raises(ZeroDivisionError):
        solved(fp.Scene(), find("cylinders"), RunContext(tmp_path))
    assert ended(summary(tmp_path)) is None
    assert Result.load(tmp_path).full_slip.mu_app > 0.25


RANKS = """
import sys
from dataclasses import replace
from pathlib import Path
from fingerpad.startup import MPI
from fingerpad.runs import post
from fingerpad.runs.context import RunContext
from fingerpad.reduced import cylinders
from fingerpad.scene import Scene
def some(result):
    if MPI.COMM_WORLD.rank == int(sys.argv[2]):
        raise ValueError("raised on one rank")
    return replace(result, notes=("of the others",))
entries = [post.Entry("one", some), post.Entry("two", lambda result: result)]
found = post.kept(cylinders.solve(Scene()), RunContext(Path(sys.argv[1]), MPI.COMM_WORLD, report=False), entries)
assert found.notes[-1] == "one: ValueError: raised on one rank", found.notes
assert "of the others" not in found.notes
"""


@pytest.mark.slow
@pytest.mark.parametrize("rank", [0, 1])
def test_failure_on_one_rank_is_the_same_on_all(tmp_path: Path, rank):
    done = python("-c", RANKS, tmp_path, rank, ranks=2)
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("raised on one rank") == 1
    assert "ValueError: raised on one rank" in (tmp_path / "run.log").read_text(encoding="utf-8")
