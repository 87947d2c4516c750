"""Scenes: everything a run needs, from Python, TOML or the command line, and refused with a message if impossible.

A number is in SI units, or a text with its unit (:mod:`geometry.units`).
"""

import json
from collections.abc import Mapping
from dataclasses import replace
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field, PrivateAttr, ValidationError, model_validator

from fingerpad.scene.changes import changed, with_coarse_start
from fingerpad.scene.contradictions import DEFAULT_HISTORY, refuse_beside_force, refuse_contradictions
from fingerpad.scene.laws import LAYERS, Laws, refuse_beside_mesh, refuse_thickness, refuse_unread
from fingerpad.scene.materials import Electric, Materials, Roughness
from fingerpad.scene.messages import SceneError, first_error, show
from fingerpad.scene.parameters import Accuracy, Contact, Geometry, Load, Numerics, Output
from fingerpad.scene.reading import plain, put, read_scene
from fingerpad.scene.slices import Slices, centre_force
from fingerpad.scene.table import Finite, Part
from fingerpad.scene.waveform import Volts
from geometry.bounds import computed, within
from geometry.parameters import MeshSize
from variational.contact.friction import Friction, law_of
from variational.roughness.closure import Closure

if TYPE_CHECKING:
    from variational.materials.material import Material


class Scene(Part):
    """Everything a run needs; SI units, forces per out-of-plane length.

    ``Scene(f_ext="50 N/m", mesh={"contact": 10e-6})`` is the scene of the same keys in a TOML file: the same values,
    the same coarse start where an accuracy is asked for, and the same refusals. NumPy's numbers and arrays are taken
    as Python's, and a table may also be one of the classes here, such as ``MeshSize``.

    Without ``history`` the bone is pressed with ``f_ext``, or the whole finger with ``force``, the voltage is switched
    on, and the bone slides until every ridge slips. With ``history`` the loads say it all and the keys of the default
    one are refused.
    """

    f_ext: Annotated[Finite, within(1e-3, 5e3, "N/m")] = 75.0
    """External normal force on the bone (N/m). Range: the weight of a grain of sand to more than 100 N on a finger."""
    force: Annotated[Finite, within(1e-5, 200.0, "N")] | None = None
    """External normal force on the whole finger (N), in place of ``f_ext``. The result is then a sum over slices along
    the finger's axis (``docs/newtons.md``). Range: the weight of a milligram to that of 20 kg."""
    voltage: Volts = 200.0
    """Instantaneous voltage U (V). *Assumption*: U is that of Eq. 3, not the peak-to-peak value of Table 3. Range:
    from 1 mV, which attracts with less than 1 µPa, to ten times the voltage of displays; 0 is no voltage. The sign
    changes no force."""
    slide_length: Annotated[Finite, within(1e-9, 0.1, "m")] = 5e-3
    """Largest displacement of the bone (m) on the way to full slip (*assumption*). The slide stops earlier, at full
    slip."""
    history: Annotated[tuple[Load, ...], Field(min_length=1, max_length=1000)] | None = None
    """Loads to reach one after the other, at most 1000, in place of the default press, charge and slide."""
    friction: Annotated[Finite, within(1e-6, 2.0, zero=True)] = 0.25
    """Friction coefficient mu_0 of skin on the screen. 0 is no friction; 2 is the coefficient of rubber."""
    geometry: Geometry = Geometry()
    mesh: MeshSize = MeshSize()
    materials: Materials = Materials()
    electric: Electric = Electric()
    roughness: Roughness = Roughness()
    contact: Contact = Contact()
    numerics: Numerics = Numerics()
    accuracy: Accuracy | None = None
    """Largest relative errors allowed. The element sizes in ``mesh`` are then those of the first mesh."""

    def __init__(self, /, **data: Any) -> None:
        """Check a scene given as nested tables.

        Raises:
            SceneError: the first key at fault.
        """
        if "laws" in data:
            raise SceneError("laws is no key, since no file can hold one; give laws from Python, by Scene.with_laws")
        given = plain(data)
        refuse_beside_mesh(given)
        text = json.dumps(with_coarse_start(given))
        try:
            # As JSON, because there a list is a tuple and a table is a model even under strict rules.
            self.__pydantic_validator__.validate_json(text, strict=True, self_instance=self)
        except ValidationError as error:
            raise SceneError(first_error(error, Scene)) from None
        self._laws = self._laws.with_file(self.geometry.file)

    output: Output = Output()
    slices: Slices = Slices()

    @model_validator(mode="after")
    def _consistent(self) -> "Scene":
        given = {name: getattr(self, name) for name in DEFAULT_HISTORY if name in self.model_fields_set}
        refuse_beside_force(self.force, given, self.history, self.geometry.file)
        scale = self.numerics.step_scale
        refuse_contradictions(
            self.accuracy, self.output, self.friction, self.roughness, self.h_0, self.history, given, scale
        )
        return self

    def replace(self, **changes: Any) -> "Scene":
        """Return a checked copy with some values changed.

        Laws given from Python stay, but for a law of friction where ``friction`` changes. What the changes make
        meaningless goes: the sizes of a coarse start with another ``accuracy``, the values of the default loads with a
        ``history``, and the values of one ``contact.formulation`` with another.

        Args:
            changes: values by key. A table given as a mapping keeps the keys that are not in it; any other value, also
                a table given as an object such as ``MeshSize``, stands in place of the present one.

        Raises:
            SceneError: the first key at fault, or one in whose place the scene has a law.
        """
        found = Scene(**changed(plain(self), self.accuracy, self.contact.formulation, changes))
        for name, value in (self.__pydantic_private__ or {}).items():
            setattr(found, name, value)
        if "friction" in changes:
            kept = {name: law for name, law in found._laws.kept.items() if name != "friction"}
            found._laws = replace(found._laws, friction=None, kept=kept)
        if found.geometry.file != self.geometry.file:
            found._laws = found._laws.with_file(found.geometry.file)
        refuse_unread(self, found)
        return found._checked()

    def __replace__(self, **changes: Any) -> "Scene":
        """Return :meth:`replace` of changes, as ``copy.replace`` does from Python 3.13 on."""
        return self.replace(**changes)

    @property
    def h_0(self) -> float:
        """Effective insulator thickness (m)."""
        return self.electric.h_0(self.geometry.sc_thickness)

    # -- laws ------------------------------------------------------------------------------------------
    _laws: Laws = PrivateAttr(default_factory=Laws)  # no field: it is no key of a file

    @property
    def laws(self) -> Laws:
        """Laws given from Python, in the place of those of the keys."""
        return self._laws

    def with_laws(
        self,
        closure: Closure | None = None,
        materials: "Mapping[str, Material] | None" = None,
        friction: Friction | float | None = None,
        mesh: Path | str | None = None,
    ) -> "Scene":
        """Return the scene with laws of one's own; what is left out stays, and so do the materials of other layers.

        Args:
            closure: the microscale.
            materials: solids by the layer's key or name.
            friction: law of friction; a number is the key ``friction`` of the scene.
            mesh: file of a mesh.

        Raises:
            SceneError: what is no law, or a closure of another insulator than the scene's; in one sentence.
        """
        given = {"closure": closure, "mesh": mesh}
        changes: dict[str, Any] = {name: law for name, law in given.items() if law is not None}
        if materials is not None:
            changes["materials"] = {**self.laws.materials, **Laws(materials=materials).materials}
        found = self.model_copy()
        if isinstance(friction, Real) and not isinstance(friction, bool):
            found = self.replace(friction=friction)
        elif friction is not None:
            changes["friction"] = friction
        found._laws = replace(found.laws, **changes)
        return found._checked()

    def _checked(self) -> "Scene":
        """Return the scene itself; refuse a closure of another insulator."""
        try:
            refuse_thickness(self.laws.closure, self.h_0)
        except ValueError as error:
            raise SceneError(str(error)) from None
        return self

    def closure(self) -> Closure:
        """Return the microscale.

        Raises:
            SceneError: it is known by name alone, in a scene that was read from a run's files.
        """
        self._laws.refuse_kept("closure")
        return self.roughness.bearing_area(self.h_0) if self.laws.closure is None else self.laws.closure

    def friction_law(self) -> Friction | None:
        """Return the law of friction, None without friction; raises as :meth:`closure` does."""
        self._laws.refuse_kept("friction")
        return law_of(self.friction if self.laws.friction is None else self.laws.friction)

    def solids(self) -> "dict[int, Material]":
        """Return the material of each layer's tag; raises as :meth:`closure` does."""
        self._laws.refuse_kept("materials")
        own = self.laws.materials
        return {LAYERS[layer]: own.get(layer, solid) for layer, solid in self.materials.solids().items()}

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
                Load(name="charge", voltage=self.voltage),
                Load(name="slide", bone_x=self.slide_length, until_full_slip=True),
            )

    def parameters(self) -> dict[str, Any]:
        """Return every parameter in use, ready for JSON; as a scene it gives the same run again."""
        unused: dict[str, Any] = {name: True for name in (("history",) if self.history is None else DEFAULT_HISTORY)}
        unused |= {"accuracy": True} if self.accuracy is None else {}
        unused["force" if self.force is None else "f_ext"] = True
        if self.output == Output():  # not a word of it, so that runs made before it was a key are found
            unused["output"] = True
        elif self.output.each_load:
            unused["output"] = {"each_load"}
        if self.slices == Slices():  # likewise
            unused["slices"] = True
        default = Numerics()  # likewise
        unused["numerics"] = {n for n in ("step_scale", "memory") if getattr(self.numerics, n) == getattr(default, n)}
        found = self.model_dump(mode="json", exclude=unused | {"contact": self.contact.unread()})
        return found | ({"laws": self.laws.parameters()} if self.laws else {})


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
    for key, value in (overrides or {}).items():
        put(data, key, value)
    return from_data(data)


