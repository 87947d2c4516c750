r"""What the laws must be whatever their numbers: objective, hyperelastic, and Hooke's at rest.

With W of F alone by C = F^T F, for every rotation Q

.. math:: W(QF) = W(F), \qquad P(QF) = Q P(F), \qquad \sigma(QF) = Q \sigma(F) Q^T,

dP/dF has the major symmetry, and at F = I it is :math:`\lambda I \otimes I + 2 \mu \mathbb{I}^{sym}` (Ogden,
Non-linear Elastic Deformations, 1984, chapters 4 and 6). The same is asked of the assembled forces and
tangents of a body of two layers of skin and one of nail.
"""

from functools import cache

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem import petsc as fem_petsc
from numpy.typing import NDArray

from benchmarks.verification.bodies import NOTHING, body, free_problem, nodal_forces
from benchmarks.verification.case import Case, Outcome, Row, worst
from benchmarks.verification.constitutive import LAYERS, in_package
from benchmarks.verification.points import Points
from benchmarks.verification.principal import moduli
from geometry import tags
from geometry.bodies import block
from variational.element import ELEMENTS
from variational.materials import saint_venant
from variational.materials.ogden import Ogden
from variational.materials.saint_venant import SaintVenant
from variational.problem import Problem
from variational.solvers.equations import Equations
from variational.solvers.newton import Solver

Array = NDArray[np.float64]
NAIL = (170e6, 0.3)
SOLIDS: dict[int, Ogden | SaintVenant] = {
    tags.STRATUM_CORNEUM: Ogden(86.76e3, -14.53, 0.48),
    tags.DERMIS: Ogden(2.55e3, -14.53, 0.48),
    tags.NAIL: SaintVenant(*NAIL),
}
SIZE = 1e-3  # m
_MESH = "4 × 4 × 2 triangles, SC, dermis and nail"
_ROUNDOFF = 1e-13


@cache
def nail() -> Points:
    """Return the package's Saint Venant-Kirchhoff law."""
    return Points(SaintVenant(1.0, 0.3))


def states(count: int) -> Array:
    """Return deformation gradients without any symmetry, J from 0.6 to 1.6, shape (count, 2, 2)."""
    generator = np.random.default_rng(1)
    F = np.eye(2) + generator.uniform(-0.5, 0.5, (20 * count, 2, 2))
    J = np.linalg.det(F)
    return np.asarray(F[(J > 0.6) & (J < 1.6)][:count])


def rotations(count: int) -> Array:
    """Return rotations all around, shape (count, 2, 2)."""
    angles = np.linspace(0.1, 2 * np.pi, count)
    c, s = np.cos(angles), np.sin(angles)
    return np.asarray(np.stack([np.stack([c, -s], -1), np.stack([s, c], -1)], -2))


def apart(
    quantity: str, ours: Array, reference: Array, scale: Array | float, tolerance: float, why: str, mesh: str = "–"
) -> Row:
    """Return a row of the largest difference over a scale: of each state, or one of all."""
    difference = np.abs(ours - reference).reshape(len(ours), -1).max(axis=1)
    return Row(quantity, float((difference / scale).max()), 0.0, tolerance, why, mesh, absolute=True)


def evaluations(F: Array) -> dict[str, tuple[Array, Array, Array, Array]]:
    """Return W, P, sigma and dP/dF of every law at deformation gradients."""
    found = {solid.name: in_package(solid, F) for solid in LAYERS}
    return found | {"nail": nail()(F, *saint_venant.lame_constants(*NAIL))}


@cache
def layered(element: str) -> Problem:
    """Return a block of three layers, of which the nail is the middle one."""
    layers = [tags.STRATUM_CORNEUM, tags.NAIL, tags.DERMIS]

    def layer(x: Array) -> Array:
        return np.select([x[:, 1] < 0.5 * SIZE, x[:, 1] < 0.75 * SIZE], layers[:2], layers[2])

    return free_problem(body(block(SIZE, SIZE, SIZE / 4), layer), SOLIDS, element)


