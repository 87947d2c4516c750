"""What a run takes: seconds by phase, work, memory."""

import resource
import time
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass


class Timings:
    """Adds up wall time by phase."""

    def __init__(self) -> None:
        self.seconds: defaultdict[str, float] = defaultdict(float)

    def add(self, other: "Timings") -> None:
        """Add another's."""
        for name, seconds in other.seconds.items():
            self.seconds[name] += seconds

    @contextmanager
    def phase(self, name: str) -> Iterator[None]:
        """Charge the block to a phase."""
        start = time.perf_counter()
        try:
            yield
        finally:
            self.seconds[name] += time.perf_counter() - start


@dataclass
class Counts:
    """Work done, for reports."""

    newton: int = 0
    factorisations: int = 0
    pseudo_transient: int = 0
    """Solves that full Newton steps did not manage."""

    def add(self, other: "Counts") -> None:
        """Add another's."""
        self.newton += other.newton
        self.factorisations += other.factorisations
        self.pseudo_transient += other.pseudo_transient


def memory_mb() -> float:
    """Return the peak memory (MB) of this process."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
