r"""A tube of Ogden's solid in plane strain, widened from inside: pressure and displacement.

The computed tube is a quarter, symmetry on its planes, of straight-sided triangles: where its outer surface is free,
the missing slivers of the wall are an error of the second order in the triangles' size. With the exact displacement
prescribed on both surfaces the body of triangles has the exact solution in it, and the element's order shows. The
pressure is the resultant of the forces at the inner nodes. Exact solutions: :mod:`benchmarks.verification.shooting`.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.verification import orders
from benchmarks.verification.bodies import NOTHING, FreeSolver, Held, body, free_problem, held, nodal_forces, nodes_of
from benchmarks.verification.case import Case, Curves, Outcome, Row, worst
from benchmarks.verification.shooting import ALPHA, AXIS, SHEAR, A, B, Exact, exact_tube, pressure_of_incompressible
from geometry import tags
from geometry.bodies import quarter_tube
from variational.materials.ogden import Ogden
from variational.problem import Problem

Array = NDArray[np.float64]
WIDENED = (1.05, 1.1, 1.2, 1.3)  # a / A
_OGDEN = "Ogden 1984, Non-linear Elastic Deformations, chapter 5"


@dataclass
class Tube:
    """A computed quarter."""

    problem: Problem
    inner: NDArray[np.int32]
    """Nodes."""
    X: Array
    """All nodes from the axis (m), shape (nodes, 2)."""

    @property
    def pressure(self) -> float:
        """Return the inner pressure (Pa of current area): the radial forces of the inner nodes over the arc."""
        X = self.X[self.inner]
        outwards = X / np.linalg.norm(X, axis=1)[:, None]
        current = X + self.problem.w.x.array.reshape(-1, 2)[self.inner]
        radius = np.linalg.norm(current, axis=1).mean()
        return float((nodal_forces(self.problem)[self.inner] * outwards).sum() / (np.pi / 2 * radius))

    @property
    def outer_radius(self) -> float:
        """Return the radius (m) to which the outer surface's node on the horizontal plane of symmetry moves."""
        node = int(np.argmin(np.hypot(self.X[:, 0] - B, self.X[:, 1])))
        return B + float(self.problem.w.x.array[2 * node])


def widen(element: str, divisions: int, poisson: float, widened: float, exact: Exact | None = None) -> Tube:
    """Solve for a quarter of the tube, its outer surface free or, with ``exact``, both surfaces displaced by it."""
    made = body(quarter_tube(A, B, divisions))
    problem = free_problem(made, {tags.STRATUM_CORNEUM: Ogden(SHEAR, ALPHA, poisson)}, element)
    X = problem.V.tabulate_dof_coordinates()[:, :2] - [0.0, AXIS]
    R = np.linalg.norm(X, axis=1)
    inner, outer = (nodes_of(problem, made.facet_tags.find(tag)) for tag in (tags.BONE_RIM, tags.ridge(0)))
    left, low = (np.flatnonzero(np.abs(X[:, k]) < 1e-9).astype(np.int32) for k in (0, 1))
    if exact is None:
        # Nodes amid a straight facet are within the circle: they move as those of an incompressible tube do.
        u = X * (np.sqrt(1 + (widened**2 - 1) * (A / R) ** 2) - 1)[:, None]
        driven = inner
    else:
        u = exact(problem.V.tabulate_dof_coordinates().T).T
        driven = np.concatenate([inner, outer])
    fixed: list[Held] = [(2 * left, 0.0), (2 * low + 1, 0.0)]
    for component, plane in ((0, left), (1, low)):
        free = np.setdiff1d(driven, plane)
        fixed += held(2 * free + component, u[free, component])
    solver = FreeSolver(problem, NOTHING, 1.0, 1e-9, fixed)
    problem.w.x.array[:] = u.ravel()
    solver.start()
    solver.solve()
    return Tube(problem, inner, X)


def polygon(divisions: int) -> tuple[float, str]:
    """Return a tolerance of pressures and where it comes from."""
    return (np.pi / 2 / divisions) ** 2, "the square of the angle that a straight facet spans"


