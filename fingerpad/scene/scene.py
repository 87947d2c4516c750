"""Scenes: everything a run needs, from Python, TOML or the command line, and refused with a message if impossible.

A number is in SI units, or a text with its unit (:mod:`geometry.units`).
"""

import json
from collections.abc import Mapping
from dataclasses import is_dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, PrivateAttr, ValidationError, model_validator

from fingerpad import notebook
from fingerpad.scene.controls import FORCE, VOLTAGE, CarriedWaveform
from fingerpad.scene.drive import Drive, Electric, drive_of, refuse_drives
from fingerpad.scene.fingers import PAPER, FingerName
from fingerpad.scene.keys import every
from fingerpad.scene.law_code import digest, folder_of, imported
from fingerpad.scene.law_keys import UnresolvedLaw, kept
from fingerpad.scene.loads import Load, drives, refuse_contradictions, refuse_floating, repeated
from fingerpad.scene.materials import (
    ADHESION,
    BEARING_AREA,
    FRICTION,
    LAYERS,
    NO_ADHESION,
    PRESET_LAWS,
    ROUGHNESS,
    Materials,
    adheres,
    refuse_memory,
    refuse_thickness,
)
from fingerpad.scene.messages import SceneError, first_error, show
from fingerpad.scene.parameters import (
    Accuracy,
    Contact,
    Geometry,
    Numerics,
    Output,
    Slices,
    centre_force,
    refuse_beside_mesh,
)
from fingerpad.scene.presets import DEFAULT_HISTORY, changed, preset_keys, with_presets, without
from fingerpad.scene.reading import flat, plain, put_all, read_scene
from fingerpad.scene.viscosity import elastic, refuse_beside, viscous_layers
from geometry.parameters import MeshSize
from geometry.units import Finite, Table, computed, within
from variational.contact.friction import Friction, law_of
from variational.materials.material import Material
from variational.roughness.closure import Closure


