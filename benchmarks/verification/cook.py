r"""Cook's membrane, nearly incompressible: a panel clamped on the left, sheared up by a dead load on the right.

Corners (0, 0), (48, 44), (48, 60) and (0, 44) mm, E = 240.565 MPa, 6.25 MPa on the right edge, plane strain
(de Souza Neto et al. 1996, doi 10.1016/0020-7683(95)00259-6). Sought is the upper right corner's rise at finite strain.
With an exponent of 2 Ogden's solid is the neo-Hookean one,
:math:`W = \frac{G}{2} (J^{-2/3} \operatorname{tr} C - 3) + \frac K2 (J - 1)^2`.

The published numbers are the benchmark of OpenGeoSys (linear quadrilaterals with F-bar), as printed in ufz/ogs,
Tests/Data/LargeDeformation/CooksMembrane/CooksMembraneFbar.py (nu = 0.499, neo-Hookean with
:math:`\frac\lambda2 \ln^2 J`: another volumetric law, which nearly constant volume hardly feels; its page writes ours).
They are still growing on their 30 elements a side, so the tolerance is what their last doubling changed. The corners at
the clamp are singular: no order is asked of a point's displacement.
"""

import gmsh
import numpy as np
import ufl

from benchmarks.verification.bodies import FreeSolver, body, free_problem
from benchmarks.verification.case import Case, Row
from geometry import tags
from geometry.shape import shape
from variational.materials.ogden import Ogden

YOUNG, TRACTION = 240.565e6, 6.25e6  # Pa
_COARSE, _FINE = 6.824183, 6.891409  # mm, published, on 15 and 30 elements a side
GAP, CORNER = 10e-3, (48e-3, 60e-3)  # m


@shape(())
def cooks_membrane(divisions: int, gap: float = GAP) -> float:
    """Return Cook's panel on a regular grid, halved into triangles, its lowest corner some gap (m) above the screen.

    The left edge is the bone's rim, the lower one ridge 0, the others are sides.
    """
    geo, low = gmsh.model.geo, gap * 1e3
    corners = [geo.addPoint(x, y + low, 0.0) for x, y in ((0.0, 0.0), (48.0, 44.0), (48.0, 60.0), (0.0, 44.0))]
    edges = [geo.addLine(corners[k], corners[(k + 1) % 4]) for k in range(4)]
    for edge in edges:
        geo.mesh.setTransfiniteCurve(edge, divisions + 1)
    panel = geo.addPlaneSurface([geo.addCurveLoop(edges)])
    geo.mesh.setTransfiniteSurface(panel)
    geo.synchronize()
    gmsh.model.addPhysicalGroup(2, [panel], tags.STRATUM_CORNEUM)
    for tag, curves in ((tags.ridge(0), edges[:1]), (tags.SIDES, edges[1:3]), (tags.BONE_RIM, edges[3:])):
        gmsh.model.addPhysicalGroup(1, curves, tag)
    gmsh.model.mesh.generate(2)
    return 1e-3


def loaded(divisions: int, poisson: float) -> tuple[FreeSolver, int]:
    """Return the clamped panel's solver, all of the load applied, and the unknown of the corner's rise."""
    made = body(cooks_membrane(divisions, GAP))
    # With a = 2 either sign of the exponent would do, were the solid incompressible.
    solid = Ogden(YOUNG / 2 / (1 + poisson), 2.0, poisson, "abaqus")
    problem = free_problem(made, {tags.STRATUM_CORNEUM: solid}, "P2-P1")
    solver = FreeSolver(problem, made.facet_tags.find(tags.BONE_RIM), 1e5)
    x, v = ufl.SpatialCoordinate(made.mesh), ufl.TestFunction(problem.V)
    right = ufl.conditional(ufl.gt(x[0], CORNER[0] * (1 - 1e-9)), 1.0, 0.0)
    ds = ufl.Measure("ds", made.mesh, subdomain_data=made.facet_tags)
    solver.set_load(TRACTION * right * v[1] * ds(tags.SIDES, metadata={"quadrature_degree": 4}))
    X = problem.V.tabulate_dof_coordinates()[:, :2] - [0.0, GAP]
    return solver, 2 * int(np.linalg.norm(X - CORNER, axis=1).argmin()) + 1


def finite_rise(divisions: int, poisson: float) -> float:
    """Return the corner's rise (mm) at finite strain, by Newton's method in ten steps of the load."""
    solver, tip = loaded(divisions, poisson)
    for solver.equations.load_part in np.linspace(0, 1, 11)[1:]:
        solver.solve()
    return float(solver.problem.w.x.array[tip]) * 1e3


def rise(small: bool) -> list[Row]:
    """The corner's rise beside the published one."""
    n, why = 16 if small else 64, "what the reference's last doubling, 15 to 30 elements, changed"
    mesh = f"{n} × {n} × 2 triangles"
    return [Row("rise, P2-P1 (mm)", finite_rise(n, 0.499), _FINE, 1 - _COARSE / _FINE, why, mesh)]


_SOURCE = "OpenGeoSys's benchmark, after de Souza Neto et al. 1996, doi 10.1016/0020-7683(95)00259-6"
CASES = (Case("Cook's membrane, finite strain", f"{_SOURCE}: CooksMembraneFbar.py in ufz/ogs", rise),)
