r"""Quasi-linear viscoelasticity of the isochoric stress, whose every step has an energy.

Branches i with the weight :math:`\beta_i` and the time :math:`\tau_i` follow the isochoric second Piola-Kirchhoff
stress :math:`S = 2\, \partial W_{iso} / \partial C` of a hyperelastic law,

.. math:: \dot Q_i + Q_i / \tau_i = \beta_i \dot S, \qquad S_{total} = S_{vol} + S + \sum_i Q_i

(Simo 1987, doi 10.1016/0045-7825(87)90107-1; Holzapfel 1996,
doi 10.1002/(SICI)1097-0207(19961130)39:22<3903::AID-NME34>3.0.CO;2-C). The elastic law is the *long-time* one, that of
a finger that is held; at once its isochoric part is :math:`1 + \sum \beta_i` times as stiff. Weights and times are
those of :mod:`variational.materials.qlv`.

Over a step :math:`\Delta` the convolution is taken with S changing at mid-step,

.. math:: Q_i^{n+1} = e^{-\Delta / \tau_i} Q_i^n + \beta_i e^{-\Delta / 2 \tau_i} (S^{n+1} - S^n),

of second order, and of any step where S stays. So the stress of a step is the derivative of

.. math:: W_\Delta = W_{vol} + \Big(1 + \sum_i \beta_i e^{-\Delta / 2 \tau_i}\Big) W_{iso} + \tfrac12 H^n : C, \qquad
          H^n = \sum_i \Big(e^{-\Delta / \tau_i} Q_i^n - \beta_i e^{-\Delta / 2 \tau_i} S^n\Big)

whose tangent is the scaled elastic one. A step that takes no time, :math:`\Delta = 0`, is elastic at the modulus at
once. In plane strain :math:`S_{33}` and :math:`Q_{33}` are carried along for the stress normal to the plane.

The branches begin without energy, so that each point's work :math:`\int \sum_i Q_i : \tfrac12 \dot C \,dt` is what they
store and dissipate, and in a material never below zero. Quasi-linear viscoelasticity does not guarantee that at large
strain; :mod:`variational.relaxation` keeps this work for each point.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, Self

from variational.coefficients import kinematics, ufl
from variational.materials.material import Material
from variational.materials.qlv import QLV


@dataclass(frozen=True)
class Viscoelastic(Material):
    """A hyperelastic solid whose isochoric stress relaxes; without time it is the elastic solid."""

    natural: ClassVar[bool] = True  # where the elastic law is, which is checked

    elastic: Material
    """Law of the body that was held for long."""
    viscosity: QLV
    """How the stress above that relaxes."""

    @property
    def shear_modulus(self) -> Any:
        """Initial shear modulus after a long time (Pa)."""
        return self.elastic.shear_modulus

    @property
    def times(self) -> tuple[float, ...]:
        """Time (s) of each branch."""
        return self.viscosity.times

    @property
    def at_rest(self) -> Material:
        """The elastic law."""
        return self.elastic

    @property
    def volumetric(self) -> Any:
        """Bulk modulus (Pa)."""
        return self.elastic.volumetric

    @property
    def constrained_modulus(self) -> float:
        """Of the elastic law (Pa)."""
        return self.elastic.constrained_modulus

    @property
    def plane_modulus(self) -> float:
        """Of the elastic law (Pa)."""
        return self.elastic.plane_modulus

    def energy(self, F):
        """Return that of the elastic law."""
        return self.elastic.energy(F)

    def distortion(self, H):
        """Return that of the elastic law."""
        return self.elastic.distortion(H)

    def distortion_zz(self, F):
        """Return that of the elastic law."""
        return self.elastic.distortion_zz(F)

    def check(self) -> None:
        """Refuse an elastic law that is no solid, or whose isochoric part is not apart.

        Raises:
            ValueError: in one sentence.
        """
        self.elastic.check()
        if self.volumetric is None:
            raise ValueError(
                f"viscosity acts on the isochoric stress, and {type(self.elastic).__name__} has no volumetric part of "
                "its own; it must be a law with a bulk modulus, such as Ogden or NeoHooke"
            )

    def step(self, lapse: Any, stress: Any, overstress: list[Any]) -> "StepLaw":
        """Return the law of a step; arguments as of :class:`StepLaw`."""
        return StepLaw(self, lapse, stress, overstress)

    @property
    def made_of(self) -> tuple[Material, dict[str, QLV]]:
        """The elastic law, and what a scene has beside that one's parameters."""
        return self.elastic, {"viscosity": self.viscosity}

    # -- its numbers as fields of a form ---------------------------------------------------------------
    @cached_property
    def branches(self) -> tuple[tuple[Any, Any], ...]:
        """Weight and time (s) of each branch."""
        return tuple(zip(self.viscosity.weights, self.viscosity.times, strict=True))

    def names(self) -> tuple[str, ...]:
        """Return the names of the elastic law's numbers and of each branch's weight and time."""
        numbers = range(1, len(self.viscosity.times) + 1)
        return (*self.elastic.names(), *(f"{name}_{k}" for k in numbers for name in ("weight", "time")))

    def number(self, name: str) -> Any:
        """Return a number by its name."""
        kind, _, place = name.rpartition("_")
        if name in self.elastic.names():
            return self.elastic.number(name)
        return self.branches[int(place) - 1][("weight", "time").index(kind)]

    def with_values(self, values: Any) -> Self:
        """Return a copy that carries ``values`` in the place of its numbers."""
        found = super().with_values({"elastic": self.elastic.with_values({n: values[n] for n in self.elastic.names()})})
        count = len(self.viscosity.times)
        found.__dict__["branches"] = tuple((values[f"weight_{k}"], values[f"time_{k}"]) for k in range(1, count + 1))
        return found

    def kind(self) -> tuple[Any, ...]:
        """Return what two of these must share to be written as one form."""
        return (type(self), self.elastic.kind(), len(self.viscosity.times))


