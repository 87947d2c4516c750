"""Kinematics of finite strain in the plane."""

import ufl


def deformation_gradient(u):
    """Return F = I + grad u, shape (2, 2)."""
    return ufl.Identity(2) + ufl.grad(u)


def cofactor(F):
    """Return J F^-T, shape (2, 2), which carries reference to current area vectors (Nanson)."""
    return ufl.as_matrix([[F[1, 1], -F[1, 0]], [-F[0, 1], F[0, 0]]])


def current_height(mesh, u):
    """Return the height of a material point above the screen y = 0 (m)."""
    return ufl.SpatialCoordinate(mesh)[1] + u[1]