def deform(problem: Problem) -> None:
    """Shear, stretch and bend the body by some 10 %, the pressure likewise."""

    def u(x):
        X, Y = x[0] / SIZE, x[1] / SIZE
        return 0.1 * SIZE * np.stack([np.sin(2 * X + Y) + 0.5 * Y**2, np.cos(3 * Y) * X - 0.4 * Y])

    problem.w.interpolate(u)
    if problem.pressure:
        problem.pressure.unknown.interpolate(lambda x: 1e-5 * np.cos(3e3 * x[0] + 2e3 * x[1]))


def turn(problem: Problem, Q: Array) -> None:
    """Rotate the deformed body about the origin."""
    X = problem.V.tabulate_dof_coordinates()[:, :2]
    u = problem.w.x.array.reshape(-1, 2)
    problem.w.x.array[:] = ((X + u) @ Q.T - X).ravel()


def objectivity(small: bool) -> Outcome:
    """Superposed rotations of points and of a body."""
    F = states(64)
    Q = rotations(len(F))
    before, after = evaluations(F), evaluations(Q @ F)
    full = np.zeros((len(F), 3, 3))
    full[:, :2, :2], full[:, 2, 2] = Q, 1.0
    why = "roundings of QF, times powers of 15, over the largest modulus"
    rows = []
    for name, (W, P, sigma, A) in before.items():
        scale = np.abs(A).max(axis=(1, 2, 3, 4))
        turned = full @ sigma @ full.transpose(0, 2, 1)
        rows.append(apart(f"energy density, {name}", after[name][0], W, scale, _ROUNDOFF, why))
        rows.append(apart(f"P(QF) - Q P(F), {name}", after[name][1], Q @ P, scale, _ROUNDOFF, why))
        rows.append(apart(f"sigma(QF) - Q sigma(F) Q^T, {name}", after[name][2], turned, scale, _ROUNDOFF, why))
    points = [worst(rows[k::3]) for k in range(3)]
    bodies = []
    why = "roundings of rotated displacements as long as the body, times the nail's stiffness over the skin's"
    for element in ELEMENTS:
        problem = layered(element)
        deform(problem)
        energy, forces = fem.assemble_scalar(problem.energy), nodal_forces(problem)
        Q = rotations(5)[1]
        turn(problem, Q)
        turned_forces = nodal_forces(problem)
        row = apart("nodal forces", turned_forces[None], (forces @ Q.T)[None], np.abs(forces).max(), 1e-12, why, _MESH)
        ours = float(fem.assemble_scalar(problem.energy))
        bodies += [row, Row("energy of a body (J/m)", ours, float(energy), 1e-12, why, _MESH)]
    return Outcome((*points, worst(bodies[::2]), worst(bodies[1::2])))


def hooke(lame: float, shear: float) -> Array:
    """Return linear elasticity's moduli (Pa), shape (2, 2, 2, 2)."""
    delta = np.eye(2)
    straight = np.einsum("ik,jl->ijkl", delta, delta) + np.einsum("il,jk->ijkl", delta, delta)
    return np.asarray(lame * np.einsum("ij,kl->ijkl", delta, delta) + shear * straight)


def dense(solver: Solver) -> Array:
    """Return the assembled tangent of a solver in its problem's state."""
    A = solver.layout.create_matrix()
    solver.equations.assemble_tangent(A)
    rows = range(A.getSize()[0])
    return np.asarray(A.getValues(rows, rows))


