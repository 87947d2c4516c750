"""The tables of a scene: loads, accuracy, contact, output and numerics, with units and the ranges that make sense.

:mod:`fingerpad.scene.materials` has the others. The docstring of a key is its text in the scene reference,
``docs/scene.md``.
"""

import hashlib
import math
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    Discriminator,
    Field,
    SerializerFunctionWrapHandler,
    Tag,
    model_serializer,
    model_validator,
)

from fingerpad.scene.law_keys import Kind, LawKey, fail, keys_of, reading_results
from fingerpad.scene.load_names import load_name
from fingerpad.scene.messages import NUMBER, WAVE, show
from fingerpad.scene.table import Finite, Part, Switch
from fingerpad.scene.waveform import Volts, Waveform
from geometry.parameters import Fingertip
from geometry.units import within
from variational import files
from variational.contact.augmented import AugmentedLagrangian
from variational.contact.formulation import Formulation
from variational.contact.nitsche import Nitsche
from variational.contact.penalty import Penalty

FORMULATIONS: dict[str, type[Formulation]] = {"penalty": Penalty, "nitsche": Nitsche, "augmented": AugmentedLagrangian}
"""Contact formulations by their names, key ``contact.formulation``: a new one is an entry here."""
CONTACT = LawKey(Kind(Formulation, "a Formulation", FORMULATIONS), Penalty(), flat="formulation")
Asked = Annotated[Finite, within(1e-6, 0.5)]
Way = Annotated[Finite, within(1e-9, 0.1, "m", zero=True, sides=2)]
_OVER_TIME = ("bone_x_by", "speed", "duration")  # keys that runs made before they were there do not have


def _kind(voltage: Any) -> str:
    return WAVE if isinstance(voltage, dict | Waveform) else NUMBER


Voltage = Annotated[Annotated[Volts, Tag(NUMBER)] | Annotated[Waveform, Tag(WAVE)], Discriminator(_kind)]


