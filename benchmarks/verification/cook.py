r"""Cook's membrane, nearly incompressible: a panel clamped on the left, sheared up by a dead load on the right.

Corners (0, 0), (48, 44), (48, 60) and (0, 44) mm, E = 240.565 MPa, 6.25 MPa on the right edge, plane strain
(de Souza Neto et al. 1996, doi 10.1016/0020-7683(95)00259-6). Sought is the upper right corner's rise, by linear
elasticity, from the tangent at rest, and at finite strain. With an exponent of 2
Ogden's solid is the neo-Hookean one, :math:`W = \frac{G}{2} (J^{-2/3} \operatorname{tr} C - 3) + \frac K2 (J - 1)^2`.

The published numbers are the benchmarks of OpenGeoSys (linear quadrilaterals with B-bar and F-bar), as printed in
ufz/ogs, Tests/Data/Mechanics/CooksMembrane/CooksMembraneBbar.py (nu = 0.4999, small strain) and
Tests/Data/LargeDeformation/CooksMembrane/CooksMembraneFbar.py (nu = 0.499, neo-Hookean with
:math:`\frac\lambda2 \ln^2 J`: another volumetric law, which nearly constant volume hardly feels; its page writes ours).
They are still growing on their 30 elements a side, so the tolerance is what their last doubling changed. The corners at
the clamp are singular: no order is asked of a point's displacement.
"""

import numpy as np
import ufl
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import spsolve

from benchmarks.verification.bodies import FreeSolver, body, free_problem
from benchmarks.verification.case import Case, Row
from geometry import tags
from geometry.bodies import cooks_membrane
from variational.materials.ogden import Ogden

YOUNG, TRACTION = 240.565e6, 6.25e6  # Pa
GAP, CORNER = 10e-3, (48e-3, 60e-3)  # m
SMALL_STRAIN = (7.897598, 7.999718)  # mm, B-bar, nu = 0.4999, on 15 and 30 elements a side
FINITE_STRAIN = (6.824183, 6.891409)  # mm, F-bar, nu = 0.499, likewise


def loaded(element: str, divisions: int, poisson: float) -> tuple[FreeSolver, int]:
    """Return the clamped panel's solver, all of the load applied, and the unknown of the corner's rise."""
    made = body(cooks_membrane(divisions, GAP))
    # With a = 2 either sign of the exponent would do, were the solid incompressible.
    solid = Ogden(YOUNG / 2 / (1 + poisson), 2.0, poisson, "abaqus")
    problem = free_problem(made, {tags.STRATUM_CORNEUM: solid}, element)
    solver = FreeSolver(problem, made.facet_tags.find(tags.BONE_RIM), 1e5)
    x, v = ufl.SpatialCoordinate(made.mesh), ufl.TestFunction(problem.V)
    right = ufl.conditional(ufl.gt(x[0], CORNER[0] * (1 - 1e-9)), 1.0, 0.0)
    ds = ufl.Measure("ds", made.mesh, subdomain_data=made.facet_tags)
    solver.set_load(TRACTION * right * v[1] * ds(tags.SIDES, metadata={"quadrature_degree": 4}))
    X = problem.V.tabulate_dof_coordinates()[:, :2] - [0.0, GAP]
    return solver, 2 * int(np.linalg.norm(X - CORNER, axis=1).argmin()) + 1


def linear_rise(element: str, divisions: int, poisson: float) -> float:
    """Return the corner's rise (mm) by the tangent at rest."""
    solver, tip = loaded(element, divisions, poisson)
    layout = solver.layout
    A, x = layout.create_matrix(), layout.create_vector()
    solver.equations.assemble_tangent(A)
    A.zeroRows(solver.equations.prescribed_rows(), diag=YOUNG)
    indptr, indices, values = A.getValuesCSR()
    x.array_w[:] = spsolve(csc_array(csr_array((values, indices, indptr))), solver.equations.dead_load.array)
    u = np.zeros_like(solver.problem.w.x.array)
    layout.to_nodes(x, u)
    return float(u[tip]) * 1e3


def finite_rise(element: str, divisions: int, poisson: float) -> float:
    """Return the corner's rise (mm) at finite strain, by Newton's method in ten steps of the load."""
    solver, tip = loaded(element, divisions, poisson)
    for solver.equations.load_part in np.linspace(0, 1, 11)[1:]:
        solver.solve()
    return float(solver.problem.w.x.array[tip]) * 1e3


def _mesh(divisions: int) -> str:
    return f"{divisions} × {divisions} × 2 triangles"


def _published(rise: float, published: tuple[float, float], divisions: int) -> Row:
    why = "what the reference's last doubling, 15 to 30 elements, changed"
    return Row("rise, P2-P1 (mm)", rise, published[1], 1 - published[0] / published[1], why, _mesh(divisions))


def small_strain(small: bool) -> list[Row]:
    """Linear elasticity: the mixed element's rise, and that P1 locks."""
    finest, middle = (16, 16) if small else (64, 16)
    rows = [_published(linear_rise("P2-P1", finest, 0.4999), SMALL_STRAIN, finest)]
    for nu, reference, tolerance, why in (
        (0.3, 0.0, 0.1, "it does not lock: a tenth is missing at most"),
        (0.4999, 0.5, 0.25, "it locks: a quarter is missing at least, and not all"),
    ):
        missing = 1 - linear_rise("P1", middle, nu) / linear_rise("P2-P1", middle, nu)
        quantity = f"part of the rise that P1 misses, nu = {nu:g}"
        rows.append(Row(quantity, missing, reference, tolerance, why, _mesh(middle), absolute=True))
    return rows


def finite_strain(small: bool) -> list[Row]:
    """The mixed element at full load."""
    divisions = 8 if small else 32
    return [_published(finite_rise("P2-P1", divisions, 0.499), FINITE_STRAIN, divisions)]


_SOURCE = "OpenGeoSys's benchmark, after de Souza Neto et al. 1996, doi 10.1016/0020-7683(95)00259-6"
CASES = (
    Case("Cook's membrane, small strain", f"{_SOURCE}: CooksMembraneBbar.py in ufz/ogs", small_strain),
    Case("Cook's membrane, finite strain", f"{_SOURCE}: CooksMembraneFbar.py in ufz/ogs", finite_strain),
)
