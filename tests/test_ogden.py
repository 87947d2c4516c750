"""Stress and tangent of the solids against closed forms in principal stretches, in 50 digits.

The bodies are in plane strain: lambda_3 = 1 in every state, and P_i = dW/dlambda_i of Eq. 1 for i = 1, 2.
"""

from decimal import Decimal, localcontext
from itertools import product

import numpy as np
import pytest
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI

from variational import compat, kinematics
from variational.materials import ogden, saint_venant

SKIN = (86.76e3, -14.53, 0.48)  # G_0 in Pa, alpha, nu of Table 2
FAT = (25e3, 5.0, 0.48)
LAWS = [(*solid, convention) for solid in (SKIN, FAT) for convention in ("printed", "abaqus")]
# The series leaves 3e-14 of the tangent at the switch; roundings, times a power of 15, come to as much again.
ROUNDOFF = 1e-13


def compiled(energy, parameters: int):
    """Return a function (F, parameters) -> (W, P (2, 2), dP/dF (2, 2, 2, 2)) from an energy density in UFL."""
    domain = mesh.create_unit_square(MPI.COMM_SELF, 1, 1)
    F = fem.Constant(domain, np.eye(2))
    values = [fem.Constant(domain, 1.0) for _ in range(parameters)]
    G = ufl.variable(F)
    W = energy(G, *values)
    P = ufl.diff(W, G)
    A = ufl.diff(P, G)
    entries = [W, *(P[i, j] for i, j in np.ndindex(2, 2)), *(A[i, j, k, m] for i, j, k, m in np.ndindex(2, 2, 2, 2))]
    expression = fem.Expression(ufl.as_vector(entries), np.array([[1 / 3, 1 / 3]]))

    def evaluate(gradient, given):
        F.value[:] = gradient
        for constant, value in zip(values, given, strict=True):
            constant.value = value
        result = compat.evaluate_on_cells(expression, domain, np.array([0], dtype=np.int32))[0]
        return result[0], result[1:5].reshape(2, 2), result[5:].reshape(2, 2, 2, 2)

    return evaluate


@pytest.fixture(scope="module")
def evaluate():
    """Energy, stress and tangent of the Ogden solid for (G_0, alpha, nu, convention)."""
    law = compiled(ogden.energy, 3)

    def parameters(shear, alpha, poisson, convention):
        return shear, ogden.exponent(alpha, convention), ogden.bulk_modulus(shear, poisson)

    return lambda F, solid: law(F, parameters(*solid))


@pytest.fixture(scope="module")
def evaluate_nail():
    """Energy, stress and tangent of the Saint Venant-Kirchhoff solid for (E, nu)."""
    law = compiled(lambda F, *lame: saint_venant.energy(kinematics.displacement_gradient(F), *lame), 2)
    return lambda F, solid: law(F, saint_venant.lame_constants(*solid))


def closed_form(stretches, solid):
    """Return (P_1, P_2) and the nonzero tangent moduli at F = diag(stretches), from Eqs. 1 and 2.

    With J = lambda_1 lambda_2 and S = lambda_1^a + lambda_2^a + 1,
    P_i = 2 G_0 / (a lambda_i) J^(-a/3) (lambda_i^a - S / 3) + 2/D (J - 1) J / lambda_i.
    The shear moduli follow from isotropy (Ogden, Non-linear Elastic Deformations, 1984, section 6.1.4).
    """
    shear, alpha, poisson, convention = solid
    with localcontext() as context:
        context.prec = 50
        one, two, three = Decimal(1), Decimal(2), Decimal(3)
        G, nu = Decimal(shear), Decimal(poisson)
        a = Decimal(alpha) * (-1 if convention == "printed" else 1)
        K = two / (three * (1 - 2 * nu) / (G * (1 + nu)))
        lam = [Decimal(float(value)) for value in stretches]
        J = lam[0] * lam[1]
        power = [(a * value.ln()).exp() for value in lam]
        S, V = power[0] + power[1] + one, (-a / three * J.ln()).exp()
        P = [2 * G / (a * lam[i]) * V * (power[i] - S / 3) + K * (J - 1) * J / lam[i] for i in (0, 1)]
        W = np.empty((2, 2), dtype=object)
        for i, j in np.ndindex(2, 2):
            same = one if i == j else Decimal(0)
            isochoric = -a / 3 * (power[i] - S / 3) + a * power[i] * same - a / 3 * power[j] - (power[i] - S / 3) * same
            volumetric = (2 * J - 1) * J - (J - 1) * J * same
            W[i, j] = (2 * G / a * V * isochoric + K * volumetric) / (lam[i] * lam[j])
        if lam[0] == lam[1]:
            straight = (W[0, 0] - W[0, 1] + P[0] / lam[0]) / 2
            crossed = (W[0, 0] - W[0, 1] - P[0] / lam[0]) / 2
        else:
            below = lam[0] ** 2 - lam[1] ** 2
            straight = (lam[0] * P[0] - lam[1] * P[1]) / below
            crossed = (lam[1] * P[0] - lam[0] * P[1]) / below
    tangent = np.zeros((2, 2, 2, 2))
    for i, j in np.ndindex(2, 2):
        tangent[i, i, j, j] = W[i, j]
    tangent[0, 1, 0, 1] = tangent[1, 0, 1, 0] = straight
    tangent[0, 1, 1, 0] = tangent[1, 0, 0, 1] = crossed
    return np.array(P, dtype=float), tangent


