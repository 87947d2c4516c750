r"""Cook's membrane, nearly incompressible: a panel clamped on the left, sheared up by a dead load on the right.

Corners (0, 0), (48, 44), (48, 60) and (0, 44) mm, E = 240.565 MPa, 6.25 MPa on the right edge, plane strain, as
de Souza Neto et al. (1996, doi 10.1016/0020-7683(95)00259-6) have it. Sought is the upper right corner's rise, computed
by linear elasticity, from the tangent at rest, with all elements, and at finite strain, by Newton's method
in ten steps of the load, with the mixed one. With an exponent of 2 Ogden's solid is the neo-Hookean one,
:math:`W = \frac{G}{2} (J^{-2/3} \operatorname{tr} C - 3) + \frac K2 (J - 1)^2`.

The published numbers are the benchmarks of OpenGeoSys (linear quadrilaterals with B-bar and F-bar), as printed in
ufz/ogs, Tests/Data/Mechanics/CooksMembrane/CooksMembraneBbar.py (nu = 0.4999, small strain) and
Tests/Data/LargeDeformation/CooksMembrane/CooksMembraneFbar.py (nu = 0.499, neo-Hookean with
:math:`\frac\lambda2 \ln^2 J`: another volumetric law, which nearly constant volume hardly feels; its page writes ours).
They are the rise on 4 to 30 elements a side, still growing: what is compared is our converged value with their last
one, within what the last doubling of their elements changed. The corners at the clamp are singular, so no order is
asked of a point's displacement.
"""

from collections.abc import Sequence

import numpy as np
import ufl
from petsc4py import PETSc

from benchmarks.verification.bodies import FreeSolver, body, free_problem
from benchmarks.verification.case import Case, Curves, Outcome, Row
from geometry import tags
from geometry.bodies import cooks_membrane
from variational.element import ELEMENTS
from variational.materials.ogden import Ogden

YOUNG, TRACTION = 240.565e6, 6.25e6  # Pa
GAP, CORNER = 10e-3, (48e-3, 60e-3)  # m
QUADRILATERALS = (4, 10, 15, 20, 25, 30)  # elements a side
SMALL_STRAIN = (6.957471, 7.772617, 7.897598, 7.951479, 7.976350, 7.999718)  # mm, B-bar, nu = 0.4999
LOCKED = (2.164587, 2.260333, 2.375296, 2.519726, 2.651529, 2.868290)  # mm, without
FINITE_STRAIN = (6.141383, 6.746284, 6.824183, 6.858936, 6.873126, 6.891409)  # mm, F-bar, nu = 0.499
_LAST = QUADRILATERALS.index(15), QUADRILATERALS.index(30)


class Membrane:
    """The loaded panel."""

    def __init__(self, element: str, divisions: int, poisson: float) -> None:
        """Clamp and load it."""
        made = body(cooks_membrane(divisions, GAP))
        # With a = 2 either sign of the exponent would do, were the solid incompressible.
        solid = Ogden(YOUNG / 2 / (1 + poisson), 2.0, poisson, "abaqus")
        self.problem = problem = free_problem(made, {tags.STRATUM_CORNEUM: solid}, element)
        X = problem.V.tabulate_dof_coordinates()[:, :2] - [0.0, GAP]
        self._tip = int(np.linalg.norm(X - CORNER, axis=1).argmin())
        self.solver = FreeSolver(problem, made.facet_tags.find(tags.BONE_RIM), 1e5)
        x, v = ufl.SpatialCoordinate(made.mesh), ufl.TestFunction(problem.V)
        right = ufl.conditional(ufl.gt(x[0], CORNER[0] * (1 - 1e-9)), 1.0, 0.0)
        ds = ufl.Measure("ds", made.mesh, subdomain_data=made.facet_tags)
        self.solver.set_load(TRACTION * right * v[1] * ds(tags.SIDES, metadata={"quadrature_degree": 4}))
        self.full = self.solver.load.copy()

    def linear(self) -> float:
        """Return the corner's rise (mm) by the tangent at rest."""
        solver, layout = self.solver, self.solver.layout
        A, x = layout.create_matrix(), layout.create_vector()
        solver.equations.assemble_tangent(A)
        A.zeroRows(solver.equations.prescribed_rows(), diag=YOUNG)
        ksp = PETSc.KSP().create(layout.comm)
        ksp.setOperators(A)
        ksp.setType(PETSc.KSP.Type.PREONLY)
        ksp.getPC().setType(PETSc.PC.Type.LU)
        ksp.getPC().setFactorSolverType("mumps")
        ksp.solve(self.full, x)
        u = np.zeros_like(self.problem.w.x.array)
        layout.to_nodes(x, u)
        return float(u[2 * self._tip + 1]) * 1e3

    def finite(self, steps: int = 10) -> float:
        """Return the corner's rise (mm) at finite strain."""
        for part in np.linspace(0, 1, steps + 1)[1:]:
            self.full.copy(self.solver.load)
            self.solver.load.scale(part)
            self.solver.solve()
        return float(self.problem.w.x.array[2 * self._tip + 1]) * 1e3


