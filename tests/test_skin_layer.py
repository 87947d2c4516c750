"""The layer of elements next to the screen, brought into balance by itself, on any number of ranks."""

import numpy as np
import pytest
from mpi4py import MPI

from geometry.bodies import ridge
from geometry.mesh import load
from tests.test_contact import MU_F, make
from tests.test_newton import walk
from variational.solvers.equations import Control

pytestmark = pytest.mark.mpi

PRESS = [Control(0.0, -10e-6 * k) for k in (1, 2, 3, 4)]
SLIDE = [Control(20e-6 * k, -40e-6) for k in (1, 2, 3)]


@pytest.fixture(scope="module")
def body():
    return load(MPI.COMM_WORLD, ridge(20e-6))


@pytest.fixture
def pressed(body):
    """A solver in equilibrium with a layer, its layer, and an iterate whose layer is out of balance by 0.1 um."""
    solver = make(body, MU_F, eps_t=5e10)
    walk(solver, PRESS)
    layer, x = solver.iteration._layer, solver.x.copy()
    rng = np.random.default_rng(MPI.COMM_WORLD.rank)
    x.array_w[layer._rows] += 1e-7 * rng.uniform(-1, 1, len(layer._rows))
    return solver, layer, x


def total(part) -> float:
    """Return the norm of a vector of which each rank has a part."""
    return float(np.sqrt(MPI.COMM_WORLD.allreduce(float(part @ part))))


def test_forms_of_the_layer_are_the_rows_of_the_whole(pressed):
    """Residual and tangent, in the layer's rows and columns. Tolerance: roundoff of the sums, of the largest entry."""
    solver, layer, x = pressed
    equations, tangent, rows = solver.equations, solver.iteration.tangent, layer._rows
    whole, part = x.duplicate(), x.duplicate()
    equations.residual(x, part, layer._residual)
    layer._iterate(layer._ksp, x.copy(), part, np.inf)  # assembles the tangent at the iterate it starts from
    equations.residual(x, part, layer._residual)
    equations.residual(x, whole)
    assert total((part.array_r - whole.array_r)[rows]) < 1e-12 * total(whole.array_r[rows])
    tangent.stale = True
    tangent.update(None, x, tangent.relative, tangent.matrix)
    direction, product = tangent.matrix.createVecs()
    small, found = layer._K.createVecs()
    some = np.random.default_rng(MPI.COMM_WORLD.rank).uniform(-1, 1, len(rows))
    direction.array_w[rows], small.array_w[:] = some, some
    tangent.matrix.mult(direction, product)
    layer._K.mult(small, found)
    assert total(found.array_r - product.array_r[rows]) < 1e-12 * total(product.array_r[rows])


def test_balance_moves_the_layer_alone(pressed):
    """Its residual falls to what was asked for; everything else stays where it was, to the last bit."""
    solver, layer, x = pressed
    before, f = x.array_r.copy(), x.duplicate()
    solver.equations.residual(x, f)
    first = total(f.array_r[layer._rows])
    layer.balance(x, f, 1e-9 * first, np.inf)
    solver.equations.residual(x, f)
    assert total(f.array_r[layer._rows]) <= 1e-9 * first
    rest = np.delete(x.array_r - before, layer._rows)
    assert not rest.any()
    assert total(x.array_r - before) > 0


@pytest.mark.slow
def test_equilibrium_is_the_same_without_the_layer(body):
    """With it fewer factorisations lead there. Tolerance: the solve's, 1e-9 N/m over the tangent's stiffness."""
    states, factorisations = [], []
    for with_layer in (True, False):
        solver = make(body, MU_F, eps_t=5e10)
        solver.iteration._layer = solver.iteration._layer if with_layer else None
        walk(solver, PRESS + SLIDE)
        states.append(solver.x.array_r.copy())
        factorisations.append(solver.counts.factorisations)
    assert total(states[1] - states[0]) < 1e-8 * total(states[0])
    assert factorisations[0] < 0.8 * factorisations[1]