class Scene(Table):
    """Everything a run needs; SI units, forces per out-of-plane length.

    ``Scene(f_ext="50 N/m", mesh={"contact": 10e-6})`` is the scene of the same keys in a TOML file: the same values,
    the same coarse start where an accuracy is asked for, and the same refusals. NumPy's numbers and arrays are taken
    as Python's, and a table may also be one of the classes here, such as ``MeshSize``.

    Without ``history`` the bone is pressed with ``f_ext``, or the whole finger with ``force``, the voltage is switched
    on, and the bone slides until every ridge slips. With ``history`` the loads say it all and the keys of the default
    one are refused.
    """

    f_ext: Annotated[Finite, within(FORCE.limits.low, FORCE.limits.high, "N/m")] = 75.0
    """External normal force on the bone (N/m). Range: the weight of a grain of sand to more than 100 N on a finger."""
    force: Annotated[Finite, within(1e-5, 200.0, "N")] | None = None
    """External normal force on the whole finger (N), in place of ``f_ext``. The result is then a sum over slices along
    the finger's axis (``docs/newtons.md``). Range: the weight of a milligram to that of 20 kg."""
    voltage: Annotated[float | CarriedWaveform, VOLTAGE, BeforeValidator(repeated)] = 200.0
    """Instantaneous voltage U (V), or a drive, whose mean attraction over a period acts. *Assumption*: U is that of
    Eq. 3, not the peak-to-peak value of Table 3. Range: from 1 mV, which attracts with less than 1 µPa, to ten times
    the voltage of displays; 0 is no voltage. The sign changes no force."""
    slide_length: Annotated[Finite, within(1e-9, 0.1, "m")] = 5e-3
    """Largest displacement of the bone (m) on the way to full slip (*assumption*). The slide stops earlier, at full
    slip."""
    history: Annotated[tuple[Load, ...], Field(min_length=1, max_length=1000)] | None = None
    """Loads to reach one after the other, at most 1000, in place of the default press, charge and slide."""
    friction: Annotated[float | Friction, FRICTION] = 0.25
    """Friction coefficient mu_0 of skin on the screen, or a table of a law of friction."""
    adhesion: ADHESION = NO_ADHESION
    """Adhesion of skin to the screen without a voltage, a table of a law; by default none."""
    finger: FingerName = "paper"
    """Finger by its name (docs/fingers.md). A given key wins over the name's. "paper" is the default finger.
    Its tissue and leak act under a drive; a constant voltage has no losses."""
    geometry: Geometry = Geometry()
    mesh: MeshSize = MeshSize()
    materials: Materials = Materials()
    electric: Electric = Electric()
    roughness: Annotated[Closure, ROUGHNESS] = Field(BEARING_AREA, validate_default=True)
    """Roughness of a ridge (Table 3): a table of the bearing area model, or of another closure."""
    contact: Contact = Contact()
    numerics: Numerics = Numerics()
    accuracy: Accuracy | None = None
    """Largest relative errors allowed. The element sizes in ``mesh`` are then those of the first mesh."""
    _preset: list[str] = PrivateAttr(default_factory=list)  # keys for which finger and accuracy may stand

    def __init__(self, /, **data: Any) -> None:
        """Check a scene given as nested tables.

        Raises:
            SceneError: the first key at fault.
        """
        given = plain(data)
        refuse_beside_mesh(given)
        try:
            self.__pydantic_validator__.validate_python(with_presets(given, PRESET_LAWS), self_instance=self)
        except ValidationError as error:
            raise SceneError(first_error(error, Scene, (key.name for key in every(Scene)))) from None
        self._preset = preset_keys(given, PRESET_LAWS, Scene)

    def __eq__(self, other: object) -> bool:
        """Return whether another scene has the same values, whichever of them were given."""
        return isinstance(other, Scene) and self.__dict__ == other.__dict__

    output: Output = Output()
    slices: Slices = Slices()

    @model_validator(mode="after")
    def _consistent(self) -> "Scene":
        given = {name: getattr(self, name) for name in DEFAULT_HISTORY if name in self.model_fields_set}
        if self.force is not None:
            self._refuse_beside_force()
        if self.accuracy is not None:
            self.accuracy.refuse(self.output.receptors, self.friction)
        if self.history is not None:
            steps, follows = self.numerics.step_scale, self.electric.follows
            refuse_contradictions(self.history, given, self.output.errors, steps, follows)
            refuse_floating(() if adheres(self.adhesion) else self.history)
        refuse_memory(self.force, self.friction)
        self.output.refuse(self.force, self.friction, self.contact.law, viscous_layers(self.materials))
        refuse_beside(viscous_layers(self.materials), {"force": self.force, "accuracy": self.accuracy})
        refuse_thickness(self.roughness, self.h_0)
        refuse_drives(self.drives(), self.electric, self.geometry.sc_thickness)
        return self

    def _refuse_beside_force(self) -> None:
        """Refuse what a force on the whole finger has no use for: another force, loads or a mesh of one's own."""
        if "f_ext" in self.model_fields_set:
            raise ValueError(
                f"force is {show(self.force)} N and f_ext is {show(self.f_ext)} N/m; give one of the two: newtons on "
                "the whole finger, or newtons per metre at its centre"
            )
        if self.history is not None or self.geometry.file is not None:
            what = "history is given" if self.history else f"geometry.file is {show(self.geometry.file)}"
            raise ValueError(
                f"force is {show(self.force)} N and {what}; a force on the whole finger is that of press, charge and "
                "slide of the scene's own geometry, so leave one of the two out"
            )

    def replace(self, **changes: Any) -> "Scene":
        """Return a checked copy with some values changed.

        What the changes make meaningless goes: the sizes of a coarse start with another ``accuracy``, the values of the
        default loads with a ``history``, and the parameters of one law with another.

        Args:
            changes: values by key. A table given as a mapping keeps the keys that are not in it; any other value, also
                a table given as an object such as ``MeshSize``, stands in place of the present one.

        Raises:
            SceneError: the first key at fault, or one in whose place the scene has a law.
        """
        return Scene(**changed(without(plain(self), self._preset), changes))

    def __replace__(self, **changes: Any) -> "Scene":
        """Return :meth:`replace` of changes, as ``copy.replace`` does from Python 3.13 on."""
        return self.replace(**changes)

    @property
    def h_0(self) -> float:
        """Effective insulator thickness (m)."""
        return self.electric.h_0(self.geometry.sc_thickness)

    def drives(self) -> dict[str, CarriedWaveform]:
        """Return the drives in place of voltages, by key."""
        return drives(self.voltage, self.history or ())

    @property
    def drive(self) -> Drive | None:
        """The drive ``voltage`` through the circuit of the gap; None where it is a number."""
        wave = self.drives().get("voltage")
        return None if wave is None else drive_of(wave, self.electric, self.geometry.sc_thickness)

    @property
    def volts(self) -> float:
        """The voltage (V) of Eq. 3: ``voltage``, or what attracts as a drive does on average over a ridge's gap."""
        return self.voltage if isinstance(self.voltage, float) else self.drive.reference  # type: ignore[union-attr]

    # -- laws ------------------------------------------------------------------------------------------
    def laws(self) -> dict[str, Any]:
        """Return what each key has that holds a law: an object, or the number of a friction coefficient."""
        layers = {f"materials.{name}": elastic(getattr(self.materials, name)) for name in LAYERS}
        own = {name: getattr(self, name) for name in ("friction", "adhesion", "roughness")}
        return own | {"contact": self.contact.law} | layers

    def own_laws(self) -> dict[str, Any]:
        """Return the laws of one's own by key."""
        return {key: law for key, law in self.laws().items() if is_dataclass(law) and digest(type(law))}  # type: ignore[arg-type]

    def resolved(self) -> "Scene":
        """Return the scene with the laws that were not imported where results were read; raises as :meth:`replace`."""
        return self.replace() if any(isinstance(law, UnresolvedLaw) for law in self.laws().values()) else self

    def refuse_laws_of_program(self, where: str) -> None:
        """Refuse laws that no other process can import.

        Args:
            where: they are to be imported, in words.

        Raises:
            SceneError: the first of them.
        """
        for key, law in self.own_laws().items():
            try:
                imported(type(law).__module__, type(law).__qualname__)
            except ValueError as error:
                raise SceneError(f"{key} is a {type(law).__name__}, which {where} cannot have: {error}") from None

    def law_folders(self) -> list[str]:
        """Return the folders from which the laws of one's own are imported."""
        return sorted({folder_of(type(law)) for law in self.own_laws().values()} - {""})

    def closure(self) -> Closure:
        """Return the microscale.

        Raises:
            SceneError: it is a law of one's own in results that were read.
        """
        return _known("roughness", self.roughness)

    def friction_law(self) -> Friction | None:
        """Return the law of friction, None without friction; raises as :meth:`closure` does."""
        own = _known("friction", self.friction)
        return own if isinstance(own, Friction) else law_of(own)  # laws are checked where a scene is made

    def solids(self) -> dict[int, Material]:
        """Return the material of each layer's tag; raises as :meth:`closure` does."""
        return {tag: _known(f"materials.{name}", getattr(self.materials, name)) for name, tag in LAYERS.items()}

    @classmethod
    def load(cls, path: str | Path) -> "Scene":
        """Return the scene of a TOML file.

        Raises:
            SceneError: the file cannot be read, or the first key at fault.
        """
        return load(Path(path))

    @property
    def centre_force(self) -> float:
        """``f_ext`` (N/m), or about that at the centre of the finger under ``force``."""
        return self.f_ext if self.force is None else centre_force(self.force, self.geometry.width)

    def loads(self) -> tuple[Load, ...]:
        """Return the loads to reach one after the other; under ``force`` those of the centre of the finger, about."""
        if self.history is not None:
            return self.history
        with computed():  # of a copy, which may have a force that a run has reached
            return (
                Load(name="press", f_ext=self.centre_force),
                Load(name="charge", voltage=self.volts),
                Load(name="slide", bone_x=self.slide_length, until_full_slip=True),
            )

    def parameters(self) -> dict[str, Any]:
        """Return every parameter in use, ready for JSON; as a scene it gives the same run again."""
        unused = {"history"} if self.history is None else {*DEFAULT_HISTORY}
        unused |= {*["accuracy"] * (self.accuracy is None), *["finger"] * (self.finger == PAPER)}
        unused |= {"force" if self.force is None else "f_ext"}
        found = self.model_dump(mode="json", exclude=unused)
        if self.geometry.file is not None:  # whose mesh has its own shape and sizes
            del found["mesh"]
            found["geometry"] = {key: found["geometry"][key] for key in ("file", "file_sha256", "sc_thickness")}
        else:
            found["geometry"] = {key: x for key, x in found["geometry"].items() if not key.startswith("file")}
        if self.slices.height is not None:
            del found["slices"]["radius"], found["slices"]["length"], found["slices"]["shape"]
        return found

    def _repr_html_(self) -> str:
        """Return what differs from the default scene, for a notebook."""
        rows = [(key, *map(show, values)) for key, values in changed_keys(self.parameters()).items()]
        return notebook.page("Scene: keys unlike the default (SI)", notebook.table(("", "scene", "default"), rows))


