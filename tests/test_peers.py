"""What other codes are told, and one ridge by them and by this package."""

import numpy as np
import pytest
from mpi4py import MPI

from benchmarks.peers import equal, ours, plain
from benchmarks.peers.exchange import Case, Load, Ridge
from geometry.bodies import ridge as one_ridge
from geometry.mesh import load

WIDTH = 0.483  # mm


@pytest.fixture(scope="module")
def body():
    return ours.make(0.04)


@pytest.fixture(scope="module")
def ridge(body) -> Ridge:
    return ours.for_peers(body)


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
