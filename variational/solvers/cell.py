"""A cell whose lateral faces are carried by its neighbours: they move sideways with the bone, and freely up and down.

In normal contact that is the symmetry of one of many equal ridges. In sliding it leaves out the shear of the column on
which the ridge stands, which a model of the whole body has of its own.
"""

import numpy as np
from dolfinx import fem
from numpy.typing import NDArray

from variational.problem import Problem
from variational.solvers.newton import Solver


class CellSolver(Solver):
    """Prescribes, in place of fixed values, the bone's translation in x."""

    def _prescribed(self) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        self._fixed_values[:] = self.control.x
        return super()._prescribed()


def carried(
    problem: Problem,
    rim: NDArray[np.int32],
    sides: NDArray[np.int32],
    force_scale: float,
    tolerance: float = 1e-9,
) -> CellSolver:
    """Return the solver of a cell.

    Args:
        problem: forms.
        rim: facets glued to the bone.
        sides: facets of the lateral faces.
        force_scale: force per length (N/m) in which residuals are measured.
        tolerance: see :class:`variational.solvers.newton.Solver`.
    """
    on_rim, on_sides = (fem.locate_dofs_topological(problem.V, 1, facets) for facets in (rim, sides))
    return CellSolver(problem, rim, force_scale, tolerance, [(2 * np.setdiff1d(on_sides, on_rim), 0.0)])
