r"""A tube of Ogden's solid in plane strain, widened from inside: pressure and displacement.

An incompressible tube has :math:`r^2 = R^2 + a^2 - A^2` and, with :math:`\hat W(\lambda) = W(1/\lambda, \lambda, 1)`,
the inner pressure (Ogden, Non-linear Elastic Deformations, 1984, chapter 5)

.. math:: p = \int_{\lambda_b}^{\lambda_a} \frac{\hat W'(\lambda)}{\lambda^2 - 1} \,d\lambda.

The computed tube has nu = 0.49999 and is a quarter of triangles whose edges on an arc are parabolas. Its pressure is
the resultant of the forces at the inner nodes.
"""

import numpy as np
from dolfinx import fem
from scipy.integrate import quad

from benchmarks.verification.bodies import NOTHING, FreeSolver, Held, body, free_problem, nodal_forces
from benchmarks.verification.case import Case, Row, order, order_row, worst
from geometry import tags
from geometry.bodies import quarter_tube
from variational.materials.ogden import Ogden

A, B, AXIS = 1e-3, 2e-3, 4e-3  # m: inner and outer radius, height of the axis
SHEAR, ALPHA, NU = 86.76e3, -14.53, 0.49999  # the stratum corneum's, in Pa and as printed
WIDENED = (1.05, 1.1, 1.2, 1.3)  # a / A


def _stretch(widened: float, R):
    return np.sqrt(1 + (widened**2 - 1) * (A / R) ** 2)


def pressure(widened: float) -> float:
    """Return the inner pressure (Pa) of the incompressible tube at a / A, by quadrature."""

    def integrand(x: float) -> float:
        return 2 * SHEAR / -ALPHA * (x ** (-ALPHA - 1) - x ** (ALPHA - 1)) / (x**2 - 1)

    return float(quad(integrand, _stretch(widened, B), widened, epsabs=0, epsrel=1e-12)[0])


def widen(divisions: int, widened: float) -> tuple[float, float]:
    """Return the computed inner pressure (Pa of current area) and the outer surface's displacement (m)."""
    made = body(quarter_tube(A, B, divisions))
    problem = free_problem(made, {tags.STRATUM_CORNEUM: Ogden(SHEAR, ALPHA, NU)}, "P2-P1")
    X = problem.V.tabulate_dof_coordinates()[:, :2] - [0.0, AXIS]
    inner = np.asarray(fem.locate_dofs_topological(problem.V, 1, made.facet_tags.find(tags.BONE_RIM)))
    u = X * (_stretch(widened, np.linalg.norm(X, axis=1)) - 1)[:, None]
    fixed: list[Held] = []
    for k in (0, 1):  # symmetry
        plane = np.flatnonzero(np.abs(X[:, k]) < 1e-9).astype(np.int32)
        fixed.append((2 * plane + k, 0.0))
        fixed += [(np.array([2 * node + k], np.int32), float(u[node, k])) for node in np.setdiff1d(inner, plane)]
    problem.w.x.array[:] = u.ravel()
    FreeSolver(problem, NOTHING, 1.0, 1e-9, fixed).solve_from_fields()
    moved, at = problem.w.x.array.reshape(-1, 2), X[inner]
    radius = np.linalg.norm(at + moved[inner], axis=1).mean()
    outwards = at / np.linalg.norm(at, axis=1)[:, None]
    force = (nodal_forces(problem)[inner] * outwards).sum()
    end = int(np.argmin(np.hypot(X[:, 0] - B, X[:, 1])))
    return float(force / (np.pi / 2 * radius)), float(moved[end, 0])


def inflation(small: bool) -> list[Row]:
    """Pressure and outer radius of a tube whose outer surface is free."""
    meshes = (8, 16) if small else (16, 32)
    mesh, most = f"P2-P1, {meshes[-1]} × {meshes[-1]} × 2 triangles", WIDENED[-1]
    tolerance, why = (np.pi / 2 / meshes[-1]) ** 4, "the fourth power of the angle that a facet spans"
    rows, found = [], {}
    for widened in WIDENED[-1:] if small else WIDENED:
        found[widened] = widen(meshes[-1], widened)
        kpa = found[widened][0] / 1e3, pressure(widened) / 1e3
        volume = "and the change of volume, some 1 - 2 nu, times the exponent"
        quantity = f"inner pressure, a/A = {widened:g} (kPa)"
        rows.append(Row(quantity, *kpa, tolerance - ALPHA * (1 - 2 * NU), f"{why}, {volume}", mesh))
    coarse = (4, 8)  # on finer ones the change of volume is more
    observed = order([widen(divisions, most)[0] / pressure(most) - 1 for divisions in coarse], coarse)
    moved = found[most][1] * 1e3, (_stretch(most, B) - 1) * B * 1e3
    return [
        worst(rows),
        order_row("order of the pressure", observed, 4.0, 0.3, "not yet asymptotic", f"P2-P1, {coarse} divisions"),
        Row(
            f"outer surface's displacement, a/A = {most:g} (mm)",
            *moved,
            tolerance + 1 - 2 * NU,
            f"{why}, and volume",
            mesh,
        ),
    ]


CASES = (Case("Inflated tube", "Ogden 1984, Non-linear Elastic Deformations, chapter 5, by quadrature", inflation),)