class StepLaw(Material):
    """The hyperelastic law of one step, of the energy W above."""

    def __init__(self, law: Viscoelastic, lapse: Any, stress: Any, overstress: list[Any]) -> None:
        """Take what the step begins with; UFL, stresses with the components 11, 22, 12 and 33.

        Args:
            law: with fields in the place of its numbers.
            lapse: duration of the step (s).
            stress: accepted isochoric stress S of the elastic law (Pa).
            overstress: accepted Q of each branch (Pa).
        """
        self.elastic, self._before, self._past = law.elastic, stress, overstress
        self._left = [ufl.exp(-lapse / tau) for _, tau in law.branches]
        self._follows = [beta * ufl.exp(-lapse / (2 * tau)) for beta, tau in law.branches]
        self._scale = 1 + sum(self._follows)
        past = zip(self._left, self._follows, overstress, strict=True)
        self._held = sum(left * Q - follows * stress for left, follows, Q in past)

    @property
    def volumetric(self) -> Any:
        """Bulk modulus (Pa)."""
        return self.elastic.volumetric

    @property
    def at_rest(self) -> Material:
        """The elastic law."""
        return self.elastic

    def distortion(self, H):
        """Return the energy of the step (J/m^3) without the volumetric part, H : C by the strain (C - I) / 2."""
        return self._scale * self.elastic.distortion(H) + kinematics.work(self._held, kinematics.green_strain(H))

    def distortion_zz(self, F):
        """Return the Cauchy stress normal to the plane (Pa) without the volumetric part."""
        return self._scale * self.elastic.distortion_zz(F) + self._held[3] / ufl.det(F)

    def density(self, F, p=None):
        """Return the energy density (J/m^3) of the elastic law, without what branches store."""
        return self.elastic.density(F, p)

    def updated(self, H) -> tuple[Any, list[Any]]:
        """Return what the step leaves of the isochoric stress and of each branch's (Pa), UFL."""
        F = ufl.classes.Variable(kinematics.deformation_gradient(H), kinematics.GRADIENT)
        S = ufl.inv(F) * ufl.diff(self.elastic.distortion(kinematics.displacement_gradient(F)), F)
        normal = self.elastic.distortion_zz(F) * ufl.det(F)
        now = ufl.as_vector([S[0, 0], S[1, 1], (S[0, 1] + S[1, 0]) / 2, normal])
        past = zip(self._left, self._follows, self._past, strict=True)
        return now, [left * Q + follows * (now - self._before) for left, follows, Q in past]
