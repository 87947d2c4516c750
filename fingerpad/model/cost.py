"""The time and the work of a run."""

import time
from collections.abc import Iterator
from contextlib import contextmanager

from mpi4py import MPI

from fingerpad.io.result import Cost
from variational.solvers.timing import Counts, memory_mb


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

    def processor_seconds(self) -> float:
        """Return the processor time (s) of all ranks since the start; collective."""
        return float(self._comm.allreduce(time.process_time() - self._processor))

    def cost(self, counts: Counts, unknowns: int) -> Cost:
        """Return the cost of a run, the same on every rank; collective.

        Args:
            counts: iterations of the path's solver.
            unknowns: of the final mesh.
        """
        processor, memory = self.processor_seconds(), self._comm.allreduce(memory_mb())
        wall = time.perf_counter() - self._wall
        found = Cost(processor, wall, counts.newton, counts.factorisations, unknowns, memory, self._comm.size)
        return self._comm.bcast(found)
