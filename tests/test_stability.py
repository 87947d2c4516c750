"""Eigenvalues and inertia of states before and beyond pull-in, against a spring's closed form."""

import numpy as np
import pytest
from mpi4py import MPI
from petsc4py import PETSc
from scipy.optimize import brentq

from geometry.bodies import block
from geometry.mesh import load
from tests import spring
from tests.test_contact import HEIGHT, MU_F, VOLTAGE, WIDTH, make
from tests.test_element import layered
from variational.element import ELEMENTS
from variational.resultants import Observer
from variational.solvers.equations import Control
from variational.solvers.outcome import NotConverged
from variational.solvers.stability import StabilityCheck
from variational.solvers.transient import EulerShift

pytestmark = pytest.mark.mpi
BEFORE, BEYOND = 1.05, 0.95  # of (h_0 + y) at the fold
HEIGHTS = [part * (spring.FOLD + spring.H_0) - spring.H_0 for part in (1.5, BEFORE, 1.005, 0.995, BEYOND, 0.85)]


@pytest.fixture(scope="module")
def solver():
    return spring.charged()


def negative_pivots(solver) -> int:
    """Count the negative eigenvalues of a symmetric tangent, by LDL^T of MUMPS; collective."""
    K = StabilityCheck(solver)._tangent(0.0, solver.equations.prescribed_rows())
    K = K.convert(PETSc.Mat.Type.AIJ, PETSc.Mat())  # a copy, which Cholesky's factorisation takes
    assert K.isSymmetric(1e-9 * K.norm(PETSc.NormType.INFINITY))
    K.setOption(PETSc.Mat.Option.SYMMETRIC, True)
    pc = PETSc.PC().create(K.comm)
    pc.setOperators(K)
    pc.setType(PETSc.PC.Type.CHOLESKY)
    pc.setFactorSolverType(PETSc.Mat.SolverType.MUMPS)
    pc.setFactorSetUpSolverType()
    factors = pc.getFactorMatrix()
    factors.setMumpsIcntl(13, 1)  # the last front on one rank, whose pivots are counted
    factors.setMumpsIcntl(24, 1)  # null pivots, too
    pc.setUp()
    return int(factors.getInertia()[0])


@pytest.mark.parametrize("y", HEIGHTS)
def test_least_eigenvalue_of_a_spring(solver, y):
    """With the skin flat at height y it is k - p_el', positive above the fold and negative on the middle branch.

    There is one negative pivot then: the skin as a whole is drawn to the screen.

    Tolerance: the solve leaves 1e-9 of the skin's height; 1e-9 of the spring's stiffness, of which the eigenvalue is a
    small difference.
    """
    spring.place(solver, y)
    assert Observer(solver.problem).state().y == pytest.approx(y, rel=1e-9, abs=0)
    found = StabilityCheck(solver).check()
    assert found.settled
    assert found.lambda_min == pytest.approx(spring.net_stiffness(y), abs=1e-9 * spring.STIFFNESS)
    assert found.stable == (y > spring.FOLD)
    assert negative_pivots(solver) == (0 if y > spring.FOLD else 1)


@pytest.mark.parametrize("element", ELEMENTS)
def test_body_at_rest_is_stable(element):
    """With each element; the mixed one has 45 unknown pressures, each of which turns the determinant's sign round."""
    at_rest = layered(element, eps_n=0.0)
    assert at_rest.layout.pressure_count == (45 if element == "P2-P1" else 0)
    found = StabilityCheck(at_rest).check()
    assert found.stable and found.settled


def test_check_after_one_that_failed(solver, monkeypatch):
    """A tangent that is no number ends in a failure; the next check begins anew and agrees to the last bit."""
    spring.place(solver, HEIGHTS[4])
    kept, assemble = StabilityCheck(solver), solver.equations.assemble_tangent
    expected = kept.check()

    def without_numbers(A):
        assemble(A)
        A.scale(np.nan)

    with monkeypatch.context() as broken:
        broken.setattr(solver.equations, "assemble_tangent", without_numbers)
        for _ in range(2):
            with pytest.raises(NotConverged):
                kept.check()
    assert kept.check() == expected


@pytest.fixture(scope="module")
def sliding():
    """A pressed, charged block that slips everywhere."""
    solver = make(load(MPI.COMM_WORLD, block(WIDTH, HEIGHT, 0.25e-3)), MU_F, 1e11, 1e10, held=False)
    problem, observer = solver.problem, Observer(solver.problem)
    problem.voltage.value = VOLTAGE / 2
    for x in (0.0, 30e-6, 60e-6, 120e-6):
        solver.control = Control(x, -4e-6)
        solver.solve(pseudo_transient=True)
        state = observer.state()
        problem.surface.set_history(problem.anchor, state.anchor)
    assert observer.slip(state) == (1.0, True)
    return solver


def test_agrees_with_all_eigenvalues(sliding):
    """Arnoldi's least eigenvalue is that of the whole dense pencil, friction too. Tolerance: its settling, 3e-9."""
    check = StabilityCheck(sliding)
    held = sliding.equations.prescribed_rows()
    K, M = check._tangent(0.0, held), check._mass_matrix(held)
    if K.comm.size > 1:
        pytest.skip("dense matrices are for one rank")
    n = K.getSize()[0]
    K, M = (A.getValues(range(n), range(n)) for A in (K, M))
    growth = np.linalg.eigvals(np.linalg.solve(K + 2e9 * M, 2e9 * M))
    growth = growth[np.abs(growth) > 1e-6]
    least = np.real(2e9 * (1 / growth - 1)).min()
    assert check.check().lambda_min == pytest.approx(least, rel=1e-7)


# -- pseudo-transient continuation over the edge of an equilibrium ---------------------------------------------------
def height(solver) -> float:
    """Return the mean height of the skin (m)."""
    problem = solver.problem
    nodes = solver.equations.skin[1] // 2
    y = problem.V.tabulate_dof_coordinates()[nodes, 1] + problem.displacement()[nodes, 1]
    return float(np.mean(np.concatenate(MPI.COMM_WORLD.allgather(y))))


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