def changed_keys(parameters: Mapping[str, Any]) -> dict[str, tuple[Any, Any]]:
    """Return the parameters that are not those of the default scene, by dotted key: their values and the default's."""
    default, given = (flat(json.loads(json.dumps(each))) for each in (Scene().parameters(), parameters))
    return {k: (x, default.get(k)) for k, x in given.items() if default.get(k) != x}  # None: of a table that is given


def _known(key: str, law: Any) -> Any:
    return law.refuse(key) if isinstance(law, UnresolvedLaw) else law


# -- files ---------------------------------------------------------------------------------------------
def load(path: Path | None = None, overrides: Mapping[str, Any] | None = None) -> Scene:
    """Read a scene.

    Args:
        path: TOML file; None for the default scene.
        overrides: values by dotted key (``{"mesh.contact": 5e-6, "history[0].voltage": 100}``), which win over the
            file's.

    Raises:
        SceneError: the file cannot be read, or the first key at fault.
    """
    data = {} if path is None else read_scene(Path(path))
    return from_data(overridden(data, overrides or {}))


def overridden(data: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return the data of a scene with values by dotted key.

    Another ``finger`` replaces values in the record of a run that are of the record's finger.

    Raises:
        SceneError: a table, or an entry of a list, that is not there.
    """
    found = without(data, preset_keys(data, PRESET_LAWS, Scene)) if "finger" in changes else dict(data)
    put_all(found, changes)
    return found


def from_data(data: Mapping[str, Any]) -> Scene:
    """Validate a scene given as nested tables.

    Raises:
        SceneError: the first key at fault.
    """
    if not isinstance(data := plain(data), dict):
        raise SceneError(f"a scene is {show(data)}; it must be a table of keys")
    return Scene(**data)


def as_kept(parameters: Mapping[str, Any]) -> Scene:
    """Return the scene of a run's files, for reading: laws of one's own and meshes are not looked for.

    Args:
        parameters: what :meth:`Scene.parameters` gave, and the model.

    Raises:
        SceneError: the first key at fault.
    """
    with computed(), kept():  # computed as the loads of a trace are
        return from_data({key: value for key, value in parameters.items() if key != "model"})