def from_data(data: Mapping[str, Any]) -> Scene:
    """Validate a scene given as nested tables.

    Raises:
        SceneError: the first key at fault.
    """
    data = plain(data)
    if not isinstance(data, dict):
        raise SceneError(f"a scene is {show(data)}; it must be a table of keys")
    return Scene(**data)


def as_kept(parameters: Mapping[str, Any]) -> Scene:
    """Return the scene of a run's files, for reading: laws that these do not hold are in it by name alone.

    Args:
        parameters: what :meth:`Scene.parameters` gave, and the model.

    Raises:
        SceneError: the first key at fault.
    """
    with computed():  # as the loads of a trace are
        scene = from_data({key: value for key, value in parameters.items() if key not in ("laws", "model")})
    laws = parameters.get("laws")
    if not isinstance(laws, Mapping) or not laws:
        return scene
    scene._laws = replace(scene.laws, kept=laws)
    try:
        mesh = from_kept({"laws": {"mesh": laws["mesh"]}}).laws.mesh
    except (SceneError, KeyError, TypeError):  # it is gone, was changed, or there is none
        return scene
    return scene.with_laws(mesh=mesh)


def from_kept(parameters: Mapping[str, Any]) -> Scene:
    """Return the scene of what :meth:`Scene.parameters` gave, which may have a mesh of its own.

    Raises:
        SceneError: another law of its own, a mesh that is gone or was changed, or the first key at fault.
    """
    given, laws = dict(parameters), parameters.get("laws", {})
    if not isinstance(laws, Mapping) or laws.keys() - {"mesh"}:
        raise SceneError("the scene has laws of its own, written in Python, which no file holds")
    given.pop("laws", None)
    scene = from_data(given)
    if not laws:
        return scene
    path, was = laws["mesh"]["path"], laws["mesh"]["sha256"]
    scene = scene.with_laws(mesh=path)
    if scene.laws.mesh_sha256 != was:
        raise SceneError(f"mesh is {show(path)}, which is not the file that the scene was kept with; put that one back")
    return scene
