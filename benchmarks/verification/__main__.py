"""Verification: every case with a known answer as numbers and a page; fails where a number is off.

environment/run python3 -m benchmarks.verification [--only AREA ...] [--small] [--pictures]
"""

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from mpi4py import MPI
from rich.progress import Progress

from benchmarks.harness import DOCS, RESULTS, keep, made, picture
from benchmarks.verification import page
from benchmarks.verification.areas import AREAS
from benchmarks.verification.case import Case, Outcome
from fingerpad.runs.batch import progress
from variational import jit


def _run(area: str, case: Case, small: bool, bar: Progress) -> Outcome:
    start = time.perf_counter()
    outcome = case.run(small)

    def say(words: str) -> None:
        bar.console.print(words, highlight=False, markup=False, soft_wrap=True)

    say(f"{area}: {case.name} ({time.perf_counter() - start:.0f} s)")
    for row in outcome.rows:
        verdict = "ok  " if row.holds else "FAIL"
        say(f"  {verdict} {row.quantity}: {row.computed:.8g}, {row.reference:.8g} expected, error {row.error:.2g}")
    return outcome


def main(given: Sequence[str] | None = None) -> int:
    """Run the areas asked for; numbers and page are written only when all were run in full."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="*", choices=AREAS, default=list(AREAS), help="areas to run")
    parser.add_argument("--small", action="store_true", help="coarse meshes, as in the tests")
    parser.add_argument("--pictures", action="store_true", help="draw known and computed curves into --out")
    parser.add_argument("--out", type=Path, default=RESULTS / "verification", help="folder of the pictures")
    parser.add_argument("--docs", type=Path, default=DOCS, help="folder of the page and its numbers")
    args = parser.parse_args(given)
    jit.delete_unfinished(MPI.COMM_WORLD)
    results: dict[str, list[tuple[Case, Outcome]]] = {area: [] for area in args.only}
    with progress() as bar:
        cases = [(area, case) for area in args.only for case in AREAS[area]]
        for area, case in bar.track(cases, description="cases"):
            results[area].append((case, _run(area, case, args.small, bar)))
    every = [(case, outcome) for some in results.values() for case, outcome in some]
    for case, outcome in every if args.pictures else []:
        if outcome.curves is not None:
            picture(args.out / f"{case.slug}.png", (7.0, 3.6), outcome.curves.draw, case.name)
    if not args.small and len(results) == len(AREAS):
        keep("verification", page.numbers(results), made(), args.docs)
        print(page.draw(args.docs))
    failed = [row for _, outcome in every for row in outcome.rows if not row.holds]
    print(f"{len(failed)} numbers are off" if failed else "every number is within its tolerance")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
