"""Snapshots restored on other meshes: what returns exactly; full slip is the path's; on any number of ranks."""

import numpy as np
import pytest
from mpi4py import MPI

from geometry.bodies import ridge
from geometry.mesh import load
from tests.measures import straightened
from tests.test_contact import MU_F, over
from variational.solvers.continuation import Continuation, Target
from variational.solvers.outcome import NotConverged
from variational.solvers.state_snapshot import take_snapshot
from variational.solvers.transfer import _near, interpolate, restore

pytestmark = pytest.mark.mpi
H_0, FORCE, VOLTAGE = 0.514e-6, 4.4, 150.0
COARSE, FINE = 30e-6, 15e-6
SLIDE = 0.2e-3


def prepare(body, element="P2") -> Continuation:
    return over(body, MU_F, held=False, element=element).continuation


@pytest.fixture(scope="module")
def bodies():
    return {size: load(MPI.COMM_WORLD, ridge(size)) for size in (COARSE, FINE)}


@pytest.fixture(scope="module")
def polygons():
    """The same of straight facets."""
    return {size: straightened(load(MPI.COMM_WORLD, ridge(size))) for size in (COARSE, FINE)}


@pytest.fixture(scope="module")
def reached(bodies):
    """States of P2, by the size of the facets."""
    return states(bodies)


def states(bodies, element="P2"):
    """Both meshes' ridge pressed, charged and slid to full slip: states of normal contact and full slip, and f_T."""
    found = {}
    for size, body in bodies.items():
        path = prepare(body, element)
        path.run(Target("press", f_ext=FORCE))
        path.run(Target("charge", voltage=VOLTAGE))
        normal = take_snapshot(path.coupling, path.surface_state)
        path.run(Target("slide", bone_x=1e-3, until_full_slip=True))
        slip = take_snapshot(path.coupling, path.surface_state)
        found[size] = (normal, slip, -path.solver.reaction[0], path.observer.ridge_loads(path.surface_state).length[0])
    return found


@pytest.mark.parametrize(("element", "cubic"), [("P2", 0.0), ("P3", 1e9)])
def test_polynomial_displacement_is_restored_exactly(polygons, element, cubic):
    """What an element holds, in its triangles and beyond them, where the fine polygon is wider. Tolerance: roundoff."""

    def u(x):
        return np.stack([1 + x[0] * x[1] * 1e6 + cubic * x[0] ** 2 * x[1], 2 - 3e6 * x[1] ** 2 + 1e3 * x[0]])

    coarse = prepare(polygons[COARSE], element)
    coarse.solver.problem.w.interpolate(u)
    points = polygons[FINE].mesh.geometry.x
    found, outside = interpolate(take_snapshot(coarse.coupling, coarse.surface_state), points[:, :2])
    np.testing.assert_allclose(found.T, u(points.T), rtol=1e-11)
    assert MPI.COMM_WORLD.allreduce(outside, op=MPI.MAX) > 1e-3, "no point of the fine mesh is beyond the coarse one"


def test_place_in_curved_triangles_is_found(bodies):
    """A displacement that is linear in the place is one of curved triangles, too, between whose nodes it is exact.

    Tolerance: roundoff. No point of the fine mesh is farther beyond the coarse one than the parabolas are from the
    ridge's curve, 0.05 um.
    """
    coarse = prepare(bodies[COARSE])
    coarse.solver.problem.w.interpolate(lambda x: np.stack([1 + 2e3 * x[1], 2 - 3e3 * x[0] + x[1]]))
    points = bodies[FINE].mesh.geometry.x
    found, outside = interpolate(take_snapshot(coarse.coupling, coarse.surface_state), points[:, :2])
    np.testing.assert_allclose(found.T, [1 + 2e3 * points[:, 1], 2 - 3e3 * points[:, 0] + points[:, 1]], rtol=1e-11)
    assert outside < 2e-3


def test_state_returns_on_its_own_mesh(bodies, reached):
    """The anchors' elastic slip, sorted along the chord and read back. Tolerance: roundoff of 1 um in 1 mm.

    The displacement comes back on the skin by its facets' polynomials, elsewhere by the triangles': roundoff of 1 mm.
    Solved again the state is what it was, with the friction on its history: both meet 1e-9 N/m, and the air gaps 1e-6
    of themselves, over a bone that gives 1e-5 m a N/m.
    """
    normal = reached[COARSE][0]
    path = prepare(bodies[COARSE])
    restore(normal, path.coupling)
    back = take_snapshot(path.coupling, path.observer.state())
    assert np.abs(normal.skin[0].history["anchor"]).max() > 1e-8
    np.testing.assert_allclose(back.skin[0].history["anchor"], normal.skin[0].history["anchor"], atol=1e-15)
    np.testing.assert_allclose(back.u, normal.u, atol=1e-16)
    path.re_equilibrate("normal contact")
    np.testing.assert_allclose(path.solver.bone, normal.bone, atol=1e-11)


@pytest.mark.parametrize(("old", "new"), [(COARSE, FINE), (FINE, COARSE)])
def test_skin_does_not_come_off_the_screen(polygons, old, new):
    """Facets of other lengths cut the ridge's curve elsewhere: fine ones lower by 0.7 um, coarse ones higher by 0.5.

    Tolerance: twice the state's own penetration, in the middle half of the contact.
    """
    before, path = prepare(polygons[old]), prepare(polygons[new])
    before.run(Target("press", f_ext=FORCE))
    before.run(Target("charge", voltage=VOLTAGE))
    state = take_snapshot(before.coupling, before.surface_state)
    restore(state, path.coupling)
    now, skin = path.observer.state(), state.skin[0]
    own = np.abs(skin.position[..., 1].ravel()[skin.history["pressure"] > 0]).max()
    middle = np.abs(now.x) < np.abs(skin.along[skin.history["pressure"] > 0]).max() / 2
    heights = np.concatenate(MPI.COMM_WORLD.allgather(now.y[middle]))
    assert own < 0.1e-6
    assert heights.max() < 2 * own
    if new == FINE:
        assert heights.min() < -0.5e-6, "moved where it need not be"


