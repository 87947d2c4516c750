"""The harness of the studies: numbers that are kept, and the pages that are drawn from them."""

import math
import shutil
from typing import ClassVar

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


# -- pages older than the code -----------------------------------------------------------------------
class History:
    """A history of five commits, the newest first; each changes one file, or none that numbers rest on."""

    changed: ClassVar = {
        "e": "docs/x.md",
        "d": "benchmarks/chart.py",
        "c": "fingerpad/x.py",
        "b": "tests/x.py",
        "a": "variational/x.py",
    }
    commits = tuple(changed)
    brought = "d"
    """Commit that brought the numbers into git."""

    def git(self, command, *words):
        """Answer as git does; a path names a file or the folder that it is in."""
        found = {"log": [self.brought]}.get(command)
        if command == "rev-list":
            paths = words[words.index("--") + 1 :]
            first, until, _ = next(word for word in words if not word.startswith("-")).partition("..")
            k = self.commits.index(first)
            asked = self.commits[:k] if until else self.commits[k:]
            found = [c for c in asked if any(self.changed[c].startswith(path) for path in paths)]
        return "\n".join(found).encode()

    def source(self, commit):
        """Return a hash that changes with the packages alone."""
        return {"e": "02", "d": "02", "c": "02", "b": "01", "a": "01"}[commit]


@pytest.fixture
def history(monkeypatch):
    found = History()
    monkeypatch.setattr(pages, "git", found.git)
    monkeypatch.setattr(pages, "source", found.source)
    return found


def count(folder, page, made):
    harness.keep(page, {}, made, folder)
    return pages.stale(page, folder)[1]


def test_page_is_older_than_the_code_by_commits_that_change_it(history, tmp_path):
    """By packages and its own program; docs, tests and other pages' programs do not count."""
    assert count(tmp_path, "errors", Made("0.1.0", "", "", "02")) == 0
    assert count(tmp_path, "chart", Made("0.1.0", "", "", "02")) == 0  # its program came with the numbers
    history.brought = "c"
    assert count(tmp_path, "chart", Made("0.1.0", "", "", "02")) == 1
    assert count(tmp_path, "errors", Made("0.1.0", "", "", "01")) == 1
    assert count(tmp_path, "chart", Made("0.1.0", "", "", "01")) == 2
    assert count(tmp_path, "chart", Made("0.1.0", "", "", "02, 01")) == 2


def test_numbers_of_no_commit_are_as_old_as_in_git(history, tmp_path):
    """By the hash of no commit, or without a hash, where the commit that brought them is kept."""
    assert count(tmp_path, "errors", Made("0.1.0", "", "", "ff")) == 0
    assert count(tmp_path, "chart", Made("0.1.0", "b", "")) == 2
    assert count(tmp_path, "errors", Made("0.1.0", "c", "")) == 0


def test_drawing_does_not_make_numbers_older():
    assert {"benchmarks/paper", ":!benchmarks/paper/page.py"} <= set(pages.program("paper"))
    assert "benchmarks/chart.py" in pages.program("chart")
    assert not any("prose" in path or "harness" in path for path in pages.program("chart"))


def test_older_pages_are_listed(history, tmp_path, capsys):
    """Those alone, with version and count; a page is not drawn."""
    harness.keep("chart", {}, Made("0.1.0", "", "2026-11-22", "01"), tmp_path)
    harness.keep("errors", {}, Made("0.1.0", "", "2026-11-22", "02"), tmp_path)
    history.brought = "c"
    assert pages.main(["chart", "errors", "--stale", "--docs", str(tmp_path)]) == 0
    assert capsys.readouterr().out.splitlines() == [
        "chart: version 0.1.0 of 2026-11-22, commit a; 2 commits since",
        "1 of 2 pages are older than the code that they rest on",
    ]
    assert not list(tmp_path.glob("*.md"))


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
    assert "version 0.1.0 of 2026-11-22 (source 0123456789ab)" in text(Made("0.1.0", "", "2026-11-22", "0123456789ab"))


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
