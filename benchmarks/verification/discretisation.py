r"""A manufactured solution at finite strain in two layers, as stiff to each other as stratum corneum and dermis.

Given u_e, zero on the boundary and with a kink in its gradient at the layers' interface Gamma, the body forces and
interface loads under which it is in equilibrium are

.. math:: f = -\operatorname{div} P(I + \nabla u_e) \text{ in each layer}, \qquad
          t = P^+ N^+ + P^- N^- \text{ on } \Gamma,

differentiated by UFL from the package's laws (Roache 2002, doi 10.1115/1.1436090). The computed displacement
converges to it with the order p + 1 in L2 and p in H1; the pressure of the mixed pair with the order 2 in L2. The
kink is that of continuous tractions in linear elasticity, so that t is small: dead loads on the interface of the order
of the moduli make it wrinkle, the more modes the finer the mesh. Stretches reach from 0.78 to 1.28.
"""

import dolfinx
import numpy as np
import ufl
from dolfinx import fem

from benchmarks.verification import bodies
from benchmarks.verification.bodies import Array, FreeSolver, body, free_problem, norm
from benchmarks.verification.case import Case, Row, order, order_row
from geometry import tags
from geometry.bodies import block
from variational import compat, jit, kinematics
from variational.materials.ogden import Ogden
from variational.problem import Problem

SIZE = 1e-3  # m: width, height and distance from the screen
INTERFACE = 1.5 * SIZE
SC, DERMIS = tags.STRATUM_CORNEUM, tags.DERMIS
SOLIDS = {SC: Ogden(86.76e3, -14.53, 0.48), DERMIS: Ogden(2.55e3, -14.53, 0.48)}
RATIO = 2.55 / 86.76  # of the shear moduli


def displacement(x, y, compliance, cosine):
    """Return u_e (m), zero on the boundary; ``compliance`` is the dermis's shear modulus over the layer's own."""
    e = y / SIZE - 1.5
    kink, smooth = compliance * e * (1 - 4 * e**2), e**2 * (1 - 4 * e**2)
    along = SIZE * cosine(np.pi * x / SIZE)
    return along * (0.2 * kink + 0.1 * smooth), along * (0.03 * kink - 0.06 * smooth)


def exact(x: Array) -> Array:
    """Return u_e (m), shape (2, n), at points (m), shape (3, n)."""
    return np.stack(displacement(x[0], x[1], np.where(x[1] < INTERFACE, RATIO, 1.0), np.cos))


def strained(problem: Problem):
    """Return the exact F in UFL; on the interface it is that of either side."""
    compliance = fem.Function(fem.functionspace(problem.mesh, ("Discontinuous Lagrange", 0)))
    for tag, value in ((SC, RATIO), (DERMIS, 1.0)):
        compliance.x.array[problem.cell_tags.find(tag)] = value
    X = ufl.SpatialCoordinate(problem.mesh)
    u = ufl.as_vector(displacement(X[0], X[1], compliance, ufl.cos))
    return ufl.Identity(2) + ufl.grad(u)


def loads(problem: Problem):
    """Return the work of body forces and interface loads, a linear form."""
    mesh, rule = problem.mesh, {"quadrature_degree": 10}
    mesh.topology.create_entities(1)
    facets = dolfinx.mesh.locate_entities(mesh, 1, lambda x: np.isclose(x[1], INTERFACE, rtol=1e-9))
    marked = dolfinx.mesh.meshtags(mesh, 1, facets, np.ones(len(facets), dtype=np.int32))
    dS = ufl.Measure("dS", mesh, subdomain_data=marked, metadata=rule)
    (law,) = problem.laws.values()
    P, v, N = (
        kinematics.first_piola_kirchhoff(law, strained(problem)),
        ufl.TestFunction(problem.V),
        ufl.FacetNormal(mesh),
    )
    return -ufl.dot(ufl.div(P), v) * ufl.dx(mesh, metadata=rule) + ufl.dot(ufl.jump(P, N), ufl.avg(v)) * dS(1)


def exact_pressure(problem: Problem):
    """Return K (J - 1) of the exact solution (Pa), UFL."""
    (law,) = problem.laws.values()
    return law.pressure(kinematics.displacement_gradient(strained(problem)))


def solve(element: str, divisions: int) -> Problem:
    """Solve on a grid of squares halved into triangles, from the exact solution interpolated."""
    build = block(SIZE, SIZE, SIZE / divisions, gap=SIZE)
    made = body(build, lambda x: np.where(x[:, 1] < INTERFACE, SC, DERMIS))
    problem = free_problem(made, SOLIDS, element)
    # Glued to a bone that stays where it is: u = 0 all around.
    boundary = [made.facet_tags.find(tag) for tag in (tags.ridge(0), tags.BONE_RIM, tags.SIDES)]
    solver = FreeSolver(problem, np.concatenate(boundary), 1.0, 1e-10)
    solver.set_load(loads(problem))
    problem.w.interpolate(exact)
    if problem.pressure:
        p = problem.pressure.unknown
        p.x.array[:] = 1.0
        unit = norm(problem.mesh, problem.pressure.p) / SIZE
        points = compat.interpolation_points(p.function_space.element)
        p.interpolate(fem.Expression(exact_pressure(problem) / unit, points, jit_options=jit.OPTIONS))
    solver.solve_from_fields()
    return problem


def manufactured(small: bool) -> list[Row]:
    """Orders of the displacement with all elements, and of the mixed one's pressure."""
    meshes = (8, 16, 32) if small else (4, 8, 16, 32, 64)
    found, pressures = {}, []
    for element in ("P1", "P2") if small else bodies.DEGREES:
        problems = [solve(element, n) for n in meshes]
        found[element] = [bodies.relative_errors(problem.w, exact) for problem in problems]
        for problem in problems:
            if problem.pressure:
                p = exact_pressure(problem)
                pressures.append(norm(problem.mesh, problem.pressure.p - p) / norm(problem.mesh, p))
    why = "not yet asymptotic: the orders of P2, P2-P1 and P3 come down to it, that of P1 up"
    rows = bodies.field_orders(found, meshes, 0.3, why)
    if pressures:
        observed = order(pressures[-2:], meshes[-2:])
        mesh = f"up to {meshes[-1]} divisions, last error {pressures[-1]:.1e}"
        rows.append(order_row("order of the pressure in L2, P2-P1", observed, 2.0, 0.05, why, mesh))
    return rows


_ROACHE = "Roache 2002, doi 10.1115/1.1436090: body force by differentiation of the exact solution; orders p + 1 and p"
CASES = (Case("Manufactured solution, two layers", _ROACHE, manufactured),)
