"""What other codes are told and how their answers are read: the parts that need none of them."""

import numpy as np
import pytest

from benchmarks.peers import calculix_ridge, ours, plain
from benchmarks.peers.__main__ import half_width
from benchmarks.peers.exchange import Answer, Case, Load, Ridge, State, cases

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


def test_skin(ridge):
    """The skin leads from side to side, left to right, without a gap."""
    np.testing.assert_array_equal(ridge.skin[1:, 0], ridge.skin[:-1, 1])
    ends = ridge.points[ridge.skin[[0, -1], [0, 1]]]
    np.testing.assert_allclose(ends, [[-WIDTH / 2, 0.1], [WIDTH / 2, 0.1]], atol=1e-12)


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
    state = State("", 0, 0, [[0.0, -1.0], [0.0, 3.0], [0.0, 0.25]], [], [], [])
    x = np.linspace(0, (-0.5 + np.sqrt(0.25 + 3)) / 1.5, 200001)
    exact = np.hypot(np.diff(x), np.diff(-1 + x / 2 + 0.75 * x**2)).sum() / 2
    assert half_width(mesh, state) == pytest.approx(exact, rel=1e-5)  # the error of six Gauss points


def test_deck(ridge):
    """CalculiX gets Ogden's exponent in its own sign, D = 2/K, every facet once, and numbers short enough for it."""
    deck = calculix_ridge.deck(cases()["friction"], ridge)
    lines = deck.splitlines()
    law = [float(word) for word in lines[lines.index("*HYPERELASTIC, OGDEN, N=1") + 1].split(",")]
    assert law == pytest.approx([0.08676, 14.53, 3 * (1 - 2 * 0.48) / (0.08676 * 1.48)])
    slave = lines[lines.index("*SURFACE, NAME=SLAVE") + 1 : lines.index("*SURFACE, NAME=MASTER")]
    assert len(slave) == len(ridge.skin)
    assert max(len(word.strip()) for line in lines for word in line.split(",") if "*" not in line) <= 20
    assert deck.count("*STEP") == len(cases()["friction"].loads)


def test_plain_script_agrees(body, ridge):
    """The same forms on the same mesh give the same forces; tolerance: imbalances of 1e-12 N/mm on some 30 nodes."""
    case = Case(0.25, (Load(0.0, -0.005, "pressed"), Load(0.0035, -0.005, "moved")))
    one, other = plain.solve(case, ridge), ours.solve(case, body, ridge.points[ridge.skin].reshape(-1, 2))
    for a, b in zip(one.states, other.states, strict=True):
        assert (a.f_n, a.f_t) == pytest.approx((b.f_n, b.f_t), abs=1e-10)
        np.testing.assert_allclose(a.displacement, b.displacement, atol=1e-8)
