"""What a solve comes to: seconds by phase, work, memory, and why there is no equilibrium."""

import resource
import time
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from petsc4py import PETSc

OUT_OF_WORKSPACE = "MUMPS_OUT_OF_WORKSPACE"
# INFOG(1) in the users' guide of MUMPS 5, section 8. Workspace is estimated before pivoting, which depends on the
# matrix; memory ran out for any matrix of the size.
_MUMPS = {
    "MUMPS_SINGULAR": (-6, -10),
    OUT_OF_WORKSPACE: (-8, -9, -11, -14, -15, -17, -18, -20),
    "MUMPS_OUT_OF_MEMORY": (-5, -7, -13, -19, -22),
}
OUTSIDE = 1e30  # N/m: norm of the residual where J <= 0 somewhere
_REASONS = {value: name for name, value in vars(PETSc.SNES.ConvergedReason).items() if isinstance(value, int)}


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


class NotConverged(RuntimeError):
    """A solve without an equilibrium.

    Attributes:
        reason: why, by SNES's name or one of MUMPS_OUT_OF_MEMORY, MUMPS_OUT_OF_WORKSPACE, MUMPS_SINGULAR,
            MUMPS_FAILED, NOT_A_NUMBER and COUPLING_CAP.
        inverted: elements were turned inside out by some iterate.
        irrecoverable: a smaller step would fail as well.
        cycling: the loop over the scales cycled at this load; at a larger one it may converge.
    """

    def __init__(self, reason: str, inverted: bool, irrecoverable: bool = False, cycling: bool = False) -> None:
        self.reason = reason
        self.inverted = inverted
        self.irrecoverable = irrecoverable
        self.cycling = cycling
        super().__init__(reason + (", elements inverted (J <= 0) on the way" if inverted else ""))


def linear_failure(pc: PETSc.PC) -> tuple[str, bool]:
    """Return why a factorisation failed, and whether one of another matrix of the same size would as well."""
    if pc.getFactorSolverType() != PETSc.Mat.SolverType.MUMPS:
        return "DIVERGED_LINEAR_SOLVE", False
    code = int(pc.getFactorMatrix().getMumpsInfog(1))
    name = next((name for name, codes in _MUMPS.items() if code in codes), "MUMPS_FAILED")
    return f"{name} (INFOG(1) = {code})", name == "MUMPS_OUT_OF_MEMORY"


def snes_failure(snes: PETSc.SNES, inverted: bool, not_a_number: str) -> NotConverged:
    """Return why the last solve of SNES ended without an equilibrium.

    Args:
        snes: that solved.
        inverted: elements were turned inside out by some iterate.
        not_a_number: what was not one, or empty.
    """
    if not_a_number:
        return NotConverged(f"NOT_A_NUMBER in the {not_a_number}", False)
    reason = int(snes.getConvergedReason())
    if reason == PETSc.SNES.ConvergedReason.DIVERGED_LINEAR_SOLVE:
        name, irrecoverable = linear_failure(snes.getKSP().getPC())
        return NotConverged(name, inverted, irrecoverable)
    return NotConverged(_REASONS.get(reason, str(reason)), inverted)