def rotation(angle: float):
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def hooke(lame: float, shear: float):
    """Return the moduli lame I x I + 2 shear sym."""
    delta = np.eye(2)
    both = np.einsum("ik,jl->ijkl", delta, delta) + np.einsum("il,jk->ijkl", delta, delta)
    return lame * np.einsum("ij,kl->ijkl", delta, delta) + shear * both


def assert_agrees(evaluate, stretches, solid):
    """Compare stress and tangent at F = diag(stretches), relative to the largest modulus and stress."""
    _, P, A = evaluate(np.diag(stretches), solid)
    expected, tangent = closed_form(stretches, solid)
    scale = np.abs(tangent).max()
    np.testing.assert_allclose(P, np.diag(expected), rtol=ROUNDOFF, atol=ROUNDOFF * scale)
    np.testing.assert_allclose(A, tangent, rtol=0, atol=ROUNDOFF * scale)


@pytest.mark.parametrize("solid", LAWS)
@pytest.mark.parametrize("stretch", [0.5, 0.8, 0.95, 1.0, 1.05, 1.3])
@pytest.mark.parametrize(
    "state", [lambda x: (x, 1.0), lambda x: (x, x), lambda x: (x, 1 / x)], ids=["uniaxial", "equibiaxial", "pure shear"]
)
def test_stress_and_tangent(evaluate, state, stretch, solid):
    """Tolerance: roundoff of the reference's digits, see the constant."""
    assert_agrees(evaluate, state(stretch), solid)


@pytest.mark.parametrize("solid", LAWS)
@pytest.mark.parametrize(("stretch", "apart"), list(product([0.8, 1.0, 1.2], [1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2])))
def test_nearly_equal_stretches(evaluate, stretch, apart, solid):
    """Where the principal stretches merge their derivatives are singular; stress and tangent are not."""
    assert_agrees(evaluate, (stretch, stretch * (1 + apart)), solid)


@pytest.mark.parametrize("solid", LAWS)
@pytest.mark.parametrize("side", [1 - 1e-9, 1 + 1e-9])
def test_series_meets_closed_form(evaluate, side, solid):
    """y = sinh^2 eta on either side of the switch, lambda = exp(+-eta)."""
    eta = np.arcsinh(np.sqrt(ogden.SERIES_BELOW * side))
    assert_agrees(evaluate, (np.exp(eta), np.exp(-eta)), solid)


@pytest.mark.parametrize("solid", LAWS)
def test_undeformed(evaluate, solid):
    """F = I is free of energy and stress, and its tangent is Hooke's: (K - 2/3 G) I x I + 2 G sym."""
    W, P, A = evaluate(np.eye(2), solid)
    shear, _, poisson, _ = solid
    bulk = ogden.bulk_modulus(shear, poisson)
    assert abs(W) < ROUNDOFF * bulk
    assert np.abs(P).max() < ROUNDOFF * bulk
    np.testing.assert_allclose(A, hooke(bulk - 2 / 3 * shear, shear), rtol=0, atol=ROUNDOFF * bulk)


@pytest.mark.parametrize("solid", LAWS)
def test_objectivity(evaluate, solid):
    """P(Q F) = Q P(F) and W(Q F) = W(F) for a rotation Q. Tolerance: roundoff of the rotated F times a power of 15."""
    F, Q = np.array([[1.1, 0.3], [-0.2, 0.8]]), rotation(0.7)
    W, P, A = evaluate(F, solid)
    rotated_W, rotated_P, _ = evaluate(Q @ F, solid)
    assert rotated_W == pytest.approx(W, rel=1e-12)
    np.testing.assert_allclose(rotated_P, Q @ P, rtol=0, atol=1e-13 * np.abs(A).max())


def test_inverted_element_is_not_finite(evaluate):
    """J < 0 has no energy: the residual must show it, for (J - 1)^2 alone would let it pass."""
    assert not np.isfinite(evaluate(np.diag([1.0, -0.1]), (*SKIN, "printed"))[0])


@pytest.mark.parametrize(("young", "poisson"), [(170e6, 0.3), (1e6, 0.3)])
@pytest.mark.parametrize("stretches", [(0.9, 1.0), (1.1, 1.1), (1.2, 1 / 1.2), (1.0, 1.0)])
def test_nail_stress(evaluate_nail, stretches, young, poisson):
    """P_i = lambda_i (lame tr E + 2 mu E_i) with E_i = (lambda_i^2 - 1) / 2. Tolerance: roundoff."""
    lame, mu = young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))
    lam = np.array(stretches)
    E = (lam**2 - 1) / 2
    _, P, _ = evaluate_nail(np.diag(lam), (young, poisson))
    np.testing.assert_allclose(P, np.diag(lam * (lame * E.sum() + 2 * mu * E)), rtol=1e-14, atol=1e-15 * young)
