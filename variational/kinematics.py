"""Kinematics of finite strain; the dimension is that of what is given."""

import ufl
from ufl.classes import Label

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


def current_height(mesh, u):
    """Return the height of a material point above the screen (m), its last coordinate."""
    return ufl.SpatialCoordinate(mesh)[len(u) - 1] + u[len(u) - 1]
