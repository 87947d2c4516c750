"""Put the kept numbers in place in every page and draw their pictures, without a run; list how old numbers are.

environment/run python3 -m benchmarks.pages [NAME ...]     also: make pages
python3 -m benchmarks.pages --stale                        also: make stale; needs git and no dolfinx

``--stale`` counts, for each page, the commits since its numbers came into git that touch the packages or the page's own
program. Whether the packages still compute the same numbers, ``benchmarks.same`` tells.
"""

import argparse
import json
import subprocess
import sys
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
# Each has a function draw(docs), which writes the page's files into a folder and returns the path of the page.
PAGES = {
    "accuracy": "benchmarks.accuracy",
    "adjoint_errors": "benchmarks.adjoint_errors",
    "assumptions": "benchmarks.assumptions",
    "calibrate": "benchmarks.calibrate",
    "chart": "benchmarks.chart",
    "drive": "benchmarks.drive",
    "errors": "benchmarks.errors",
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
    "presses": "benchmarks.presses",
    "sensitivities": "benchmarks.sensitivities",
    "stability": "benchmarks.stability.__main__",
    "two_meshes": "benchmarks.two_meshes",
    "verification": "benchmarks.verification.case",
    "viscosity": "benchmarks.viscosity",
}
_PACKAGES = ("geometry", "variational", "fingerpad")


def git(*words: str) -> str:
    """Return what git writes."""
    return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()


def age(name: str, docs: Path) -> str:
    """Return which version made the numbers of a page, and how many commits have touched its code since."""
    file = docs / f"{name}.json"
    made = json.loads(file.read_text(encoding="utf-8"))["made"]
    _, own, *module = PAGES[name].split(".")
    program = f"benchmarks/{own if module else f'{own}.py'}"
    brought = git("log", "-1", "--format=%h", "--", str(file)) or "HEAD"
    later = (git("rev-list", "--count", f"{brought}..HEAD", "--", *paths) for paths in (_PACKAGES, (program,)))
    counts = "{} commits to the packages and {} to its program since".format(*later)
    return f"{name}: numbers of version {made['version']}, {made['date']}, in git by {brought}; {counts}"


def main(given: Sequence[str] | None = None) -> int:
    """Fill the pages named, or all; or list how old their numbers are."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"pages: {', '.join(PAGES)}; all without a name")
    parser.add_argument("--docs", type=Path, default=ROOT / "docs", help="folder of the pages and their numbers")
    parser.add_argument("--stale", action="store_true", help="fill nothing, list how old the numbers are")
    args = parser.parse_args(given)
    if unknown := set(args.names) - set(PAGES):
        parser.error(f"no page {', '.join(sorted(unknown))}; there are {', '.join(PAGES)}")
    for name in args.names or PAGES:
        print(age(name, args.docs) if args.stale else import_module(PAGES[name]).draw(args.docs))
    return 0


if __name__ == "__main__":
    sys.exit(main())
