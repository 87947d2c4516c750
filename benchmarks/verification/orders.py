"""Orders of convergence: the errors of a field on finer and finer meshes, as rows and as curves."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import ufl
from dolfinx import fem, mesh
from numpy.typing import NDArray

from benchmarks.verification.case import Curves, Row
from variational import jit

Array = NDArray[np.float64]
ELEMENTS = {"P1": 1, "P2": 2, "P2-P1": 2, "P3": 3}
"""Degrees of the displacement."""
Errors = Mapping[str, Sequence[tuple[float, float]]]
"""Of each element the errors in L2 and H1, mesh by mesh."""


def observed(errors: Sequence[float]) -> float:
    """Return the order between the last two of meshes each twice as fine as the one before."""
    return float(np.log2(errors[-2] / errors[-1]))


def norm(domain: mesh.Mesh, value: Any) -> float:
    """Return the L2 norm of a UFL expression, integrated to degree 10."""
    squared = ufl.inner(value, value) * ufl.dx(domain, metadata={"quadrature_degree": 10})
    return float(np.sqrt(fem.assemble_scalar(fem.form(squared, jit_options=jit.OPTIONS))))


def relative_errors(u: fem.Function, exact: Callable[[Array], Array]) -> tuple[float, float]:
    """Return the errors of a displacement and of its gradient over the norms of the exact ones.

    The exact one is interpolated by polynomials of degree 6, cell by cell.
    """
    domain = u.function_space.mesh
    e = fem.Function(fem.functionspace(domain, ("Discontinuous Lagrange", 6, (2,))))
    e.interpolate(exact)
    gradients = norm(domain, ufl.grad(u - e)) / norm(domain, ufl.grad(e))
    return norm(domain, u - e) / norm(domain, e), gradients


def rows(errors: Errors, meshes: Sequence[int], tolerance: float, why: str) -> list[Row]:
    """Return the observed orders, p + 1 in L2 and p in H1 expected."""
    made = []
    for element, found in errors.items():
        p = ELEMENTS[element]
        for name, expected, values in zip(("L2", "H1"), (p + 1, p), zip(*found, strict=True), strict=True):
            order = observed(values)
            finest = f"{meshes[0]} to {meshes[-1]} divisions, last error {values[-1]:.1e}"
            quantity = f"order in {name}, {element}"
            made.append(Row(quantity, order, expected, tolerance, why, finest, order, absolute=True))
    return made


def curves(errors: Errors, meshes: Sequence[int]) -> Curves:
    """Return the picture of the errors in L2 over divisions, with lines of the expected order through the last."""
    n = np.array(meshes)
    found = {element: (n, [pair[0] for pair in values]) for element, values in errors.items()}
    known = {
        f"order {ELEMENTS[element] + 1}": (n, values[-1][0] * (n[-1] / n) ** (ELEMENTS[element] + 1.0))
        for element, values in errors.items()
    }
    return Curves("divisions (–)", "displacement's relative error in L2", known, found, logarithmic=True)
