"""Draw every generated page and picture from the kept numbers, without a run; list those older than the code.

environment/run python3 -m benchmarks.pages [NAME ...]     also: make pages
python3 -m benchmarks.pages --stale                        also: make stale; needs git and no dolfinx

A page is older than the code where a file that computes its numbers differs from that which made them: one of the
packages (geometry, variational, fingerpad without what starts, reads, refuses, orders runs, writes and prints), or of
the page's own program, up to its comment "-- page". Comments and docstrings do not count, nor packages that were found
to compute the same numbers (docs/same.json, by benchmarks/same.py), or the same but for some that the page's program
has no word of. Where these agree within a tolerance alone, the page is listed with it. The commit that made numbers is
found by the hash of the packages' files that is kept with them; a program in benchmarks/ is compared with that of the
commit that brought them into git. Numbers of files that are in no commit count as made by the commit that brought them,
and so do older numbers, which have no hash.
"""

import argparse
import ast
import functools
import hashlib
import io
import json
import re
import subprocess
import sys
import tarfile
from collections.abc import Iterable, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
# Each has a function draw(docs), which writes the page's files into a folder and returns the path of the page.
PAGES = {
    "accuracy": "benchmarks.accuracy",
    "assumptions": "benchmarks.assumptions",
    "chart": "benchmarks.chart",
    "drive": "benchmarks.drive",
    "errors": "benchmarks.errors",
    "feel": "benchmarks.feel.__main__",
    "fingers": "benchmarks.fingers",
    "hero": "benchmarks.hero",
    "loads": "benchmarks.loads.__main__",
    "measured": "benchmarks.measured.__main__",
    "microscale": "benchmarks.microscale.__main__",
    "models": "benchmarks.models",
    "newtons": "benchmarks.newtons",
    "paper": "benchmarks.paper.__main__",
    "peers": "benchmarks.peers.__main__",
    "performance": "benchmarks.performance",
    "stability": "benchmarks.stability.__main__",
    "two_meshes": "benchmarks.two_meshes",
    "verification": "benchmarks.verification.case",
    "viscosity": "benchmarks.viscosity",
}
SAME = "same.json"  # pairs of commits that compute the same numbers
_PACKAGES = ("geometry", "variational", "fingerpad")
_WITHOUT_NUMBERS = (  # these start, read, refuse, order runs, write and print
    *(f"fingerpad/{wing}/" for wing in ("cli", "io", "results", "report", "calculator", "runs")),  # io: now results
    *("fingerpad/startup.py", "fingerpad/launcher.py", "geometry/meshfile.py", "fingerpad/model/cost.py"),
    *("fingerpad/model/expected.py", "fingerpad/scene/contradictions.py", "fingerpad/scene/messages.py"),
    "fingerpad/model/report.py",
)
_APART = ("fingerpad/reduced",)  # no full run uses them: parts of the programs that import them
_SHARED = ("runs", "limits", "measure")  # modules of benchmarks/ that make numbers of several pages
_SEARCHED = 100  # commits before the one that brought numbers into git, among which theirs is looked for
_SHOWN = 3  # changed files of a page that are printed


def git(*words: str) -> bytes:
    """Return what git writes."""
    return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, check=True).stdout


@functools.cache
def files(commit: str, paths: tuple[str, ...]) -> dict[str, bytes]:
    """Return the Python files of a commit in folders, or at paths, by path."""
    there = [path for path in paths if git("ls-tree", "--name-only", commit, "--", path)]
    if not there:
        return {}
    with tarfile.open(fileobj=io.BytesIO(git("archive", commit, *there))) as packed:
        found = {name: packed.extractfile(name) for name in sorted(packed.getnames(), key=Path) if name.endswith(".py")}
        return {name: file.read() for name, file in found.items() if file}


def source(commit: str) -> str:
    """Return the hash of the packages' files in a commit, as ``fingerpad.results.provenance`` of those on disk."""
    found = hashlib.sha256()
    for path, text in files(commit, _PACKAGES).items():
        found.update(path.encode() + text)
    return found.hexdigest()[:12]


@functools.cache
def computes(text: bytes) -> str:
    """Return the statements of a module, without comments and docstrings, up to the comment ``-- page``."""
    module = ast.parse(text.partition(b"\n# -- page ")[0])
    for node in ast.walk(module):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(node, clean=False):
            node.body = node.body[1:] or [ast.Pass()]
    return ast.dump(module)


