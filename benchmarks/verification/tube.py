r"""A tube of Ogden's solid in plane strain, widened from inside: pressure and displacement.

With r(R) the radius to which R moves, :math:`\lambda_r = r'`, :math:`\lambda_\theta = r / R` and
:math:`\lambda_z = 1`, equilibrium is

.. math:: \frac{dP_r}{dR} + \frac{P_r - P_\theta}{R} = 0, \qquad r(A) = a, \quad P_r(B) = 0

(Ogden, Non-linear Elastic Deformations, 1984, chapter 5), an initial value problem for r and lambda_r, of which the
second's value at A is shot for. An incompressible tube has :math:`r^2 = R^2 + a^2 - A^2`, and with
:math:`\hat W(\lambda) = W(1/\lambda, \lambda, 1)` the inner pressure

.. math:: p = \int_{\lambda_b}^{\lambda_a} \frac{\hat W'(\lambda)}{\lambda^2 - 1} \,d\lambda.

The computed tube is a quarter of straight-sided triangles: where its outer surface is free, the missing slivers of the
wall are an error of the second order in the triangles' size. With the exact displacement prescribed on both surfaces
the element's order shows. The computed pressure is the resultant of the forces at the inner nodes.
"""

from dataclasses import replace
from functools import cache

import numpy as np
from dolfinx import fem
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

from benchmarks.verification import constitutive
from benchmarks.verification.bodies import (
    NOTHING,
    Array,
    FreeSolver,
    Held,
    body,
    field_orders,
    free_problem,
    nodal_forces,
    relative_errors,
)
from benchmarks.verification.case import Case, Row, order, order_row, worst
from geometry import tags
from geometry.bodies import quarter_tube
from variational.materials.ogden import Ogden

A, B, AXIS = 1e-3, 2e-3, 4e-3  # m: inner and outer radius, height of the axis
SHEAR, ALPHA = 86.76e3, -14.53  # the stratum corneum's, in Pa and as printed
WIDENED = (1.05, 1.1, 1.2, 1.3)  # a / A
_OGDEN = "Ogden 1984, Non-linear Elastic Deformations, chapter 5"


# -- exact solutions -----------------------------------------------------------------------------------
def _incompressible_stretch(widened: float, R):
    return np.sqrt(1 + (widened**2 - 1) * (A / R) ** 2)


def pressure_of_incompressible(widened: float) -> float:
    """Return the inner pressure (Pa) at a / A, by quadrature."""
    a = -ALPHA

    def integrand(x: float) -> float:
        return 2 * SHEAR / a * (x ** (a - 1) - x ** (-a - 1)) / (x**2 - 1)

    return float(quad(integrand, _incompressible_stretch(widened, B), widened, epsabs=0, epsrel=1e-12)[0])


class Exact:
    """The compressible tube's radius and stress, by shooting."""

    def __init__(self, poisson: float, widened: float) -> None:
        """Find the radial stretch at the inner surface."""
        self.solid, self.inner = constitutive.skin("SC", SHEAR, ALPHA, poisson, -1), widened * A

        def outer_stress(start: float) -> float:
            r, stretch = self._integrate(start, (A, B)).y[:, -1]
            return self._stress(stretch, r / B)

        # No volume change, but for a tenth: the stress grows with the stretch.
        start = brentq(outer_stress, 0.93 / widened, 1.1 / widened, xtol=1e-15, rtol=1e-14)
        self._out = self._integrate(start, (A, B))
        self._in = self._integrate(start, (A, 0.9 * A))  # chords of the inner circle are within it
        self.pressure = -self._stress(start, widened) / widened  # on the current area

    def _stress(self, radial: float, hoop: float) -> float:
        return float(constitutive.nominal(self.solid, (radial, hoop, 1.0))[0])

    def _slope(self, R: float, y: Array) -> list[float]:
        r, radial = y
        hoop = r / R
        P = constitutive.nominal(self.solid, (radial, hoop, 1.0))
        dP = constitutive.moduli(self.solid, (radial, hoop, 1.0))[0]
        return [radial, -(P[0] - P[1] + dP[1] * (radial - hoop)) / (R * dP[0])]

    def _integrate(self, start: float, span: tuple[float, float]):
        method = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-16, "dense_output": True}
        return solve_ivp(self._slope, span, [self.inner, start], **method)

    def radius(self, R: Array) -> Array:
        """Return r (m) at R (m) anywhere in the wall and a little within it."""
        return np.where(R < A, self._in.sol(np.minimum(R, A))[0], self._out.sol(np.maximum(R, A))[0])

    def __call__(self, x: Array) -> Array:
        """Return the displacement (m), shape (2, n), at points (m), shape (3, n)."""
        X = x[:2] - np.array([[0.0], [AXIS]])
        R = np.hypot(*X)
        return X * (self.radius(R) / R - 1)


exact_tube = cache(Exact)


