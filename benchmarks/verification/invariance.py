r"""What the laws must be whatever their numbers: objective, hyperelastic, and Hooke's at rest.

With W of F alone by C = F^T F, for every rotation Q

.. math:: W(QF) = W(F), \qquad P(QF) = Q P(F), \qquad \sigma(QF) = Q \sigma(F) Q^T,

dP/dF has the major symmetry, and at F = I it is :math:`\lambda I \otimes I + 2 \mu \mathbb{I}^{sym}` (Ogden, Non-linear
Elastic Deformations, 1984, chapters 4 and 6); likewise the assembled forces and tangents of a body of three layers.
"""

from functools import cache

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem import petsc as fem_petsc

from benchmarks.verification.bodies import NOTHING, Array, body, free_problem, nodal_forces
from benchmarks.verification.case import Case, Row, worst
from benchmarks.verification.constitutive import LAYERS, ROUNDOFF, Evaluation, Points, in_package, moduli
from geometry import tags
from geometry.bodies import block
from variational.element import ELEMENTS
from variational.materials import saint_venant
from variational.materials.ogden import Ogden
from variational.materials.saint_venant import SaintVenant
from variational.problem import Problem
from variational.solvers.equations import Equations

NAIL = (170e6, 0.3)
SOLIDS: dict[int, Ogden | SaintVenant] = {
    tags.STRATUM_CORNEUM: Ogden(86.76e3, -14.53, 0.48),
    tags.DERMIS: Ogden(2.55e3, -14.53, 0.48),
    tags.NAIL: SaintVenant(*NAIL),
}
SIZE = 1e-3  # m
_MESH = "4 × 4 × 2 triangles, SC, dermis and nail"


def states(count: int) -> Array:
    """Return deformation gradients without any symmetry, J from 0.6 to 1.6, shape (count, 2, 2)."""
    F = np.eye(2) + np.random.default_rng(1).uniform(-0.5, 0.5, (20 * count, 2, 2))
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


@cache
def nail() -> Points:
    """Return the package's Saint Venant-Kirchhoff law."""
    return Points(SaintVenant(1.0, 0.3))


def evaluations(F: Array) -> dict[str, Evaluation]:
    """Return what the package computes by every law at deformation gradients."""
    found = {solid.name: in_package(solid, F) for solid in LAYERS}
    return found | {"nail": nail()(F, *saint_venant.lame_constants(*NAIL))}


def largest(A: Array) -> Array:
    """Return the largest modulus of each state (Pa)."""
    return np.asarray(np.abs(A).reshape(len(A), -1).max(axis=1))


def deformed(element: str) -> Problem:
    """Return a block of three layers, the middle one nail, sheared, stretched and bent by 10 %, pressure likewise."""
    layers = [tags.STRATUM_CORNEUM, tags.NAIL, tags.DERMIS]
    build = block(SIZE, SIZE, SIZE / 4)
    made = body(build, lambda x: np.select([x[:, 1] < 0.5 * SIZE, x[:, 1] < 0.75 * SIZE], layers[:2], layers[2]))
    problem = free_problem(made, SOLIDS, element)

    def u(x):
        X, Y = x[0] / SIZE, x[1] / SIZE
        return 0.1 * SIZE * np.stack([np.sin(2 * X + Y) + 0.5 * Y**2, np.cos(3 * Y) * X - 0.4 * Y])

    problem.w.interpolate(u)
    if problem.pressure:
        problem.pressure.unknown.interpolate(lambda x: 1e-5 * np.cos(3e3 * x[0] + 2e3 * x[1]))
    return problem


def objectivity(small: bool) -> list[Row]:
    """Superposed rotations of points and of a body."""
    F = states(64)
    Q = rotations(len(F))
    after, why = evaluations(Q @ F), "roundings of QF, times powers of 15, over the largest modulus"
    full = np.zeros((len(F), 3, 3))
    full[:, :2, :2], full[:, 2, 2] = Q, 1.0
    points: tuple[list[Row], ...] = ([], [], [])
    for name, (W, P, sigma, A) in evaluations(F).items():
        W_Q, P_Q, sigma_Q, _ = after[name]
        turned = full @ sigma @ full.transpose(0, 2, 1)
        for rows, quantity, ours, expected in (
            (points[0], "energy density", W_Q, W),
            (points[1], "P(QF) - Q P(F)", P_Q, Q @ P),
            (points[2], "sigma(QF) - Q sigma(F) Q^T", sigma_Q, turned),
        ):
            rows.append(apart(f"{quantity}, {name}", ours, expected, largest(A), ROUNDOFF, why))
    all_forces, energies = [], []
    why = "roundings of rotated displacements as long as the body, times the nail's stiffness over the skin's"
    for element in ELEMENTS:
        problem, turn = deformed(element), rotations(5)[1]
        energy, forces = float(fem.assemble_scalar(problem.energy)), nodal_forces(problem)
        X = problem.V.tabulate_dof_coordinates()[:, :2]
        problem.w.x.array[:] = ((X + problem.w.x.array.reshape(-1, 2)) @ turn.T - X).ravel()
        ours, expected, scale = nodal_forces(problem)[None], (forces @ turn.T)[None], np.abs(forces).max()
        all_forces.append(apart("nodal forces", ours, expected, scale, 1e-12, why, _MESH))
        turned_energy = float(fem.assemble_scalar(problem.energy))
        energies.append(Row("energy of a body (J/m)", turned_energy, energy, 1e-12, why, _MESH))
    return [worst(rows) for rows in (*points, all_forces, energies)]


