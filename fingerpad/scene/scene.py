"""Scenes: everything a run needs, from Python, TOML or the command line, and refused in one sentence if impossible.

A number is in SI units, or a text with its unit (:mod:`geometry.units`).
"""

import json
from collections.abc import Mapping
from dataclasses import replace
from numbers import Real
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field, PrivateAttr, ValidationError, model_validator

from fingerpad.scene.laws import LAYERS, Laws, refuse_thickness, refuse_unread
from fingerpad.scene.load_names import first_clash
from fingerpad.scene.materials import Electric, Materials, Roughness
from fingerpad.scene.messages import SceneError, first_error, show
from fingerpad.scene.parameters import FORMULATION_KEYS, Accuracy, Contact, Load, Numerics, Output, Voltage
from fingerpad.scene.reading import override as override
from fingerpad.scene.reading import plain, put, read
from fingerpad.scene.table import Finite, Part
from geometry.bounds import within
from geometry.parameters import Fingertip, MeshSize
from variational.contact.friction import Friction, law_of
from variational.roughness.closure import Closure

if TYPE_CHECKING:
    from variational.materials.material import Material


class Scene(Part):
    """Everything a run needs; SI units, forces per out-of-plane length.

    ``Scene(f_ext="50 N/m", mesh={"contact": 10e-6})`` is the scene of the same keys in a TOML file: the same values,
    the same coarse start where an accuracy is asked for, and the same refusals. NumPy's numbers and arrays are taken
    as Python's, and a table may also be one of the classes here, such as ``MeshSize``.

    Without ``history`` the bone is pressed with ``f_ext``, the voltage is switched on, and the bone slides until
    every ridge slips. With ``history`` the loads say it all and the three keys of the default one are refused.
    """

    f_ext: Annotated[Finite, within(1e-3, 5e3, "N/m")] = 75.0
    """External normal force on the bone (N/m). Range: the weight of a grain of sand to 100 N on 20 mm of finger."""
    voltage: Voltage = 200.0
    """Instantaneous voltage U (V). *Assumption*: U is that of Eq. 3, not the peak-to-peak value of Table 3. Range:
    from 1 mV, which attracts with less than 1 µPa, to ten times the voltage of displays; 0 is no voltage."""
    slide_length: Annotated[Finite, within(1e-9, 0.1, "m")] = 5e-3
    """Largest displacement of the bone (m) on the way to full slip (*assumption*). The slide stops earlier, at full
    slip."""
    history: Annotated[tuple[Load, ...], Field(min_length=1, max_length=1000)] | None = None
    """Loads to reach one after the other, at most 1000, in place of the default press, charge and slide."""
    friction: Annotated[Finite, within(1e-6, 2.0, zero=True)] = 0.25
    """Friction coefficient mu_0 of skin on the screen. 0 is no friction; 2 is the coefficient of rubber."""
    geometry: Fingertip = Fingertip()
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
        text = json.dumps(_coarse_start(plain(data)))
        try:
            # As JSON, because there a list is a tuple and a table is a model even under strict rules.
            self.__pydantic_validator__.validate_json(text, strict=True, self_instance=self)
        except ValidationError as error:
            raise SceneError(first_error(error, Scene)) from None

    @model_validator(mode="after")
    def _can_be_carried(self) -> "Scene":
        if self.accuracy is not None and self.numerics.element == "P2-P1":
            raise ValueError(
                "accuracy is given and numerics.element is 'P2-P1', whose pressure cannot be carried to another mesh; "
                "take 'P2'"
            )
        return self

    output: Output = Output()

    @model_validator(mode="after")
    def _has_sites(self) -> "Scene":
        if self.accuracy is not None and self.accuracy.sed is not None and not self.output.receptors:
            raise ValueError(
                f"accuracy.sed is {show(self.accuracy.sed)} and output.receptors is false, without which there are no "
                "sites; leave out one of the two"
            )
        return self

    @model_validator(mode="after")
    def _ends_somewhere(self) -> "Scene":
        gap = self.roughness.largest_gap(self.h_0)
        if not gap < _LARGEST_GAP:
            raise ValueError(
                f"roughness.p_floor is {show(self.roughness.p_floor)}, where the air gap would be held at {gap:.3g} m; "
                f"it must be below {_LARGEST_GAP:g} m: take a larger p_floor, or a smaller gamma or h_rms"
            )
        return self

    @model_validator(mode="after")
    def _one_history(self) -> "Scene":
        if self.history is None:
            return self
        for name in _DEFAULT_HISTORY:
            if name in self.model_fields_set:
                raise ValueError(
                    f"{name} is {show(getattr(self, name))} and history is given too; "
                    "with a history each load states its own values"
                )
        first = self.history[0]
        if first.f_ext is None and first.bone_height is None:
            raise ValueError(
                f"history[0].name is {show(first.name)}, with neither f_ext nor bone_height; "
                "the first load must give one of them"
            )
        clash = first_clash([load.name for load in self.history])
        if clash is not None:
            one, other = (show(self.history[k].name) for k in clash)
            raise ValueError(
                f"history[{clash[1]}].name is {other} and history[{clash[0]}].name is {one}; each load must have a "
                "name of its own, also where spaces become _ and letters have no case, since files are named by it"
            )
        self._refuse_floating()
        return self

    def _refuse_floating(self) -> None:
        """Refuse loads that leave the bone neither held nor pressed nor attracted."""
        f_ext, voltage = None, 0.0
        for k, load in enumerate(self.history or ()):
            if load.f_ext is not None or load.bone_height is not None:
                f_ext = load.f_ext
            voltage = voltage if load.voltage is None else load.voltage
            if f_ext == 0 and voltage == 0:
                raise ValueError(
                    f"history[{k}].name is {show(load.name)}, which ends at f_ext 0 and voltage 0, where nothing holds "
                    "the skin on the screen; one of the two must be greater than 0, or a bone_height be given"
                )

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
        present = plain(self)
        if "accuracy" in changes and self.accuracy is not None:
            coarse = start(self.accuracy.tolerances())
            present["mesh"] = {key: size for key, size in present.get("mesh", {}).items() if coarse.get(key) != size}
        if changes.get("history") is not None:
            present = {key: value for key, value in present.items() if key not in _DEFAULT_HISTORY}
        contact = changes.get("contact")
        if isinstance(contact, Mapping) and contact.get("formulation", self.contact.formulation) != (
            self.contact.formulation
        ):
            present["contact"] = {
                key: value for key, value in present.get("contact", {}).items() if key not in FORMULATION_KEYS
            }
        found = Scene(**_merged(present, changes))
        for name, value in (self.__pydantic_private__ or {}).items():
            setattr(found, name, value)
        if "friction" in changes:
            found._laws = replace(found._laws, friction=None)
        refuse_unread(self, found)
        return found._checked()

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
        """Return the microscale."""
        return self.roughness.bearing_area(self.h_0) if self.laws.closure is None else self.laws.closure

    def friction_law(self) -> Friction | None:
        """Return the law of friction, None without friction."""
        return law_of(self.friction if self.laws.friction is None else self.laws.friction)

    def solids(self) -> "dict[int, Material]":
        """Return the material of each layer's tag."""
        from variational.materials.ogden import Ogden  # UFL: not for those who only read scenes
        from variational.materials.saint_venant import SaintVenant

        m = self.materials
        skins = ("subcutis", "dermis", "viable_epidermis", "stratum_corneum")
        found: dict[str, Material] = {}
        for layer in skins:
            skin = getattr(m, layer)
            found[layer] = Ogden(skin.shear_modulus, skin.alpha, skin.poisson, m.exponent)
        found |= {"nail": SaintVenant(m.nail.young, m.nail.poisson)}
        found |= {"nail_bed": SaintVenant(m.nail_bed.young, m.nail_bed.poisson)}
        return {LAYERS[layer]: self.laws.materials.get(layer, solid) for layer, solid in found.items()}

    @classmethod
    def load(cls, path: str | Path) -> "Scene":
        """Return the scene of a TOML file.

        Raises:
            SceneError: the file cannot be read, or the first key at fault.
        """
        return load(Path(path))

    def loads(self) -> tuple[Load, ...]:
        """Return the loads to reach one after the other."""
        if self.history is not None:
            return self.history
        return (
            Load(name="press", f_ext=self.f_ext),
            Load(name="charge", voltage=self.voltage),
            Load(name="slide", bone_x=self.slide_length, until_full_slip=True),
        )

    def parameters(self) -> dict[str, Any]:
        """Return every parameter in use, ready for JSON; as a scene it gives the same run again."""
        unused: dict[str, Any] = {name: True for name in (("history",) if self.history is None else _DEFAULT_HISTORY)}
        unused |= {"accuracy": True} if self.accuracy is None else {}
        if self.output == Output():  # not a word of it, so that runs made before it was a key are found
            unused["output"] = True
        default = Numerics()  # likewise
        unused["numerics"] = {n for n in ("step_scale", "memory") if getattr(self.numerics, n) == getattr(default, n)}
        found = self.model_dump(mode="json", exclude=unused | {"contact": self.contact.unread()})
        return found | ({"laws": self.laws.parameters()} if self.laws else {})