class Load(Part):
    """A load to reach from the present one; omitted values stay as they are."""

    name: Annotated[str, AfterValidator(load_name)]
    """Name of the load, also of the load's pictures; see :mod:`fingerpad.scene.load_names`."""
    f_ext: Annotated[Finite, within(1e-3, 5e3, "N/m", zero=True)] | None = None
    """External normal force on the bone (N/m). Zero is allowed only under voltage, which then holds the skin on the
    screen."""
    bone_height: Way | None = None
    """Change of the bone's height from the unloaded position (m), negative when pressed."""
    voltage: Voltage | None = None
    """Instantaneous voltage U (V), or a waveform. The attraction goes with its square: the sign changes no force."""
    bone_x: Way | None = None
    """Horizontal position of the bone (m), zero when unloaded."""
    bone_x_by: Way | None = None
    """The same as a move (m) from where the bone is when the load begins."""
    speed: Annotated[Finite, within(1e-6, 100.0, "m/s")] | None = None
    """Speed (m/s) of the bone on its way, which makes it a load over time. The model is quasi-static: the speed only
    sets how long the way takes."""
    duration: Annotated[Finite, within(1e-6, 1e5, "s")] | None = None
    """Time (s) that the load takes, in place of a speed. The bone moves evenly in time; of a force its root changes
    evenly, and of a voltage its square, as the attraction does."""
    until_full_slip: Switch = False
    """Whether the load stops at full slip: where every point in contact slips one way, and forces stay the same over a
    further 0.2 mm, which may end beyond bone_x. Only with bone_x or bone_x_by."""

    @model_validator(mode="after")
    def _consistent(self) -> "Load":
        if self.f_ext is not None and self.bone_height is not None:
            raise ValueError(
                f"f_ext is {show(self.f_ext)} and bone_height is {show(self.bone_height)}; "
                "at most one of the two can be prescribed"
            )
        if not any(v is not None for v in (self.f_ext, self.bone_height, self.voltage, self.bone_x, self.bone_x_by)):
            raise ValueError(
                f"name is {show(self.name)} and nothing else is given; "
                "it must come with at least one of f_ext, bone_height, voltage, bone_x and bone_x_by"
            )
        if self.until_full_slip:
            self._refuse_unfinished()
        self._refuse_time()
        return self

    def _refuse_unfinished(self) -> None:
        """Refuse what a load that stops at full slip may not have reached."""
        for name in ("f_ext", "bone_height", "voltage"):
            if getattr(self, name) is not None:
                given = "a waveform" if self.wave is not None and name == "voltage" else show(getattr(self, name))
                raise ValueError(
                    f"{name} is {given} and until_full_slip is true, which may stop before that is "
                    f"reached; {name} must come in a load of its own"
                )

    def _refuse_time(self) -> None:
        """Refuse a way that is given twice, and times that are missing or contradict each other."""
        if self.bone_x is not None and self.bone_x_by is not None:
            raise ValueError(
                f"bone_x is {show(self.bone_x)} and bone_x_by is {show(self.bone_x_by)}; give the place or the move"
            )
        if self.speed is not None and self.bone_x is None and self.bone_x_by is None:
            raise ValueError(f"speed is {show(self.speed)} and the bone does not move; give bone_x or bone_x_by too")
        if self.speed is not None and self.duration is not None:
            raise ValueError(
                f"speed is {show(self.speed)} and duration is {show(self.duration)}; one follows from the other, so "
                "give one"
            )
        if self.wave is None:
            return
        for name in ("f_ext", "bone_height"):
            if getattr(self, name) is not None:
                raise ValueError(
                    f"{name} is {show(getattr(self, name))} and voltage is a waveform; {name} must come in a load of "
                    "its own, before it"
                )
        if self.speed is None and self.duration is None and self.wave.end == math.inf:
            raise ValueError(f"voltage is a {self.wave.waveform} and the load takes no time; give a speed or duration")

    @property
    def wave(self) -> Waveform | None:
        """The voltage over time; None where it is a number or stays."""
        return self.voltage if isinstance(self.voltage, Waveform) else None

    @property
    def level(self) -> float | None:
        """The voltage (V) to go to; None where it is over time or stays."""
        return None if isinstance(self.voltage, Waveform) else self.voltage

    @property
    def moves(self) -> bool:
        """Whether the load may take the bone away from where it was unloaded."""
        return bool(self.bone_x or self.bone_x_by)

    @property
    def pace(self) -> str:
        """Speed or duration in words; empty without."""
        if self.speed is not None:
            return f"at {1e3 * self.speed:g} mm/s"
        return "" if self.duration is None else f"in {self.duration:g} s"

    @property
    def takes_time(self) -> bool:
        """Whether it is a load over time."""
        return self.speed is not None or self.duration is not None or self.wave is not None

    def place(self, x: float) -> float | None:
        """Return where the load takes the bone (m) from a place x (m); None where it stays."""
        return self.bone_x if self.bone_x_by is None else x + self.bone_x_by

    def seconds(self, way: float) -> float:
        """Return how long the load takes (s) for a way of the bone (m); 0 where it is none over time."""
        if self.speed is not None:
            return abs(way) / self.speed
        if self.duration is None:
            return 0.0 if self.wave is None else self.wave.end
        return self.duration

    @model_serializer(mode="wrap")
    def _without_time(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Leave out what is not given of the keys of loads over time: runs made before they were there are found."""
        found: dict[str, Any] = write(self)
        return {name: value for name, value in found.items() if name not in _OVER_TIME or value is not None}


class Accuracy(Part):
    """Largest relative discretisation errors allowed.

    See :mod:`fingerpad.richardson` and :mod:`fingerpad.accuracy.refinement`. Friction is that of full slip, lengths and
    energy densities are those of normal contact and of full slip.
    """

    mu_app: Asked | None = None
    """Largest relative error of the apparent friction coefficient at full slip. Range: from 1e-6, beyond any mesh
    that fits into memory, to 0.5, which excludes almost nothing."""
    f_t: Asked | None = None
    """Largest relative error of the friction force at full slip."""
    contact_length: Asked | None = None
    """Largest relative error of the contact length, at normal contact and at full slip."""
    sed: Asked | None = None
    """Largest error of the strain energy density at the Merkel sites of touching ridges, relative to the largest
    density among the sites."""

    @model_validator(mode="after")
    def _asks(self) -> "Accuracy":
        if not self.tolerances():
            raise ValueError(f"accuracy is empty; give at least one of {', '.join(type(self).model_fields)}")
        return self

    def tolerances(self) -> dict[str, float]:
        """Return what is asked for, by quantity."""
        return {name: value for name in type(self).model_fields if (value := getattr(self, name)) is not None}


class Geometry(Fingertip):
    """Cross-section of a fingertip (Table 1 of Forsbach et al. 2023; all lengths in m), or the file of its mesh.

    The outline is an ellipse that the ridge tips touch; the lowest tip is at y = 0. Choices that the paper leaves open
    are marked as *assumption*.
    """

    file: str | None = None
    """File of a gmsh mesh in place of the cross-section and of the sizes in mesh, by the rules of ``docs/mesh.md``; a
    relative path starts at the scene file. Only sc_thickness is read of the other keys, for the attraction."""
    file_sha256: str | None = None
    """Hash of that file, which a run writes into its scene; another file is then refused."""

    @model_validator(mode="before")
    @classmethod
    def _hashed(cls, data: Any) -> Any:
        file = data.get("file") if isinstance(data, dict) else None
        if not isinstance(file, str) or reading_results():
            return data
        try:
            found = hashlib.sha256(files.read(file)).hexdigest()
        except FileNotFoundError:
            raise fail(f"is {show(file)}, and there is no such file", "file") from None
        except OSError as error:
            raise fail(f"is {show(file)}, which cannot be read: {error.strerror}", "file") from None
        if data.get("file_sha256") not in (None, found):
            raise fail(f"is {show(file)}, which was changed since the scene was kept; put that file back", "file")
        return data | {"file": str(Path(file).absolute()), "file_sha256": found}


class Contact(Part):
    """Discretisation of contact and friction, and the definition of the contact length.

    A formulation reads its own keys only; keys of another formulation are refused.
    """

    law: Annotated[Formulation, CONTACT] = Penalty()
    """Penalty (springs of the screen), Nitsche's method or an augmented Lagrangian; see
    :mod:`variational.contact.formulation`. The augmented Lagrangian is a method for comparison: it takes several times
    the factorisations of the penalty, finds full slip in fewer scenes (``docs/stability.md``), and its friction at full
    slip depends a little on the load path."""
    length: Literal["pressure", "gap"] = "pressure"
    """Ridge length L_R of Eq. 4: ``"pressure"`` is the length under contact pressure, ``"gap"`` the length where
    the gap is below d_eq. *Assumption*: the former; the domain printed in Eq. 4 is the whole boundary. Tables have the
    length and the mean pressure of the former in either case."""

    @model_validator(mode="before")
    @classmethod
    def _nested(cls, data: Any) -> Any:
        """Put the keys of a formulation into a table of their own."""
        if isinstance(data, Formulation):
            return {"law": data}
        if not isinstance(data, dict):
            return data
        own = {key: value for key, value in data.items() if key not in ("law", "formulation", "length")}
        before = data.get("law", {})  # a table, of a scene of which some keys are changed
        name = before if isinstance(before, str) else data.get("formulation")
        if name is not None:
            same = isinstance(before, dict) and CONTACT.kind.laws.get(str(name)) is before.get("law", ...)
            own = (before if same else {"law": name}) | own
        elif isinstance(before, dict):
            own = before | own
        elif own:
            raise ValueError(f"{next(iter(own))} is given beside a formulation, which has its own; leave it out")
        else:
            return data
        return {key: value for key, value in data.items() if key == "length"} | {"law": own}

    @model_serializer(mode="wrap")
    def _flat(self, write: SerializerFunctionWrapHandler) -> dict[str, Any]:
        found: dict[str, Any] = write(self)
        own = found.pop("law")
        return {"formulation": own.pop("law", self.formulation)} | own | found

    @property
    def formulation(self) -> str:
        """Name of the formulation, or its import path."""
        return CONTACT.kind.name(type(self.law))

    def __getattr__(self, name: str) -> Any:
        """Return a parameter of the formulation."""
        law = self.__dict__.get("law")
        if law is not None and name in keys_of(law):
            return getattr(law, name)
        raise AttributeError(f"contact has no {name}")


class Output(Part):
    """Optional outputs; an output that is switched off is not computed."""

    receptors: Switch = True
    """Whether strain energy densities at the Merkel and Meissner sites are computed, with elements of size
    ``mesh.receptor`` below the Merkel sites."""
    errors: Switch = True
    """Whether discretisation errors are estimated; see :mod:`fingerpad.accuracy.refinement`. With an accuracy they
    always are."""
    each_load: Switch = True
    """Whether the finger and its skin are drawn at the end of each load. A load over time has one end."""


class Numerics(Part):
    """Discretisation and tolerances."""

    element: Literal["P1", "P2", "P2 reduced", "P2-P1", "P3"] = "P2"
    """Element of the displacement, and of the pressure in P2-P1; see :mod:`variational.element`."""
    quadrature_points: Annotated[int, Field(strict=True, ge=2, le=8)] = 4
    """Number of Gauss points on a surface facet."""
    tolerance: Annotated[Finite, within(1e-12, 1e-7)] = 1e-9
    """Residual of the equilibrium at which Newton's method ends, relative to the largest f_ext of the loads; where all
    are by the bone's height, to 1 N/m. Range: from 5e-7 on the forces of bone and screen can differ by more than the
    1e-6 that is accepted."""
    coupling_tolerance: Annotated[Finite, within(1e-12, 1e-3)] = 1e-6
    """Relative change of d_eq at which the coupling iteration ends. With a gain g the remaining error of d_eq is up
    to g / (1 - g) times as large, that of the attraction up to twice that."""
    coupling_cap: Annotated[int, Field(strict=True, ge=1, le=1000)] = 30
    """Largest number of coupling iterations of one solve."""
    step_scale: Annotated[Finite, within(1e-3, 10.0)] = 1.0
    """Factor on the largest steps of force, voltage and displacement."""
    memory: Annotated[Finite, within(1e8, 1e15, "B")] = 16e9
    """Most memory (bytes) of all ranks together, by :mod:`fingerpad.model.options`. A larger scene
    is refused before meshing. The default fits a machine of 24 GB."""

    @model_validator(mode="after")
    def _consistent(self) -> "Numerics":
        if self.element != "P1" and self.quadrature_points < 3:
            raise ValueError(
                f"quadrature_points is {self.quadrature_points}; it must be at least 3 for element {show(self.element)}"
            )
        return self
