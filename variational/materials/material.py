r"""What a solid is in plane strain: a strain energy density, from which stresses and tangents are derived.

.. math:: W(F) = W_{iso}(F) + \frac{K}{2} (J - 1)^2, \qquad P = \frac{\partial W}{\partial F}, \qquad
          \sigma_{zz} = \frac{\lambda_3}{J} \frac{\partial W}{\partial \lambda_3} \Big|_{\lambda_3 = 1}

The volumetric part is apart because an element may have a better pressure :math:`p = K (J - 1)` than that of the F at
hand (:mod:`variational.element`); its energy is :math:`p^2 / 2K`. A solid without K has no such part: all of its
energy is in :math:`W_{iso}`.

Your own solid is one frozen dataclass, here that of :mod:`variational.materials.neo_hooke`::

    @dataclass(frozen=True)
    class Mine(Material):
        shear_modulus: float  # Pa
        bulk: float  # Pa

        def energy(self, F):  # (3, 3)
            return self.shear_modulus / 2 * (ufl.det(F) ** (-2 / 3) * ufl.inner(F, F) - 3)

Its numbers become fields of the compiled form with one value a layer: layers of one law share a kernel, and other
numbers do not compile it again.
"""

from dataclasses import fields, is_dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from variational.coefficients import Law, kinematics, said, ufl

_NATURAL = 1e-8  # of the shear modulus: stress of the unloaded solid that is roundoff
MODULUS = 1.0, 1e12, "Pa"
"""Range of a modulus: slime to diamond."""
POISSON = -0.9, 0.4999
"""Range of Poisson's ratio: stability needs more than -1; above 0.4999 roundoff of the volume decides."""
_MODULUS_TOLERANCE = 1e-6  # relative: a shear modulus that was written with seven digits is the energy's


class Material(Law):
    """A solid in plane strain.

    A derived class has ``shear_modulus``, the initial one (Pa), and gives :meth:`energy`. Without a number ``bulk``,
    the bulk modulus K (Pa) of the volumetric part, it has none and gives :attr:`constrained_modulus`.
    """

    natural: ClassVar[bool] = False
    """Whether the energy of this very class, whatever its numbers, leaves no stress in the unloaded solid and has the
    initial shear modulus, as a test shows; else both are computed for each law, in 0.2 s."""

    if TYPE_CHECKING:  # in the class they would be the defaults of fields of these names

        @property
        def shear_modulus(self) -> Any:
            """Initial shear modulus G (Pa)."""

        @property
        def bulk(self) -> Any:
            """Bulk modulus K (Pa) of the volumetric part, None without one; see :attr:`volumetric`."""

    def energy(self, F):
        """Return the strain energy density (J/m^3 of reference volume) without the volumetric part; UFL.

        Args:
            F: deformation gradient, (3, 3); in plane strain its third stretch is one.
        """
        raise NotImplementedError

    @property
    def volumetric(self) -> Any:
        """Bulk modulus K (Pa) of the volumetric part; None without one."""
        named = "bulk" in self.__dataclass_fields__ or hasattr(type(self), "bulk")  # type: ignore[attr-defined]
        return self.bulk if named else None

    @property
    def times(self) -> tuple[float, ...]:
        """Times (s) in which the stress relaxes; none of an elastic solid."""
        return ()

    @property
    def at_rest(self) -> "Material":
        """The law without what time adds to it."""
        return self

    @property
    def constrained_modulus(self) -> float:
        """Stress over strain where the strain is confined to one direction, K + 4 G / 3 (Pa), unloaded."""
        if self.volumetric is None:
            raise ValueError(f"{self} has no bulk modulus; it must have a constrained_modulus of its own")
        return float(self.volumetric + 4 * self.shear_modulus / 3)

    @property
    def plane_modulus(self) -> float:
        r"""Plane strain modulus :math:`E / (1 - \nu^2) = 4 G (M - G) / M` (Pa), M the constrained modulus, unloaded."""
        M, G = self.constrained_modulus, self.shear_modulus
        return float(4 * G * (M - G) / M)

    # -- in the plane ----------------------------------------------------------------------------------
    def distortion(self, H):
        """Return :meth:`energy` of a displacement gradient H = F - I in the plane, (2, 2)."""
        return self.energy(_in_space(kinematics.deformation_gradient(H), 1.0))

    def distortion_zz(self, F):
        """Return the Cauchy stress normal to the plane (Pa) without the volumetric part, of F, (2, 2)."""
        stretch = ufl.classes.Variable(ufl.as_ufl(1.0), kinematics.STRETCH)
        return ufl.diff(self.energy(_in_space(F, stretch)), stretch) / ufl.det(F)

    def pressure(self, H):
        """Return p = K (J - 1) (Pa), positive in tension, of H; zero without a volumetric part."""
        bulk = self.volumetric
        return ufl.as_ufl(0.0) if bulk is None else bulk * kinematics.dilation(H)

    def density(self, F, p=None):
        """Return the whole strain energy density W (J/m^3) of F, (2, 2); by default p is that of F."""
        H, bulk = kinematics.displacement_gradient(F), self.volumetric
        if bulk is None:
            return self.distortion(H)
        return self.distortion(H) + (self.pressure(H) if p is None else p) ** 2 / (2 * bulk)

    def keeps_symmetry(self) -> bool:
        """Return whether a body of it, its own mirror image at x = 0, may stay so: fibres at an angle would not let it.

        The energy of a sheared state is compared with that of its mirror image, to roundoff.
        """
        sheared = [[1.1, 0.2], [0.05, 0.95]], [[1.1, -0.2], [-0.05, 0.95]]
        one, other = (_value(self.density(ufl.as_matrix(F) + 0 * ufl.Identity(2))) for F in sheared)
        return bool(np.isclose(one, other, rtol=1e-9, atol=0.0))

    # -- refusals --------------------------------------------------------------------------------------
    def check(self) -> None:
        """Refuse what is no solid.

        Raises:
            ValueError: no energy, or one that is no number, leaves stress in the unloaded solid or has another initial
                shear modulus; numbers that are not finite; moduli that are not positive. In one sentence.
        """
        self.refuse_numbers()
        kind = type(self)
        names = ("energy", "distortion", "distortion_zz")
        own = {name for name in names if getattr(kind, name) != getattr(Material, name)}
        if "energy" not in own and not own >= {"distortion", "distortion_zz"}:
            raise ValueError(
                f"{kind.__name__} has no energy; it must have a method energy(F), or distortion(H) and distortion_zz(F)"
            )
        if not ("shear_modulus" in self.__dataclass_fields__ or hasattr(kind, "shear_modulus")):  # type: ignore[attr-defined]
            raise ValueError(f"{kind.__name__} has no shear_modulus; it must have the initial one, in Pa")
        try:
            moduli = {"shear_modulus": self.shear_modulus, "bulk": self.volumetric}
            if moduli["bulk"] is None:
                moduli["constrained_modulus"] = self.constrained_modulus
        except ZeroDivisionError:
            bound = "poisson must be above -1 and below 0.5" if hasattr(self, "poisson") else "they must be finite"
            raise ValueError(f"{self} has moduli that are divided by zero; {bound}") from None
        for name, value in moduli.items():
            if not (name == "bulk" and value is None) and not (np.isfinite(value) and value > 0):
                raise ValueError(f"{self}: {name} is {value:g} Pa; it must be finite and greater than 0")
        self._refuse_energy()

    def _refuse_energy(self) -> None:
        if vars(type(self)).get("natural"):
            return
        try:
            stress, shear = (_unloaded if _hashable(self) else _unloaded.__wrapped__)(self)
        except Exception as error:  # whatever the user's energy raises
            raise ValueError(
                f"the energy of {self}, to be written with arithmetic and ufl's functions, cannot be evaluated "
                f"unloaded: {said(error)}"
            ) from error
        left, given = max(map(abs, stress)), float(self.shear_modulus)
        if not left <= _NATURAL * given:
            raise ValueError(
                f"{self} has a stress of {left:.3g} Pa unloaded; it must have none, which an energy of "
                "the stretches of F / J^(1/3) has not"
            )
        least, largest = shear
        if not (1 - _MODULUS_TOLERANCE) * least <= given <= (1 + _MODULUS_TOLERANCE) * largest:
            found = f"{least:.7g}" + (f" to {largest:.7g}" if largest - least > _MODULUS_TOLERANCE * largest else "")
            raise ValueError(
                f"{self}: shear_modulus is {given:.7g} Pa; it must be that of the unloaded energy, {found} Pa"
            )


