"""Jobs in processes of their own, a few at a time, started by threads or by any executor of ``concurrent.futures``.

A job that is killed, crashes in the linear solver or takes too long costs that job and no other: a thread, or a worker
of an executor, only waits for a fresh process, which can be stopped by itself. Time is processor time, the same on a
busy machine. What ends the program or the worker stops its jobs, too, also where it is killed: each gets SIGTERM.
"""

import ctypes
import math
import os
import resource
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import TypeVar

from fingerpad.scene.law_code import LAWS, entries

_ROOT = Path(__file__).resolve().parents[2]
_LAUNCHERS = ("OMPI_", "PMIX_", "PMI_", "PRTE_", "MV2_")  # by whose variables MPI takes a process for a rank of theirs
_STUCK = 20  # times its limit that a job may take by the clock
_RUNNING = set[subprocess.Popen[str]]()  # of all threads: a signal is to the program
_STOPPED = threading.Event()
_PROGRAM, _SIGNAL_OF_PARENT = "FINGERPAD_PROGRAM", 1  # whose job a process is; PR_SET_PDEATHSIG of <sys/prctl.h>
_NOTICED = 0.5  # s after which a signal is seen at the latest
Key = TypeVar("Key")


@dataclass(frozen=True)
class End:
    """How a process ended."""

    code: int
    reason: str
    """TIME_LIMIT, STUCK, STOPPED, LOST, CRASH with the exit code, or nothing if it ended without an error."""
    message: str
    stdout: str
    seconds: float = 0.0
    """Elapsed time; 0 where it was not begun or did not end by itself."""


def limit_processor_time(seconds: float) -> None:
    """End this process, with :attr:`End.reason` TIME_LIMIT, when it has used so much, or when its program has ended."""
    whole = math.ceil(seconds)
    resource.setrlimit(resource.RLIMIT_CPU, (whole, whole + 10))
    program = os.environ.get(_PROGRAM)
    if program is not None and sys.platform == "linux":
        ctypes.CDLL(None).prctl(_SIGNAL_OF_PARENT, signal.SIGTERM)
        if os.getppid() != int(program):  # it ended before
            os.kill(os.getpid(), signal.SIGTERM)


def run(module: str, arguments: Sequence[str], limit: float, folders: Sequence[str] = ()) -> End:
    """Run ``python3 -m module arguments`` to its end, whatever that is.

    Args:
        module: calls :func:`limit_processor_time`.
        arguments: of its command line.
        limit: processor time (s); elapsed time is limited to :data:`_STUCK` times this.
        folders: of laws of one's own.
    """
    path, laws = os.pathsep.join([str(_ROOT), *entries("PYTHONPATH")]), os.pathsep.join([*entries(LAWS), *folders])
    alone = {name: value for name, value in os.environ.items() if not name.startswith(_LAUNCHERS)}
    env = alone | {_PROGRAM: str(os.getpid()), "PYTHONPATH": path, LAWS: laws}
    env |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, "-P", "-m", module, *arguments]  # -P: no modules of the current folder
    if _STOPPED.is_set():  # while the job waited for its turn
        return End(-signal.SIGTERM, "STOPPED", "a signal came before it began", "")
    start = time.monotonic()
    process = subprocess.Popen(command, env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    _RUNNING.add(process)
    try:
        if _STOPPED.is_set():
            process.terminate()
        out, errors = process.communicate(timeout=_STUCK * limit)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
        return End(-signal.SIGKILL, "STUCK", f"not done after {_STUCK * limit:g} s", "")
    finally:
        _RUNNING.discard(process)
    if process.returncode == -signal.SIGXCPU:
        return End(process.returncode, "TIME_LIMIT", f"not done after {limit:g} s of processor time", out)
    last = (errors.strip().splitlines() or ["no message"])[-1]
    reason = f"CRASH_{process.returncode}" if process.returncode else ""
    return End(process.returncode, reason, last if reason else "", out, time.monotonic() - start)


@contextmanager
def _stopped_by_signals() -> Iterator[None]:
    """Send SIGTERM to the running jobs when a signal ends the block.

    Raises:
        KeyboardInterrupt: SIGINT came.
        SystemExit: SIGTERM or SIGHUP came, which would end the program and leave its jobs; with 128 and its number.
    """

    def end(number: int, frame: FrameType | None) -> None:
        raise SystemExit(128 + number)

    main = threading.current_thread() is threading.main_thread()
    taken = [n for n in (signal.SIGTERM, signal.SIGHUP) if main and signal.getsignal(n) == signal.SIG_DFL]
    for number in taken:
        signal.signal(number, end)
    try:
        yield
    except (KeyboardInterrupt, SystemExit):
        _STOPPED.set()
        running = tuple(_RUNNING)
        for process in running:
            process.terminate()
        if running:
            words = "running points that stop after their present step"
            print(f"fingerpad: {words}: {len(running)}", file=sys.stderr, flush=True)
        raise
    finally:
        for number in taken:
            signal.signal(number, signal.SIG_DFL)


def finish(
    calls: Mapping[Key, Callable[[], End]],
    done: Callable[[Key, End, int], None],
    jobs: int,
    executor: Executor | None = None,
    look: Callable[[], None] = lambda: None,
) -> None:
    """Make calls and wait for them.

    Args:
        calls: by key, in order; each waits for a process of :func:`run`. An executor must be able to pickle them.
        done: called with each key, how its process ended, and the number of those left.
        jobs: processes at a time, without an executor.
        executor: of ``concurrent.futures``; by default threads of this process. It stays open.
        look: called in between, at least every :data:`_NOTICED` s.

    Raises:
        KeyboardInterrupt: SIGINT, after the processes of this program have ended.
        SystemExit: SIGTERM or SIGHUP, after the processes of this program have ended.
    """
    own = ThreadPoolExecutor(jobs) if executor is None else None
    running: dict[Future[End], Key] = {}
    try:
        with _stopped_by_signals():
            for key, call in calls.items():
                running[(executor or own).submit(call)] = key  # type: ignore[union-attr]
            while running:
                ended, _ = wait(running, timeout=_NOTICED, return_when=FIRST_COMPLETED)  # then a signal is seen
                look()
                for future in ended:
                    done(running.pop(future), _end(future), len(running))
    finally:
        for future in running:
            future.cancel()
        if own is not None:
            own.shutdown(cancel_futures=True)
        _STOPPED.clear()  # all processes have ended


def _end(future: Future[End]) -> End:
    """Return how a process ended; LOST where the worker of an executor that waited for it is gone."""
    try:
        return future.result()
    except Exception as error:  # of any executor
        return End(1, "LOST", f"{type(error).__name__}: {error}", "")
