r"""First-order Ogden solid in plane strain (Forsbach et al. 2023, Eqs. 1 and 2).

.. math:: W = \frac{2 G_0}{a^2} (\bar\lambda_1^a + \bar\lambda_2^a + \bar\lambda_3^a - 3) + \frac1D (J - 1)^2,
          \qquad D = \frac{3 (1 - 2\nu)}{G_0 (1 + \nu)}

with :math:`\bar\lambda_i = J^{-1/3} \lambda_i` and :math:`\lambda_3 = 1`. The paper prints the exponent
:math:`a = -\alpha`; Abaqus's own Ogden form has :math:`a = +\alpha`.

The in-plane stretches are the roots of a quadratic whose derivatives are singular where they coincide, at
F = I for one. With :math:`\lambda_{1,2} = \sqrt J e^{\pm\eta}` and

.. math:: y = \sinh^2\eta = \frac{(F_{11} - F_{22})^2 + (F_{12} + F_{21})^2}{4J}

the sum of powers is :math:`\lambda_1^a + \lambda_2^a = 2 J^{a/2} \cosh(a \eta)`, and
:math:`\cosh(a\,\mathrm{asinh}\sqrt y)` is an entire function's restriction, analytic in y at 0: its Taylor
series is used below ``SERIES_BELOW`` and the closed form above.
"""

from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

from variational.coefficients import OF_SCENE, kinematics, parameter, ufl
from variational.materials.material import MODULUS, POISSON, Material, bulk_modulus

SERIES_BELOW = 0.01
SERIES_TERMS = 9  # leaves 3e-14 in the tangent at a = 14.53, y = 0.01; seven would leave 2e-8


def exponent(alpha, convention: str):
    """Return a, the power of the stretches, for the parameter alpha.

    Args:
        alpha: the table's exponent.
        convention: ``"printed"`` for the paper's -alpha, ``"abaqus"`` for +alpha.
    """
    return {"printed": -1, "abaqus": 1}[convention] * alpha


def cosh_of_asinh(a, y):
    """Return cosh(a asinh(sqrt(y))) for y >= 0, smooth at y = 0."""
    term, series = 1.0, 1.0
    for k in range(SERIES_TERMS - 1):
        term = term * (a**2 - 4 * k**2) / ((2 * k + 1) * (2 * k + 2)) * y
        series = series + term
    near = ufl.lt(y, SERIES_BELOW)
    guarded = ufl.conditional(near, 1.0, y)
    eta = ufl.ln(ufl.sqrt(guarded) + ufl.sqrt(1 + guarded))
    return ufl.conditional(near, series, (ufl.exp(a * eta) + ufl.exp(-a * eta)) / 2)


def isochoric_energy(F, shear_modulus, a):
    """Return the part of the strain energy density W (J/m^3) that a change of volume alone leaves as it is.

    Args:
        F: deformation gradient, (2, 2).
        shear_modulus: initial shear modulus G_0 (Pa).
        a: power of the stretches, see :func:`exponent`.
    """
    J = ufl.det(F)
    y = ((F[0, 0] - F[1, 1]) ** 2 + (F[0, 1] + F[1, 0]) ** 2) / (4 * J)
    log_J = ufl.ln(J)
    powers = 2 * ufl.exp(a * log_J / 6) * cosh_of_asinh(a, y) + ufl.exp(-a * log_J / 3)
    return 2 * shear_modulus / a**2 * (powers - 3)


def energy(F, shear_modulus, a, bulk):
    """Return the strain energy density W (J/m^3 of reference volume).

    Args:
        F: deformation gradient, (2, 2).
        shear_modulus: initial shear modulus G_0 (Pa).
        a: power of the stretches, see :func:`exponent`.
        bulk: bulk modulus 2/D (Pa).
    """
    return isochoric_energy(F, shear_modulus, a) + bulk / 2 * (ufl.det(F) - 1) ** 2


def isochoric_sigma_zz(F, shear_modulus, a):
    r"""Return the out-of-plane Cauchy stress (Pa) of the isochoric part.

    .. math:: \sigma_{zz} = \frac{2 G_0}{a J} \Big(\bar\lambda_3^a - \frac13 \sum_i \bar\lambda_i^a\Big),
              \qquad \bar\lambda_3 = J^{-1/3}

    Args:
        F: deformation gradient, (2, 2).
        shear_modulus: initial shear modulus G_0 (Pa).
        a: power of the stretches.
    """
    J = ufl.det(F)
    y = ((F[0, 0] - F[1, 1]) ** 2 + (F[0, 1] + F[1, 0]) ** 2) / (4 * J)
    normal = ufl.exp(-a * ufl.ln(J) / 3)
    in_plane = 2 * ufl.exp(a * ufl.ln(J) / 6) * cosh_of_asinh(a, y)
    return 2 * shear_modulus / (3 * a * J) * (2 * normal - in_plane)


@dataclass(frozen=True)
class Ogden(Material):
    """Ogden solid (Eqs. 1 and 2)."""

    natural: ClassVar[bool] = True

    shear_modulus: float = parameter(*MODULUS)
    """Initial shear modulus G_0 (Pa). Range: slime to diamond."""
    alpha: float = parameter(1e-2, 50.0, sides=2)
    """Exponent of the stretches, of either sign. Range: at 50 a stretch of 2 raises the stress by 1e15; zero, the
    logarithmic limit, is not supported."""
    poisson: float = parameter(*POISSON, default=0.48)
    """Poisson's ratio of small strains. Range: stability needs more than -1; above 0.4999 roundoff of the volume
    decides, and such stiff volumes need the element P2-P1."""
    convention: str = field(default="printed", metadata=OF_SCENE)
    """Sign of the exponent: ``"printed"`` or ``"abaqus"``, see :func:`exponent`."""

    coefficients = "shear_modulus", "bulk", "a"

    @cached_property
    def bulk(self) -> float:
        """Bulk modulus 2/D (Pa)."""
        return float(bulk_modulus(self.shear_modulus, self.poisson))

    @cached_property
    def a(self) -> float:
        """Power of the stretches."""
        return float(exponent(self.alpha, self.convention))

    @property
    def plane_modulus(self) -> float:
        """Plane strain modulus 2 G / (1 - nu) (Pa), unloaded."""
        return 2 * self.shear_modulus / (1 - self.poisson)

    def distortion(self, H):
        """Return :func:`isochoric_energy` of a displacement gradient."""
        return isochoric_energy(kinematics.deformation_gradient(H), self.shear_modulus, self.a)

    def distortion_zz(self, F):
        """Return :func:`isochoric_sigma_zz`."""
        return isochoric_sigma_zz(F, self.shear_modulus, self.a)
