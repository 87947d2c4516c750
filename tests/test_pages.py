"""The harness of the studies: numbers that are kept, and the pages that are drawn from them."""

import json
import math
import shutil

import pytest

from benchmarks import harness, pages, same
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
OLD = {"variational/x.py": b"x = 1  # once", "fingerpad/io/x.py": b"", "benchmarks/chart.py": b"x = 1"}
NEW = {"variational/x.py": b'"""X."""\nx = 1', "fingerpad/io/x.py": b"y", "benchmarks/chart.py": b"x = 1"}
CHANGED = {"variational/x.py": b"x = 2", "benchmarks/chart.py": b"x = 2", "benchmarks/paper/page.py": b"y"}


class History:
    """A history of commits by name with their files; ``brought`` brought the numbers into git."""

    def __init__(self, **commits):
        self.commits, self.brought = commits, next(iter(commits))

    def git(self, command, *words):
        """Answer as git does."""
        return "\n".join({"log": [self.brought], "rev-list": self.commits}[command]).encode()

    def files(self, commit, paths):
        """Return the files of a commit in folders or at paths."""
        found = self.commits["new" if commit == "HEAD" else commit]
        return {path: text for path, text in found.items() if path.startswith(tuple(paths))}


@pytest.fixture
def since(monkeypatch, tmp_path):
    def since(page, made, **commits):
        history = History(**commits)
        monkeypatch.setattr(pages, "git", history.git)
        monkeypatch.setattr(pages, "files", history.files)
        monkeypatch.setattr(pages, "source", {"old": "01", "new": "02"}.__getitem__)
        harness.keep(page, {}, made, tmp_path)
        return pages.stale(page, tmp_path)[1]

    return since


MADE = Made("0.1.0", "", "2026-11-22", "01")


def test_page_is_older_where_its_code_computes_something_else(since):
    """By packages and its own program; comments, docstrings and what writes files do not count."""
    assert since("chart", MADE, old=OLD, new=NEW) == []
    assert since("chart", MADE, old=OLD, new=NEW | CHANGED) == ["benchmarks/chart.py", "variational/x.py"]
    assert since("errors", MADE, old=OLD, new=NEW | CHANGED) == ["variational/x.py"]
    drawing = {"benchmarks/paper/page.py": b"x"}, {"benchmarks/paper/page.py": b"y"}
    assert since("paper", MADE, old=OLD | drawing[0], new=OLD | drawing[1]) == []
    assert since("chart", MADE, old=OLD, new=NEW | {"variational/new.py": b"x"}) == []  # imported by none of the others
    assert since("chart", MADE, old=OLD, new={}) == ["benchmarks/chart.py", "variational/x.py"]


def test_what_only_draws_a_page_does_not_make_it_older(since):
    """The function draw and private names that it alone uses, in turn; not those which compute use too."""
    old = """
_WIDTH = 4
_MESH = 5
def _both(): return 1
def _picture(): return 2
def _words(): return _picture()
def shared(): return 3
def compute(): return _both(), _MESH
def draw(docs): return _words(), _both(), shared(), _WIDTH
main(compute, draw)
"""
    page = "benchmarks/chart.py"
    for value, older in ((1, [page]), (2, []), (3, [page])):
        new = old.replace(f"return {value}", "return 9")
        assert since("chart", MADE, old={page: old.encode()}, new={page: new.encode()}) == older
    for name, older in (("_WIDTH", []), ("_MESH", [page])):
        new = old.replace(f"{name} = ", f"{name} = 9")
        assert since("chart", MADE, old={page: old.encode()}, new={page: new.encode()}) == older
    new = old.replace("_words(), _both()", "_words()").replace("main(compute", "main(compute2")
    assert since("chart", MADE, old={page: old.encode()}, new={page: new.encode()}) == [page]
    assert since("chart", MADE, old={page: old.encode()}, new={page: new.replace("compute2", "compute").encode()}) == []


def test_numbers_of_several_commits_are_as_old_as_the_oldest(since):
    states = Made("0.1.0", "", "", "02, 01")
    assert since("errors", states, old=OLD, new=NEW | CHANGED) == ["variational/x.py"]
    assert since("errors", Made("0.1.0", "", "", "02"), old=OLD, new=NEW | CHANGED) == []


def test_numbers_of_no_commit_are_as_old_as_in_git(since):
    """By the hash of no commit, or without a hash, where the commit that brought them is kept."""
    assert since("errors", Made("0.1.0", "", "", "ff"), old=OLD, new=CHANGED) == ["variational/x.py"]
    assert since("errors", Made("0.1.0", "old", ""), old=OLD, new=CHANGED) == ["variational/x.py"]
    assert since("errors", Made("0.1.0", "new", ""), old=OLD, new=CHANGED) == []


def test_page_is_not_older_where_the_same_numbers_were_computed(since, tmp_path):
    """By the packages of both commits, from pair to pair; a page's own program counts all the same."""
    commits = {"old": OLD, "mid": OLD | {"variational/x.py": b"x = 3"}, "new": NEW | CHANGED}
    pairs = [{"before": "mid", "now": "new"}, {"before": "old", "now": "mid"}]
    for kept, older in ((pairs, []), (pairs[:1], ["variational/x.py"]), (pairs[1:], ["variational/x.py"])):
        harness.replace(tmp_path / "same.json", json.dumps(kept))
        assert since("errors", MADE, **commits) == older
        assert since("chart", MADE, **commits) == ["benchmarks/chart.py", *older]


def test_same_but_for_some_numbers_counts_where_the_program_has_no_word_of_them(since, tmp_path):
    commits = {"old": OLD, "new": NEW | {"variational/x.py": b"x = 2"}}
    for word, older in (("sed", []), ("x", ["variational/x.py"])):
        harness.replace(tmp_path / "same.json", json.dumps([{"before": "old", "now": "new", "but": [word]}]))
        assert since("chart", MADE, **commits) == older


def test_results_differ_by_their_numbers_alone():
    """Not by seconds; a key that only the present result has is new."""
    before = {"mu": 0.5, "seconds_path": 3.0, "steps": [{"a": 1}, {"a": float("nan")}]}
    assert same.numbers(before) == {"mu": 0.5, "steps": before["steps"]}
    assert list(same.differences(before, before | {"more": 1})) == []
    now = before | {"mu": 0.5000000000000001, "steps": [{"a": 1}]}
    assert len(list(same.differences(before, now))) == 2
    assert len(list(same.differences(before, now, but=["mu"]))) == 1
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


def test_program_of_a_page_is_in_git():
    root = harness.ROOT
    assert all((root / path).exists() for name in pages.PAGES for path in pages.program(name))
    assert "benchmarks/limits.py" in pages.program("errors")
    assert pages.program("models") == ("benchmarks/runs.py", "benchmarks/models.py")
    assert not any("prose" in path or "harness" in path for path in pages.program("chart"))


def test_older_pages_are_listed(since, tmp_path, capsys):
    """Those alone, with their version and what changed; a page is not drawn."""
    harness.keep("errors", {}, Made("0.1.0", "", "", "02"), tmp_path)
    since("chart", MADE, old=OLD, new=NEW | CHANGED)
    assert pages.main(["chart", "errors", "--stale", "--docs", str(tmp_path)]) == 0
    assert capsys.readouterr().out.splitlines() == [
        "chart: version 0.1.0 of 2026-11-22, commit old; since then changed: benchmarks/chart.py, variational/x.py",
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