def hooke(lame: float, shear: float) -> Array:
    """Return linear elasticity's moduli (Pa), shape (2, 2, 2, 2)."""
    delta = np.eye(2)
    straight = np.einsum("ik,jl->ijkl", delta, delta) + np.einsum("il,jk->ijkl", delta, delta)
    return np.asarray(lame * np.einsum("ij,kl->ijkl", delta, delta) + shear * straight)


def dense(A) -> Array:
    """Return the entries of a matrix."""
    rows = range(A.getSize()[0])
    return np.asarray(A.getValues(rows, rows))


def linear_stiffness(problem: Problem) -> Array:
    """Return the matrix of linear elasticity from Lame's constants, written anew."""
    v, du = ufl.TestFunction(problem.V), ufl.TrialFunction(problem.V)
    dx, strain = ufl.Measure("dx", problem.mesh, subdomain_data=problem.cell_tags), ufl.sym(ufl.grad(du))
    form = 0
    for tag, solid in SOLIDS.items():
        nu = solid.poisson
        G = solid.shear_modulus if isinstance(solid, Ogden) else solid.young / (2 * (1 + nu))
        sigma = 2 * G * (nu / (1 - 2 * nu) * ufl.tr(strain) * ufl.Identity(2) + strain)
        form += ufl.inner(sigma, ufl.sym(ufl.grad(v))) * dx(tag)
    A = fem_petsc.assemble_matrix(fem.form(form))
    A.assemble()
    return dense(A)


def tangent(small: bool) -> list[Row]:
    """Symmetry, closed forms and Hooke's law of points; symmetry and linear elasticity of a body."""
    why = "roundings; the series about F = I leaves 3e-14 of the tangent"
    rows: list[list[Row]] = [[] for _ in range(5)]
    symmetry, at_rest, pulled, matrices, linear = rows
    for name, (*_, A) in evaluations(states(64)).items():
        quantity = f"dP/dF major symmetry, {name}"
        symmetry.append(apart(quantity, A, A.transpose(0, 3, 4, 1, 2), largest(A), ROUNDOFF, why))

    nails, unstrained = saint_venant.lame_constants(*NAIL), evaluations(np.eye(2)[None])
    rest = [(s.name, s.bulk - 2 / 3 * s.terms[0][0], s.terms[0][0], s.bulk) for s in LAYERS]
    for name, lame, G, scale in (*rest, ("nail", *nails, nails[0])):
        quantity, expected = f"dP/dF at F = I less Hooke's, {name}", hooke(lame, G)[None]
        at_rest.append(apart(quantity, unstrained[name].tangent, expected, scale, ROUNDOFF, why))

    for solid in LAYERS:
        for stretches in ((0.7, 1.2), (1.3, 0.9), (1.095, 0.905), (1.001, 1.0), (1.5, 1.5)):
            A = in_package(solid, np.diag(stretches)[None]).tangent
            expected, ours = moduli(solid, (*stretches, 1.0))[:2, :2], np.einsum("niijj->nij", A)
            quantity = f"dP_i/dλ_j at ({stretches[0]}, {stretches[1]}, 1), {solid.name}"
            pulled.append(apart(quantity, ours, expected[None], largest(A), ROUNDOFF, why))

    for element in ELEMENTS:
        problem = deformed(element)
        equations = Equations(problem, NOTHING)
        K, sums = equations.layout.create_matrix(), "roundings of sums over triangles"
        equations.assemble_tangent(K)
        matrix = dense(K)
        quantity, scale = f"assembled tangent less its transpose, {element}", np.abs(matrix).max()
        matrices.append(apart(quantity, matrix[None], matrix.T[None], scale, 1e-14, sums, _MESH))
        if element in ("P1", "P2"):
            problem.w.x.array[:] = 0.0
            K.zeroEntries()
            equations.assemble_tangent(K)
            unknowns = np.ix_(equations.layout.rows, equations.layout.rows)
            ours, expected = dense(K)[unknowns], linear_stiffness(problem)
            quantity, scale = f"tangent at rest less linear elasticity's, {element}", np.abs(expected).max()
            linear.append(apart(quantity, ours[None], expected[None], scale, ROUNDOFF, why, _MESH))
    return [worst(found) for found in rows]


_OGDEN = "Ogden 1984, Non-linear Elastic Deformations"
CASES = (
    Case("Objectivity", f"{_OGDEN}, chapter 4; differences over a scale", objectivity),
    Case("Tangent", f"{_OGDEN}, chapters 4 and 6; differences over a scale", tangent),
)
