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

At a frozen inner state a branch is elastic, so that it stores, and can give back at once,

.. math:: \psi_i = \frac{1}{2 \beta_i} Q_i : M : Q_i, \qquad M = (\partial S / \partial E)^{-1},

with Green's strain E (exact where S is linear in E; M is that of the present strain). Strain stays in both halves of a
step. What a branch loses there is what it dissipates,

.. math:: D_i = \psi_i(Q_i^n) - \psi_i(e^{-\Delta / 2 \tau_i} Q_i^n) + \psi_i(Q_i^*) - \psi_i(Q_i^{n+1}), \qquad
          Q_i^* = e^{-\Delta / 2 \tau_i} Q_i^n + \beta_i (S^{n+1} - S^n),

the first two terms by M of the step's beginning, the others by M of its end. It is never below zero where weights,
times and M are positive. Quasi-linear viscoelasticity does not guarantee M at large strain, so that
:mod:`variational.relaxation` computes D of each branch at each point. Strain normal to the plane is zero and does no
work, so that M is that of the plane.
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

    def step(self, scale: Any, held: Any, stored: Any) -> "StepLaw":
        """Return the law of a step; arguments as of :class:`StepLaw`."""
        return StepLaw(self, scale, held, stored)

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

    def __init__(self, law: Viscoelastic, scale: Any, held: Any, stored: Any) -> None:
        """Take what the step begins with; UFL.

        Args:
            law: with fields in the place of its numbers.
            scale: factor on the isochoric energy.
            held: stress H (Pa) that the past leaves, with the components 11, 22, 12 and 33.
            stored: energy (J/m^3) that all branches store in the accepted state.
        """
        self.elastic, self._scale, self._held, self._stored = law.elastic, scale, held, stored

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
        """Return the energy density (J/m^3) of the elastic law with what branches store."""
        return self.elastic.density(F, p) + self._stored

    def strained(self, H) -> Any:
        """Return S (Pa; 11, 22, 12, 33), Green's strain (11, 22, 12) and M (1/Pa; 11, 22, 33, 12, 13, 23), in a row.

        M leads from stresses 11, 22, 12 to strains 11, 22 and twice 12.
        """
        F = ufl.classes.Variable(kinematics.deformation_gradient(H), kinematics.GRADIENT)
        S = ufl.inv(F) * ufl.diff(self.elastic.distortion(kinematics.displacement_gradient(F)), F)
        normal = self.elastic.distortion_zz(F) * ufl.det(F)
        slope = ufl.diff(S, F)
        rows = []
        for E in ([[1, 0], [0, 0]], [[0, 0], [0, 1]], [[0, 0.5], [0.5, 0]]):
            dF = ufl.inv(F).T * ufl.as_matrix(E)  # of which dE = (F^T dF + dF^T F) / 2 is the E given
            dS = [[sum(slope[i, j, k, m] * dF[k, m] for k in (0, 1) for m in (0, 1)) for j in (0, 1)] for i in (0, 1)]
            rows.append([dS[0][0], dS[1][1], (dS[0][1] + dS[1][0]) / 2])
        M = ufl.inv(ufl.as_matrix(rows))
        stress = S[0, 0], S[1, 1], (S[0, 1] + S[1, 0]) / 2, normal
        strain = kinematics.green_strain(H)
        compliance = M[0, 0], M[1, 1], M[2, 2], M[0, 1], M[0, 2], M[1, 2]
        return ufl.as_vector([*stress, *(strain[k] for k in range(3)), *compliance])
