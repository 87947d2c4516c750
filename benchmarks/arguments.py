"""What every benchmark that runs scenes of the finger is asked on the command line."""

import argparse
from pathlib import Path

from fingerpad.cli.arguments import positive

_ROOT = Path(__file__).resolve().parents[1]


def parser(description: str | None) -> argparse.ArgumentParser:
    """Return a parser of ``--out``, ``--docs`` and ``--jobs``; all such benchmarks share one folder of results."""
    found = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    found.add_argument("--out", type=Path, default=_ROOT / "results" / "traces", help="folder of results")
    found.add_argument("--docs", type=Path, default=_ROOT / "docs", help="folder of the page and its pictures")
    found.add_argument("--jobs", type=positive(int), default=2, help="runs at a time")
    return found
