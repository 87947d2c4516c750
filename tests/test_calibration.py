"""The printed error against the errors that are known: it is large enough in nine of ten cases."""

import re
from pathlib import Path

import pytest

from benchmarks import calibration
from benchmarks.calibration import KINDS, WANTED, Case, coverage, kept, read, section

DOCS = Path(__file__).parents[1] / "docs"


@pytest.fixture(scope="module")
def cases():
    return kept(DOCS)


@pytest.mark.parametrize("kind", KINDS)
def test_known_errors_are_covered(cases, kind):
    """In at least nine of ten cases of each kind of quantity, and by the factors: without them it is fewer."""
    n, bare, safe = coverage(cases, kind)
    assert n >= 20
    assert safe >= WANTED * n
    assert bare < WANTED * n


@pytest.mark.parametrize("kind", KINDS)
def test_known_errors_of_whole_runs_are_covered(cases, kind):
    """What a user sees: runs of scenes, all their sizes at once."""
    runs = [case for case in cases if case.source.startswith("Accuracy asked for")]
    n, _, safe = coverage(runs, kind)
    assert n >= 20
    assert safe >= WANTED * n


def test_every_quantity_of_the_default_run_is_covered(cases):
    default = [case for case in cases if case.scene == "default scene as it is"]
    assert len(default) == 5
    assert all(case.covered(case.factor) for case in default)
    assert not all(case.covered(1.0) for case in default)


def test_record_is_of_the_page(cases):
    """docs/calibration.json and the section are those of docs/accuracy.md; the command of the module makes them."""
    page = (DOCS / "accuracy.md").read_text(encoding="utf-8")
    assert read(page) == cases
    assert page.endswith(section(cases, DOCS) + "\n")


def test_all_rows_are_read(cases):
    """The page counts the effectivities of whole runs, of those what was asked for, of single sizes, and of Hertz."""
    page = (DOCS / "accuracy.md").read_text(encoding="utf-8")
    whole, _, knobs, hertz = (int(n) for n in re.findall(r"\d+ of (\d+) effectivities", page))
    clear = [case.source.split()[0] for case in cases if case.clear]
    assert clear.count("Accuracy") == whole
    assert clear.count("Hertz's") == hertz
    assert len(clear) - whole - hertz == knobs


def test_written_again_it_is_the_same(tmp_path):
    for name in ("accuracy.md", "calibration.json", "errors.json"):
        (tmp_path / name).write_text((DOCS / name).read_text(encoding="utf-8"), encoding="utf-8")
    assert calibration.main(["--docs", str(tmp_path)]) == 0
    for name in ("accuracy.md", "calibration.json"):
        assert (tmp_path / name).read_text(encoding="utf-8") == (DOCS / name).read_text(encoding="utf-8")


def test_error_below_its_bar_counts_for_nothing():
    """Three cases: one covered, one covered by its factor of 1.5, one of which nothing is known."""
    known = [
        Case("", "", "f_T", "friction", False, estimate, error, bar)
        for estimate, error, bar in ((1.0, 0.9, 0.0), (1.0, 1.4, 0.1), (1.0, 2.0, 2.1))
    ]
    assert coverage(known, "friction") == (2, 1, 2)
