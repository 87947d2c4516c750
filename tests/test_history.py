"""A history field of one's own is accepted, rolled back, translated, transferred and mirrored like those of contact."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
import ufl
from dolfinx import fem
from mpi4py import MPI

from fingerpad.scene import Scene
from geometry.bodies import ridge
from geometry.mesh import load
from tests.measures import straightened
from tests.runs import path_of
from tests.test_contact import MU_F, over
from tests.test_loads_over_time import PRESS, SLIDE, scene
from variational import compat
from variational.history import BodyField, SkinField
from variational.problem import Problem
from variational.solvers.continuation import Continuation, Target
from variational.solvers.state_snapshot import take_snapshot
from variational.solvers.transfer import restore

pytestmark = pytest.mark.mpi
DT = 0.5
_RELAXATION = 2.0  # s


@dataclass
class Own:
    """Accumulated slip on the skin, and a viscous strain in the body that no form reads."""

    slip: fem.Function
    strain: fem.Function

    @classmethod
    def of(cls, problem: Problem, mesh_degree: int = 1) -> "Own":
        slip = fem.Function(problem.surface.history_space)
        strain = fem.Function(fem.functionspace(problem.mesh, ("Discontinuous Lagrange", mesh_degree, (2, 2))))
        step = abs(problem.contact.new_anchor - problem.anchor)
        problem.history.add(SkinField("slip", slip + step, slip))
        rate = problem.dt / _RELAXATION
        now = (strain + rate * ufl.sym(ufl.grad(problem.w))) / (1 + rate)
        problem.history.add(BodyField("strain", now, strain))
        return cls(slip, strain)


def prepare(body) -> tuple[Continuation, Own]:
    path = over(body, MU_F, held=False).continuation
    return path, Own.of(path.problem)


@pytest.fixture(scope="module")
def body():
    """Of straight triangles, whose discontinuous linear fields are linear in the place."""
    return straightened(load(MPI.COMM_WORLD, ridge(30e-6)))


def largest(values: np.ndarray) -> float:
    return MPI.COMM_WORLD.allreduce(float(np.abs(values).max(initial=0.0)), op=MPI.MAX)


def test_accepted(body):
    """The slip is the way of the anchors, summed; steps add up to the duration; the strain follows backward Euler."""
    path, own = prepare(body)
    summed, anchors = 0.0, path.problem.history.accepted["anchor"]
    strains, steps = [own.strain.x.array.copy()], list[float]()

    def accepted(target, part, attempt):
        nonlocal summed, anchors
        now = path.problem.history.accepted["anchor"]
        summed, anchors = summed + np.abs(now - anchors), now
        strains.append(own.strain.x.array.copy())
        steps.append(float(path.problem.dt.value))

    path.on_accept = accepted
    path.run(Target("press", f_ext=4.4))
    assert largest(strains[-1]) == 0.0, "a load that takes no time leaves no viscous strain"
    path.run(Target("slide", bone_x=0.2e-3, duration=DT))
    np.testing.assert_allclose(path.problem.history.accepted["slip"], summed, atol=1e-15)
    assert largest(path.problem.history.accepted["slip"]) > 0.1e-3
    assert path.time == pytest.approx(DT, rel=1e-12)
    assert sum(steps) == pytest.approx(DT, rel=1e-12)
    before, last = strains[-2:]
    strain = fem.Function(own.strain.function_space)
    points = compat.interpolation_points(own.strain.function_space.element)
    strain.interpolate(fem.Expression(ufl.sym(ufl.grad(path.problem.w)), points))
    rate = float(path.problem.dt.value) / _RELAXATION
    assert 0 < rate < DT / _RELAXATION, "steps split the duration"
    np.testing.assert_allclose(last, (before + rate * strain.x.array) / (1 + rate), atol=1e-12)
    assert largest(last) > 1e-3


@pytest.mark.parametrize("size", [30e-6, 15e-6])
def test_transferred(body, size):
    """Back on its own mesh exactly; on a finer one, a quadratic's strain stays what it is. Tolerance: roundoff."""
    path, own = prepare(body)
    own.strain.interpolate(lambda x: np.stack([1e2 * x[0], 1e2 * x[1], 1e2 * x[1], 3e2 * x[0] + 1e2 * x[1]]))
    history = path.problem.history
    slip = 1e-6 + history.accepted["x"] * 1e-3
    history.accept({"slip": slip, "strain": own.strain.x.array.copy()})
    snapshot = take_snapshot(path.coupling, path.observer.state())
    snapshot.skin[0].history["slip"][:] = 1e-6 + 1e-3 * (snapshot.skin[0].origin[0] + snapshot.skin[0].along)
    again, other = prepare(body if size == 30e-6 else straightened(load(MPI.COMM_WORLD, ridge(size))))
    restore(snapshot, again.coupling)
    expected = fem.Function(other.strain.function_space)
    expected.interpolate(lambda x: np.stack([1e2 * x[0], 1e2 * x[1], 1e2 * x[1], 3e2 * x[0] + 1e2 * x[1]]))
    np.testing.assert_allclose(other.strain.x.array, expected.x.array, atol=1e-14)
    assert largest(other.slip.x.array) > 1e-6


@pytest.mark.slow
def test_mirrored(monkeypatch):
    """On the whole finger the strain is the half's and its mirror image: even along, odd across."""
    plain, owns = Problem.__init__, dict[int, Own]()

    def init(self, *args, **more):
        plain(self, *args, **more)
        owns[id(self)] = Own.of(self, 0)

    monkeypatch.setattr(Problem, "__init__", init)
    asked: Scene = scene(PRESS | {"f_ext": 0.5}, SLIDE)
    made = path_of(asked)
    pressed = dict[str, np.ndarray]()

    def on_load():
        if not pressed:
            strain = owns[id(made.finger.problem)].strain
            x = strain.function_space.tabulate_dof_coordinates()[:, :2]
            pressed.update(x=x, strain=strain.x.array.reshape(-1, 4).copy())

    made.on_load = on_load
    run = Continuation.run
    monkeypatch.setattr(Continuation, "run", lambda self, target: run(self, replace(target, duration=DT)))
    made.run()
    x, strain = (np.concatenate(MPI.COMM_WORLD.allgather(pressed[name])) for name in ("x", "strain"))
    order = np.lexsort(np.round([x[:, 1], np.abs(x[:, 0])], 12))
    x, strain = x[order], strain[order]
    left, right = strain[x[:, 0] < 0], strain[x[:, 0] > 0]
    assert np.abs(strain).max() > 1e-3
    np.testing.assert_allclose(left * [1, -1, -1, 1], right, atol=1e-9)
