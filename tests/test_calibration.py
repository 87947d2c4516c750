"""The printed error against known errors: it is large enough in nine of ten cases, but for energy densities."""

import pytest

from benchmarks.accuracy import KINDS, WANTED, WHOLE, Case, coverage, kept
from benchmarks.harness import ROOT


@pytest.fixture(scope="module")
def cases():
    return kept()


_SCATTER = pytest.mark.xfail(strict=True, reason="with one size changed alone, coarse sites scatter: docs/accuracy.md")


@pytest.mark.parametrize(
    "kind", [pytest.param(kind, marks=[_SCATTER] if kind == "energy density" else []) for kind in KINDS]
)
def test_known_errors_are_covered(cases, kind):
    """In at least nine of ten cases of each kind of quantity, and by the factors: without them it is fewer."""
    n, bare, safe = coverage(cases, kind)
    assert n >= 20
    assert safe >= WANTED * n
    assert bare < WANTED * n


def test_what_is_not_covered_is_stated_where_the_factors_are(cases):
    """The docstring of the factors has the kept number of energy densities, and so has the page."""
    n, _, safe = coverage(cases, "energy density")
    for file in ("fingerpad/richardson.py", "docs/accuracy.md"):
        assert f"{safe} of {n}" in " ".join((ROOT / file).read_text(encoding="utf-8").split())


@pytest.mark.parametrize("kind", KINDS)
def test_known_errors_of_whole_runs_are_covered(cases, kind):
    """What a user gets: runs of scenes, all their sizes at once."""
    n, _, safe = coverage(mine := [case for case in cases if case.source == WHOLE], kind)
    assert safe >= WANTED * n
    # Of most energy densities the limit is less certain than the run is wrong: those that are not clear count too.
    every = [case.covered(case.factor) for case in mine if case.kind == kind]
    assert len(every) >= 20 and sum(every) >= WANTED * len(every)
    assert n >= 20 or kind == "energy density"


def test_every_quantity_of_the_default_run_is_covered(cases):
    default = [case for case in cases if case.scene == "default scene as it is"]
    assert len(default) == 5
    assert all(case.covered(case.factor) for case in default)
    assert not all(case.covered(1.0) for case in default)


def test_error_below_its_bar_counts_for_nothing():
    """Three cases: one covered, one covered by its factor of 1.5, one whose error is not significant."""
    known = [
        Case("", "", "f_T", False, estimate, error, bar)
        for estimate, error, bar in ((1.0, 0.9, 0.0), (1.0, 1.4, 0.1), (1.0, 2.0, 2.1))
    ]
    assert coverage(known, "friction") == coverage(known) == (2, 1, 2)
    assert "| (0.50) |" in known[-1].line
