r"""Saint Venant-Kirchhoff solid in plane strain: linear elastic at finite rotation.

.. math:: W = \frac{\lambda}{2} (\operatorname{tr} E)^2 + \mu E : E,
          \qquad E = \tfrac12 (F^T F - I) = \tfrac12 (H + H^T + H^T H)

For the nail and its bed, which turn but hardly strain. It softens in large compression, so it is not for skin. The
strain is written in the displacement gradient H = F - I: of a nail of 170 MPa whose strains are 1e-6 the difference
of F^T F and I would lose six digits, and nodal forces of 1e-11 N/m with them.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from variational.coefficients import parameter, ufl
from variational.materials.material import MODULUS, POISSON, Material


def energy(H, lame, shear_modulus):
    """Return the strain energy density W (J/m^3) for a displacement gradient H, (2, 2), and Lamé's constants (Pa)."""
    E = (H + H.T + H.T * H) / 2
    return lame / 2 * ufl.tr(E) ** 2 + shear_modulus * ufl.inner(E, E)


def lame_constants(young: float, poisson: float) -> tuple[float, float]:
    """Return (lambda, mu) in Pa for Young's modulus (Pa) and Poisson's ratio."""
    return young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))


def sigma_zz(F, lame):
    r"""Return the out-of-plane Cauchy stress (Pa), :math:`\lambda \operatorname{tr} E / J`, for Lamé's lambda (Pa)."""
    return lame / 2 * (ufl.inner(F, F) - 2) / ufl.det(F)


@dataclass(frozen=True)
class SaintVenant(Material):
    """Saint Venant-Kirchhoff solid: linear elastic at finite rotation (*assumption*; the paper: linear elastic)."""

    natural: ClassVar[bool] = True

    young: float = parameter(*MODULUS)
    """Young's modulus (Pa)."""
    poisson: float = parameter(*POISSON, default=0.3)
    """Poisson's ratio."""

    coefficients = "lame", "shear_modulus"

    @cached_property
    def lame(self) -> float:
        """Lamé's lambda (Pa)."""
        return lame_constants(self.young, self.poisson)[0]

    @cached_property
    def shear_modulus(self) -> float:
        """Lamé's mu (Pa)."""
        return lame_constants(self.young, self.poisson)[1]

    @property
    def constrained_modulus(self) -> float:
        """Stress over strain where the strain is confined to one direction, lambda + 2 mu (Pa), unloaded."""
        return self.lame + 2 * self.shear_modulus

    def distortion(self, H):
        """Return :func:`energy` of a displacement gradient."""
        return energy(H, self.lame, self.shear_modulus)

    def distortion_zz(self, F):
        """Return :func:`sigma_zz`."""
        return sigma_zz(F, self.lame)
