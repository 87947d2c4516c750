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
