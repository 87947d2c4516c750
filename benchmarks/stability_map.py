"""The stability map: where the solver converges, at what cost and with what error, as pictures and a page.

environment/run python3 benchmarks/stability_map.py [--jobs 2] [--hours 6] [--draw]

Results are kept in results/stability/runs.jsonl after each run; started again, only what is missing is run. After a
change of the solver delete that file.
"""

import argparse
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path

from benchmarks.stability import pictures, plan, table
from benchmarks.stability.cache import Cache, run_all
from benchmarks.stability.case import Case, Outcome
from fingerpad.cli.arguments import positive
from variational.roughness.bam import BearingArea

_ROOT = Path(__file__).resolve().parents[1]
# The floor of the closure is no part of what the fixed points are compared for.
_CLOSURE = BearingArea(h_0=0.514e-6, p_floor=1.0)


def show(cache: Cache, left: int, out: Path, docs: Path) -> None:
    """Draw the charts and write the page from what the cache holds."""
    charts = plan.charts()
    (docs / "stability").mkdir(parents=True, exist_ok=True)
    for chart in charts:
        pictures.draw(chart, cache, out / f"{chart.name}.png")
        shutil.copy(out / f"{chart.name}.png", docs / "stability")
    table.write(docs / "stability.md", charts, plan.neighbours(), plan.named(), _CLOSURE, cache, left)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run what is missing, draw, and say what failed to be run."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=_ROOT / "results" / "stability", help="folder of results")
    parser.add_argument("--docs", type=Path, default=_ROOT / "docs", help="folder of the page and its pictures")
    parser.add_argument("--jobs", type=positive(int), default=2, help="runs at a time")
    parser.add_argument("--limit", type=positive(float), default=120.0, help="seconds of processor time for one run")
    parser.add_argument("--hours", type=positive(float), default=6.0, help="after which no run is started")
    parser.add_argument("--draw", action="store_true", help="run nothing, draw what is there")
    args = parser.parse_args(arguments)
    cache, cases = Cache(args.out / "runs.jsonl"), plan.cases()

    def report(case: Case, outcome: Outcome, left: int) -> None:
        print(f"{left:4d} left  {outcome.seconds:6.1f} s  {outcome.status} {outcome.reason}  {case}", flush=True)

    print(f"stability map: {len(cases)} solves, {len(cache.missing(cases))} to be run")
    if not args.draw:
        run_all(cases, cache, args.jobs, args.limit, args.hours, report)
    left = len(cache.missing(cases))
    show(cache, left, args.out, args.docs)
    print(f"{args.docs / 'stability.md'}" + (f"; {left} runs are missing" if left else ""))
    return 1 if left and not args.draw else 0


if __name__ == "__main__":
    sys.exit(main())
