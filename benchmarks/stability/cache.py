"""Cases run in processes of their own, each result kept as a line of JSON as soon as it is there.

The map that is stopped has lost the runs in hand; started again it goes on, and with all lines there it only draws.
"""

import json
from collections.abc import Callable, Iterable
from dataclasses import asdict
from pathlib import Path

from benchmarks.stability.case import Case, Outcome
from fingerpad.runs import processes
from fingerpad.runs.processes import Pool


class Cache:
    """Outcomes of cases in a file, one line each.

    Attributes:
        outcomes: by :attr:`Case.key`.
    """

    def __init__(self, path: Path) -> None:
        """Read what is there; a last line that was cut short is left out."""
        self.path, self.outcomes = path, dict[str, Outcome]()
        path.parent.mkdir(parents=True, exist_ok=True)
        for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else []:
            try:
                entry = json.loads(line)
            except json.JSONDecodeError:
                continue
            self.outcomes[entry["key"]] = Outcome(**entry["outcome"])

    def get(self, case: Case) -> Outcome | None:
        """Return the outcome of a case if it has been run."""
        return self.outcomes.get(case.key)

    def add(self, case: Case, outcome: Outcome) -> None:
        """Keep an outcome."""
        self.outcomes[case.key] = outcome
        entry = {"key": case.key, "case": asdict(case), "outcome": asdict(outcome)}
        with self.path.open("a", encoding="utf-8") as file:
            # First ends a line that was cut short; blank ones are skipped.
            file.write("\n" + json.dumps(entry) + "\n")

    def missing(self, cases: Iterable[Case]) -> list[Case]:
        """Return the cases that have not been run, each once, in order."""
        return list({case.key: case for case in cases if case.key not in self.outcomes}.values())


def solve(case: Case, limit: float) -> Outcome:
    """Run a case in a process of its own; whatever ends the process is an outcome.

    Args:
        case: what to run.
        limit: seconds of processor time, the same on a busy machine, after which the process ends.
    """
    end = processes.run("benchmarks.stability.solve", [json.dumps(asdict(case)), str(limit)], limit)
    if end.reason:
        return Outcome("failed", end.reason, end.message, seconds=0.0 if end.reason.startswith("CRASH") else limit)
    try:
        return Outcome(**json.loads(end.stdout.splitlines()[-1]))
    except (IndexError, TypeError, json.JSONDecodeError):
        return Outcome("failed", "CRASH", "no outcome printed")


def run_all(
    cases: Iterable[Case],
    cache: Cache,
    jobs: int,
    limit: float,
    hours: float,
    report: Callable[[Case, Outcome, int], None] = lambda case, outcome, left: None,
) -> int:
    """Run what the cache lacks.

    Args:
        cases: in the order in which they are started.
        cache: is written after each run.
        jobs: processes at a time.
        limit: seconds of processor time for one run.
        hours: after which no further run is started.
        report: called with each case, its outcome and the number of those left.

    Returns:
        The number of cases that were not run for want of time.
    """

    def done(case: Case, outcome: Outcome, left: int) -> None:
        cache.add(case, outcome)
        report(case, outcome, left)

    return Pool[Case, Outcome](lambda case: solve(case, limit), jobs, hours).run(cache.missing(cases), done)
