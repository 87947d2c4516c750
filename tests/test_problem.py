"""Residual, Jacobian and energy are derivatives of one another; attraction has the resultants of Eq. 3."""

import dolfinx
import numpy as np
import pytest
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix
from mpi4py import MPI

from geometry import tags
from geometry.bodies import block
from geometry.mesh import load
from variational.contact.augmented import AugmentedLagrangian
from variational.contact.interface import Interface
from variational.contact.nitsche import Nitsche
from variational.contact.penalty import Penalty
from variational.materials.ogden import Ogden
from variational.materials.saint_venant import SaintVenant
from variational.problem import Problem
from variational.resultants import Observer
from variational.surface import Surface

SKIN, FAT, NAIL = Ogden(86.76e3, -14.53, 0.48), Ogden(25e3, 5.0, 0.48), SaintVenant(170e6, 0.3)
H_0, D_EQ, VOLTAGE = 0.514e-6, 2e-6, 200.0
EPS_0 = 8.854e-12
EPS_N, EPS_T = 1e12, 1e11
FORMULATIONS = [Penalty(EPS_N, EPS_T), AugmentedLagrangian(EPS_N, EPS_T, 1e-9), *(Nitsche(10.0, t) for t in (1, 0, -1))]
NAMES = ["penalty", "augmented", "nitsche 1", "nitsche 0", "nitsche -1"]
STEPS = 0.5 ** np.arange(5)
NEAR = 1e-9  # m, size of the perturbations: small against the micrometres over which the laws change


def make(body, mu_f=0.25, solid=SKIN, element="P2", formulation=Penalty(EPS_N, EPS_T)) -> Problem:  # noqa: B008
    """Return a problem on a block, its gaps at D_EQ."""
    surface = Surface(body.mesh, body.facet_tags, {0: tags.ridge(0)})
    interface = Interface(formulation, mu_f, H_0)
    problem = Problem(body.mesh, body.cell_tags, surface, {tags.STRATUM_CORNEUM: solid}, interface, element)
    problem.set_air_gaps(np.array([D_EQ]))
    return problem


def wave(problem, lowest=-1.5e-6, height=6e-6):
    """Deform the bottom into waves from ``lowest`` up to ``lowest + height``, and shear it."""
    problem.w.interpolate(
        lambda x: np.stack(
            [
                1e-6 * np.cos(5e3 * x[0]) - 4e-4 * x[1] + 2e-3 * x[0] * x[1] / 1e-3,
                lowest + height / 2 * (1 + np.sin(7e3 * x[0] + 0.4)) - 3e-2 * x[1],
            ]
        )
    )


def anchor_apart(problem):
    """Of the points of a facet, let one stick and one slip either way; none is where its spring is slack.

    Without friction there is nothing to do.
    """
    if problem.anchor is None:
        return
    c = problem.contact
    s, limit, t_t, gamma_t = problem.surface.evaluate(
        problem.surface.compile([c.new_anchor, c.limit, c.t_t, c.springs.gamma_t])
    )
    reach, slack = limit / gamma_t, s - t_t / gamma_t
    pull = np.array([0.6, 1.7, -0.6, -1.7])
    problem.surface.set_history(problem.anchor, slack + np.where(reach > 0, pull * reach, 1e-7))


def direction(problem, scale=NEAR):
    """Return a displacement without any symmetry."""
    return scale * np.random.default_rng(1).uniform(-1, 1, len(problem.w.x.array))


def residual(problem):
    b = fem.assemble_vector(problem.residual)
    return b.array.copy()


def jacobian(problem):
    A = assemble_matrix(problem.jacobian)
    A.assemble()
    return A


def dense(A):
    rows, columns = A.getSize()
    return A.getValues(range(rows), range(columns))


