"""The error study of the default scene, on made-up runs whose limits are known."""

from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks import errors, limits
from benchmarks.errors import QUANTITIES
from benchmarks.limits import limit
from fingerpad.scene import Scene
from variational.solvers.continuation import StepFailed


def exact(mesh):
    """A quantity whose errors are 1 % times the sizes over their defaults, of second order."""
    sizes = mesh.contact / 5e-6, mesh.growth / 0.25, mesh.receptor / 5e-6
    return dict.fromkeys(QUANTITIES, 2 + 0.02 * sum(size**2 for size in sizes))


def solve(mesh, off=0.0):
    values = {name: value + off for name, value in exact(mesh).items()}
    return {"mesh": mesh.model_dump(), "unknowns": 10, "factorisations": 3, "values": values}


@pytest.fixture
def again():
    meshes = limits.meshes(errors.DEFAULT.mesh, errors.LEVELS)
    own = solve(errors.DEFAULT.mesh)
    return {"path": own, "own": own, "levels": [solve(mesh) for mesh in meshes]}


def test_reference_is_the_limit(again):
    """Errors of second order are taken away exactly, the bar is Roache's for the finest mesh. Tolerance: roundoff."""
    found = errors.reference(again, exact(errors.DEFAULT.mesh))
    finest = limits.meshes(errors.DEFAULT.mesh, errors.LEVELS)[-1]
    assert set(found) == set(QUANTITIES)
    for name, each in found.items():
        assert each.value == pytest.approx(2, rel=1e-12, abs=0)
        assert each.order == pytest.approx(2, rel=1e-9)
        assert each.bar == pytest.approx(1.25 * (exact(finest)[name] - 2), rel=1e-9, abs=0)


# -- Limits of scenes: their path, the kept output, and one solve for each scene ---
class Path:
    """A simulation that is lost on some contact sizes."""

    tried: list[float]

    def __init__(self, model, comm, on_step, on_load):
        self.contact, self.on_load = model.mesh.contact, on_load

    def run(self):
        Path.tried.append(self.contact)
        self.on_load()
        if self.contact > 10e-6:
            raise StepFailed(f"lost at {self.contact:g}")


class StateRecorder:
    """Keeps the contact size of its mesh alone."""

    def __init__(self, simulation):
        self.contact, self.states = simulation.contact, {}
        StateRecorder.kept = self.states

    def keep(self, name):
        self.states[name] = self.contact

    def solve(self):
        return self.contact


@pytest.fixture
def path(monkeypatch):
    Path.tried = []
    monkeypatch.setattr(limits, "Simulation", Path)
    monkeypatch.setattr(limits, "StateRecorder", StateRecorder)


def test_path_that_is_lost_is_followed_on_a_finer_mesh(path, monkeypatch):
    """The uncharged contact is that of the mesh that was found; lost on all of them it is a failure."""
    assert limits._path(Scene()) == 10e-6
    assert Path.tried == [20e-6, 10e-6] and StateRecorder.kept == {"uncharged": 10e-6}
    monkeypatch.setattr(limits, "_STARTS", (40e-6, 20e-6))
    with pytest.raises(StepFailed, match="lost at 2e-05"):
        limits._path(Scene())


@pytest.mark.parametrize(("lost", "levels"), [(4, 4), (3, 3), (2, None)])
def test_limit_is_of_the_meshes_before_one_on_which_a_state_is_lost(monkeypatch, lost, levels):
    """The meshes are numbered from zero, each of half the sizes; of fewer than three no limit is made."""
    meshes = limits.meshes(Scene().mesh, 4)
    for name in limits._HALVED:
        assert [getattr(mesh, name) for mesh in meshes[:3]] == [getattr(meshes[0], name) / k for k in (1, 2, 4)]

    def solved(model, states, comm):
        if meshes[lost:] and model.mesh.contact == meshes[lost].contact:
            raise StepFailed("lost")
        cost = {"unknowns": 1, "factorisations": 1, "processor_seconds": 0.0}
        return SimpleNamespace(states={}, mesh=model.mesh, values=dict, **cost)

    monkeypatch.setattr(limits, "solve_again", solved)
    monkeypatch.setattr(limits, "_path", lambda scene: solved(Scene(), {}, None))
    if levels is None:
        with pytest.raises(StepFailed, match="lost"):
            limits._solve(Scene(), 4)
    else:
        assert len(limits._solve(Scene(), 4)["levels"]) == levels


# -- limits of sequences ---------------------------------------------------------------------------------------------
SIZES = 0.5 ** np.arange(4)


@pytest.mark.parametrize("order", [0.6, 1.0, 1.5, 2.0])
def test_power_law(order):
    """A single power of the size is found exactly. Tolerance: roundoff of differences, 1e-14 of numbers about 2."""
    found = limit(list(2 - 0.3 * SIZES**order))
    assert found.order == pytest.approx(order, rel=1e-12)
    assert found.value == pytest.approx(2, rel=1e-14, abs=0)
    assert found.bar == pytest.approx(1.25 * 0.3 * SIZES[-1] ** order, rel=1e-12, abs=0)


def test_swings_that_shrink():
    """Three times the last change, here of a value that swings about 1 with half the distance each time. Roundoff."""
    found = limit([1.4, 0.8, 1.1, 0.95])
    assert found.order is None
    assert (found.value, found.bar) == (0.95, pytest.approx(3 * 0.15, rel=1e-14))


@pytest.mark.parametrize(
    "values", [[1.0, 1.05, 1.2, 1.05], [1.0, 1.1, 1.2, 1.3], [1.0, 1.1, 1.2, 1.28], [1.0, 1.0, 1.1, 1.1]]
)
def test_no_order(values):
    """Changes that swing as far as before, hardly shrink, or vanish: three times the largest of the last two.

    Tolerance: roundoff.
    """
    found = limit(values)
    assert found.order is None
    assert found.value == values[-1]
    changes = abs(values[-1] - values[-2]), abs(values[-2] - values[-3])
    assert found.bar == pytest.approx(3 * max(changes), rel=1e-14, abs=0)


def test_accident_is_no_order():
    """A last change that happens to be small does not claim an accuracy of 2^-10: the bar is that of order 2.

    Tolerance: roundoff of the changes, 1e-4 of numbers about 1 in the order.
    """
    found = limit([1.0, 1.1024, 1.1025])
    assert found.order == pytest.approx(10, rel=1e-11)
    assert found.value == pytest.approx(1.1025 + 1e-4 / 3, rel=1e-14, abs=0)
    assert found.bar == pytest.approx(1.25 * 0.1024 / 12, rel=1e-12, abs=0)
