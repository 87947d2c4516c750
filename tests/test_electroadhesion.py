"""The attraction has the resultants of Eq. 3 and derives from its potential."""

import numpy as np
import pytest
import ufl
from dolfinx import fem
from mpi4py import MPI

from geometry.bodies import block
from geometry.mesh import load
from tests.test_problem import EPS_0, H_0, VOLTAGE, make, rates, residual
from variational.problem import Problem
from variational.resultants import Observer


def attraction(problem):
    """Return the attraction's part of the residual, what the voltage adds, shape (nodes, 2)."""
    problem.voltage.value = 0.0
    without = residual(problem)
    problem.voltage.value = VOLTAGE
    return (residual(problem) - without).reshape(-1, 2)


def traction(problem):
    """Return - int p_el cof F N . v dS, Eq. 3 on the deformed skin, shape (nodes, 2)."""
    problem.voltage.value = VOLTAGE
    v = ufl.TestFunction(problem.V)
    form = fem.form(-problem.p_el * ufl.dot(problem.area, v) * problem.surface.measure)
    return fem.assemble_vector(form).array.reshape(-1, 2).copy()


def tilted(cells: int, low: float, high: float) -> Problem:
    """Return a block with its bottom on a slope between two heights."""
    body = load(MPI.COMM_SELF, block(1e-3, 0.25e-3, 1e-3 / cells))
    problem = make(body)
    problem.w.interpolate(lambda x: np.stack([0.1 * x[0], low + (high - low) * (x[0] / 1e-3 + 0.5)]))
    return problem


def end_potentials(problem):
    """Return rows of the bottom's two end nodes and the potential there."""
    x = problem.V.tabulate_dof_coordinates()
    ends = [int(np.argmin(np.hypot(x[:, 0] - side * 0.5e-3, x[:, 1]))) for side in (-1, 1)]
    y = x[ends, 1] + problem.w.x.array.reshape(-1, 2)[ends, 1]
    outside = -EPS_0 * VOLTAGE**2 / 2 / (H_0 + y)
    return ends, outside


def test_attraction_on_a_slope():
    """Over a slope above d_eq the downward resultant is eps_0 U^2 / 2 (1/(h_0 + y_0) - 1/(h_0 + y_1)) L / (y_1 - y_0).

    L is the current projected length. Tolerance: the quadrature, of order eight, leaves 1.5e-9 on 16 facets.
    """
    low, high = 3e-6, 20e-6
    problem = tilted(16, low, high)
    closed = EPS_0 * VOLTAGE**2 / 2 * (1 / (H_0 + low) - 1 / (H_0 + high)) * 1.1e-3 / (high - low)
    assert attraction(problem)[:, 1].sum() == pytest.approx(closed, rel=5e-9)


def test_attraction_is_the_traction():
    """The potential's derivative is -int p_el cof F N . v dS node by node, and the potential at the skin's ends.

    The two differ by the quadrature of a total derivative, with 4 Gauss points of order 8 in the facets' size: by
    2e-11 of the largest force on the finest mesh. Rates are held to half that order.
    """
    errors = []
    for cells in (8, 16, 32):
        problem = tilted(cells, 5e-6, 5e-6)
        problem.w.interpolate(
            lambda x: np.stack([0.02e-3 * np.sin(4e3 * x[0]), 8e-6 + 4e-6 * np.sin(5e3 * x[0] + 0.3) - 0.05 * x[1]])
        )
        ends, potentials = end_potentials(problem)
        expected = traction(problem)
        expected[ends, 0] += np.array([-1, 1]) * potentials
        errors.append(np.abs(attraction(problem) - expected).max() / np.abs(expected).max())
    assert errors[-1] < 1e-10
    assert (rates(np.array(errors)) > 4).all()


# -- a ridge's resultant -------------------------------------------------------------------------------
def test_resultant_of_a_slope():
    """A ridge's downward force is p_el over the projected length, its horizontal one p_el over the rise.

    Closed forms as above, the second 1/65 of the first. Tolerance: the quadrature, as above.
    """
    left, right = 20e-6, 3e-6
    problem = tilted(16, left, right)
    problem.voltage.value = VOLTAGE
    loads = Observer(problem).ridge_loads()
    over_the_rise = EPS_0 * VOLTAGE**2 / 2 * (1 / (H_0 + left) - 1 / (H_0 + right))
    assert loads.f_attraction[0] == pytest.approx(over_the_rise * 1.1e-3 / (right - left), rel=5e-9)
    assert loads.f_attraction_x[0] == pytest.approx(over_the_rise, rel=5e-9)
