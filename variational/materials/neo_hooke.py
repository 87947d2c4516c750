r"""Neo-Hookean solid, compressible, its isochoric part apart.

.. math:: W = \frac{G}{2} (\bar I_1 - 3) + \frac{K}{2} (J - 1)^2, \qquad \bar I_1 = J^{-2/3} \operatorname{tr} F^T F,
          \qquad K = \frac{2 G (1 + \nu)}{3 (1 - 2 \nu)}

The energy of a network of Gaussian chains (Treloar 1943, doi 10.1039/TF9433900241) of the isochoric part of the
deformation, :math:`\bar F = J^{-1/3} F` (Flory 1961, doi 10.1039/TF9615700829). It is Ogden's solid with an exponent of
2 in the sign of Abaqus: stiffening under large stretch is left out.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

from variational.coefficients import parameter, ufl
from variational.materials.material import MODULUS, POISSON, Material, bulk_modulus


@dataclass(frozen=True)
class NeoHooke(Material):
    """Neo-Hookean solid."""

    natural: ClassVar[bool] = True

    shear_modulus: float = parameter(*MODULUS)
    """Initial shear modulus G (Pa)."""
    poisson: float = parameter(*POISSON, default=0.48)
    """Poisson's ratio of small strains."""

    coefficients = "shear_modulus", "bulk"

    @cached_property
    def bulk(self) -> float:
        """Bulk modulus K (Pa)."""
        return float(bulk_modulus(self.shear_modulus, self.poisson))

    def energy(self, F):
        """Return the isochoric strain energy density (J/m^3) of F, (3, 3)."""
        return self.shear_modulus / 2 * (ufl.det(F) ** (-2 / 3) * ufl.inner(F, F) - 3)