def distance_to_kinks(problem):
    """Return how far the nearest point is from touching, from d_eq and from its cone's edge (m of displacement)."""
    compiled = problem.surface.compile([problem.y, problem.contact.p_n, problem.u[0], problem.anchor or problem.y])
    y, p_n, u_x, anchor = problem.surface.evaluate(compiled)
    law = problem.interface
    apart = [np.abs(y), np.abs(y - D_EQ)]
    if law.friction is not None:
        mu_f = law.friction.mu_f
        cone = np.abs(np.abs(u_x - anchor) - mu_f * p_n / EPS_T) / (1 + mu_f * EPS_N / EPS_T)
        apart.append(cone)
    return min(float(a.min()) for a in apart)


def rates(remainders):
    return np.log2(remainders[:-1] / remainders[1:])


def taylor(problem, move):
    """Return |r(u + e du) - r(u) - e J du| for the steps e."""
    at = problem.w.x.array.copy()
    r, J = residual(problem), jacobian(problem)
    x, y = J.createVecs()
    x.array_w[:] = move
    J.mult(x, y)
    remainders = []
    for step in STEPS:
        problem.w.x.array[:] = at + step * move
        remainders.append(np.linalg.norm(residual(problem) - r - step * y.array_r))
    problem.w.x.array[:] = at
    return np.array(remainders), np.linalg.norm(y.array_r)


def check_jacobian(problem, move):
    """Assert that the remainder is of second order in the step; a wrong entry would leave a first-order one.

    The tolerance is the next term of the expansion, a thousandth of the remainder.
    """
    remainders, linear = taylor(problem, move)
    assert remainders[0] < 1e-2 * linear
    np.testing.assert_allclose(rates(remainders), 2, atol=0.02)


def disturb(problem, lowest=-1.5e-6):
    """Charge, deform and shear the skin, with points that stick and slip."""
    problem.voltage.value = VOLTAGE
    wave(problem, lowest)
    anchor_apart(problem)


@pytest.mark.parametrize("voltage", [0.0, VOLTAGE])
@pytest.mark.parametrize("mu_f", [0.0, 0.25])
@pytest.mark.parametrize(
    ("solid", "element", "lowest"),
    [(SKIN, "P2", -1.5e-6), (FAT, "P2", -1.5e-6), (NAIL, "P2", -1.5e-6), (SKIN, "P1", -1.4e-6)],
    ids=["skin", "fat", "nail", "linear"],
)
def test_jacobian(square, solid, element, lowest, mu_f, voltage):
    """No point crosses a kink of the laws."""
    problem = make(square, mu_f, solid, element)
    disturb(problem, lowest)
    problem.voltage.value = voltage
    move = direction(problem)
    assert distance_to_kinks(problem) > np.abs(move).max()
    check_jacobian(problem, move)


def states(problem):
    """Tell of each point whether it touches, is above d_eq, sticks or slips which way; shape (4, facets, points)."""
    c = problem.contact
    found = problem.surface.evaluate(problem.surface.compile([c.gap, problem.y, c.p_n, c.t_t, c.limit]))
    gap, y, p_n, t_t, cone = *found[:4], found[4] * (1 - 1e-8)
    return np.array([gap < 0, y > D_EQ, (p_n > 0) & (t_t >= cone), (p_n > 0) & (-t_t >= cone)])


@pytest.mark.parametrize("formulation", FORMULATIONS, ids=NAMES)
def test_jacobian_of_every_formulation(square, formulation):
    """With points of every state, none of which changes it on the way."""
    problem = make(square, formulation=formulation)
    disturb(problem)
    x = problem.surface.evaluate(problem.surface.compile([ufl.SpatialCoordinate(square.mesh)[0]]))[0]
    problem.surface.set_history(problem.multiplier, 4e5 * (1 + np.cos(9e3 * x)))
    anchor_apart(problem)
    at, move, before = problem.w.x.array.copy(), direction(problem), states(problem)
    open_, above, forth, back = ~before[0], *before[1:]
    sticks = ~(open_ | forth | back)
    assert all(some.any() for some in (open_, above, ~above & open_, forth, back, sticks))
    problem.w.x.array[:] = at + move
    assert (states(problem) == before).all()
    problem.w.x.array[:] = at
    check_jacobian(problem, move)


