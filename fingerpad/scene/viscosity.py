"""Viscosity of a layer in a scene: a table beside the parameters of the layer's elastic law.

::

    [materials.dermis]
    viscosity = {preset = "fingerpad"}

    [materials.subcutis]
    viscosity = {moduli = [0.2, 0.3], times = ["10 ms", "0.5 s"]}

The elastic law is that of a layer that is held for long.

Presets
-------
``"skin, mouse"``
    Branches that a public implementation has behind a study of touch domes in mouse skin, for compression
    (doi 10.1371/journal.pone.0120897); the text of the paper was not read, its constants were. 0.351 of the modulus at
    once lasts.
``"fingerpad"``
    No relaxation of a human fingertip's layers was found in print. The *force* of a pressed human fingerpad at a held
    depth relaxes in three exponentials of about 4 ms, 70 ms and 1.4 s (Pawluk and Howe 1999,
    doi 10.1115/1.2835100, read as abstract). These branches, in all four soft layers, let the force of this program's
    default finger at a held depth of 0.7 mm relax in these times: a calibration of this program, not a measurement of a
    layer. Since the volume's stress does not relax, the branches are 8 to 13 % faster than the force, and stronger.
    The force's weights were not in the text that was read. *Assumption* of this program: the three are alike, and the
    force at once is 2.375 times the lasting one, the middle of the 2 to 2.75 by which peak forces of a palm at impact
    exceed static ones (doi 10.1371/journal.pone.0261008, read as abstract). ``python3 -m benchmarks.viscosity`` fits
    the force again.
"""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, model_validator

from fingerpad.scene.messages import show
from geometry.units import Finite, Table, within
from variational.materials.qlv import QLV

PRESETS = {
    "skin, mouse": QLV((0.154, 0.495), (1.111, 0.092)),
    "fingerpad": QLV((0.300, 0.247, 0.190), (3.7e-3, 63e-3, 1.22)),
}
"""Branches by the name of the preset, see above."""


class Viscosity(Table):
    """Quasi-linear viscoelasticity of a layer's isochoric stress, by ``preset`` or by ``moduli`` and ``times``."""

    law: Literal["QLV"] = "QLV"
    """Law of the relaxation, see docs/laws.md."""
    preset: Literal["skin, mouse", "fingerpad"] | None = None
    """Branches by name. "skin, mouse" is of a mouse's skin. "fingerpad" is a calibration of this program to the times
    in which the force of a pressed fingerpad relaxes, with weights that are an assumption."""
    moduli: tuple[Annotated[Finite, within(1e-12, 1.0)], ...] | None = None
    """Part of the modulus at once that each branch relaxes; below 1 in all. The layer's elastic law is what lasts."""
    times: tuple[Annotated[Finite, within(1e-6, 1e6, "s")], ...] | None = None
    """Time (s) of each branch."""

    @model_validator(mode="after")
    def _branches(self) -> Self:
        given = [name for name in ("moduli", "times") if getattr(self, name) is not None]
        if self.preset is not None and given:
            raise ValueError(f"preset is {show(self.preset)} and {given[0]} is given too; give one of the two")
        if self.preset is None and len(given) < 2:
            missing = "times" if given == ["moduli"] else "moduli"
            raise ValueError(f"{missing} is missing; viscosity must have moduli and times, or a preset")
        self.qlv()
        return self

    def qlv(self) -> QLV:
        """Return the law; raises ``ValueError`` where its branches are none."""
        return QLV(self.moduli, self.times) if self.preset is None else PRESETS[self.preset]


def elastic(law: Any) -> Any:
    """Return the elastic law of a viscous one, any other law as it is."""
    return getattr(law, "at_rest", law)


def viscous_layers(materials: BaseModel) -> list[str]:
    """Return the keys of the viscous layers' materials, as in ``materials.dermis``."""
    return [f"materials.{name}" for name, law in materials if getattr(law, "times", ())]


def refuse_beside(layers: Sequence[str], given: Mapping[str, Any]) -> None:
    """Refuse keys that a path with viscous layers cannot serve.

    Args:
        layers: keys of the viscous layers.
        given: ``force`` and ``accuracy``, None where they are not given.

    Raises:
        ValueError: one is given; in one sentence.
    """
    reasons = {
        "force": "the sum of slices has no common time; give f_ext or a history",
        "accuracy": "states cannot be solved again on another mesh without the past of their layers; leave it out: "
        "errors are estimated without it",
    }
    for name, value in given.items():
        if layers and value is not None:
            raise ValueError(f"{name} is given and {layers[0]}.viscosity too, and {reasons[name]}")
