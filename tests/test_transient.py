"""Pseudo-transient continuation over the edge of an equilibrium: a charged spring whose skin is torn off."""

import numpy as np
import pytest
from mpi4py import MPI
from scipy.optimize import brentq

from tests import spring
from variational.solvers.equations import Control
from variational.solvers.transient import EulerShift


def height(solver) -> float:
    """Return the mean height of the skin (m)."""
    problem = solver.problem
    nodes = solver.equations.skin[1] // 2
    y = problem.V.tabulate_dof_coordinates()[nodes, 1] + problem.displacement()[nodes, 1]
    return float(np.mean(np.concatenate(MPI.COMM_WORLD.allgather(y))))


@pytest.mark.mpi
@pytest.mark.parametrize("raised", [1e-9, 1e-8, 1e-7])
def test_skin_is_torn_off_at_the_kink_of_the_attraction(raised):
    """The last equilibrium with the skin near the screen has it at d_eq, where attraction turns from constant to steep.

    With the bone a little higher there is none near by: beyond d_eq the stiffness is negative up to the fold. The skin
    ends on the other side of the fold, where its height is the closed form's to the height's own roundoff and the
    block's bending, a thousandth.
    """
    solver = spring.charged()
    pull = spring.HALF / (spring.H_0 + spring.D_EQ) ** 2
    stretch = brentq(lambda s: spring.stress(s) - pull, 0.9, 1.1, xtol=1e-15)
    kink = spring.D_EQ + (stretch - 1) * spring.HEIGHT - spring.GAP
    x = solver.problem.V.tabulate_dof_coordinates()
    skin, bone = spring.D_EQ - 1e-7 - spring.GAP, kink - 1e-7
    u = np.stack([0 * x[:, 0], skin + (bone - skin) * (x[:, 1] - spring.GAP) / spring.HEIGHT], axis=1)
    solver.set_displacement(u, np.array([0.0, bone]))
    solver.control = Control(0.0, bone)
    solver.solve()
    assert 0 < height(solver) < spring.D_EQ
    bone = kink + raised
    solver.control = Control(0.0, bone)
    solver.solve(pseudo_transient=True)

    def imbalance(y: float) -> float:
        return spring.stress(1 + (bone + spring.GAP - y) / spring.HEIGHT) - spring.HALF / (spring.H_0 + y) ** 2

    assert height(solver) == pytest.approx(brentq(imbalance, spring.FOLD, spring.GAP, xtol=1e-15), rel=1e-3)
    assert solver.counts.pseudo_transient >= 1


@pytest.mark.mpi
def test_shift_is_twice_a_negative_stiffness():
    """A step along a stiffness of -3e9 Pa/m at a shift of 2e9 Pa/m is uphill; the next shift is 6e9, not 4e9 Pa/m."""
    solver = spring.charged()
    equations, shift = solver.equations, EulerShift(solver.equations)
    x, step, f = (solver.layout.create_vector() for _ in range(3))
    rows = equations.local(equations.prescribed_rows())
    step.array_w[:] = 1e-9
    for own in (rows, equations.local(equations.layout.rigid_rows) if equations.layout.owns_rigid else rows):
        step.array_w[own] = 0.0
    mass = solver.layout.create_matrix()
    solver.layout.add_to_matrix(mass, solver.problem.skin_mass, (0, 0))
    mass.assemble()
    mass.mult(step, f)
    f.array_w[rows] = 0.0
    shift.begin(x)
    eta = float(solver.problem.eta.value)
    f.scale(-eta / 2)
    assert shift.leads_uphill(f, f.norm(), step)
    shift.adapt(x, f, f.norm())
    assert float(solver.problem.eta.value) == pytest.approx(3 * eta, rel=1e-9)
    solver.problem.eta.value = 0.0
