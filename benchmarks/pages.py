"""Draw every generated page and picture from the kept numbers, without a run; list those older than the code.

environment/run python3 -m benchmarks.pages [NAME ...]     also: make pages
python3 -m benchmarks.pages --stale                        also: make stale; needs git and no dolfinx

A page is older than the code where a commit after the one that made its numbers changes a package (geometry,
variational, fingerpad), or one after that which brought them into git changes the page's own program, the module that
only draws it left out. Commits that change nothing but docs, tests, prose or other pages' programs do not count. The
commit that made numbers is found by the hash of the packages' files that is kept with them. Numbers of files that are
in no commit count as made by the commit that brought them, and so do older numbers, which have no hash.
"""

import argparse
import hashlib
import io
import json
import subprocess
import sys
import tarfile
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
# Each has a function draw(docs), which writes the page's files into a folder and returns the path of the page.
PAGES = {
    "accuracy": "benchmarks.accuracy",
    "chart": "benchmarks.chart",
    "errors": "benchmarks.errors",
    "hero": "benchmarks.hero",
    "models": "benchmarks.models",
    "paper": "benchmarks.paper.page",
    "peers": "benchmarks.peers.page",
    "performance": "benchmarks.performance",
    "stability": "benchmarks.stability.page",
    "verification": "benchmarks.verification.case",
}
_PACKAGES = ("geometry", "variational", "fingerpad")
_SHARED = ("runs", "limits", "measure", "explicit")  # modules of benchmarks/ that make numbers of several pages
_SEARCHED = 100  # commits before the one that brought numbers into git, among which theirs is looked for


def git(*words: str) -> bytes:
    """Return what git writes."""
    return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, check=True).stdout


def source(commit: str) -> str:
    """Return the hash of the packages' files in a commit, as ``fingerpad.io.provenance`` has it of those on disk."""
    found = hashlib.sha256()
    with tarfile.open(fileobj=io.BytesIO(git("archive", commit, *_PACKAGES))) as files:
        for path in sorted(Path(name) for name in files.getnames() if name.endswith(".py")):
            if file := files.extractfile(str(path)):
                found.update(str(path).encode() + file.read())
    return found.hexdigest()[:12]


def program(name: str) -> list[str]:
    """Return the files in benchmarks/ that make the numbers of a page, as git names paths."""
    _, own, *module = PAGES[name].split(".")
    parts = [f"benchmarks/{own}", f":!benchmarks/{own}/page.py"] if module else [f"benchmarks/{own}.py"]
    return [*(f"benchmarks/{shared}.py" for shared in _SHARED), *parts]


def stale(name: str, docs: Path) -> tuple[str, int]:
    """Return which version made the numbers of a page, in words, and how many commits since have changed its code."""

    def commits(where: str, paths: Sequence[str], *options: str) -> list[str]:
        return git("rev-list", "--abbrev-commit", *options, where, "--", *paths).decode().split()

    made = json.loads((docs / f"{name}.json").read_text(encoding="utf-8"))["made"]
    found = [brought := made["commit"]]  # of older numbers, which have no hash
    if made["source"]:
        brought = git("log", "-1", "--format=%h", "--", str(docs / f"{name}.json")).decode().strip() or "HEAD"
        before, states = commits(brought, _PACKAGES, f"-n{_SEARCHED}"), made["source"].split(", ")
        found = [next((commit for commit in before if source(commit) == state), brought) for state in states]
    since = {later for commit in found for later in commits(f"{commit}..HEAD", _PACKAGES)}
    since |= set(commits(f"{brought}..HEAD", program(name)))
    return f"version {made['version']} of {made['date']}, commit {', '.join(found)}", len(since)


def main(given: Sequence[str] | None = None) -> int:
    """Draw the pages named, or all; or list those of them that are older than the code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"pages: {', '.join(PAGES)}; all without a name")
    parser.add_argument("--docs", type=Path, default=ROOT / "docs", help="folder of the pages and their numbers")
    parser.add_argument("--stale", action="store_true", help="draw nothing, list the pages older than the code")
    args = parser.parse_args(given)
    if unknown := set(args.names) - set(PAGES):
        parser.error(f"no page {', '.join(sorted(unknown))}; there are {', '.join(PAGES)}")
    names = args.names or list(PAGES)
    if not args.stale:
        for name in names:
            print(import_module(PAGES[name]).draw(args.docs))
        return 0
    found = {name: stale(name, args.docs) for name in names}
    older = {name: (words, count) for name, (words, count) in found.items() if count}
    for name, (words, count) in older.items():
        print(f"{name}: {words}; {count} commits since")
    print(f"{len(older)} of {len(found)} pages are older than the code that they rest on")
    return 0


if __name__ == "__main__":
    sys.exit(main())