@lru_cache(maxsize=64)  # UFL takes 0.1 s a law, and every mesh of a run has its laws checked
def _unloaded(solid: Material) -> tuple[list[float], list[float]]:
    """Return stresses (Pa), and least and largest shear modulus in the plane (Pa), of the unloaded solid.

    All are without the volumetric part. The shear modulus depends on the direction where the solid has fibres.
    """
    F = ufl.variable(ufl.Identity(2) + 0 * ufl.Identity(2))
    P = ufl.diff(solid.distortion(kinematics.displacement_gradient(F)), F)
    stress = [P[0, 0], P[0, 1], P[1, 0], P[1, 1], solid.distortion_zz(F)]
    t = ufl.variable(ufl.as_ufl(0.0))
    along, across = ufl.as_matrix([[0, t / 2], [t / 2, 0]]), ufl.as_matrix([[t / 2, 0], [0, -t / 2]])  # at 45 degrees
    energies = [solid.distortion(H) for H in (along, across, along + across)]
    one, other, both = (_value(ufl.diff(ufl.diff(W, t), t)) for W in energies)
    mixed = (both - one - other) / 2
    return [_value(s) for s in stress], [float(G) for G in np.linalg.eigvalsh([[one, mixed], [mixed, other]])]


def _value(expression) -> float:
    """Return the number that an expression without coefficients is."""
    from ufl.algorithms.apply_algebra_lowering import apply_algebra_lowering
    from ufl.algorithms.apply_derivatives import apply_derivatives

    return float(apply_derivatives(apply_algebra_lowering(expression)))


def _hashable(solid: Material) -> bool:
    """Return whether a law can be recognised: one of a user may carry an array, or fields that equality leaves out."""
    try:
        hash(solid)
    except TypeError:
        return False
    return is_dataclass(solid) and all(field.compare for field in fields(solid))


def _in_space(F, stretch):
    """Return the deformation gradient (3, 3) of one in the plane, (2, 2), and the stretch normal to it."""
    return ufl.as_matrix([[F[0, 0], F[0, 1], 0], [F[1, 0], F[1, 1], 0], [0, 0, stretch]])


def bulk_modulus(shear_modulus, poisson):
    """Return K = 2/D (Pa) of Eq. 2 for an initial shear modulus (Pa) and Poisson's ratio."""
    return 2 * shear_modulus * (1 + poisson) / (3 * (1 - 2 * poisson))
