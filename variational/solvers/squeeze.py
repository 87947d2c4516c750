r"""Skin that is in the screen, moved out of it: a first guess for a body whose surface was known only roughly.

Where the skin's current height :math:`y_s(x)` is below :math:`-d`, it and what is above it are moved up by

.. math:: (-d - y_s(x)) \, \langle 1 - \frac{y - y_s(x)}{\ell} \rangle_+

so that contact begins with a depth d and the material above is compressed evenly over a height :math:`\ell`, far
larger than the move. It is a change of the guess alone, no part of any equation.
"""

import numpy as np
from dolfinx import fem

from variational.solvers.newton import Solver


def squeeze(solver: Solver, depth: float, reach: float) -> None:
    """Move skin that is in the screen out of it, and what is above it less and less; collective.

    Args:
        solver: whose unknowns are changed.
        depth: d, how deep the skin stays (m).
        reach: l, height over which the body is compressed (m).
    """
    problem = solver.problem
    u = problem.displacement()
    now = problem.V.tabulate_dof_coordinates()[:, :2] + u
    nodes = fem.locate_dofs_topological(problem.V, 1, problem.surface.facets)
    skin = np.concatenate(problem.mesh.comm.allgather(now[nodes]))
    skin = skin[np.argsort(skin[:, 0])]
    floor = np.interp(now[:, 0], skin[:, 0], skin[:, 1], left=np.inf, right=np.inf)
    move = np.where(floor < -depth, -depth - floor, 0.0)
    over = np.where(move > 0, np.maximum(now[:, 1] - floor, 0.0), 0.0)
    u[:, 1] += move * np.maximum(1 - over / reach, 0.0)
    solver.set_displacement(u, solver.bone)
