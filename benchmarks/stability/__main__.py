"""The stability map and random scenes: where the solver converges, at what cost and with what error.

environment/run python3 -m benchmarks.stability [--part map | random] [--jobs 2] [--hours 6] [--draw]
environment/run python3 -m benchmarks.stability --row "ε_n × 10"      one row of a table, with its reference

Cases are run in processes of their own. Outcomes of the map are kept in results/stability/map after each run, random
scenes (benchmarks/stability/scenes.py) in folders beside it; started again, only what is missing is run. After a
change of the solver delete that folder. Writes docs/stability.json, and from it docs/stability.md and its picture.
"""

import argparse
import json
import sys
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from benchmarks.harness import keep, kept, made, parser, solve
from benchmarks.stability import page, plan, scenes
from benchmarks.stability.plan import Case, Outcome

# Of an outcome, what the page shows.
_SHOWN = "status reason load newton factorisations cutbacks inverted penetration f_t contact_length f_ext".split()


def outcomes(cases: Iterable[Case], args: argparse.Namespace) -> dict[Case, Outcome]:
    """Run the cases whose outcomes are not kept yet; return those there are within the hours given."""
    named = {json.dumps(case.changed, ensure_ascii=False): case for case in cases}
    data = {name: case.changed for name, case in named.items()}
    found = solve("benchmarks.stability.solve", data, args.out / "map", args.jobs, args.limit, args.hours)
    return {case: _outcome(found[name], args.limit) for name, case in named.items() if name in found}


def _outcome(found: dict[str, Any], limit: float) -> Outcome:
    if "failure" not in found:
        return Outcome(**found)
    seconds = 0.0 if found["failure"].startswith("CRASH") else limit
    return Outcome("failed", found["failure"], found["message"], seconds=seconds)


def numbers(found: Mapping[Case, Outcome]) -> dict[str, Any]:
    """Return what the page shows of the cases that have been run, ready for JSON."""
    rows = []
    for case, outcome in found.items():
        compared = {"f_t": case.slide, "contact_length": True, "f_ext": case.indentation}
        errors = {f"error_{name}": _error(found, case, name) for name, told in compared.items() if told}
        rows.append({"case": case.changed} | {name: getattr(outcome, name) for name in _SHOWN} | errors)
    return {"solves": len(found), "seconds": sum(outcome.seconds for outcome in found.values()), "runs": rows}


def _error(found: Mapping[Case, Outcome], case: Case, name: str) -> float | None:
    """Return the relative error of a quantity, with its sign; None without a reference or where one of both failed."""
    here, finest = found[case], found.get(case.reference)
    if finest is None or "failed" in (here.status, finest.status):
        return None
    exact = getattr(finest, name)
    return float((getattr(here, name) - exact) / abs(exact)) if exact else None


def main(given: Sequence[str] | None = None) -> int:
    """Run what is missing, keep its numbers and draw the page; or make one row."""
    names = [name for group in (plan.neighbours(), *plan.named().values()) for name in group.cases]
    asked = parser(__doc__, "stability")
    asked.add_argument("--limit", type=float, default=120.0, help="seconds of processor time for one run")
    asked.add_argument("--hours", type=float, default=6.0, help="after which no run of the map is started")
    asked.add_argument("--part", choices=("map", "random"), help="run this part alone, and keep the other's numbers")
    asked.add_argument("--row", choices=names, metavar="NAME", help=f"this row alone, printed: {', '.join(names)}")
    args = asked.parse_args(given)
    if args.row:
        group = next(group for group in (plan.neighbours(), *plan.named().values()) if args.row in group.cases)
        case = group.cases[args.row]
        runs = numbers(outcomes([case, case.reference] if group.referenced else [case], args))["runs"]
        rows = {Case(**each["case"]): each for each in runs}
        print(page.named_table(plan.Named({args.row: case}, group.referenced), rows))
        return 0 if case in rows else 1
    left = 0
    if not args.draw and args.part != "random":
        found = outcomes(cases := plan.cases(), args)
        left = len(cases) - len(found)
        keep("stability", kept("stability", args.docs).numbers | numbers(found), made(), args.docs)
    if not args.draw and args.part != "map":
        old = kept("stability", args.docs)
        keep("stability", old.numbers | {"random": scenes.numbers(args)}, old.made, args.docs)
    print(f"{page.draw(args.docs)}" + (f"; {left} runs are missing" if left else ""))
    return 1 if left else 0


if __name__ == "__main__":
    sys.exit(main())
