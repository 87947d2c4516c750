"""Jobs in processes of their own, a few at a time.

A job that is killed, crashes in the linear solver or takes too long costs that job and no other: a thread of the pool
only waits for a fresh process, which, unlike a worker of a process pool, can be stopped by itself. Time is that of the
processor, the same on a busy machine.
"""

import math
import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

_ROOT = Path(__file__).resolve().parents[2]
_LAUNCHERS = ("OMPI_", "PMIX_", "PMI_", "PRTE_", "MV2_")  # by whose variables MPI takes a process for a rank of theirs
_STUCK = 20  # times its limit that a job may take by the clock
Key = TypeVar("Key")
Result = TypeVar("Result")


@dataclass(frozen=True)
class End:
    """How a process ended."""

    code: int
    reason: str
    """TIME_LIMIT, STUCK, CRASH with the exit code, or nothing if the process ended by itself without an error."""
    message: str
    stdout: str


def limit_processor_time(seconds: float) -> None:
    """End this process, with :attr:`End.reason` TIME_LIMIT, when it has used so much."""
    whole = math.ceil(seconds)
    resource.setrlimit(resource.RLIMIT_CPU, (whole, whole + 10))


def run(module: str, arguments: Sequence[str], limit: float) -> End:
    """Run ``python3 -m module arguments`` to its end, whatever that is.

    Args:
        module: calls :func:`limit_processor_time`.
        arguments: of its command line.
        limit: what it calls it with; a twentieth of the time it may take by the clock.
    """
    path = os.pathsep.join([str(_ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
    alone = {name: value for name, value in os.environ.items() if not name.startswith(_LAUNCHERS)}
    env = alone | {"PYTHONPATH": path, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, "-P", "-m", module, *arguments]  # -P: no modules of the current folder
    try:
        done = subprocess.run(command, env=env, capture_output=True, text=True, timeout=_STUCK * limit)
    except subprocess.TimeoutExpired:
        return End(-signal.SIGKILL, "STUCK", f"not done after {_STUCK * limit:g} s", "")
    if done.returncode == -signal.SIGXCPU:
        return End(done.returncode, "TIME_LIMIT", f"not done after {limit:g} s of processor time", done.stdout)
    last = (done.stderr.strip().splitlines() or ["no message"])[-1]
    reason = f"CRASH_{done.returncode}" if done.returncode else ""
    return End(done.returncode, reason, last if reason else "", done.stdout)


@dataclass(frozen=True)
class Pool(Generic[Key, Result]):
    """Runs jobs.

    Attributes:
        job: from a key to what becomes of it; waits for its process.
        jobs: processes at a time.
        hours: after which no further one is started.
    """

    job: Callable[[Key], Result]
    jobs: int
    hours: float = math.inf

    def run(self, keys: Iterable[Key], done: Callable[[Key, Result, int], None]) -> int:
        """Run all jobs in order.

        Args:
            keys: of the jobs.
            done: called with each key, its result and the number of those left.

        Returns:
            The number of jobs that were not started for want of time.
        """
        waiting, stop = list(keys), time.monotonic() + 3600 * self.hours
        running: dict[Future[Result], Key] = {}
        with ThreadPoolExecutor(self.jobs) as pool:
            while running or (waiting and time.monotonic() < stop):
                while waiting and len(running) < self.jobs and time.monotonic() < stop:
                    key = waiting.pop(0)
                    running[pool.submit(self.job, key)] = key
                ended, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in ended:
                    key = running.pop(future)
                    done(key, future.result(), len(waiting) + len(running))
        return len(waiting)
