r"""Cauchy stress of the solids in plane strain, the component normal to the plane included.

.. math:: \sigma = \frac1J P F^T, \quad P = \frac{\partial W}{\partial F}, \qquad
          \sigma_{zz} = \frac{\lambda_3}{J} \frac{\partial W}{\partial \lambda_3} \Big|_{\lambda_3 = 1}

The in-plane part is differentiated from the energy density, which knows only the plane's F; sigma_zz, the reaction
of the constraint lambda_3 = 1, is given in closed form.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import ufl

from variational import ogden, saint_venant


@dataclass(frozen=True)
class Law:
    """A solid in plane strain: functions of the deformation gradient F, (2, 2)."""

    energy: Callable[[Any], Any]
    """Strain energy density W (J/m^3 of reference volume)."""
    sigma_zz: Callable[[Any], Any]
    """Cauchy stress normal to the plane (Pa)."""


def ogden_law(shear_modulus, a, bulk) -> Law:
    """Return the law of an Ogden solid; arguments as in :func:`variational.ogden.energy`."""
    return Law(lambda F: ogden.energy(F, shear_modulus, a, bulk), lambda F: ogden_sigma_zz(F, shear_modulus, a, bulk))


def saint_venant_law(lame, shear_modulus) -> Law:
    """Return the law of a Saint Venant-Kirchhoff solid; arguments as in :func:`variational.saint_venant.energy`."""
    return Law(lambda F: saint_venant.energy(F, lame, shear_modulus), lambda F: saint_venant_sigma_zz(F, lame))


def ogden_sigma_zz(F, shear_modulus, a, bulk):
    r"""Return the out-of-plane Cauchy stress (Pa) of an Ogden solid.

    .. math:: \sigma_{zz} = \frac{2 G_0}{a J} \Big(\bar\lambda_3^a - \frac13 \sum_i \bar\lambda_i^a\Big) + K (J - 1),
              \qquad \bar\lambda_3 = J^{-1/3}

    Args:
        F: deformation gradient, (2, 2).
        shear_modulus: initial shear modulus G_0 (Pa).
        a: power of the stretches.
        bulk: bulk modulus K = 2/D (Pa).
    """
    J = ufl.det(F)
    y = ((F[0, 0] - F[1, 1]) ** 2 + (F[0, 1] + F[1, 0]) ** 2) / (4 * J)
    normal = ufl.exp(-a * ufl.ln(J) / 3)
    in_plane = 2 * ufl.exp(a * ufl.ln(J) / 6) * ogden.cosh_of_asinh(a, y)
    return 2 * shear_modulus / (3 * a * J) * (2 * normal - in_plane) + bulk * (J - 1)


def saint_venant_sigma_zz(F, lame):
    r"""Return the out-of-plane Cauchy stress (Pa), :math:`\lambda \operatorname{tr} E / J`, for Lamé's lambda (Pa)."""
    return lame / 2 * (ufl.inner(F, F) - 2) / ufl.det(F)


def first_piola_kirchhoff(law: Law, F):
    """Return the first Piola-Kirchhoff stress P = dW/dF (Pa), shape (2, 2)."""
    F = ufl.variable(F)
    return ufl.diff(law.energy(F), F)


def cauchy(law: Law, F):
    """Return the Cauchy stress (Pa), shape (3, 3), z normal to the plane."""
    sigma = first_piola_kirchhoff(law, F) * F.T / ufl.det(F)
    return ufl.as_tensor([[sigma[0, 0], sigma[0, 1], 0], [sigma[1, 0], sigma[1, 1], 0], [0, 0, law.sigma_zz(F)]])
