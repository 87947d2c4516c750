"""What the rungs of the ladder have in common: a scene in, the summary's keys, a cost and what is to be said out.

Every rung answers with the keys of :meth:`fingerpad.report.Report.summary` for normal contact and full slip. One that
it cannot know is not there, and a note says so.
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from fingerpad.scene import Scene, SceneError
from fingerpad.sentences import show

STATES = ("normal", "slip")
NAMES = ("f_t", "mu_app", "f_electrostatic", "f_contact", "bone_height", "ridges_in_contact", "contact_length")


@dataclass(frozen=True)
class Cost:
    """What an answer took."""

    seconds: float
    """Processor time, microscale, mesh and compiled forms included (s)."""
    factorisations: int = 0
    unknowns: int = 0
    """Of the largest linear system."""


@dataclass(frozen=True)
class Answer:
    """What a rung says of a scene."""

    rung: int
    summary: dict[str, Any]
    """Keys are a state, an underscore and a name, of :data:`STATES` and :data:`NAMES`, and ``full_slip``; SI units."""
    cost: Cost
    notes: tuple[str, ...] = ()
    """Where its inputs come from, what it left out, and what a reader should know of the state."""
    more: dict[str, Any] = field(default_factory=dict)
    """What this rung alone knows."""
    errors: dict[str, float] = field(default_factory=dict)
    """Estimated discretisation errors, by the summary's keys; none of a closed form, which has no mesh."""

    def missing(self) -> list[str]:
        """Return the keys that this rung cannot know."""
        keys = [f"{state}_{name}" for state in STATES for name in NAMES]
        return [key for key in keys if self.summary.get(key) is None]


def at_rest(f_ext: float, contact: Mapping[str, float | int]) -> dict[str, Any]:
    """Return the keys of normal contact; by symmetry there is no friction."""
    return {"normal_f_t": 0.0, "normal_mu_app": 0.0} | {f"normal_{name}": value for name, value in contact.items()}


def at_slip(scene: Scene, contact: Mapping[str, float | int]) -> dict[str, Any]:
    """Return the keys of full slip: f_T is the limit of friction, of the mean pressure over the contact length.

    Coulomb's is mu_0 times the contact force, however that is spread.
    """
    law = scene.friction_law()
    f_t = 0.0 if law is None else law.resultant(contact["f_contact"], contact["contact_length"])
    keys = {"full_slip": True, "slip_f_t": f_t, "slip_mu_app": f_t / scene.f_ext}
    return keys | {f"slip_{name}": value for name, value in contact.items()}


def refuse_others(scene: Scene, rung: int) -> None:
    """Refuse a scene whose loads are not press, charge and slide, or whose finger has a mesh of its own.

    Raises:
        SceneError: it has a history, or a mesh.
    """
    if scene.laws.mesh is not None:
        raise SceneError(
            f"mesh is {show(str(scene.laws.mesh))}; rung {rung} of the ladder answers for fingers of the scene's own "
            "geometry, so use rung 3"
        )
    if scene.history is not None:
        raise SceneError(
            f"history is given; rung {rung} of the ladder answers for press, charge and slide alone, so use rung 3 "
            "or give f_ext and voltage instead"
        )


class Stopwatch:
    """Processor time since it was made."""

    def __init__(self) -> None:
        self._start = time.process_time()

    def seconds(self) -> float:
        """Return the time (s)."""
        return time.process_time() - self._start
