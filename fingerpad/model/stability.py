"""The stability of accepted states of a finger, examined once each."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from variational.solvers.continuation import StepFailed
from variational.solvers.failure import NotConverged
from variational.solvers.stability import Stability, StabilityCheck

if TYPE_CHECKING:
    from fingerpad.model.finger import Finger


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


class StabilityChecks(dict[int, Checked]):
    """Stability by step."""

    def __init__(self, finger: "Finger") -> None:
        """Take the finger."""
        super().__init__()
        self._finger, self._check = finger, StabilityCheck(finger.solver)

    def check(self, load: str) -> Checked:
        """Return the stability of the present state; collective.

        Args:
            load: name of the present load.

        Raises:
            StepFailed: the stability cannot be examined.
        """
        finger, step = self._finger, self._finger.continuation.steps
        if step not in self:
            gain = finger.coupling.gain[finger.observer.ridge_loads(finger.continuation.surface_state).length > 0]
            known = gain[np.isfinite(gain)]
            largest = float(known.max()) if len(known) and finger.voltage != 0 else 0.0
            try:
                self[step] = Checked(self._check.check(), largest)
            except NotConverged as failure:
                raise StepFailed(f"step {step} ({load}): its stability cannot be examined: {failure}") from failure
        return self[step]

    def free(self) -> None:
        """Free the memory that the checks take; further ones may follow; collective."""
        self._check.free()
