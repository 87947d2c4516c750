r"""Kinematics of finite strain, whose dimension is that of what is given, and stresses of a solid in plane strain.

.. math:: \sigma = \frac1J P F^T, \qquad P = \frac{\partial W}{\partial F}

The in-plane part is differentiated from the energy density, which depends only on the plane's F; sigma_zz, the reaction
of the constraint lambda_3 = 1, is the solid's own (:mod:`variational.materials.material`). The stress of the volumetric
part is p I, p positive in tension: an element may have a better p than the one of the F at hand
(:mod:`variational.element`).
"""

import ufl
from ufl.classes import Label, Variable

from variational.materials.material import Material

# What laws are differentiated by. A label's number is part of a kernel's name: with the next free one, as UFL gives
# them out from 0 on, the stresses of each body in a process would be compiled anew.
GRADIENT, STRETCH = Label(10**9), Label(10**9 + 1)


def deformation_gradient(H):
    """Return F = I + H for a displacement gradient H, square of the dimension."""
    return ufl.Identity(H.ufl_shape[0]) + H


def displacement_gradient(F):
    """Return H = F - I."""
    return F - ufl.Identity(F.ufl_shape[0])


def dilation(H):
    """Return J - 1 = tr H + det H of a displacement gradient H without the difference of J and 1."""
    second = (ufl.tr(H) ** 2 - ufl.tr(H * H)) / 2 if H.ufl_shape[0] > 2 else 0
    return ufl.tr(H) + second + ufl.det(H)


def cofactor(F):
    """Return J F^-T, which carries reference to current area vectors (Nanson)."""
    if F.ufl_shape[0] > 2:
        return ufl.det(F) * ufl.inv(F).T
    return ufl.as_matrix([[F[1, 1], -F[1, 0]], [-F[0, 1], F[0, 0]]])


def green_strain(H):
    """Return Green's strain (C - I) / 2 in the plane, its components 11, 22 and 12, of a displacement gradient H."""
    E = (H + H.T + H.T * H) / 2
    return ufl.as_vector([E[0, 0], E[1, 1], E[0, 1]])


def work(stress, strain):
    """Return S : E (J/m^3) of a stress (Pa), components 11, 22, 12 and more, and a strain in the plane, 11, 22, 12."""
    return stress[0] * strain[0] + stress[1] * strain[1] + 2 * stress[2] * strain[2]


def current_height(mesh, u):
    """Return the height of a material point above the screen (m), its last coordinate."""
    return ufl.SpatialCoordinate(mesh)[len(u) - 1] + u[len(u) - 1]


def first_piola_kirchhoff(solid: Material, F, p=None):
    """Return the first Piola-Kirchhoff stress P = dW/dF (Pa), shape (2, 2); by default the pressure p is that of F."""
    F = Variable(F, GRADIENT)
    H = displacement_gradient(F)
    p = solid.pressure(H) if p is None else p
    return ufl.diff(solid.distortion(H), F) + p * cofactor(F)


def cauchy(solid: Material, F, p=None):
    """Return the Cauchy stress (Pa), shape (3, 3), z normal to the plane; by default the pressure p is that of F."""
    p = solid.pressure(displacement_gradient(F)) if p is None else p
    sigma = first_piola_kirchhoff(solid, F, p) * F.T / ufl.det(F)
    return ufl.as_tensor(
        [[sigma[0, 0], sigma[0, 1], 0], [sigma[1, 0], sigma[1, 1], 0], [0, 0, solid.distortion_zz(F) + p]]
    )
