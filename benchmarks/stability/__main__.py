"""The stability map and random scenes: where the solver converges, at what cost and with what error.

environment/run python3 -m benchmarks.stability [--part map | random] [--jobs 2] [--hours 6] [--draw]
environment/run python3 -m benchmarks.stability --row "ε_n × 10"      one row of a table, with its reference

Cases are run in processes of their own. Outcomes of the map are kept in results/stability/runs.jsonl after each run,
random scenes (benchmarks/stability/scenes.py) in folders beside it; started again, only what is missing is run. After a
change of the solver delete that folder. Writes docs/stability.json, and from it docs/stability.md and its picture.
"""

import json
import sys
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from benchmarks.harness import keep, kept, made, parser
from benchmarks.stability import page, plan, scenes
from benchmarks.stability.plan import Case, Outcome
from fingerpad.runs import processes
from fingerpad.runs.processes import Pool

# Of an outcome, what the page shows.
_SHOWN = "status reason load newton factorisations cutbacks inverted penetration f_t contact_length f_ext".split()


class Runs:
    """Outcomes by case, in a file, one line each."""

    def __init__(self, path: Path) -> None:
        """Read what is there; a last line that was cut short is left out."""
        self.path, self.outcomes = path, dict[Case, Outcome]()
        path.parent.mkdir(parents=True, exist_ok=True)
        for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else []:
            try:
                entry = json.loads(line)
            except json.JSONDecodeError:
                continue
            self.outcomes[Case(**entry["case"])] = Outcome(**entry["outcome"])

    def add(self, case: Case, outcome: Outcome) -> None:
        """Keep an outcome."""
        self.outcomes[case] = outcome
        with self.path.open("a", encoding="utf-8") as file:
            # First ends a line that was cut short; blank ones are skipped.
            file.write("\n" + json.dumps({"case": case.changed, "outcome": asdict(outcome)}) + "\n")

    def missing(self, cases: Iterable[Case]) -> list[Case]:
        """Return the cases that have not been run, each once, in order."""
        return [case for case in dict.fromkeys(cases) if case not in self.outcomes]

    def error(self, case: Case, name: str) -> float | None:
        """Return the relative error of a quantity, with its sign; None without a run or a reference that ended well."""
        here, finest = self.outcomes.get(case), self.outcomes.get(case.reference)
        if here is None or finest is None or "failed" in (here.status, finest.status):
            return None
        exact = getattr(finest, name)
        return float((getattr(here, name) - exact) / abs(exact)) if exact else None

    def numbers(self, cases: Iterable[Case]) -> dict[str, Any]:
        """Return what the page shows of cases that have been run, ready for JSON."""
        rows = []
        for case in (case for case in cases if case in self.outcomes):
            compared = {"f_t": case.slide, "contact_length": True, "f_ext": case.indentation}
            errors = {f"error_{name}": self.error(case, name) for name, told in compared.items() if told}
            outcome = asdict(self.outcomes[case])
            rows.append({"case": case.changed} | {name: outcome[name] for name in _SHOWN} | errors)
        seconds = sum(outcome.seconds for outcome in self.outcomes.values())
        return {"solves": len(self.outcomes), "seconds": seconds, "runs": rows}


def solve(case: Case, limit: float) -> Outcome:
    """Run a case in a process of its own, for at most so many seconds of processor time; however it ends, return."""
    end = processes.run("benchmarks.stability.solve", [json.dumps(case.changed), str(limit)], limit)
    if end.reason:
        return Outcome("failed", end.reason, end.message, seconds=0.0 if end.reason.startswith("CRASH") else limit)
    try:
        return Outcome(**json.loads(end.stdout.splitlines()[-1]))
    except (IndexError, TypeError, json.JSONDecodeError):
        return Outcome("failed", "CRASH", "no outcome printed")


def run_all(cases: Iterable[Case], runs: Runs, jobs: int, limit: float, hours: float) -> int:
    """Run what is missing, each for at most ``limit`` (s); return how many are left when ``hours`` are up."""

    def done(case: Case, outcome: Outcome, left: int) -> None:
        runs.add(case, outcome)
        print(f"{left:4d} left  {outcome.seconds:6.1f} s  {outcome.status} {outcome.reason}  {case}", flush=True)

    return Pool[Case, Outcome](lambda case: solve(case, limit), jobs, hours).run(runs.missing(cases), done)


def row(name: str, runs: Runs, jobs: int, limit: float, hours: float) -> int:
    """Run a row of a table and its reference where they are missing, print the row; return how many runs are left."""
    group = next(group for group in (plan.neighbours(), *plan.named().values()) if name in group.cases)
    case = group.cases[name]
    cases = [case, case.reference] if group.referenced else [case]
    left = run_all(cases, runs, jobs, limit, hours)
    found = {Case(**each["case"]): each for each in runs.numbers(cases)["runs"]}
    print(page.named_table(plan.Named({name: case}, group.referenced), found))
    return left


def main(given: Sequence[str] | None = None) -> int:
    """Run what is missing, keep its numbers and draw the page; or make one row."""
    rows = [name for group in (plan.neighbours(), *plan.named().values()) for name in group.cases]
    asked = parser(__doc__, "stability")
    asked.add_argument("--limit", type=float, default=120.0, help="seconds of processor time for one run")
    asked.add_argument("--hours", type=float, default=6.0, help="after which no run of the map is started")
    asked.add_argument("--part", choices=("map", "random"), help="run this part alone, and keep the other's numbers")
    asked.add_argument("--row", choices=rows, metavar="NAME", help=f"this row alone, printed: {', '.join(rows)}")
    args = asked.parse_args(given)
    left = 0
    if args.row:
        return row(args.row, Runs(args.out / "runs.jsonl"), args.jobs, args.limit, args.hours)
    if not args.draw and args.part != "random":
        runs, cases = Runs(args.out / "runs.jsonl"), plan.cases()
        print(f"stability map: {len(cases)} solves, {len(runs.missing(cases))} to be run")
        left = run_all(cases, runs, args.jobs, args.limit, args.hours)
        keep("stability", kept("stability", args.docs).numbers | runs.numbers(cases), made(), args.docs)
    if not args.draw and args.part != "map":
        old = kept("stability", args.docs)
        keep("stability", old.numbers | {"random": scenes.numbers(args)}, old.made, args.docs)
    print(f"{page.draw(args.docs)}" + (f"; {left} runs are missing" if left else ""))
    return 1 if left else 0


if __name__ == "__main__":
    sys.exit(main())