# -- computed ------------------------------------------------------------------------------------------
def widen(
    element: str, divisions: int, poisson: float, widened: float, exact: Exact | None = None
) -> tuple[fem.Function, float, float]:
    """Solve for a quarter of the tube, its outer surface free or, with ``exact``, both surfaces displaced by it.

    Returns:
        displacement (m), inner pressure (Pa of current area) and the outer surface's displacement (m).
    """
    made = body(quarter_tube(A, B, divisions))
    problem = free_problem(made, {tags.STRATUM_CORNEUM: Ogden(SHEAR, ALPHA, poisson)}, element)
    points = problem.V.tabulate_dof_coordinates()
    X = points[:, :2] - [0.0, AXIS]
    surfaces = (made.facet_tags.find(tag) for tag in (tags.BONE_RIM, tags.ridge(0)))
    inner, outer = (np.asarray(fem.locate_dofs_topological(problem.V, 1, facets)) for facets in surfaces)
    if exact is None:
        # Nodes amid a straight facet are within the circle: they move as those of an incompressible tube do.
        u, driven = X * (_incompressible_stretch(widened, np.linalg.norm(X, axis=1)) - 1)[:, None], inner
    else:
        u, driven = exact(points.T).T, np.concatenate([inner, outer])
    fixed: list[Held] = []
    for k in (0, 1):  # symmetry
        plane = np.flatnonzero(np.abs(X[:, k]) < 1e-9).astype(np.int32)
        fixed.append((2 * plane + k, 0.0))
        fixed += [(np.array([2 * node + k], np.int32), float(u[node, k])) for node in np.setdiff1d(driven, plane)]
    problem.w.x.array[:] = u.ravel()
    FreeSolver(problem, NOTHING, 1.0, 1e-9, fixed).solve_from_fields()

    moved, at = problem.w.x.array.reshape(-1, 2), X[inner]
    radius = np.linalg.norm(at + moved[inner], axis=1).mean()
    outwards = at / np.linalg.norm(at, axis=1)[:, None]
    pressure = (nodal_forces(problem)[inner] * outwards).sum() / (np.pi / 2 * radius)
    end = int(np.argmin(np.hypot(X[:, 0] - B, X[:, 1])))
    return problem.w, float(pressure), float(moved[end, 0])


def inflation(small: bool) -> list[Row]:
    """Pressure and outer radius of a tube whose outer surface is free, at nu = 0.48 and towards 1/2."""
    meshes = (4, 8, 16) if small else (8, 16, 32)
    n, mesh, most = meshes[-1], f"P2-P1, {meshes[-1]} × {meshes[-1]} × 2 triangles", WIDENED[-1]
    tolerance, why = (np.pi / 2 / n) ** 2, "the square of the angle that a straight facet spans"
    rows: list[Row] = []
    for nu in (0.48, 0.49999):
        found = []
        for widened in WIDENED[-1:] if small else WIDENED:
            exact, (_, pressure, end) = exact_tube(nu, widened), widen("P2-P1", n, nu, widened)
            quantity = f"inner pressure, nu = {nu:g}, a/A = {widened:g} (kPa)"
            found.append(Row(quantity, pressure / 1e3, exact.pressure / 1e3, tolerance, f"{why}: order 2", mesh))
        errors = [widen("P2-P1", k, nu, most)[1] / exact.pressure - 1 for k in meshes[-2:-1]]
        observed = order([*errors, found[-1].error], meshes[-2:])
        moved = end * 1e3, (float(exact.radius(np.array([B]))[0]) - B) * 1e3
        rows += [
            replace(worst(found), order=observed),
            order_row(f"order of the pressure, nu = {nu:g}", observed, 2.0, 0.1, "not yet asymptotic", mesh),
            Row(f"outer surface's displacement, nu = {nu:g}, a/A = {most:g} (mm)", *moved, tolerance, why, mesh),
        ]
    limit = pressure_of_incompressible(most)
    short = [1 - exact_tube(nu, most).pressure / limit for nu in (0.4999, 0.49999)]
    quantity = "order in 1 - 2 nu of what shooting is short of the closed form"
    next_order = "the next order: the exponent times 1 - 2 nu = 2e-4"
    rows.append(Row(quantity, float(np.log10(short[0] / short[1])), 1.0, -ALPHA * 2e-4, next_order, absolute=True))
    quantity = f"inner pressure, nu = 0.49999, a/A = {most:g}, against the incompressible closed form (kPa)"
    why, tolerance = f"{why}, and the change of volume, some 1 - 2 nu, times the exponent", tolerance - ALPHA * 2e-5
    return [*rows, Row(quantity, pressure / 1e3, limit / 1e3, tolerance, why, mesh)]


def convergence(small: bool) -> list[Row]:
    """Errors of the field where the exact solution is prescribed on both surfaces, nu = 0.48."""
    meshes, exact = (4, 8, 16) if small else (4, 8, 16, 32), exact_tube(0.48, WIDENED[-1])
    found = {
        e: [relative_errors(widen(e, n, 0.48, WIDENED[-1], exact)[0], exact) for n in meshes]
        for e in (("P2-P1",) if small else ("P1", "P2", "P2-P1"))
    }
    return field_orders(found, meshes, 0.1, "not yet asymptotic")


CASES = (
    Case("Inflated tube", f"{_OGDEN}: shooting, and the incompressible tube by quadrature", inflation),
    Case("Tube, exact on both surfaces", f"{_OGDEN}: shooting; orders p + 1 and p", convergence),
)
