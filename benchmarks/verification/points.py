"""The package's laws at any number of given deformation gradients: one to a cell of a mesh that is only a list."""

from typing import Any, NamedTuple

import numpy as np
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI
from numpy.typing import NDArray

from variational import compat, jit
from variational.materials import stress
from variational.materials.material import Material

Array = NDArray[np.float64]


class Evaluation(NamedTuple):
    """W (n,), P (n, 2, 2), sigma (n, 3, 3) and dP/dF (n, 2, 2, 2, 2), in Pa."""

    density: Array
    P: Array
    sigma: Array
    tangent: Array


class Points:
    """Energy, stresses and tangent of a law; compiled once. Each rank evaluates all points by itself."""

    def __init__(self, solid: Material) -> None:
        """Compile the law; its numbers are replaced at each evaluation."""
        self._mesh = mesh.create_unit_square(MPI.COMM_SELF, 8, 8)
        self._cells = np.arange(128, dtype=np.int32)

        def field(*shape: int) -> fem.Function:
            return fem.Function(fem.functionspace(self._mesh, ("Discontinuous Lagrange", 0, shape)))

        self._F, self._parameters = field(2, 2), [field() for _ in solid.names()]
        made = solid.with_values(dict(zip(solid.names(), self._parameters, strict=True)))
        F = ufl.variable(self._F)
        P = stress.first_piola_kirchhoff(made, F)
        parts: list[Any] = [made.density(F), P, stress.cauchy(made, F), ufl.diff(P, F)]
        entries = [part[index] if index else part for part in parts for index in np.ndindex(part.ufl_shape)]
        centre = np.array([[1 / 3, 1 / 3]])
        self._compiled = fem.Expression(ufl.as_vector(entries), centre, jit_options=jit.OPTIONS)

    def __call__(self, F: Array, *parameters: Any) -> Evaluation:
        """Evaluate.

        Args:
            F: deformation gradients, (n, 2, 2).
            parameters: its numbers in the order of the law's names, each a number or of shape (n,).
        """
        results = []
        for start in range(0, len(F), len(self._cells)):
            part = slice(start, start + len(self._cells))
            count = len(F[part])
            self._F.x.array[:] = np.tile(np.eye(2).ravel(), len(self._cells))
            self._F.x.array[: 4 * count] = F[part].ravel()
            for function, value in zip(self._parameters, parameters, strict=True):
                function.x.array[:] = 1.0
                function.x.array[:count] = np.broadcast_to(value, (len(F),))[part]
            results.append(compat.evaluate_on_cells(self._compiled, self._mesh, self._cells)[:count])
        found, n = np.concatenate(results), len(F)
        W, P, sigma, tangent = np.split(found, (1, 5, 14), axis=1)
        shapes = P.reshape(n, 2, 2), sigma.reshape(n, 3, 3), tangent.reshape(n, 2, 2, 2, 2)
        return Evaluation(W[:, 0], *shapes)
