"""Limits of scenes: their path, the kept output, and one solve for each scene."""

from types import SimpleNamespace

import pytest

from benchmarks import limits
from fingerpad.scene import Scene
from variational.solvers.continuation import StepFailed


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


def test_path_that_is_lost_is_followed_on_a_finer_mesh(path):
    assert limits._path(Scene()) == 10e-6
    assert Path.tried == [20e-6, 10e-6]


@pytest.mark.parametrize(("lost", "levels"), [(4, 4), (3, 3), (2, None)])
def test_limit_is_of_the_meshes_before_one_on_which_a_state_is_lost(monkeypatch, lost, levels):
    """The meshes are numbered from zero; of fewer than three no limit is made."""
    sizes = [mesh.contact for mesh in limits.meshes(Scene().mesh, 4)]

    def solved(model, states, comm):
        if sizes[lost:] and model.mesh.contact == sizes[lost]:
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