def inflation(small: bool) -> Outcome:
    """Pressure and outer radius of a tube whose outer surface is free, at nu = 0.48 and towards 1/2."""
    meshes = (4, 8, 16) if small else (8, 16, 32)
    n, mesh, most = meshes[-1], f"P2-P1, {meshes[-1]} × {meshes[-1]} × 2 triangles", WIDENED[-1]
    tolerance, why = polygon(n)
    pressures, rows = {}, []
    for nu in (0.48, 0.49999):
        found = []
        for widened in WIDENED[-1:] if small else WIDENED:
            exact, tube = exact_tube(nu, widened), widen("P2-P1", n, nu, widened)
            pressures[nu, widened] = exact.pressure, tube.pressure
            quantity = f"inner pressure, nu = {nu:g}, a/A = {widened:g} (kPa)"
            found.append(Row(quantity, tube.pressure / 1e3, exact.pressure / 1e3, tolerance, f"{why}: order 2", mesh))
        reference = float(exact.radius(np.array([B]))[0])
        errors = [abs(widen("P2-P1", k, nu, most).pressure / exact.pressure - 1) for k in meshes[:-1]]
        errors.append(found[-1].error)
        order = orders.observed(errors)
        moved = (tube.outer_radius - B) * 1e3, (reference - B) * 1e3
        quantity = f"outer surface's displacement, nu = {nu:g}, a/A = {most:g} (mm)"
        rows += [
            replace(worst(found), order=order),
            Row(
                f"order of the pressure, nu = {nu:g}", order, 2.0, 0.1, "not yet asymptotic", mesh, order, absolute=True
            ),
            Row(quantity, *moved, tolerance, why, mesh),
        ]
    limit = pressure_of_incompressible(most)
    short = [1 - exact_tube(nu, most).pressure / limit for nu in (0.4999, 0.49999)]
    quantity, why = (
        "order in 1 - 2 nu of what shooting is short of the closed form",
        "the next order: the exponent times 1 - 2 nu = 2e-4",
    )
    rows.append(Row(quantity, float(np.log10(short[0] / short[1])), 1.0, -ALPHA * 2e-4, why, absolute=True))
    ours, compressible = pressures[0.49999, most][1], -ALPHA * 2e-5
    quantity = f"inner pressure, nu = 0.49999, a/A = {most:g}, against the incompressible closed form (kPa)"
    why = f"{polygon(n)[1]}, and the change of volume, some 1 - 2 nu, times the exponent"
    rows.append(Row(quantity, ours / 1e3, limit / 1e3, tolerance + compressible, why, mesh))

    x = np.linspace(1.02, most, 15)
    known = {
        "incompressible, closed form": (x, [pressure_of_incompressible(k) / 1e3 for k in x]),
        "ν = 0.48, by shooting": (x, [exact_tube(0.48, k).pressure / 1e3 for k in x]),
    }
    computed: dict[str, tuple[Array, Array]] = {}
    for nu in (0.48, 0.49999):
        k, p = np.array([(k, p / 1e3) for (given, k), (_, p) in pressures.items() if given == nu]).T
        computed[f"ν = {nu:g}"] = (k, p)
    return Outcome(tuple(rows), Curves("a / A (–)", "inner pressure (kPa)", known, computed))


def convergence(small: bool) -> Outcome:
    """Errors of the field where the exact solution is prescribed on both surfaces, nu = 0.48."""
    meshes = (4, 8, 16) if small else (4, 8, 16, 32)
    exact = exact_tube(0.48, WIDENED[-1])

    def errors(element: str, n: int) -> tuple[float, float]:
        return orders.relative_errors(widen(element, n, 0.48, WIDENED[-1], exact).problem.w, exact)

    found = {e: [errors(e, n) for n in meshes] for e in (("P2-P1",) if small else ("P1", "P2", "P2-P1"))}
    rows = orders.rows(found, meshes, 0.1, "not yet asymptotic")
    return Outcome(tuple(rows), orders.curves(found, meshes))


CASES = (
    Case("Inflated tube", f"{_OGDEN}: shooting, and the incompressible tube by quadrature", inflation),
    Case("Tube, exact on both surfaces", f"{_OGDEN}: shooting; orders p + 1 and p", convergence),
)
