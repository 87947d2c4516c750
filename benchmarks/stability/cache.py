"""Cases run in processes of their own, two at a time, each result kept as a line of JSON as soon as it is there.

A run that is killed, crashes in the linear solver or takes too long costs that run and no other: a thread of the pool
only waits for a fresh process, which, unlike a worker of a process pool, can be stopped by itself. The map that is
stopped has lost the runs in hand; started again it goes on, and with all lines there it only draws.
"""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterable
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import asdict
from pathlib import Path

from benchmarks.stability.case import Case, Outcome

_ROOT = Path(__file__).resolve().parents[2]
_STUCK = 20  # times its limit that a process may take by the clock


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
    path = os.pathsep.join([str(_ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
    env = os.environ | {"PYTHONPATH": path, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, "-m", "benchmarks.stability.solve", json.dumps(asdict(case)), str(limit)]
    try:
        done = subprocess.run(command, env=env, capture_output=True, text=True, timeout=_STUCK * limit)
    except subprocess.TimeoutExpired:
        return Outcome("failed", "STUCK", f"not done after {_STUCK * limit:g} s", seconds=limit)
    if done.returncode == -signal.SIGXCPU:
        return Outcome("failed", "TIME_LIMIT", f"not done after {limit:g} s of processor time", seconds=limit)
    try:
        return Outcome(**json.loads(done.stdout.splitlines()[-1]))
    except (IndexError, TypeError, json.JSONDecodeError):
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        return Outcome("failed", f"CRASH_{done.returncode}", last)


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
    waiting, end = cache.missing(cases), time.monotonic() + 3600 * hours
    running: dict[Future[Outcome], Case] = {}
    with ThreadPoolExecutor(jobs) as pool:
        while running or (waiting and time.monotonic() < end):
            while waiting and len(running) < jobs and time.monotonic() < end:
                case = waiting.pop(0)
                running[pool.submit(solve, case, limit)] = case
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                case, outcome = running.pop(future), future.result()
                cache.add(case, outcome)
                report(case, outcome, len(waiting) + len(running))
    return len(waiting)