def limit(rises: Sequence[float]) -> tuple[float, float]:
    """Return the limit of a sequence by its last three values (Aitken), and what that adds to the last one."""
    before, last = rises[-2] - rises[-3], rises[-1] - rises[-2]
    added = last**2 / (before - last)
    return rises[-1] + added, abs(added)


def small_strain(small: bool) -> Outcome:
    """Linear elasticity with all elements: the limit, and that P1 locks."""
    meshes = (4, 8, 16) if small else (4, 8, 16, 32, 64)
    elements = ("P1", "P2-P1") if small else tuple(ELEMENTS)
    rises = {e: [Membrane(e, n, 0.4999).linear() for n in meshes] for e in elements}
    mixed, ours = limit(rises["P2-P1"])[0], rises["P2-P1"][-1]
    mesh = f"{meshes[-1]} × {meshes[-1]} × 2 triangles"
    changed = 1 - SMALL_STRAIN[_LAST[0]] / SMALL_STRAIN[_LAST[1]]
    why = "what the reference's last doubling, 15 to 30 elements, changed"
    rows = [Row("rise, P2-P1 (mm)", ours, SMALL_STRAIN[-1], changed, why, mesh)]
    for element in ("P2", "P2 reduced"):
        if element in rises:
            value, added = limit(rises[element])
            why = f"half of what extrapolation adds to {element}'s rise"
            quantity = f"rise extrapolated, {element}, against P2-P1's (mm)"
            rows.append(Row(quantity, value, mixed, added / mixed / 2, why, f"up to {mesh}"))
    divisions = meshes[2]
    for nu, reference, tolerance, why in (
        (0.3, 0.0, 0.1, "it does not lock: a tenth is missing at most"),
        (0.4999, 0.5, 0.25, "it locks: a quarter is missing at least, and not all"),
    ):
        missing = 1 - Membrane("P1", divisions, nu).linear() / Membrane("P2-P1", divisions, nu).linear()
        quantity, mesh = f"part of the rise that P1 misses, nu = {nu:g}", f"{divisions} × {divisions} × 2 triangles"
        rows.append(Row(quantity, missing, reference, tolerance, why, mesh, absolute=True))

    known = {"OpenGeoSys, B-bar": (QUADRILATERALS, SMALL_STRAIN), "OpenGeoSys, plain": (QUADRILATERALS, LOCKED)}
    found = {element: (meshes, values) for element, values in rises.items()}
    return Outcome(tuple(rows), Curves("divisions of a side", "rise of the corner (mm)", known, found))


def finite_strain(small: bool) -> Outcome:
    """The mixed element at full load."""
    meshes = (4, 8) if small else (4, 8, 16, 32)
    rises = [Membrane("P2-P1", n, 0.499).finite() for n in meshes]
    changed = 1 - FINITE_STRAIN[_LAST[0]] / FINITE_STRAIN[_LAST[1]]
    why, mesh = (
        "what the reference's last doubling, 15 to 30 elements, changed",
        f"{meshes[-1]} × {meshes[-1]} × 2 triangles",
    )

    known = {"OpenGeoSys, F-bar": (QUADRILATERALS, FINITE_STRAIN)}
    curves = Curves("divisions of a side", "rise of the corner (mm)", known, {"P2-P1": (meshes, rises)})
    return Outcome((Row("rise, P2-P1 (mm)", rises[-1], FINITE_STRAIN[-1], changed, why, mesh),), curves)


_SOURCE = "OpenGeoSys's benchmark, after de Souza Neto et al. 1996, doi 10.1016/0020-7683(95)00259-6"
CASES = (
    Case("Cook's membrane, small strain", f"{_SOURCE}: CooksMembraneBbar.py in ufz/ogs", small_strain),
    Case("Cook's membrane, finite strain", f"{_SOURCE}: CooksMembraneFbar.py in ufz/ogs", finite_strain),
)