@pytest.mark.parametrize(
    ("formulation", "mu_f", "voltage", "least", "most"),
    [
        (Penalty(EPS_N, EPS_T), 0.0, VOLTAGE, 0.0, 1e-14),
        (Penalty(EPS_N, EPS_T), 10.0, 0.0, 0.0, 1e-14),
        (Penalty(EPS_N, EPS_T), 0.25, 0.0, 0.025, 1.0),
        (Nitsche(10.0, 1), 0.0, 0.0, 0.0, 1e-13),
        (Nitsche(10.0, 0), 0.0, 0.0, 1e-3, 1.0),
        (Nitsche(10.0, -1), 0.0, 0.0, 1e-3, 1.0),
    ],
    ids=repr,
)
def test_symmetry(square, formulation, mu_f, voltage, least, most):
    """Contact and attraction derive from potentials, springs of sticking points too, and theta = 1 alone of Nitsche's.

    Where a point slips, dt_t/du_y = mu_f eps_n has no partner dp_n/du_x: the skew part is half of it. Tolerance:
    roundoff.
    """
    problem = make(square, mu_f, formulation=formulation)
    problem.voltage.value = voltage
    wave(problem)
    if mu_f == 10.0:
        here = problem.surface.evaluate(problem.surface.compile([problem.u[0]]))[0]
        problem.surface.set_history(problem.anchor, here)
    else:
        anchor_apart(problem)
    J = dense(jacobian(problem))
    skew = np.abs(J - J.T).max() / np.abs(J).max()
    assert least <= skew < most


def test_nitsche_refuses_skin_of_two_laws(square):
    """The traction in the skin is that of one law."""
    cells = np.arange(square.mesh.topology.index_map(2).size_local, dtype=np.int32)
    middle = dolfinx.mesh.compute_midpoints(square.mesh, 2, cells)[:, 0]
    cell_tags = dolfinx.mesh.meshtags(square.mesh, 2, cells, np.where(middle < 0, 1, 2).astype(np.int32))
    surface = Surface(square.mesh, square.facet_tags, {0: tags.ridge(0)})
    with pytest.raises(ValueError, match=r"has 2 material laws behind it, of the layers \[1, 2\]"):
        Problem(square.mesh, cell_tags, surface, {1: SKIN, 2: NAIL}, Interface(Nitsche(10.0), 0.0, H_0))


def test_energy(square):
    """Above the screen the residual is the derivative of the energy alone; tolerance as for the Jacobian."""
    problem = make(square)
    problem.voltage.value = VOLTAGE
    wave(problem, lowest=0.3e-6)
    at, move = problem.w.x.array.copy(), direction(problem, 1e-7)
    start, slope = fem.assemble_scalar(problem.energy), residual(problem) @ move
    remainders = []
    for step in STEPS:
        problem.w.x.array[:] = at + step * move
        remainders.append(abs(fem.assemble_scalar(problem.energy) - start - step * slope))
    np.testing.assert_allclose(rates(np.array(remainders)), 2, atol=0.1)


def test_shift_is_a_mass_on_the_touching_skin(square):
    """The pseudo-transient shift adds eta times the surface's mass: a translation by one gets eta times its length."""
    problem = make(square)
    wave(problem)
    plain = dense(jacobian(problem))
    problem.eta.value = 3e9
    added = dense(jacobian(problem)) - plain
    assert added[::2, ::2].sum() == pytest.approx(3e9 * 1e-3, rel=1e-9)  # roundoff of entries 100 times as large
    assert added[1::2, 1::2].sum() == pytest.approx(3e9 * 1e-3, rel=1e-9)
    assert np.abs(added[::2, 1::2]).max() < 1e-15 * np.abs(plain).max()


# -- the attraction has the resultants of Eq. 3 and derives from its potential ---------------------------------------
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
