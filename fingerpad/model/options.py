"""What a scene needs of the model, decided from the scene alone.

What cannot change any number asked for is left out, and each omission comes with its reason. Nothing here is an
approximation but what the finite elements make of it: the numbers stay those of the whole model. Ridges that are not
expected to touch are another matter (:mod:`fingerpad.model.touching`).
"""

from dataclasses import dataclass, replace

from fingerpad.scene import Scene


@dataclass(frozen=True)
class Omission:
    """A part of the model that is left out, and why."""

    what: str
    reason: str

    def __str__(self) -> str:
        """Return both in words."""
        return f"{self.what} left out: {self.reason}"

    def to_dict(self) -> dict[str, str]:
        """Return both, ready for JSON."""
        return {"what": self.what, "reason": self.reason}


@dataclass(frozen=True)
class ModelOptions:
    """The parts of the model that a scene needs."""

    voltage: bool
    """Attraction in the forms, and the loop over the scales."""
    friction: bool
    """Tangential tractions and their history."""
    receptors: bool
    """Receptor sites, and elements small enough for them."""
    both_halves: bool
    """The finger on both sides of x = 0."""
    errors: bool
    """Discretisation errors, from states solved again on other meshes."""
    omitted: tuple[Omission, ...]

    def with_both_halves(self) -> "ModelOptions":
        """Return the options for the whole finger."""
        return replace(self, both_halves=True, omitted=tuple(o for o in self.omitted if o != _HALF))


_FILE = "the mesh is of a file"
_HALF = Omission(
    "the half at x < 0, but in tables and pictures (displacement.bp, stress.bp and sed.bp hold the other)",
    "no load moves the bone sideways, and the finger is its own mirror image",
)


def plan(scene: Scene) -> ModelOptions:
    """Return what a scene needs; a pure function of it."""
    voltage = any(load.voltage for load in scene.loads())
    friction, receptors = scene.friction_law() is not None, scene.output.receptors
    omitted = []
    if not voltage:
        omitted.append(Omission("attraction and the air gaps of the ridges", "no load has a voltage"))
    if not friction:
        omitted.append(Omission("friction and its history", "the friction coefficient is 0"))
    if not receptors:
        omitted.append(Omission("receptor sites and their fine elements", "output.receptors is false"))
    errors = scene.output.errors or scene.accuracy is not None
    if not errors:
        omitted.append(Omission("discretisation errors", "output.errors is false"))
    both_halves = any(load.bone_x for load in scene.loads())
    if scene.laws.mesh is not None:  # the whole of it, and no other mesh of the same finger
        if receptors:
            omitted.append(Omission("receptor sites", _FILE))
        if errors:
            omitted.append(Omission("discretisation errors", f"{_FILE} and cannot be refined"))
        return ModelOptions(voltage, friction, False, True, False, tuple(omitted))
    if not both_halves:
        omitted.append(_HALF)
    return ModelOptions(voltage, friction, receptors, both_halves, errors, tuple(omitted))
