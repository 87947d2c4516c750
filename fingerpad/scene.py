"""Scenes: everything a run needs, read from TOML and the command line, and refused in one sentence if impossible."""

import json
import math
import re
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from fingerpad.sentences import first_error, qualify, show
from geometry.parameters import Fingertip, MeshSize
from geometry.profiles import GeometryError
from variational.augmented import AugmentedLagrangian
from variational.contact import Formulation
from variational.electroadhesion import insulator_thickness
from variational.nitsche import Nitsche
from variational.penalty import Penalty
from variational.roughness.bam import BearingArea

Finite = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Positive = Annotated[float, Field(strict=True, allow_inf_nan=False, gt=0)]
NonNegative = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0)]
Permittivity = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=1)]
Poisson = Annotated[float, Field(strict=True, allow_inf_nan=False, gt=-1, lt=0.5)]
Tolerance = Annotated[float, Field(strict=True, allow_inf_nan=False, gt=0, lt=1)]


class SceneError(ValueError):
    """A scene that cannot be run; one sentence that names the key, its value and what is allowed."""


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Load(_Part):
    """A load to reach from the present one; what is left out stays as it is."""

    name: str
    f_ext: NonNegative | None = None
    """External normal force on the bone (N/m); zero only under voltage, which then holds the skin on the screen."""
    bone_height: Finite | None = None
    """Change of the bone's height from the unloaded position (m), negative when pressed."""
    voltage: NonNegative | None = None
    """Instantaneous voltage U (V)."""
    bone_x: Finite | None = None
    """Horizontal position of the bone (m), zero when unloaded."""
    until_full_slip: Annotated[bool, Field(strict=True)] = False
    """Stop as soon as every point in contact slips one way."""

    @model_validator(mode="after")
    def _consistent(self) -> "Load":
        if self.f_ext is not None and self.bone_height is not None:
            raise ValueError(
                f"f_ext is {show(self.f_ext)} and bone_height is {show(self.bone_height)}; "
                "at most one of the two can be prescribed"
            )
        if {self.f_ext, self.bone_height, self.voltage, self.bone_x} == {None}:
            raise ValueError(
                f"name is {show(self.name)} and nothing else is given; "
                "it must come with at least one of f_ext, bone_height, voltage and bone_x"
            )
        return self


class Skin(_Part):
    """Ogden solid (Eqs. 1 and 2)."""

    shear_modulus: Positive
    """Initial shear modulus G_0 (Pa)."""
    alpha: Finite
    poisson: Poisson = 0.48

    @model_validator(mode="after")
    def _consistent(self) -> "Skin":
        if self.alpha == 0:
            raise ValueError("alpha is 0; it must be another number, positive or negative")
        return self


class Stiff(_Part):
    """Saint Venant-Kirchhoff solid: linear elastic at finite rotation (*assumption*; the paper: linear elastic)."""

    young: Positive
    """Young's modulus (Pa)."""
    poisson: Poisson = 0.3


class Materials(_Part):
    """Materials of the layers (Table 2). A table that gives some keys of a layer keeps the others' defaults."""

    subcutis: Skin = Skin(shear_modulus=25e3, alpha=5.0)
    dermis: Skin = Skin(shear_modulus=2.55e3, alpha=-14.53)
    viable_epidermis: Skin = Skin(shear_modulus=61.75e3, alpha=-14.53)
    stratum_corneum: Skin = Skin(shear_modulus=86.76e3, alpha=-14.53)
    nail: Stiff = Stiff(young=170e6)
    nail_bed: Stiff = Stiff(young=1e6)
    exponent: Literal["printed", "abaqus"] = "printed"
    """Power of the stretches: ``"printed"`` for the paper's -alpha, ``"abaqus"`` for +alpha.
    *Assumption*: the paper computed with Abaqus but prints -alpha."""

    @model_validator(mode="before")
    @classmethod
    def _complete(cls, data: Any) -> Any:
        if not isinstance(data, dict):
            return data
        defaults = {name: field.default for name, field in cls.model_fields.items()}
        return {
            name: defaults[name].model_dump() | given
            if isinstance(given, dict) and isinstance(defaults.get(name), BaseModel)
            else given
            for name, given in data.items()
        }


class Electric(_Part):
    """Insulators between finger and electrode (Table 3)."""

    eps_sc: Permittivity = 1650.0
    """Relative permittivity of the stratum corneum, at 3 kHz."""
    d_i: Positive = 1e-6
    """Thickness of the screen's insulating layer (m)."""
    eps_i: Permittivity = 3.9
    """Relative permittivity of that layer."""

    def h_0(self, d_sc: float) -> float:
        """Return the effective insulator thickness (m) under stratum corneum of thickness ``d_sc`` (m)."""
        return insulator_thickness(d_sc, self.eps_sc, self.d_i, self.eps_i)


