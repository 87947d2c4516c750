"""The harness of the studies: numbers that are kept, and the pages that are drawn from them."""

import math
import shutil

import pytest

from benchmarks import harness, pages
from benchmarks.harness import DOCS, Made

BY = Made("0.1.0", "abc1234", "2026-11-22", "0123456789ab")


def test_pages_in_git_are_those_of_the_kept_numbers(tmp_path, capsys):
    """Drawn anew, without a run, every page is the one in git."""
    for path in [*DOCS.glob("*.json"), *DOCS.glob("*.png")]:
        shutil.copy(path, tmp_path)
    assert pages.main(["--docs", str(tmp_path)]) == 0
    drawn = capsys.readouterr().out.split()
    assert len(drawn) == len(pages.PAGES)
    for path in tmp_path.glob("*.md"):
        assert path.read_text(encoding="utf-8") == (DOCS / path.name).read_text(encoding="utf-8"), path.name


def test_prose_is_of_pages():
    files = list((harness.ROOT / "benchmarks" / "prose").glob("*.md"))
    assert files and {file.stem for file in files} <= set(pages.PAGES)
    for file in files:
        texts = harness.prose(file.stem)
        assert texts and all(texts.values())


def test_unknown_page_is_refused(capsys):
    with pytest.raises(SystemExit):
        pages.main(["nothing"])
    assert "no page nothing" in capsys.readouterr().err


def test_numbers_are_kept_as_they_are(tmp_path):
    """Not rounded, a short record a line; what is not finite is null."""
    numbers = {"rows": [{"k": k, "value": 0.1 + k} for k in range(30)], "none": math.nan}
    harness.keep("study", numbers, BY, tmp_path)
    found = harness.kept("study", tmp_path)
    assert found.numbers == numbers | {"none": None}
    assert found.made == BY
    assert '   {"k": 0, "value": 0.1},\n' in (tmp_path / "study.json").read_text(encoding="utf-8")


def test_page_names_the_program_that_made_its_numbers(tmp_path):
    def text(by):
        path = harness.page(tmp_path / "x.md", "Title", "It holds.", "So.", ["", "## More"], "make x", by, ["x"])
        return path.read_text(encoding="utf-8")

    assert text(BY).startswith("# Title\n\nIt holds.\n\n## How the numbers were found\n\nSo.\n\n## More\n\n---\n\n")
    assert "version 0.1.0, commit abc1234, of 2026-11-22 (source 0123456789ab)" in text(BY)
    older = Made("0.1.0", "abc1234", "2026-11-22")
    assert "version 0.1.0 before 2026-11-22, in git since commit abc1234" in text(older)
    assert "several commits" in text(Made("0.1.0", "", "2026-11-22", "01, 23"))


def test_runs_of_another_program_have_no_commit():
    def summary(source):
        return {"provenance": {"versions": {"source": source}}}

    present = harness.made()
    assert harness.made([summary(present.source), {}]).commit == present.commit
    older = harness.made([summary("0123456789ab")])
    assert older.commit == ""
    assert set(older.source.split(", ")) == {present.source, "0123456789ab"}


def test_table():
    rows = [["a|b", 1.23456], [None, 3]]
    assert harness.table(["x", "y"], rows) == "| x | y |\n|---|---|\n| a\\|b | 1.235 |\n| – | 3 |"


def test_commands_share_their_options():
    args = harness.parser("A study.").parse_args(["--jobs", "3"])
    assert (args.jobs, args.draw, args.docs) == (3, False, DOCS)
