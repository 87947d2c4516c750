"""Newton's homotopy: forces that balance a state are taken away part by part.

It leads from a state that is no equilibrium to one (Allgower and Georg 1990, doi 10.1007/978-3-642-61257-2).
"""

from typing import TYPE_CHECKING

from variational.solvers.failure import NotConverged

if TYPE_CHECKING:
    from variational.solvers.newton import Solver

_SMALLEST_PART = 1 / 8


def relax(solver: "Solver", part: float, skin: bool = False) -> None:
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