class Roughness(_Part):
    """Roughness of a ridge (Table 3), see :class:`variational.roughness.bam.BearingArea`."""

    h_rms: Positive = 3.1e-6
    """Root mean square height (m)."""
    wavelength: Positive = 100e-6
    """Largest wavelength lambda_0 (m)."""
    young: Positive = 1e6
    """Elastic modulus of the stratum corneum on the microscale (Pa)."""
    gamma: Positive = 0.5
    beta: Positive = 1.0
    """Prefactor of the repulsion: 1 in Eq. 9; Eq. 15 takes 3/4. *Assumption*: Eq. 9 is meant."""
    p_floor: Positive = 1e3
    """Pressure (Pa) below which the air gap is held (*assumption*)."""

    def bearing_area(self, h_0: float) -> BearingArea:
        """Return the closure for an effective insulator thickness ``h_0`` (m)."""
        return BearingArea(h_0, **self.model_dump())

    @model_validator(mode="after")
    def _consistent(self) -> "Roughness":
        full = self.bearing_area(1.0).full_pressure
        if self.p_floor >= full:
            raise ValueError(
                f"p_floor is {show(self.p_floor)}; it must be below the pressure at zero separation, {full:.4g} Pa"
            )
        return self


class Contact(_Part):
    """How contact and friction are discretised, and what is called contact.

    A formulation reads the keys of its own; to give it another's is refused.
    """

    formulation: Literal["penalty", "nitsche", "augmented"] = "penalty"
    """Springs of the screen, Nitsche's method, or an augmented Lagrangian; see :mod:`variational.contact`."""
    eps_n: Positive = 1.5e12
    """Normal stiffness of the penalty and the augmented Lagrangian (Pa/m of reference area). *Assumption*: penetration
    stays below a tenth of d_eq. The augmented Lagrangian's default is ten times as stiff, for fewer sweeps."""
    eps_t: Positive = 5e10
    """Tangential stiffness of the two (Pa/m of reference area) (*assumption*); the augmented Lagrangian's likewise."""
    tolerance: Positive = 5e-9
    """Penetration and elastic slip that the augmented Lagrangian leaves (m): a three-hundredth of the smallest d_eq."""
    gamma_0: Positive = 10.0
    """Nitsche's stiffness over the skin's constrained modulus per facet length."""
    theta: Literal[-1, 0, 1] = 0
    """Nitsche's variant; 1 and -1 compile for longer, and 1 needs a larger gamma_0."""
    length: Literal["pressure", "gap"] = "pressure"
    """What counts as ridge length L_R in Eq. 4: where there is contact pressure, or where the gap is below d_eq.
    *Assumption*: the former; the domain printed in Eq. 4 is the whole boundary."""

    @model_validator(mode="before")
    @classmethod
    def _complete(cls, data: Any) -> Any:
        stiff = isinstance(data, dict) and data.get("formulation") == "augmented"
        return {"eps_n": 1.5e13, "eps_t": 5e11} | data if stiff else data

    @model_validator(mode="after")
    def _own_keys(self) -> "Contact":
        for name in self.unread():
            if name in self.model_fields_set:
                raise ValueError(
                    f"{name} is {show(getattr(self, name))} and formulation is {show(self.formulation)}, "
                    "which does not read it"
                )
        return self

    def unread(self) -> set[str]:
        """Return the keys that the formulation does not read."""
        return set().union(*_FORMULATION_KEYS.values()) - _FORMULATION_KEYS[self.formulation]

    def law(self) -> Formulation:
        """Return the formulation with its parameters."""
        if self.formulation == "nitsche":
            return Nitsche(self.gamma_0, self.theta)
        if self.formulation == "augmented":
            return AugmentedLagrangian(self.eps_n, self.eps_t, self.tolerance)
        return Penalty(self.eps_n, self.eps_t)


_FORMULATION_KEYS = {
    "penalty": {"eps_n", "eps_t"},
    "nitsche": {"gamma_0", "theta"},
    "augmented": {"eps_n", "eps_t", "tolerance"},
}


class Numerics(_Part):
    """Discretisation and tolerances."""

    element: Literal["P1", "P2", "P2 reduced", "P2-P1"] = "P2"
    """Displacement, and pressure where there is one; see :mod:`variational.element`."""
    quadrature_points: Annotated[int, Field(strict=True, ge=2, le=8)] = 4
    """Gauss points on a surface facet."""
    tolerance: Tolerance = 1e-9
    """Residual of the equilibrium over f_ext at which Newton's method ends."""
    coupling_tolerance: Tolerance = 1e-6
    """Relative change of d_eq at which the loop over the scales ends."""
    coupling_cap: Annotated[int, Field(strict=True, ge=1)] = 30
    """Most sweeps of that loop."""

    @model_validator(mode="after")
    def _consistent(self) -> "Numerics":
        if self.element != "P1" and self.quadrature_points < 3:
            raise ValueError(
                f"quadrature_points is {self.quadrature_points}; it must be at least 3 for element {show(self.element)}"
            )
        return self


