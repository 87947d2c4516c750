"""What other codes are told, and one ridge by them and by this package."""

import numpy as np
import pytest
from mpi4py import MPI

from benchmarks.peers import compared, equal, ours, plain
from benchmarks.peers.compared import CURVED, OURS, half_width
from benchmarks.peers.exchange import Answer, Case, Load, Ridge, State
from geometry.bodies import ridge as one_ridge
from geometry.mesh import load

WIDTH = 0.483  # mm


@pytest.fixture(scope="module")
def body():
    return ours.make(0.04)


@pytest.fixture(scope="module")
def ridge(body) -> Ridge:
    return ours.for_peers(body)


@pytest.fixture(scope="module")
def answer(body, ridge) -> Answer:
    pressed, moved = Load(0.0, -0.01, "pressed without friction"), Load(0.02, -0.01, "moved 5 µm")
    case = Case(0.25, (Load(0.0, -0.005), pressed, moved))
    return ours.solve(case, body, ridge.points[ridge.skin].reshape(-1, 2))


def test_triangles(ridge):
    """Counter-clockwise, each middle half-way along its edge (roundoff), and together the ridge.

    Tolerance of the area: chords of 40 um over a curvature of 4 per mm miss a thousandth of the bottom's 0.05 mm.
    """
    p = ridge.points[ridge.triangles]
    for k in range(3):
        np.testing.assert_allclose(p[:, 3 + k], (p[:, k] + p[:, (k + 1) % 3]) / 2, atol=1e-14)
    (a, b), (c, d) = ((p[:, k] - p[:, 0]).T for k in (1, 2))
    area = (a * d - b * c) / 2
    assert area.min() > 0
    assert area.sum() == pytest.approx(WIDTH * (0.6 - 0.05), rel=2e-3)


def test_screen_that_moves_instead(answer):
    """After 20 um under a penetration of 10 um all slips: friction on the skin is mu_f F_n, against the motion.

    Tolerance: the imbalance at which solves end, 1e-12 N/mm, on some 30 nodes.
    """
    _, moved = answer.states
    assert moved.f_t == pytest.approx(-0.25 * moved.f_n, abs=1e-10)


def test_half_width_of_a_parabola():
    """An edge from (0, -1) to (2, 3) with its middle at (1, 0.25): y = -1 + x/2 + 3/4 x^2, below until its root."""
    points = np.array([[0.0, 0.0], [2.0, 0.0], [1.0, 0.0]])
    mesh = Ridge(points, np.zeros((0, 6), int), np.array([[0, 1, 2]]), np.zeros(0, int), np.zeros(0, int))
    state = State("", 0, 0, [[0.0, -1.0], [0.0, 3.0], [0.0, 0.25]], 0.0)
    x = np.linspace(0, (-0.5 + np.sqrt(0.25 + 3)) / 1.5, 200001)
    exact = np.hypot(np.diff(x), np.diff(-1 + x / 2 + 0.75 * x**2)).sum() / 2
    assert half_width(mesh, state) == pytest.approx(exact, rel=1e-5)  # the error of six Gauss points


# -- at equal error --------------------------------------------------------------------------------------------------
def test_plain_script_agrees_on_curved_facets():
    """As on straight ones. Tolerance: imbalances of 1e-12 N/mm on some 30 nodes."""
    body = load(MPI.COMM_SELF, one_ridge(40e-6))
    ridge, case = ours.for_peers(body), Case(0.25, (Load(0.0, -0.005, "pressed"), Load(0.0035, -0.005, "moved")))
    assert ridge.curved and not ours.for_peers(ours.make(0.04)).curved
    one, other = plain.solve(case, ridge), ours.solve(case, body, ridge.points[ridge.skin].reshape(-1, 2))
    for a, b in zip(one.states, other.states, strict=True):
        assert (a.f_n, a.f_t) == pytest.approx((b.f_n, b.f_t), abs=1e-10)
        np.testing.assert_allclose(a.displacement, b.displacement, atol=1e-8)


def test_states_solved_again_are_those_of_the_script():
    """Small facets where contact ends, after a path on large ones, and small ones everywhere give the same two states.

    Tolerance: facets of 2.5 um at the ends of a contact of 110 um miss 0.4 % of its length, and those of 20 um within
    it 2 % of the highest pressure and 0.2 % of the force.
    """
    found, other = equal.by_package(equal.case(), 20.0), equal.by_script(equal.case(), 2.5, True)
    for values, expected in zip(found["values"], other["values"], strict=True):
        for value, there, within in zip(values, expected, (2e-3, 5e-3, 2e-2), strict=True):
            assert value == pytest.approx(there, rel=within)
    assert found["factorisations"] + found["path"]["factorisations"] < other["factorisations"] / 2


def test_cheapest_row_is_nowhere_less_accurate():
    """The script's of least time whose errors, and those of its finer meshes, are no larger; None without one."""
    mine = {"program": OURS, "size": 10.0, "seconds": 1.0, "errors": [1e-3, 1e-3, 1e-3]}
    lucky, coarse, fine, finest = (
        {"program": CURVED, "size": size, "seconds": 10 / size, "errors": errors}
        for size, errors in ((8.0, [1e-3] * 3), (5.0, [1e-3, 2e-3, 1e-4]), (2.0, [1e-3, 1e-3, 1e-4]), (1.0, [1e-4] * 3))
    )
    found = compared.words([lucky, mine, finest, coarse, fine])
    assert found["pairs"] == [(mine, fine)] and found["reached"] == [5.0]
    assert found["lucky"] == [10 / 8] and found["asked"] == [mine, lucky]
    assert compared.words([mine, coarse])["reached"] == []
