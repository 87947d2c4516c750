"""Kinematics of finite strain in the plane."""

import ufl
from ufl.classes import Label

# What laws are differentiated by. A label's number is part of a kernel's name: with the next free one, as UFL gives
# them out from 0 on, the stresses of each body in a process would be compiled anew.
GRADIENT, STRETCH = Label(10**9), Label(10**9 + 1)


def deformation_gradient(H):
    """Return F = I + H, shape (2, 2), for a displacement gradient H."""
    return ufl.Identity(2) + H


def displacement_gradient(F):
    """Return H = F - I, shape (2, 2)."""
    return F - ufl.Identity(2)


def dilation(H):
    """Return J - 1 = tr H + det H of a displacement gradient, (2, 2), without the difference of J and 1."""
    return ufl.tr(H) + ufl.det(H)


def cofactor(F):
    """Return J F^-T, shape (2, 2), which carries reference to current area vectors (Nanson)."""
    return ufl.as_matrix([[F[1, 1], -F[1, 0]], [-F[0, 1], F[0, 0]]])


def current_height(mesh, u):
    """Return the height of a material point above the screen y = 0 (m)."""
    return ufl.SpatialCoordinate(mesh)[1] + u[1]
