"""Checks of accepted states of a finger: skin that cannot touch, stability, and whether full slip is steady.

Ridges far from the contact have coarse elements and no contact forces. Which ones these are follows from a scene only
roughly. So each accepted step is checked: the last ridge on either side that can touch must not, and skin beyond must
stay clear of the screen. The last ridge touches long before the next one would: by the outline's curvature that one
is a tenth of a millimetre higher. Where skin comes near the screen, the path goes on with more ridges.

Stability is examined once a state. Full slip is steady if the forces stay the same over a further 0.2 mm of sliding,
since the screen is uniform.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from dolfinx import fem

from fingerpad.model.finger import Finger
from fingerpad.model.options import FingerModel
from fingerpad.model.state import steady
from fingerpad.results.states import SLIDE_ON, full_slip
from geometry import tags
from variational.resultants import RidgeLoads
from variational.solvers.continuation import StepFailed
from variational.solvers.outcome import NotConverged
from variational.solvers.stability import Stability, StabilityCheck
from variational.solvers.target import Target
from variational.state import ContactState

_MIN_CLEARANCE = 10e-6  # m, height of the skin at which an attraction of 200 V comes to 1 kPa
_MORE = 2  # ridges on either side that are added at least, or
_PART = 0.25  # this part of those that could touch before


class FingerExceeded(RuntimeError):
    """Skin touches beyond the last ridge that the finger has."""


class ContactZone:
    """Checks the skin of a finger."""

    def __init__(self, finger: Finger, model: FingerModel) -> None:
        """Find the skin that cannot touch; a mesh of a file has all the ridges there are."""
        self._problem, self._ridges = finger.problem, finger.ridges
        self._count, self._file = model.geometry.ridge_count, model.mesh_file
        self._nodes = fem.locate_dofs_topological(self._problem.V, 1, finger.mesh.facets(tags.OUTER_SKIN))

    def _lowest_outside(self) -> float:
        """Return the lowest height (m) of the skin that cannot touch; collective."""
        heights = self._problem.V.tabulate_dof_coordinates()[self._nodes, 1]
        heights = heights + self._problem.displacement()[self._nodes, 1]
        return float(np.min(self._problem.mesh.comm.allgather(float(heights.min(initial=np.inf)))))

    def check(self, loads: RidgeLoads) -> tuple[int, str] | None:
        """Return the last ridge, on either side, that must be able to touch, and why; None where it can; collective.

        Raises:
            FingerExceeded: more ridges must be able to touch, and there are no more.
        """
        lowest = self._lowest_outside()
        if self._file is not None:
            if lowest < 0:
                raise FingerExceeded(
                    f"skin of the group 'outer skin' is at a height of {lowest:.3g} m; {self._file} must have more "
                    "ridges, or f_ext be smaller"
                )
            return None
        ridges, wider = self._ridges, more(self._ridges[-1], self._count)
        last = [j for j, length in ((ridges[0], loads.length[0]), (ridges[-1], loads.length[-1])) if length > 0]
        if last:
            reason = f"ridge {last[0]}, the last one that is meshed to touch, is in contact"
        elif lowest < (0.0 if wider is None else _MIN_CLEARANCE):
            reason = f"skin beyond the ridges that are meshed to touch is at a height of {lowest:.3g} m"
        else:
            return None
        if wider is None:
            raise FingerExceeded(
                f"{reason}, and the finger has no more ridges; geometry.ridge_count is {self._count} and must be "
                "larger, or f_ext smaller"
            )
        return wider, reason


def more(last: int, count: int) -> int | None:
    """Return the last of ``count`` ridges, on either side, that can touch after a restart; None if all could before."""
    return None if last == (count - 1) // 2 else last + max(_MORE, round(_PART * last))


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

    def of(self, state: ContactState) -> ContactState:
        """Return a state with this stability."""
        return replace(state, stable=self.stable, lambda_min=self.frozen.lambda_min, gain=self.gain)

    def __str__(self) -> str:
        """Return the verdict in words."""
        least = f"{self.frozen.lambda_min:.4g} Pa/m{'' if self.frozen.settled else ', not settled'}"
        return f"{'' if self.stable else 'not '}stable: lambda_min {least}, gain of the air gaps {self.gain:.3g}"


class StabilityChecks(dict[int, Checked]):
    """Stability by step."""

    def __init__(self, finger: Finger) -> None:
        """Have no stability yet."""
        super().__init__()
        self._finger, self._check = finger, StabilityCheck(finger.solver)

    def check(self, load: str) -> Checked:
        """Return the stability of the present state, in the load of this name; collective.

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

    def __init__(self, finger: Finger) -> None:
        """Take the finger."""
        self._finger = finger

    def slides_on(self, load: str, direction: float, speed: float = 0.0) -> bool:
        """Return whether full slip is steady, and slide on by 0.2 mm for that; collective.

        Args:
            load: its name.
            direction: 1 or -1, the way the bone slides.
            speed: of the bone (m/s); 0 where it takes no time.
        """
        path, solver = self._finger.continuation, self._finger.solver
        begun = path.begun()
        before, x = begun.reaction[0], begun.control.x
        path.run(Target(load, bone_x=x + direction * SLIDE_ON, duration=SLIDE_ON / speed if speed else 0.0))
        return path.slip[1] and self._unchanged(before, solver.reaction[0])

    def placed(self, states: Sequence[ContactState], state: ContactState, probe: bool) -> ContactState:
        """Return the present state with the step at which its full slip began and whether that was held; collective.

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
