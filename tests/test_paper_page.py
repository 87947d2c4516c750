"""The paper's page: runs are read, missing ones are named, and the page is drawn from the kept numbers alone."""

from dataclasses import asdict

import numpy as np
import pytest

from benchmarks.harness import DOCS, keep, kept
from benchmarks.limits import Limit
from benchmarks.paper import __main__ as command
from benchmarks.paper import page
from benchmarks.paper.statement import BUILT, HOLDS, NOT, Statement
from tests.test_paper import MADE, judged

# -- runs ----------------------------------------------------------------------------------------------


def test_missing_runs_are_named(tmp_path, capsys):
    """Without a run the statements on the microscale are made all the same, and the page lists what is missing."""
    numbers = command.collect(tmp_path / "runs")
    assert [s["figure"] for s in numbers["statements"]] == ["4, Eq. 14", "5, Eq. 15"]
    keep("paper", numbers, MADE, tmp_path)
    assert "**Not run yet:** Fig. 2, Figs. 6 to 8" in page.draw(tmp_path).read_text(encoding="utf-8")
    assert "missing: Fig. 2, run" in capsys.readouterr().out


# -- scenes, page - ------------------------------------------------------------------------------


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
