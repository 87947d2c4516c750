"""The stability map: where the solver converges, at what cost and with what error.

environment/run python3 -m benchmarks.stability [--jobs 2] [--hours 6] [--draw]

Outcomes are kept in results/stability/runs.jsonl after each run; started again, only what is missing is run. After a
change of the solver delete that file. Writes docs/stability.json, and from it docs/stability.md and its picture.
"""

import sys
from collections.abc import Sequence

from benchmarks.harness import keep, made, parser
from benchmarks.stability import page, plan
from benchmarks.stability.runs import Runs, run_all
from fingerpad.cli.arguments import positive


def main(given: Sequence[str] | None = None) -> int:
    """Run what is missing, keep its numbers and draw the page."""
    asked = parser(__doc__, "stability")
    asked.add_argument("--limit", type=positive(float), default=120.0, help="seconds of processor time for one run")
    asked.add_argument("--hours", type=positive(float), default=6.0, help="after which no run is started")
    args = asked.parse_args(given)
    left = 0
    if not args.draw:
        runs, cases = Runs(args.out / "runs.jsonl"), plan.cases()
        print(f"stability map: {len(cases)} solves, {len(runs.missing(cases))} to be run")
        left = run_all(cases, runs, args.jobs, args.limit, args.hours)
        keep("stability", runs.numbers(cases), made(), args.docs)
    print(f"{page.draw(args.docs)}" + (f"; {left} runs are missing" if left else ""))
    return 1 if left else 0


if __name__ == "__main__":
    sys.exit(main())
