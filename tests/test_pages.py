"""The harness of the studies: numbers that are kept, and the pages that are drawn from them."""

import math
import shutil

import pytest

from benchmarks import fill, harness, pages, same
from benchmarks.harness import DOCS, Made

BY = Made("0.1.0", "abc1234", "2026-11-22", "0123456789ab")


@pytest.mark.slow
def test_pages_in_git_have_the_kept_numbers(tmp_path, capsys):
    """Put in place anew, without a run, every number of every page is the one in git."""
    for path in DOCS.glob("*.*"):
        shutil.copy(path, tmp_path)
    assert pages.main(["--docs", str(tmp_path)]) == 0
    assert len(capsys.readouterr().out.split()) == len(pages.PAGES)
    for path in tmp_path.glob("*.md"):
        assert path.read_text(encoding="utf-8") == (DOCS / path.name).read_text(encoding="utf-8"), path.name


def test_results_differ_by_their_numbers_alone():
    """Not by seconds; a key that only the present result has is new."""
    before = {"mu": 0.5, "seconds_path": 3.0, "steps": [{"a": 1}, {"a": float("nan")}]}
    assert same.numbers(before) == {"mu": 0.5, "steps": before["steps"]}
    assert list(same.differences(before, before | {"more": 1})) == []
    now = before | {"mu": 0.5000000000000001, "steps": [{"a": 1}]}
    assert list(same.differences(before, now)) == [
        "mu: 0.5 before, 0.5000000000000001 now",
        "steps[]: 2 before, 1 now",
        "steps[1].a: nan before, None now",
    ]
    assert list(same.differences(before, now, but=["mu", "steps"])) == []
    assert list(same.differences({"full_slip_mu_app": 0.0}, {"full_slip_mu_app": None})) == []
    assert list(same.differences({"full_slip_mu_app": 0.1}, {"full_slip_mu_app": None}))
    assert list(same.differences(before, {})) and list(same.differences({"a": None}, {"a": 0.0}))


def test_numbers_may_differ_by_a_part_of_the_largest_of_their_key():
    """Roundoff of a force that is zero counts beside the largest force; another key has its own."""
    before = {"states": [{"f_t": 1e-16, "x": 2e-3}, {"f_t": 40.0, "x": math.nan}], "steps": 3}
    now = {"states": [{"f_t": -3e-9, "x": 2e-3}, {"f_t": 40.0, "x": math.nan}], "steps": 3}
    within = same.allowed(before, 1e-9)
    assert within == {"f_t": pytest.approx(40e-9), "x": pytest.approx(2e-12)}
    assert list(same.differences(before, now)) and not list(same.differences(before, now, within=within))
    assert list(same.differences(before, now | {"steps": 4}, within=within))
    now["states"][0]["x"] = 2.001e-3
    assert len(list(same.differences(before, now, within=within))) == 1


def test_numbers_are_kept_as_they_are(tmp_path):
    """Not rounded, a short record a line; what is not finite is null."""
    numbers = {"rows": [{"k": k, "value": 0.1 + k} for k in range(30)], "none": math.nan}
    harness.keep("study", numbers, BY, tmp_path)
    found = harness.kept("study", tmp_path)
    assert found.numbers == numbers | {"none": None}
    assert found.made == BY
    assert '   {"k": 0, "value": 0.1},\n' in (tmp_path / "study.json").read_text(encoding="utf-8")


PAGE = """# Page 9<!--=x:.2f-->
<!--numbers study-->
is (9<!--=x-->), 9<!--=x:.2f-->
<!--rows k, v in rows: | {k} | {cells(v, None)} |
| {len(rows)} |-->
| k | v |
|---|---|
| old |
| older |

<!--block text-->
old
<!--end-->
<!--numbers other-->
9<!--=x-->
"""


def test_numbers_are_put_in_place():
    """Values, rows and blocks of one study; other parts stay, and a second time changes nothing."""
    names = {"x": 1.5, "rows": [("a", 0.123456), ("b", 2)], "cells": harness.cells, "text": "a\n\nb"}
    found = fill.filled(PAGE, "study", names)
    assert found.startswith("# Page 9<!--=x:.2f-->\n") and found.endswith("<!--numbers other-->\n9<!--=x-->\n")
    assert "is (1.5<!--=x-->), 1.50<!--=x:.2f-->\n" in found and "\na\n\nb\n" in found and "old" not in found
    assert "|---|---|\n| a | 0.1235 | – |\n| b | 2 | – |\n| 2 |\n\n" in found
    assert fill.filled(found, "study", names) == found
    with pytest.raises(ValueError, match="must be one word"):
        fill.filled(PAGE, "study", {"x": "1 m", "rows": [], "text": ""})
