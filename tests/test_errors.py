"""The error study of the default scene, on made-up runs whose limits are known."""

from types import SimpleNamespace

import pytest

from benchmarks import errors, harness, limits
from benchmarks.errors import QUANTITIES
from fingerpad.scene import Scene
from variational.solvers.continuation import StepFailed

BY = harness.Made("0", "abc", "2026-01-01")


def exact(mesh):
    """A quantity whose errors are 1 % times the sizes over their defaults, of second order."""
    sizes = mesh.contact / 5e-6, mesh.growth / 0.25, mesh.receptor / 5e-6
    return dict.fromkeys(QUANTITIES, 2 + 0.02 * sum(size**2 for size in sizes))


def solve(mesh, off=0.0):
    values = {name: value + off for name, value in exact(mesh).items()}
    return {"mesh": mesh.model_dump(), "unknowns": 10, "factorisations": 3, "values": values}


@pytest.fixture
def again():
    """States of the default scene, solved again."""
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


def soft(scene):
    """The quantities of a scene, over a screen whose penalty changes them by the law of the program."""
    factor = 1 + (scene.contact.eps_n / 1e10) ** -errors.ORDER
    return {name: value * factor for name, value in exact(scene.mesh).items()}


def test_page(again, tmp_path):
    """The default's error against the limit: 0.02 (1 + 1 + 1) over 2, and a bar of 1.25 times 0.02 3 / 16.

    Over a stiffer screen the law of the program is found again, to roundoff.
    """
    whole = exact(errors.DEFAULT.mesh) | {"unknowns": 9.0, "factorisations": 30.0}
    studies = {
        name: [{"value": value, "quantities": soft(scene)} for value, scene in errors.study(name).items()]
        for name in errors.STUDIES
    }
    ends = {name: vars(each) for name, each in errors.reference(again, whole).items()}
    numbers = {"default": whole, "again": again, "studies": studies, "reference": ends}
    harness.keep("errors", numbers, BY, tmp_path)
    text = errors.draw(tmp_path).read_text(encoding="utf-8")
    row = next(line for line in text.splitlines() if line.startswith("| SED at ridge 0, full slip"))
    assert row.split(" | ")[1] == "2.06"
    assert row.split(" | ")[-3:] == ["2.0000 ± 0.0047", "2.0", "3 ± 0.2 % |"]
    assert (tmp_path / "errors.png").exists()
    for predicted, found in errors.stiffer(tmp_path).values():
        assert predicted == pytest.approx(found, rel=1e-9)
        assert found < 0


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
