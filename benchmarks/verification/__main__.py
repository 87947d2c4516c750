"""Verification: every case with a known answer as numbers and a page; fails where a number is off.

environment/run python3 -m benchmarks.verification [--only AREA ...] [--small]
"""

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from benchmarks.harness import DOCS, keep, made
from benchmarks.verification import (
    adhesion,
    constitutive,
    cook,
    discretisation,
    electric,
    friction,
    halfspace,
    microscale,
    normal_contact,
    relaxing,
    rough,
    slices,
    spikes,
)
from benchmarks.verification.case import Case, Row, draw, numbers

AREAS: dict[str, tuple[Case, ...]] = {
    "Constitutive": constitutive.CASES,
    "Discretisation": discretisation.CASES + cook.CASES,
    "Viscosity": relaxing.CASES,
    "Normal contact": normal_contact.CASES,
    "Friction": friction.CASES,
    "Adhesion": adhesion.CASES,
    "Circuit": electric.CASES,
    "Rough contact": halfspace.CASES + rough.CASES,
    "Microscale": microscale.CASES,
    "Two scales": microscale.TWO_SCALES,
    "Whole finger": slices.CASES,
    "Spikes": spikes.CASES,
}


def main(given: Sequence[str] | None = None) -> int:
    """Run the given areas; numbers and page are written only when all were run in full."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="*", choices=AREAS, default=list(AREAS), help="areas to run")
    parser.add_argument("--small", action="store_true", help="coarse meshes, as in the tests")
    parser.add_argument("--docs", type=Path, default=DOCS, help="folder of the page and its numbers")
    args = parser.parse_args(given)
    results: dict[str, list[tuple[Case, Sequence[Row]]]] = {area: [] for area in args.only}
    for area, case in ((name, case) for name in args.only for case in AREAS[name]):
        start = time.perf_counter()
        results[area].append((case, case.rows(args.small)))
        print(f"{area}: {case.name} ({time.perf_counter() - start:.0f} s)", flush=True)
        for row in results[area][-1][1]:
            words = f"{row.quantity}: {row.computed:.8g}, {row.reference:.8g} expected, error {row.error:.2g}"
            print(f"  {'ok  ' if row.holds else 'FAIL'} {words}")
    if not args.small and len(results) == len(AREAS):
        keep("verification", numbers(results), made(), args.docs)
        print(draw(args.docs))
    failed = [row for cases in results.values() for _, rows in cases for row in rows if not row.holds]
    print(f"{len(failed)} numbers are off" if failed else "every number is within its tolerance")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