_LARGEST_GAP = 1.0  # m, with which the attraction is as good as none
_START = {"contact": 20e-6, "receptor": 40e-6, "interface": 120e-6, "growth": 0.5}
_START_AT_SITES = 10e-6  # m; coarser elements do not see the tips of 6 µm, and to halve them tells nothing of the error
_DEFAULT_HISTORY = ("f_ext", "voltage", "slide_length")


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
    data: dict[str, Any] = plain(read(Path(path))) if path is not None else {}
    if path is not None:
        _beside(data, Path(path).parent)
    if "sweep" in data:
        raise SceneError(f"{path} has a table sweep, which makes it a study; run it by fingerpad sweep, or without it")
    for key, value in (overrides or {}).items():
        put(data, key, value)
    return from_data(data)


def _beside(data: dict[str, Any], folder: Path) -> None:
    """Put the folder of a scene file before the name of a height map."""
    place: Any = data
    for key in ("roughness", "topography"):
        place = place.get(key) if isinstance(place, dict) else None
    if isinstance(place, dict) and isinstance(place.get("file"), str):
        place["file"] = str(folder / place["file"])


def from_data(data: Mapping[str, Any]) -> Scene:
    """Validate a scene given as nested tables.

    Raises:
        SceneError: the first key at fault.
    """
    data = plain(data)
    if not isinstance(data, dict):
        raise SceneError(f"a scene is {show(data)}; it must be a table of keys")
    return Scene(**data)


def _coarse_start(data: Mapping[str, Any]) -> Mapping[str, Any]:
    """Start from a coarse mesh, in sizes that the scene does not give, if it asks for an accuracy."""
    mesh, accuracy = data.get("mesh", {}), data.get("accuracy")
    if not (isinstance(mesh, dict) and isinstance(accuracy, dict) and accuracy):
        return data
    return {**data, "mesh": start(accuracy) | mesh}


def start(asked: Mapping[str, Any]) -> dict[str, float]:
    """Return the element sizes from which a scene starts that asks for accuracies by quantity."""
    return _START | ({"receptor": _START_AT_SITES} if asked.get("sed") is not None else {})


def _merged(present: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return a table with changes, of which tables are merged and all else replaced."""
    found = dict(present)
    for key, value in changes.items():
        both = isinstance(value, Mapping) and isinstance(found.get(key), Mapping)
        found[key] = _merged(found[key], value) if both else value
    return found
