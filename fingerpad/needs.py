"""What a scene needs of the model, decided from the scene alone.

What cannot change any number asked for is left out, and each omission comes with its reason. Nothing here is an
approximation but what the finite elements make of it: the numbers stay those of the whole model.
"""

from dataclasses import asdict, dataclass

from fingerpad.scene import Scene


@dataclass(frozen=True)
class Omission:
    """A part of the model that is left out, and why."""

    what: str
    reason: str

    def __str__(self) -> str:
        """Return both in words."""
        return f"{self.what} left out: {self.reason}"


@dataclass(frozen=True)
class Plan:
    """The parts of the model that a scene needs."""

    voltage: bool
    """Attraction in the forms, and the loop over the scales."""
    friction: bool
    """Tangential tractions and their history."""
    receptors: bool
    """Receptor sites, and elements small enough for them."""
    omitted: tuple[Omission, ...]

    def table(self) -> list[dict[str, str]]:
        """Return the omissions, ready for JSON."""
        return [asdict(omission) for omission in self.omitted]


def plan(scene: Scene) -> Plan:
    """Return what a scene needs; a pure function of it."""
    voltage = any(load.voltage for load in scene.loads())
    friction, receptors = scene.friction > 0, scene.output.receptors
    omitted = []
    if not voltage:
        omitted.append(Omission("attraction and the air gaps of the ridges", "no load has a voltage"))
    if not friction:
        omitted.append(Omission("friction and its history", "the friction coefficient is 0"))
    if not receptors:
        omitted.append(Omission("receptor sites and their fine elements", "output.receptors is false"))
    return Plan(voltage, friction, receptors, tuple(omitted))
