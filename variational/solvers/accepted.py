r"""How a state becomes one that is accepted: put back to the onset of slip, or balanced.

**Onset of full slip.** The screen is uniform. Once every point in contact slips, the body moves on as a rigid one. So
the state at the end of a step was reached before that end, in the place where the last point began to slip. With the
anchors s of friction before and after the step (:mod:`~variational.contact.formulation`) that place is

.. math:: \min_{p_n > 0} |s_{n+1} - s_n|

behind the end. Tractions, pressures and shape are those at the end; the last point is at the limit of friction without
slip, and every other point has slipped: a solution of the same equations. The end of a slide until full slip, and the
work of friction up to it, therefore do not depend on how far the last step went.

**Newton's homotopy** leads from a state that is no equilibrium to one: forces that balance it are taken away part by
part (Allgower and Georg 1990, doi 10.1007/978-3-642-61257-2).
"""

import numpy as np
from mpi4py import MPI

from variational.resultants import Observer
from variational.solvers.newton import Solver
from variational.solvers.outcome import NotConverged

_LEFT = 1e-9  # part of the way back that is left, so that the last point stays at the limit of friction
_SMALLEST_PART = 1 / 8  # of the forces that balance a state, taken away at a time


def return_to_onset(solver: Solver, observer: Observer, way: float) -> float:
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
    least = float(np.min(slip, where=state.touching, initial=np.inf))
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


def relax(solver: Solver, part: float, skin: bool = False) -> None:
    """Bring the solver's state into balance at frozen air gaps; collective.

    Args:
        solver: whose load is set.
        part: of the forces that is taken away at first.
        skin: hold the skin that can touch where it is.

    Raises:
        NotConverged: no equilibrium was found even with the smallest part.
    """
    equations = solver.equations
    equations.hold(solver.x, skin)
    try:
        while equations.load_part > 0:
            before, held = solver.x.array_r.copy(), equations.load_part
            equations.load_part = max(held - part, 0.0)
            try:
                solver.solve()
            except NotConverged:
                solver.x.array_w[:], equations.load_part, part = before, held, part / 2
                if part < _SMALLEST_PART:
                    raise
    finally:
        equations.release()