def changed(before: Mapping[str, bytes], now: Mapping[str, bytes]) -> set[str]:
    """Return the paths of modules that compute something else or are gone; a new one counts where one imports it."""
    differ = [path for path in before if before[path] != now.get(path)]
    return {path for path in differ if path not in now or computes(before[path]) != computes(now[path])}


def program(name: str) -> tuple[str, ...]:
    """Return the files and folders in benchmarks/ that make the numbers of a page."""
    _, own, *module = PAGES[name].split(".")
    path = ROOT / "benchmarks" / (own if module else f"{own}.py")
    text = "".join(file.read_text(encoding="utf-8") for file in ([path] if path.is_file() else path.glob("*.py")))
    shared = [name for name in _SHARED if re.search(rf"benchmarks(\.| import (\w+, )*){name}\b", text)]
    return *(f"benchmarks/{name}.py" for name in shared), f"benchmarks/{path.name}"


def since(commit: str, aside: tuple[str, ...], pairs: Sequence[Mapping[str, Any]]) -> tuple[set[str], float]:
    """Return the files of the packages that compute something else since a commit, and the tolerance of the others.

    Args:
        commit: the older commit.
        aside: beginnings of paths that do not count.
        pairs: commits that compute the same numbers, within a part of the largest one where they say so.
    """

    def differ(older: str, newer: str) -> set[str]:
        found = changed(files(older, _PACKAGES), files(newer, _PACKAGES))
        return {path for path in found if not path.startswith(aside)}

    if not (found := differ(commit, "HEAD")):
        return set(), 0.0
    for pair in (pair for pair in pairs if not differ(commit, pair["before"])):
        left, within = since(pair["now"], aside, [other for other in pairs if other is not pair])
        if not left:
            return set(), max(within, pair.get("within", 0.0))
    return found, 0.0


def _same(docs: Path, texts: Iterable[bytes]) -> list[dict[str, Any]]:
    """Return the pairs of commits that compute the same numbers for a program, by the texts of its files."""
    path = docs / SAME
    pairs = json.loads(path.read_text(encoding="utf-8")) if path.exists() else []
    words = set(re.findall(r"[a-z]+", b" ".join(texts).decode()))
    return [pair for pair in pairs if not words & set(pair.get("but", ()))]


def stale(name: str, docs: Path) -> tuple[str, list[str]]:
    """Return which version made the numbers of a page, in words, and the files of its code that have changed since."""
    made = json.loads((docs / f"{name}.json").read_text(encoding="utf-8"))["made"]
    found = [brought := made["commit"]]  # of older numbers, which have no hash
    if made["source"]:
        brought = git("log", "-1", "--format=%h", "--", str(docs / f"{name}.json")).decode().strip() or "HEAD"
        options = ("--abbrev-commit", f"-n{_SEARCHED}", brought, "--", *_PACKAGES)
        before, states = git("rev-list", *options).decode().split(), made["source"].split(", ")
        found = [next((commit for commit in before if source(commit) == state), brought) for state in states]
    now = files("HEAD", own := program(name))
    pairs = _same(docs, now.values())
    compared = [since(commit, (*_WITHOUT_NUMBERS, *_APART), pairs) for commit in found]
    differ, within = set[str]().union(*(paths for paths, _ in compared)), max(part for _, part in compared)
    used = tuple(part for part in _APART if any(part.replace("/", ".").encode() in text for text in now.values()))
    if used:
        differ |= {path for path in since(brought, _WITHOUT_NUMBERS, pairs)[0] if path.startswith(used)}
    differ |= changed(files(brought, own), now)
    words = f"version {made['version']} of {made['date']}, commit {', '.join(found)}"
    return words + f"; the packages compute the same within {within:g} ({SAME})" * (within > 0), sorted(differ)


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
    for name, (words, differ) in found.items():
        if differ:
            words += f"; since then changed: {', '.join(differ[:_SHOWN])}{' …' * (len(differ) > _SHOWN)}"
        if differ or "within" in words:
            print(f"{name}: {words}")
    own = [all(path.startswith("benchmarks/") for path in differ) for _, differ in found.values() if differ]
    print(f"{len(own)} of {len(found)} pages are older than their code, {sum(own)} by benchmarks/ alone")
    return 0


if __name__ == "__main__":
    sys.exit(main())
