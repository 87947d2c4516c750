"""Orders of convergence of a displacement field on finer and finer meshes."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import ufl
from dolfinx import fem, mesh
from numpy.typing import NDArray

from benchmarks.verification.case import Row, order, order_row
from variational import jit

Array = NDArray[np.float64]
DEGREES = {"P1": 1, "P2": 2, "P2-P1": 2, "P3": 3}  # of the displacement, by element
Errors = tuple[float, float]  # in L2 and H1


def norm(domain: mesh.Mesh, value: Any) -> float:
    """Return the L2 norm of a UFL expression, integrated to degree 10."""
    squared = ufl.inner(value, value) * ufl.dx(domain, metadata={"quadrature_degree": 10})
    return float(np.sqrt(fem.assemble_scalar(fem.form(squared, jit_options=jit.OPTIONS))))


def relative_errors(u: fem.Function, exact: Callable[[Array], Array]) -> Errors:
    """Return the errors of a displacement and of its gradient over the norms of the exact ones.

    The exact one is interpolated by polynomials of degree 6, cell by cell.
    """
    domain = u.function_space.mesh
    e = fem.Function(fem.functionspace(domain, ("Discontinuous Lagrange", 6, (2,))))
    e.interpolate(exact)
    gradients = norm(domain, ufl.grad(u - e)) / norm(domain, ufl.grad(e))
    return norm(domain, u - e) / norm(domain, e), gradients


def rows(errors: Mapping[str, Sequence[Errors]], meshes: Sequence[int], tolerance: float, why: str) -> list[Row]:
    """Return the orders on the last two meshes, p + 1 in L2 and p in H1 expected, by element."""
    made = []
    for element, found in errors.items():
        p = DEGREES[element]
        for name, expected, values in zip(("L2", "H1"), (p + 1, p), zip(*found, strict=True), strict=True):
            finest = f"{meshes[0]} to {meshes[-1]} divisions, last error {values[-1]:.1e}"
            observed = order(values[-2:], meshes[-2:])
            made.append(order_row(f"order in {name}, {element}", observed, expected, tolerance, why, finest))
    return made
