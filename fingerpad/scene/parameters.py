"""The tables of a scene: loads, accuracy, contact, output and numerics, with units and the ranges that make sense.

:mod:`fingerpad.scene.materials` has the others. The docstring of each parameter has the reason of its range.
"""

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import AfterValidator, Field, model_validator

from fingerpad.scene.load_names import load_name
from fingerpad.scene.messages import show
from fingerpad.scene.table import Finite, Part, Switch
from geometry.bounds import within

if TYPE_CHECKING:
    from variational.contact.formulation import Formulation

Rest = Annotated[Finite, within(1e-12, 1e-3)]
Asked = Annotated[Finite, within(1e-6, 0.5)]
Voltage = Annotated[Finite, within(1e-3, 5e3, "V", zero=True)]
Way = Annotated[Finite, within(1e-9, 0.1, "m", zero=True, sides=2)]


class Load(Part):
    """A load to reach from the present one; what is left out stays as it is."""

    name: Annotated[str, AfterValidator(load_name)]
    """Also of the load's pictures; see :mod:`fingerpad.scene.load_names`."""
    f_ext: Annotated[Finite, within(1e-3, 5e3, "N/m", zero=True)] | None = None
    """External normal force on the bone (N/m); zero only under voltage, which then holds the skin on the screen. The
    range is the default scene's."""
    bone_height: Way | None = None
    """Change of the bone's height from the unloaded position (m), negative when pressed; 1 nm is less than an atom of
    skin feels, 0.1 m is more than any finger."""
    voltage: Voltage | None = None
    """Instantaneous voltage U (V), in the range of the default scene's."""
    bone_x: Way | None = None
    """Horizontal position of the bone (m), zero when unloaded; in the range of the height."""
    until_full_slip: Switch = False
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

    See :mod:`fingerpad.richardson` and :mod:`fingerpad.accuracy.refinement`. Friction is that of full slip, lengths and
    energy densities are those of normal contact and of full slip.
    """

    mu_app: Asked | None = None
    """This and the others are from 1e-6, to which no mesh comes that a machine can hold, to 0.5, which says nothing."""
    f_t: Asked | None = None
    contact_length: Asked | None = None
    sed: Asked | None = None
    """At the Merkel sites of the ridges that can touch, over the largest of them."""

    @model_validator(mode="after")
    def _asks(self) -> "Accuracy":
        if not self.tolerances():
            raise ValueError(f"accuracy is empty; give at least one of {', '.join(type(self).model_fields)}")
        return self

    def tolerances(self) -> dict[str, float]:
        """Return what is asked for, by quantity."""
        return {name: value for name in type(self).model_fields if (value := getattr(self, name)) is not None}


class Contact(Part):
    """How contact and friction are discretised, and what is called contact.

    A formulation reads the keys of its own; to give it another's is refused.
    """

    formulation: Literal["penalty", "nitsche", "augmented"] = "penalty"
    """Springs of the screen, Nitsche's method, or an augmented Lagrangian; see
    :mod:`variational.contact.formulation`."""
    eps_n: Annotated[Finite, within(1e7, 1e17, "Pa/m")] = 1.5e12
    """Normal stiffness of the penalty and the augmented Lagrangian (Pa/m of reference area). *Assumption*: penetration
    stays below a tenth of d_eq. The augmented Lagrangian's default is ten times as stiff, to take fewer iterations.
    With 1e7 the finger sinks in by millimetres; with 1e17 roundoff of a length of 1 mm makes 20 kPa."""
    eps_t: Annotated[Finite, within(1e6, 1e17, "Pa/m")] = 5e10
    """Tangential stiffness of the two (Pa/m of reference area) (*assumption*); the augmented Lagrangian's likewise."""
    tolerance: Annotated[Finite, within(1e-12, 1e-6, "m")] = 5e-9
    """Penetration and elastic slip that the augmented Lagrangian leaves (m): a three-hundredth of the smallest d_eq.
    Below 1e-12 it is roundoff, above 1 µm the air gap itself."""
    gamma_0: Annotated[Finite, within(1e-3, 1e6)] = 1.0
    """Nitsche's stiffness over the skin's constrained modulus per facet length; with 10 the default finger finds no
    equilibrium while it is pressed (``docs/chart.md``). Of order 1 by its meaning, with powers of ten to try."""
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
        return set(FORMULATION_KEYS) - _FORMULATION_KEYS[self.formulation]

    def law(self) -> "Formulation":
        """Return the formulation with its parameters."""
        from variational.contact.augmented import AugmentedLagrangian  # UFL: not for those who only read scenes
        from variational.contact.nitsche import Nitsche
        from variational.contact.penalty import Penalty

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
FORMULATION_KEYS = frozenset().union(*_FORMULATION_KEYS.values())
"""Keys of :class:`Contact` that some formulations read and others do not."""


class Output(Part):
    """What a run is asked for; what is not wanted is not computed."""

    receptors: Switch = True
    """Strain energy density at the Merkel and Meissner sites, with elements of ``mesh.receptor`` at them."""
    errors: Switch = True
    """Discretisation errors of the results; see :mod:`fingerpad.accuracy.refinement`. Where an accuracy is asked for
    they are estimated in any case."""


class Numerics(Part):
    """Discretisation and tolerances."""

    element: Literal["P1", "P2", "P2 reduced", "P2-P1", "P3"] = "P2"
    """Displacement, and pressure where there is one; see :mod:`variational.element`."""
    quadrature_points: Annotated[int, Field(strict=True, ge=2, le=8)] = 4
    """Gauss points on a surface facet."""
    tolerance: Rest = 1e-9
    """Residual of the equilibrium over f_ext at which Newton's method ends: from 1e-12, near roundoff, to 1e-3, with
    which no force is off by more than some thousandths."""
    coupling_tolerance: Rest = 1e-6
    """Relative change of d_eq at which the loop over the scales ends, in the same range. What is left of the loop is
    its gain g times as much over 1 - g, and the attraction is off by up to twice that: by less than 1e-2 with 1e-3
    up to a gain of 0.8."""
    coupling_cap: Annotated[int, Field(strict=True, ge=1, le=1000)] = 30
    """Most iterations of that loop; one that needs a thousand does not converge."""
    step_scale: Annotated[Finite, within(1e-3, 10.0)] = 1.0
    """Factor on the largest steps of force, voltage and displacement: a thousandth makes thousands of steps of each
    load, and of ten times the largest steps few are accepted."""
    memory: Annotated[Finite, within(1e8, 1e15, "B")] = 16e9
    """Most memory (bytes) that a run may need on all ranks together, by the estimate of :mod:`fingerpad.model.memory`.
    A scene beyond it is refused before meshing; the default leaves a machine of 24 GB some room. From 0.1 GB, which the
    program itself takes, to 1000 TB."""

    @model_validator(mode="after")
    def _consistent(self) -> "Numerics":
        if self.element != "P1" and self.quadrature_points < 3:
            raise ValueError(
                f"quadrature_points is {self.quadrature_points}; it must be at least 3 for element {show(self.element)}"
            )
        return self
