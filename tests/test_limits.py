"""Limits of scenes: their path, the kept output, and one solve for each scene."""

import json
from types import SimpleNamespace

import pytest

from benchmarks import limits
from fingerpad.runs.processes import End
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


def test_uncharged_contact_is_kept(path):
    limits._path(Scene())
    assert StateRecorder.kept == {"uncharged": 10e-6}


def test_path_that_is_lost_on_all_meshes_is_a_failure(path, monkeypatch):
    monkeypatch.setattr(limits, "_STARTS", (40e-6, 20e-6))
    with pytest.raises(StepFailed, match="lost at 2e-05"):
        limits._path(Scene())


def test_meshes_are_halved_in_all_sizes():
    first, second = limits.meshes(Scene().mesh, 2)
    assert all(getattr(second, name) == getattr(first, name) / 2 for name in limits._HALVED)
    assert second.touching_half_arc == first.touching_half_arc


def test_kept_scene_is_not_solved_again(tmp_path, monkeypatch):
    """A scene that failed has its reason and is tried again the next time; one that was solved is not."""
    solved = []

    def run(module, arguments, limit):
        solved.append(arguments[1])
        scene = json.loads((tmp_path / arguments[0]).read_text(encoding="utf-8"))
        if scene["voltage"] == 50.0:
            return End(1, "CRASH_1", "no equilibrium", "")
        return End(0, "", "", json.dumps({"levels": []}))

    monkeypatch.setattr(limits, "run", run)
    scenes = {"good": Scene(), "bad": Scene(voltage=50.0)}
    found = limits.solve_all(scenes, 3, tmp_path, 1)
    assert found == {"good": {"levels": []}, "bad": {"failure": "CRASH_1: no equilibrium"}}
    assert limits.solve_all(scenes, 3, tmp_path, 1) == found
    assert solved == ["3", "3", "3"]


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
