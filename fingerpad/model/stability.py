"""Whether accepted states of a finger are stable, and whether full slip is steady.

Stability is examined once a state. Full slip is steady if the forces stay the same over a further 0.2 mm of sliding,
since the screen is uniform.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fingerpad.model.state import steady
from fingerpad.results.states import SLIDE_ON, full_slip
from variational.solvers.continuation import StepFailed
from variational.solvers.outcome import NotConverged
from variational.solvers.stability import Stability, StabilityCheck
from variational.solvers.target import Target
from variational.state import ContactState

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


class FullSlip:
    """Slides a finger on at full slip and compares the forces."""

    def __init__(self, finger: "Finger") -> None:
        """Take the finger."""
        self._finger = finger

    def slides_on(self, load: str, direction: float, speed: float = 0.0) -> bool:
        """Return whether full slip is steady, and slide on by 0.2 mm for that; collective.

        Args:
            load: name of the load.
            direction: 1 or -1, the way the bone slides.
            speed: of the bone (m/s); 0 where it takes no time.
        """
        path, solver = self._finger.continuation, self._finger.solver
        begun = path.begun()
        before, x = begun.reaction[0], begun.control.x
        path.run(Target(load, bone_x=x + direction * SLIDE_ON, duration=SLIDE_ON / speed if speed else 0.0))
        return path.slip[1] and self._unchanged(before, solver.reaction[0])

    def placed(self, states: Sequence[ContactState], state: ContactState, probe: bool) -> ContactState:
        """Return a state with the step at which its full slip began and whether that was held; collective.

        Args:
            states: those before it.
            state: the present one.
            probe: whether to slide on where full slip was not held for 0.2 mm yet; none of that is accepted.
        """
        began, held = full_slip(states, state, self._steady(), self._finger.force_error)
        return replace(state, slip_began=began, slip_held=held or (probe and began > 0 and self._holds()))

    def _holds(self) -> bool:
        """Return whether full slip would go on as it is for a further 0.2 mm; none of that is accepted."""
        before, control = self._finger.solver.reaction.copy(), self._finger.solver.control
        further = replace(control, x=control.x - (np.sign(before[0]) or -1.0) * SLIDE_ON)
        found = self._finger.continuation.probe(further)
        return found is not None and found[1] and self._unchanged(before, found[0])

    def _unchanged(self, before: Any, after: Any) -> bool:
        """Return whether forces (N/m) before and after sliding on at full slip are the same."""
        return bool(np.all(np.abs(after - before) <= self._steady() * np.abs(before) + self._finger.force_error))

    def _steady(self) -> float:
        finger, laws = self._finger, self._finger.problem.interface
        gap = float(finger.coupling.d_eq.min()) + laws.h_0 if finger.options.voltage else np.inf
        return steady(laws.formulation.tolerance, gap)
