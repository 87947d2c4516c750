"""Draw every generated page and picture from the kept numbers, without a run.

environment/run python3 -m benchmarks.pages [NAME ...]     also: make pages
"""

import argparse
import sys
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

from benchmarks.harness import DOCS

# Each has a function draw(docs), which writes the page's files into a folder and returns the path of the page.
PAGES = {
    "accuracy": "benchmarks.accuracy",
    "chart": "benchmarks.chart",
    "errors": "benchmarks.errors",
    "hero": "benchmarks.hero",
    "models": "benchmarks.models",
    "paper": "benchmarks.paper.page",
    "peers": "benchmarks.peers.page",
    "stability": "benchmarks.stability.page",
    "verification": "benchmarks.verification.case",
}


def main(given: Sequence[str] | None = None) -> int:
    """Draw the pages named, or all."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"pages: {', '.join(PAGES)}; all without a name")
    parser.add_argument("--docs", type=Path, default=DOCS, help="folder of the pages and their numbers")
    args = parser.parse_args(given)
    if unknown := set(args.names) - set(PAGES):
        parser.error(f"no page {', '.join(sorted(unknown))}; there are {', '.join(PAGES)}")
    for name in args.names or PAGES:
        print(import_module(PAGES[name]).draw(args.docs))
    return 0


if __name__ == "__main__":
    sys.exit(main())
