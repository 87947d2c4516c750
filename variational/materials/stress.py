r"""Stresses of a solid in plane strain, the component normal to the plane included.

.. math:: \sigma = \frac1J P F^T, \qquad P = \frac{\partial W}{\partial F}

The in-plane part is differentiated from the energy density, which depends only on the plane's F; sigma_zz, the reaction
of the constraint lambda_3 = 1, is the solid's own (:mod:`variational.materials.material`). The stress of the volumetric
part is p I, p positive in tension: an element may have a better p than the one of the F at hand
(:mod:`variational.element`).
"""

from typing import TYPE_CHECKING

import ufl
from ufl.classes import Variable

from variational import kinematics

if TYPE_CHECKING:
    from variational.materials.material import Material


def first_piola_kirchhoff(solid: "Material", F, p=None):
    """Return the first Piola-Kirchhoff stress P = dW/dF (Pa), shape (2, 2); by default the pressure p is that of F."""
    F = Variable(F, kinematics.GRADIENT)
    H = kinematics.displacement_gradient(F)
    p = solid.pressure(H) if p is None else p
    return ufl.diff(solid.distortion(H), F) + p * kinematics.cofactor(F)


def cauchy(solid: "Material", F, p=None):
    """Return the Cauchy stress (Pa), shape (3, 3), z normal to the plane; by default the pressure p is that of F."""
    p = solid.pressure(kinematics.displacement_gradient(F)) if p is None else p
    sigma = first_piola_kirchhoff(solid, F, p) * F.T / ufl.det(F)
    return ufl.as_tensor(
        [[sigma[0, 0], sigma[0, 1], 0], [sigma[1, 0], sigma[1, 1], 0], [0, 0, solid.distortion_zz(F) + p]]
    )