class Scene(_Part):
    """Everything a run needs; SI units, forces per out-of-plane length.

    Without ``history`` the bone is pressed with ``f_ext``, the voltage is switched on, and the bone slides until
    every ridge slips. With ``history`` the loads say it all and the three keys of the default one are refused.
    """

    f_ext: Positive = 75.0
    """External normal force on the bone (N/m)."""
    voltage: NonNegative = 200.0
    """Instantaneous voltage U (V). *Assumption*: Eq. 3's, not Table 3's peak to peak."""
    slide_length: Positive = 5e-3
    """Farthest the bone slides (m) on its way to full slip (*assumption*)."""
    history: Annotated[tuple[Load, ...], Field(min_length=1)] | None = None
    """Loads one after the other, in place of the default press, charge and slide."""
    friction: Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0, le=2)] = 0.25
    """Friction coefficient mu_0 of skin on the screen."""
    width: Positive = 20e-3
    """Out-of-plane width of the contact (m) that turns N/m into N, for reports only (*assumption*)."""
    geometry: Fingertip = Fingertip()
    mesh: MeshSize = MeshSize()
    materials: Materials = Materials()
    electric: Electric = Electric()
    roughness: Roughness = Roughness()
    contact: Contact = Contact()
    numerics: Numerics = Numerics()

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

    @property
    def h_0(self) -> float:
        """Effective insulator thickness (m)."""
        return self.electric.h_0(self.geometry.sc_thickness)

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
        return self.model_dump(mode="json", exclude=unused | {"contact": self.contact.unread()})


# The default mesh is wide enough for this force (N/m) and friction. Ridges in contact grow as the force to the 0.27 (15
# at 46 N/m, 17 at 73 N/m); friction rolls the finger onto its leading side (ridge 10 touches at 1 before full slip).
_FORCE, _WIDENS = 75.0, 0.27
_FRICTION, _ROLLS = 0.25, 0.3
_DEFAULT_HISTORY = ("f_ext", "voltage", "slide_length")


# -- files ---------------------------------------------------------------------------------------------
def load(path: Path | None = None, overrides: Mapping[str, Any] | None = None) -> Scene:
    """Read a scene.

    Args:
        path: TOML file; None for the default scene.
        overrides: values by dotted key (``{"mesh.contact": 5e-6}``), which win over the file's.

    Raises:
        SceneError: the file cannot be read, or the first key at fault.
    """
    data: dict[str, Any] = {}
    if path is not None:
        try:
            data = tomllib.loads(Path(path).read_text(encoding="utf-8"))
        except OSError as error:
            raise SceneError(f"scene file {path} cannot be read: {error.strerror or error}") from None
        except ValueError as error:  # of the encoding or of TOML
            raise SceneError(f"scene file {path} is not TOML: {error}") from None
    for key, value in (overrides or {}).items():
        _put(data, key.split("."), value)
    return from_data(data)


def from_data(data: Mapping[str, Any]) -> Scene:
    """Validate a scene given as nested tables.

    Raises:
        SceneError: the first key at fault.
    """
    try:
        # As JSON, because there a list is a tuple and a table is a model even under strict rules.
        return Scene.model_validate_json(json.dumps(_wide_enough(data), default=str), strict=True)
    except ValidationError as error:
        raise SceneError(first_error(error, Scene)) from None


def _wide_enough(data: Mapping[str, Any]) -> Mapping[str, Any]:
    """Mesh more ridges to touch under a larger force or friction, if the scene does not say how many."""
    mesh, history = data.get("mesh", {}), data.get("history")
    if not isinstance(mesh, dict) or "touching_half_arc" in mesh:
        return data
    loads = [data, *(history if isinstance(history, list | tuple) else ())]
    force = _largest(load.get("f_ext") for load in loads if isinstance(load, Mapping)) / _FORCE
    rolling = _largest([data.get("friction")]) / _FRICTION
    wider = max(force, 1.0) ** _WIDENS * max(rolling, 1.0) ** _ROLLS
    if wider == 1.0:
        return data
    return {**data, "mesh": {**mesh, "touching_half_arc": MeshSize().touching_half_arc * wider}}


def _largest(values: Iterable[Any]) -> float:
    """Return the largest finite number among values that may be anything; zero if there is none."""
    return max((float(v) for v in values if isinstance(v, float | int) and 0 < v < math.inf), default=0.0)


def check(scene: Scene) -> None:
    """Refuse a scene whose finger cannot be built or meshed.

    Raises:
        SceneError: layers touch or cross, ridges do not fit, the bone touches the skin, or elements are too large.
    """
    from geometry import fingertip  # gmsh: not for those who only read scenes

    try:
        fingertip.check(scene.geometry, scene.mesh)
    except GeometryError as error:
        message = re.sub(r"\bcontact size (\S+) m is", r"mesh.contact is \1 m,", str(error))
        raise SceneError(qualify(message, "geometry.", Fingertip.model_fields)) from None


def _put(data: dict[str, Any], keys: Sequence[str], value: Any) -> None:
    for depth, key in enumerate(keys[:-1], start=1):
        data = data.setdefault(key, {})
        if not isinstance(data, dict):
            raise SceneError(f"{'.'.join(keys[:depth])} is {show(data)}; it must be a table of keys")
    data[keys[-1]] = value
