"""The time and the work of a run."""

import time
from collections.abc import Iterator
from contextlib import contextmanager

from mpi4py import MPI

from fingerpad.results.answer import Cost
from variational.solvers.outcome import Counts, memory_mb


class Clock:
    """Wall and processor time since the run began.

    Attributes:
        seconds: wall time of the set-up and of the output (s), by these names.
    """

    def __init__(self, comm: MPI.Comm) -> None:
        """Start."""
        self._comm = comm
        self._wall, self._processor = time.perf_counter(), time.process_time()
        self.seconds = {"setup": 0.0, "output": 0.0}

    @contextmanager
    def phase(self, name: str) -> Iterator[None]:
        """Count the time inside as that of a phase, ``setup`` or ``output``."""
        start = time.perf_counter()
        yield
        self.seconds[name] += time.perf_counter() - start

    def earlier(self, wall: float, processor: float) -> None:
        """Add the time (s) that the run took before it was cut short, all ranks' processor time together."""
        self._wall -= wall
        self._processor -= processor / self._comm.size

    def present(self) -> tuple[float, float]:
        """Return wall time and processor time of all ranks since the start (s); collective."""
        return time.perf_counter() - self._wall, self.processor_seconds()

    def processor_seconds(self) -> float:
        """Return the processor time (s) of all ranks since the start; collective."""
        return float(self._comm.allreduce(time.process_time() - self._processor))

    def cost(self, counts: Counts, unknowns: int) -> Cost:
        """Return the cost of a run, the same on every rank; collective.

        Args:
            counts: iterations of the path's solver.
            unknowns: of the final mesh.
        """
        memory, (wall, processor) = self._comm.allreduce(memory_mb()), self.present()
        found = Cost(processor, wall, counts.newton, counts.factorisations, unknowns, memory, self._comm.size)
        return self._comm.bcast(found)
