"""An accepted step as it is reported, and what is known of its state."""

from dataclasses import dataclass

import numpy as np

from variational.contact.formulation import SurfaceState
from variational.solvers.continuation import Attempt
from variational.solvers.stability import Stability
from variational.state import ContactState


@dataclass(frozen=True)
class Step:
    """An accepted step."""

    state: ContactState
    notes: list[str]
    """What a reader should know of each ridge's place on the closure, mostly nothing."""
    attempt: Attempt
    surface: SurfaceState


@dataclass(frozen=True)
class Checked:
    """Stability of an accepted state."""

    frozen: Stability
    """At frozen air gaps."""
    gain: float
    """Largest measured gain of a ridge's loop over the scales, zero without voltage or where none was measured."""

    @property
    def stable(self) -> bool:
        """Whether the skin stays, each ridge's air gap following its pressure."""
        return self.frozen.stable and self.gain < 1

    def __str__(self) -> str:
        """Return the verdict in words."""
        verdict = "stable" if self.stable else "not stable"
        unsettled = "" if self.frozen.settled else ", not settled"
        return (
            f"{verdict}: lambda_min {self.frozen.lambda_min:.4g} Pa/m{unsettled}, gain of the air gaps {self.gain:.3g}"
        )


def force_error(unknowns: int, tolerance: float, force_scale: float) -> float:
    """Return the largest sum (N/m) of the nodal forces in one direction that a converged solve can leave.

    The solve ends where the norm of all of them is the tolerance times the force scale; their sum is at most the root
    of their number times that (Cauchy and Schwarz).

    Args:
        unknowns: their number, at most.
        tolerance: of the solver, over ``force_scale``.
        force_scale: force per length (N/m) in which residuals are measured.
    """
    return float(np.sqrt(unknowns)) * tolerance * force_scale