def test_full_slip_from_a_coarse_mesh_is_that_of_the_path(bodies, reached):
    """The key claim: solved again from 30 um, the state at 15 um is that of the whole path at 15 um.

    Tolerance: two loops over the scales that end at 1e-6 of d_eq, whose gain is below one half here; the meshes' own
    f_T differ by far more, which is asserted. Full slip is steady over a further 0.2 mm.
    """
    path = prepare(bodies[FINE])
    restore(reached[COARSE][1], path.coupling, SLIDE)
    path.re_equilibrate("full slip")
    f_t, length = -path.solver.reaction[0], path.observer.ridge_loads(path.surface_state).length[0]
    assert path.slip == (1.0, True)
    assert f_t == pytest.approx(reached[FINE][2], rel=2e-6)
    assert length == pytest.approx(reached[FINE][3], rel=2e-6)
    assert abs(reached[COARSE][2] / reached[FINE][2] - 1) > 2e-5
    path.run(Target("slide", bone_x=path.solver.control.x + SLIDE))
    assert path.slip == (1.0, True)
    assert -path.solver.reaction[0] == pytest.approx(f_t, rel=1e-6), "the run's own criterion of steady slip"


def test_body_comes_into_balance_under_skin_that_is_held(bodies, reached):
    """The skin stays where it is and all else is in balance, until it is released.

    Tolerance: the solver's, 1e-9 of its force scale; of the skin's place, roundoff of the bone's way: the unknowns are
    relative to the bone, which moves.
    """
    path = prepare(bodies[FINE])
    restore(reached[COARSE][1], path.coupling, SLIDE)
    solver, skin = path.solver, path.observer.state()
    before = solver.x.array_r.copy()
    solver.equations.hold(solver.x, skin=True)
    solver.equations.load_part = 0.0
    solver.solve()
    now = path.observer.state()
    np.testing.assert_array_equal(now.x, skin.x)
    np.testing.assert_allclose(now.y, skin.y, rtol=0, atol=4 * np.finfo(float).eps * np.abs(solver.bone).max())
    assert MPI.COMM_WORLD.allreduce(float(np.abs(solver.x.array_r - before).max()), op=MPI.MAX) > 1e-9
    assert solver.imbalance() < 1e-9
    held = len(solver.equations.prescribed_rows())
    solver.equations.release()
    assert len(solver.equations.prescribed_rows()) < held or not len(skin.x)
    solver.solve()
    assert solver.imbalance() < 1e-9


@pytest.mark.parametrize("failures", [1, 2, 3])
def test_a_state_not_found_at_once_is_found(bodies, reached, monkeypatch, failures):
    """Where Newton's method fails the body is relaxed under held skin, then part by part.

    Pseudo-transient continuation comes last, from the state under held skin.

    Tolerance: two ends of the loop at 1e-6.
    """
    path = prepare(bodies[FINE])
    restore(reached[COARSE][1], path.coupling, SLIDE)
    solve, solver, calls, ways = path.coupling.solve, path.solver, [], []
    hold = solver.equations.hold

    def fails(pseudo_transient):
        calls.append((pseudo_transient, solver.counts.newton, solver.x.array_r.copy()))
        if len(calls) <= failures:
            raise NotConverged("DIVERGED_LOCAL_MIN", False)
        solve(pseudo_transient)

    def noted(x, skin=False):
        ways.append(skin)
        hold(x, skin)

    def loaded(*load, on_cone=True, **more):
        assert not on_cone, "another guess would be tried, of which no point knows"
        new_load(*load, on_cone=on_cone, **more)

    new_load = solver.new_load
    monkeypatch.setattr(path.coupling, "solve", fails)
    monkeypatch.setattr(solver.equations, "hold", noted)
    monkeypatch.setattr(solver, "new_load", loaded)
    attempt = path.re_equilibrate("full slip")
    assert attempt.cutbacks == failures * ["DIVERGED_LOCAL_MIN"]
    assert attempt.pseudo_transient == 0
    assert [pseudo_transient for pseudo_transient, *_ in calls] == [False, False, False, True][: failures + 1]
    assert ways == [True, False][:failures]
    newton = [n for _, n, _ in calls][:3]
    assert sorted(set(newton)) == newton, "nothing was solved for in between"
    if failures == 3:
        np.testing.assert_array_equal(calls[3][2], calls[1][2])
    assert solver.equations.load_part == 0
    assert -solver.reaction[0] == pytest.approx(reached[FINE][2], rel=2e-6)


# -- which elements of another mesh a point may be in ----------------------------------------------------------------
def test_large_triangle_beside_many_small_ones_is_found():
    """A point in it, beside sixty triangles of a thousandth of its size, all with nearer centroids."""
    point, angles = np.array([[0.02, 0.02]]), np.linspace(0, 2 * np.pi, 60, endpoint=False)
    middles = point + 1.1e-3 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    unit = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    small = middles + 1e-3 * (unit - unit.mean(axis=0))[:, None]
    corners = np.concatenate([small, unit[:, None]], axis=1)
    assert 60 in _near(corners, point)[0]
