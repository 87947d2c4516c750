"""Verification: every case with a known answer, as numbers, a page and pictures; fails where a number is off.

environment/run python3 benchmarks/verify.py [--only AREA ...] [--small]
"""

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from mpi4py import MPI
from rich.progress import Progress

from benchmarks.verification import page
from benchmarks.verification.areas import AREAS
from benchmarks.verification.case import Case, Outcome
from fingerpad.runs.batch import progress
from variational import jit

_ROOT = Path(__file__).resolve().parents[1]


def _run(area: str, case: Case, small: bool, bar: Progress) -> Outcome:
    start = time.perf_counter()
    outcome = case.run(small)

    def say(words: str) -> None:
        bar.console.print(words, highlight=False, markup=False, soft_wrap=True)

    say(f"{area}: {case.name} ({time.perf_counter() - start:.0f} s)")
    for row in outcome.rows:
        verdict = "ok  " if row.holds else "FAIL"
        say(f"  {verdict} {row.quantity}: {row.ours:.8g}, {row.reference:.8g} expected, error {row.error:.2g}")
    return outcome


def _run_all(areas: Sequence[str], small: bool) -> dict[str, list[tuple[Case, Outcome]]]:
    with progress() as bar:
        cases = [(area, case) for area in areas for case in AREAS[area]]
        results: dict[str, list[tuple[Case, Outcome]]] = {area: [] for area in areas}
        for area, case in bar.track(cases, description="cases"):
            results[area].append((case, _run(area, case, small, bar)))
    return results


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the areas asked for; the page is written only when all were run in full."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="*", choices=AREAS, default=list(AREAS), help="areas to run")
    parser.add_argument("--small", action="store_true", help="coarse meshes, as in the tests")
    parser.add_argument("--docs", type=Path, default=_ROOT / "docs", help="folder of the page")
    args = parser.parse_args(arguments)
    jit.delete_unfinished(MPI.COMM_WORLD)
    results = _run_all(args.only, args.small)
    if not args.small and len(results) == len(AREAS):
        page.write(results, args.docs)
        print(args.docs / "verification.md")
    failed = [r for cases in results.values() for _, outcome in cases for r in outcome.rows if not r.holds]
    print(f"{len(failed)} numbers are off" if failed else "every number is within its tolerance")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
