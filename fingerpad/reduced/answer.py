"""What the reduced models have in common: a scene in, normal contact and full slip out, as a full run has them.

A quantity that is not part of a model is NaN in its states, and a note names it.
"""

import time
from collections.abc import Mapping
from typing import Any

from fingerpad.scene import Scene, SceneError
from fingerpad.scene.messages import show
from variational.state import ContactState, Errors

STATES = ("charged", "full_slip")
"""For which they answer, by their names in :mod:`fingerpad.io.states`."""


def at_rest(scene: Scene, contact: Mapping[str, float], error: Errors | None = None) -> ContactState:
    """Return normal contact; by symmetry there is no friction.

    Args:
        scene: whose loads act.
        contact: contact force, attraction, contact length and ridges in contact, and the bone's height if known.
        error: estimated discretisation errors.
    """
    return _state(scene, contact, 0.0, error)


def at_slip(scene: Scene, contact: Mapping[str, float], error: Errors | None = None) -> ContactState:
    """Return full slip: f_T is the limit of friction, of the mean pressure over the contact length.

    Coulomb's is mu_0 times the contact force, however that is spread. Arguments as of :func:`at_rest`.
    """
    law = scene.friction_law()
    f_t = 0.0 if law is None else law.resultant(contact["f_contact"], contact["contact_length"])
    return _state(scene, contact, f_t, error)


def _state(scene: Scene, contact: Mapping[str, float], f_t: float, error: Errors | None) -> ContactState:
    values: dict[str, Any] = {name: value for name, value in contact.items() if name != "ridges_in_contact"}
    return ContactState(
        f_ext=scene.f_ext,
        voltage=scene.voltage,
        f_t=f_t,
        mu_app=f_t / scene.f_ext,
        ridges_in_contact=int(contact["ridges_in_contact"]),
        error=error or Errors(),
        **values,
    )


def refuse_others(scene: Scene, model: str) -> None:
    """Refuse a scene whose loads are not press, charge and slide, or whose finger has a mesh of its own.

    Raises:
        SceneError: it has a history, or a mesh.
    """
    if scene.laws.mesh is not None:
        raise SceneError(
            f"mesh is {show(str(scene.laws.mesh))}; the model '{model}' answers for fingers of the scene's own "
            "geometry, so use the model 'full'"
        )
    if scene.history is not None:
        raise SceneError(
            f"history is given; the model '{model}' answers for press, charge and slide alone, so use the model 'full' "
            "or give f_ext and voltage instead"
        )


class Stopwatch:
    """Processor time since it was made."""

    def __init__(self) -> None:
        self._start = time.process_time()

    def seconds(self) -> float:
        """Return the time (s)."""
        return time.process_time() - self._start