def linear_stiffness(problem: Problem) -> Array:
    """Return the matrix of linear elasticity from Lame's constants, written anew."""
    v, du = ufl.TestFunction(problem.V), ufl.TrialFunction(problem.V)
    dx = ufl.Measure("dx", problem.mesh, subdomain_data=problem.cell_tags)
    form = 0
    for tag, solid in SOLIDS.items():
        if isinstance(solid, Ogden):
            G, nu = solid.shear_modulus, solid.poisson
        else:
            G, nu = solid.young / (2 * (1 + solid.poisson)), solid.poisson
        strain = ufl.sym(ufl.grad(du))
        sigma = 2 * G * (nu / (1 - 2 * nu) * ufl.tr(strain) * ufl.Identity(2) + strain)
        form += ufl.inner(sigma, ufl.sym(ufl.grad(v))) * dx(tag)
    A = fem_petsc.assemble_matrix(fem.form(form))
    A.assemble()
    rows = range(A.getSize()[0])
    return np.asarray(A.getValues(rows, rows))


def tangent(small: bool) -> Outcome:
    """Symmetry, closed forms and Hooke's law of points; symmetry and linear elasticity of a body."""
    F, why = states(64), "roundings; the series about F = I leaves 3e-14 of the tangent"
    rows = []
    for name, (_, _, _, A) in evaluations(F).items():
        scale = np.abs(A).max(axis=(1, 2, 3, 4))
        rows.append(apart(f"dP/dF major symmetry, {name}", A, A.transpose(0, 3, 4, 1, 2), scale, _ROUNDOFF, why))
    symmetry = worst(rows)

    at_rest = []
    for solid in LAYERS:
        G, K = solid.shear_modulus, solid.bulk
        A, expected = in_package(solid, np.eye(2)[None])[3], hooke(K - 2 / 3 * G, G)
        at_rest.append(apart(f"dP/dF at F = I less Hooke's, {solid.name}", A, expected[None], K, _ROUNDOFF, why))
    constants = saint_venant.lame_constants(*NAIL)
    A = nail()(np.eye(2)[None], *constants)[3]
    at_rest.append(apart("dP/dF at F = I less Hooke's, nail", A, hooke(*constants)[None], constants[0], _ROUNDOFF, why))

    pulled = []
    for solid in LAYERS:
        for stretches in ((0.7, 1.2), (1.3, 0.9), (1.095, 0.905), (1.001, 1.0), (1.5, 1.5)):
            A = in_package(solid, np.diag(stretches)[None])[3][0]
            expected = moduli(solid, (*stretches, 1.0))[:2, :2]
            ours = np.einsum("iijj->ij", A)
            quantity = f"dP_i/dλ_j at ({stretches[0]}, {stretches[1]}, 1), {solid.name}"
            pulled.append(apart(quantity, ours[None], expected[None], np.abs(A).max(), _ROUNDOFF, why))

    matrices, linear = [], []
    for element in ELEMENTS:
        problem = layered(element)
        solver = Solver(Equations(problem, NOTHING), 1.0)
        deform(problem)
        matrix = dense(solver)
        quantity, sums = f"assembled tangent less its transpose, {element}", "roundings of sums over triangles"
        matrices.append(apart(quantity, matrix[None], matrix.T[None], np.abs(matrix).max(), 1e-14, sums, _MESH))
        if element in ("P1", "P2"):
            problem.w.x.array[:] = 0.0
            rows_ = solver.layout.rows
            ours, expected = dense(solver)[np.ix_(rows_, rows_)], linear_stiffness(problem)
            quantity, largest = f"tangent at rest less linear elasticity's, {element}", np.abs(expected).max()
            linear.append(apart(quantity, ours[None], expected[None], largest, _ROUNDOFF, why, _MESH))
    return Outcome((symmetry, worst(at_rest), worst(pulled), worst(matrices), worst(linear)))


_OGDEN = "Ogden 1984, Non-linear Elastic Deformations"
CASES = (
    Case("Objectivity", f"{_OGDEN}, chapter 4; differences over a scale", objectivity),
    Case("Tangent", f"{_OGDEN}, chapters 4 and 6; differences over a scale", tangent),
)
