"""Orders of convergence: the errors of a field on finer and finer meshes, as rows and as a picture."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import ufl
from dolfinx import fem, mesh
from matplotlib.figure import Figure
from numpy.typing import NDArray

from benchmarks.verification.case import Row
from variational import jit

Array = NDArray[np.float64]
ELEMENTS = {"P1": 1, "P2": 2, "P2-P1": 2, "P3": 3}
"""Degrees of the displacement."""
_STYLES = dict(zip(ELEMENTS, ("o-", "s--", "D:", "^-."), strict=True))
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


def draw(figure: Figure, errors: Errors, meshes: Sequence[int]) -> None:
    """Draw errors over divisions, with lines of the expected order through the last."""
    axes = figure.subplots(1, 2, sharey=True)
    n = np.array(meshes)
    for k, (ax, name) in enumerate(zip(axes, ("L2", "H1"), strict=True)):
        for element, found in errors.items():
            values, expected = [pair[k] for pair in found], ELEMENTS[element] + 1 - k
            marker, line = _STYLES[element][0], _STYLES[element][1:]
            colour = f"C{list(ELEMENTS).index(element)}"
            ax.loglog(n, values, marker, mfc="none", color=colour, label=f"{element}, ours")
            ax.loglog(n, values[-1] * (n[-1] / n) ** expected, line, color=colour, label=f"order {expected}")
        ax.set_xticks(n, [str(count) for count in meshes])
        ax.minorticks_off()
        ax.set(xlabel="divisions", title=f"displacement in {name}")
        ax.legend(fontsize="small")
    axes[0].set_ylabel("relative error")
