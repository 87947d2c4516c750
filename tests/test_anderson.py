"""Anderson acceleration of an iteration with a kept factorisation, on any number of ranks."""

import numpy as np
import pytest
from mpi4py import MPI

from variational.solvers.tangent import Anderson

pytestmark = pytest.mark.mpi

SIZE, RANK = 60, 3
ROWS = np.array_split(np.arange(SIZE), MPI.COMM_WORLD.size)[MPI.COMM_WORLD.rank]


@pytest.fixture
def linear():
    """Return a matrix, a right-hand side and the matrix kept: the other without a part of rank three."""
    rng = np.random.default_rng(0)
    kept = np.diag(rng.uniform(1, 2, SIZE))
    change = 0.3 * np.linalg.qr(rng.normal(size=(SIZE, RANK)))[0]
    return kept + change @ change.T * 8, rng.normal(size=SIZE), kept


def norms(linear, accelerated: bool) -> list[float]:
    """Return the residuals' norms of an iteration; each rank has its rows of the vectors."""
    matrix, right, kept = linear
    x, found, anderson = np.zeros(SIZE), [], Anderson(MPI.COMM_WORLD)
    for _ in range(9):
        r = matrix @ x - right
        found.append(float(np.linalg.norm(r)))
        step = np.linalg.solve(kept, r)
        more = anderson.correction(x[ROWS], r[ROWS], step[ROWS]) if accelerated else None
        if more is not None:
            step += np.concatenate(MPI.COMM_WORLD.allgather(more))
        x = x - step
    return found


def test_change_of_low_rank_is_learnt(linear):
    """A kept matrix that lacks three directions is made good by three differences; the plain iteration goes on slowly.

    Tolerance: roundoff of the least squares, and their share that counts as dependent, 1e-8.
    """
    plain, accelerated = norms(linear, False), norms(linear, True)
    assert accelerated[RANK + 2] < 1e-6 * accelerated[0]
    assert plain[RANK + 2] > 1e-3 * plain[0]


def test_differences_of_another_factorisation_are_forgotten(linear):
    """With a new factorisation the first step is the plain one."""
    anderson, (matrix, right, kept) = Anderson(MPI.COMM_WORLD), linear
    first, second = right[ROWS], (kept @ right)[ROWS]
    anderson.correction(first, first, first)
    assert anderson.correction(second, first, second) is None, "a residual that stayed is no difference"
    assert anderson.correction(first, second, (matrix @ right)[ROWS]) is not None
    anderson.forget()
    assert anderson.correction(second, first, first) is None


def test_no_difference_is_drawn_between_other_equations(linear):
    """An interruption leaves out the difference that would mix two loads, and keeps the ones before."""
    anderson, (_, right, kept) = Anderson(MPI.COMM_WORLD), linear
    first, second = right[ROWS], (kept @ right)[ROWS]
    assert anderson.correction(first, first, first) is None
    anderson.interrupt()
    assert anderson.correction(second, second, second) is None
    assert anderson.correction(first, first, second) is not None
