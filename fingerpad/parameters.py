"""The tables of a scene: loads, materials, insulators, roughness, contact and numerics, with units and bounds."""

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from fingerpad.sentences import show
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


class Part(BaseModel):
    """A table that refuses keys it does not have, and cannot be changed."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class Load(Part):
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
    """Stop as soon as every point in contact slips one way; with bone_x alone."""

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
        if self.until_full_slip:
            self._refuse_unfinished()
        return self

    def _refuse_unfinished(self) -> None:
        """Refuse what a load that stops at full slip may not have reached."""
        for name in ("f_ext", "bone_height", "voltage"):
            if getattr(self, name) is not None:
                raise ValueError(
                    f"{name} is {show(getattr(self, name))} and until_full_slip is true, which may stop before that is "
                    f"reached; {name} must come in a load of its own"
                )


class Accuracy(Part):
    """Discretisation errors that are asked for, relative.

    See :mod:`fingerpad.estimate` and :mod:`fingerpad.accuracy`. Friction is that of full slip, lengths and energy
    densities are those of normal contact and of full slip.
    """

    mu_app: Tolerance | None = None
    f_t: Tolerance | None = None
    contact_length: Tolerance | None = None
    sed: Tolerance | None = None
    """At the Merkel sites of the ridges that can touch, over the largest of them."""

    @model_validator(mode="after")
    def _asks(self) -> "Accuracy":
        if not self.tolerances():
            raise ValueError(f"accuracy is empty; give at least one of {', '.join(type(self).model_fields)}")
        return self

    def tolerances(self) -> dict[str, float]:
        """Return what is asked for, by quantity."""
        return {name: value for name in type(self).model_fields if (value := getattr(self, name)) is not None}


class Skin(Part):
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


class Stiff(Part):
    """Saint Venant-Kirchhoff solid: linear elastic at finite rotation (*assumption*; the paper: linear elastic)."""

    young: Positive
    """Young's modulus (Pa)."""
    poisson: Poisson = 0.3


class Materials(Part):
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


class Electric(Part):
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


class Roughness(Part):
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


class Contact(Part):
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
    gamma_0: Positive = 1.0
    """Nitsche's stiffness over the skin's constrained modulus per facet length; with 10 the default finger finds no
    equilibrium while it is pressed (``docs/chart.md``)."""
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


class Output(Part):
    """What a run is asked for; what is not wanted is not computed."""

    receptors: Annotated[bool, Field(strict=True)] = True
    """Strain energy density at the Merkel and Meissner sites, with elements of ``mesh.receptor`` at them."""
    errors: Annotated[bool, Field(strict=True)] = True
    """Discretisation errors of the results; see :mod:`fingerpad.accuracy`. Where an accuracy is asked for they are
    estimated in any case."""


class Numerics(Part):
    """Discretisation and tolerances."""

    element: Literal["P1", "P2", "P2 reduced", "P2-P1", "P3"] = "P2"
    """Displacement, and pressure where there is one; see :mod:`variational.element`."""
    quadrature_points: Annotated[int, Field(strict=True, ge=2, le=8)] = 4
    """Gauss points on a surface facet."""
    tolerance: Tolerance = 1e-9
    """Residual of the equilibrium over f_ext at which Newton's method ends."""
    coupling_tolerance: Tolerance = 1e-6
    """Relative change of d_eq at which the loop over the scales ends."""
    coupling_cap: Annotated[int, Field(strict=True, ge=1)] = 30
    """Most sweeps of that loop."""
    step_scale: Annotated[float, Field(strict=True, allow_inf_nan=False, gt=0, le=10)] = 1.0
    """Factor on the largest steps of force, voltage and displacement."""

    @model_validator(mode="after")
    def _consistent(self) -> "Numerics":
        if self.element != "P1" and self.quadrature_points < 3:
            raise ValueError(
                f"quadrature_points is {self.quadrature_points}; it must be at least 3 for element {show(self.element)}"
            )
        return self
