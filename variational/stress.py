r"""Laws of the solids in plane strain, and their Cauchy stress, the component normal to the plane included.

.. math:: \sigma = \frac1J P F^T, \quad P = \frac{\partial W}{\partial F}, \qquad
          \sigma_{zz} = \frac{\lambda_3}{J} \frac{\partial W}{\partial \lambda_3} \Big|_{\lambda_3 = 1}

The in-plane part is differentiated from the energy density, which knows only the plane's F; sigma_zz, the reaction
of the constraint lambda_3 = 1, is given in closed form. Where the energy has a volumetric part K (J - 1)^2 / 2, that
part's stress is the pressure p I, positive in tension, p = K (J - 1): an element may know a better p than the one of
the F at hand (:mod:`variational.element`), and the part's energy is p^2 / (2 K).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import ufl

from variational import kinematics, ogden, saint_venant


@dataclass(frozen=True)
class Law:
    """A solid in plane strain, by its deformation gradient F or its displacement gradient H = F - I, (2, 2)."""

    distortion: Callable[[Any], Any]
    """Strain energy density W(H) (J/m^3 of reference volume) without its volumetric part, if it has one."""
    distortion_zz: Callable[[Any], Any]
    """Cauchy stress normal to the plane (Pa) without that part, a function of F."""
    bulk: Any = None
    """Bulk modulus K (Pa) of the volumetric part K (J - 1)^2 / 2; None without one."""

    def pressure(self, H):
        """Return p = K (J - 1) (Pa), positive in tension, of H; zero without a volumetric part."""
        return ufl.as_ufl(0.0) if self.bulk is None else self.bulk * kinematics.dilation(H)

    def energy(self, F, p=None):
        """Return the strain energy density W (J/m^3 of reference volume); by default p is that of F."""
        H = kinematics.displacement_gradient(F)
        if self.bulk is None:
            return self.distortion(H)
        return self.distortion(H) + (self.pressure(H) if p is None else p) ** 2 / (2 * self.bulk)


def ogden_law(shear_modulus, a, bulk) -> Law:
    """Return the law of an Ogden solid; arguments as in :func:`variational.ogden.energy`."""
    return Law(
        lambda H: ogden.isochoric_energy(kinematics.deformation_gradient(H), shear_modulus, a),
        lambda F: isochoric_sigma_zz(F, shear_modulus, a),
        bulk,
    )


def saint_venant_law(lame, shear_modulus) -> Law:
    """Return the law of a Saint Venant-Kirchhoff solid; arguments as in :func:`variational.saint_venant.energy`."""
    return Law(lambda H: saint_venant.energy(H, lame, shear_modulus), lambda F: saint_venant_sigma_zz(F, lame))


def isochoric_sigma_zz(F, shear_modulus, a):
    r"""Return the out-of-plane Cauchy stress (Pa) of an Ogden solid's isochoric part.

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
    in_plane = 2 * ufl.exp(a * ufl.ln(J) / 6) * ogden.cosh_of_asinh(a, y)
    return 2 * shear_modulus / (3 * a * J) * (2 * normal - in_plane)


def saint_venant_sigma_zz(F, lame):
    r"""Return the out-of-plane Cauchy stress (Pa), :math:`\lambda \operatorname{tr} E / J`, for Lamé's lambda (Pa)."""
    return lame / 2 * (ufl.inner(F, F) - 2) / ufl.det(F)


def first_piola_kirchhoff(law: Law, F, p=None):
    """Return the first Piola-Kirchhoff stress P = dW/dF (Pa), shape (2, 2); by default the pressure p is that of F."""
    F = ufl.variable(F)
    H = kinematics.displacement_gradient(F)
    p = law.pressure(H) if p is None else p
    return ufl.diff(law.distortion(H), F) + p * kinematics.cofactor(F)


def cauchy(law: Law, F, p=None):
    """Return the Cauchy stress (Pa), shape (3, 3), z normal to the plane; by default the pressure p is that of F."""
    p = law.pressure(kinematics.displacement_gradient(F)) if p is None else p
    sigma = first_piola_kirchhoff(law, F, p) * F.T / ufl.det(F)
    return ufl.as_tensor(
        [[sigma[0, 0], sigma[0, 1], 0], [sigma[1, 0], sigma[1, 1], 0], [0, 0, law.distortion_zz(F) + p]]
    )
