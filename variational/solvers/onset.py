r"""Where full slip begins: the state at the end of a step that went beyond it, translated back.

The screen is uniform. Once every point in contact slips, the body moves on as a rigid one. So the state at the end of
a step was reached before that end, in the place where the last point began to slip. With the anchors s of friction
before and after the step (:mod:`~variational.contact.return_mapping`) that place is

.. math:: \min_{p_n > 0} |s_{n+1} - s_n|

behind the end. Tractions, pressures and shape are those at the end; the last point is at the limit of friction without
slip, and every other point has slipped: a solution of the same equations. The end of a slide until full slip, and the
work of friction up to it, therefore do not depend on how far the last step went.
"""

from typing import TYPE_CHECKING

import numpy as np
from mpi4py import MPI

if TYPE_CHECKING:
    from variational.quantities import Observer
    from variational.solvers.newton import Solver

_LEFT = 1e-9  # part of the way back that is left, so that the last point stays at the limit of friction


def return_to_onset(solver: "Solver", observer: "Observer", way: float) -> float:
    """Translate a body in full slip back to where full slip began in the present step; collective.

    Args:
        solver: at the end of a step in which the bone alone moved, and that sideways; not accepted yet.
        observer: of its surface.
        way: how far the bone moves with the load (m), below zero towards x < 0.

    Returns:
        How far the body was translated (m); 0 where it does not slip everywhere, or where it is no equilibrium there,
        since something else than the screen and the bone holds it.
    """
    direction, state = float(np.sign(way)), observer.state()
    if not observer.slip(state)[1]:
        return 0.0
    slip = direction * (state.anchor - solver.problem.history.imposed["anchor"])
    least = float(np.min(slip, where=state.p_n > 0, initial=np.inf))
    back = (1 - _LEFT) * max(solver.layout.comm.allreduce(least, op=MPI.MIN), 0.0)
    forces = solver.iteration.f
    allowed = solver.iteration.tolerance + 2 * forces.norm()
    solver.slide(-direction * back)
    solver.equations.residual(solver.x, forces)
    if forces.norm() <= allowed:
        return back
    solver.slide(direction * back)
    solver.equations.residual(solver.x, forces)
    return 0.0
