"""How many ridges a mesh has: what a coarse finger says of a scene, that it is enough, and what it spares."""

import pytest
from mpi4py import MPI

from fingerpad.model import touching
from fingerpad.model.options import plan
from fingerpad.model.simulation import Simulation
from fingerpad.model.touching import by_rule, decide
from fingerpad.reduced import coarse
from fingerpad.scene import Scene, from_data
from geometry.profiles import GeometryError
from geometry.sizing import touching_ridges
from tests.runs import run
from variational.contact.friction import Coulomb

COMM = MPI.COMM_WORLD
PRESS = {"name": "press", "bone_height": -50e-6}
MESH = {"contact": 30e-6, "receptor": 80e-6, "interface": 150e-6, "growth": 0.8}


def ridges(scene: Scene) -> int:
    return touching_ridges(scene.geometry, scene.mesh)[-1]


# -- what the coarse finger says -------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def default():
    """The default scene's decision."""
    return decide(Scene(), COMM)


@pytest.mark.mpi
def test_default_mesh_is_what_it_was(default):
    """The default scene is meshed with ridges -10 to 10, as by the rule of thumb: its mesh is the same to the bit."""
    assert ridges(default.scene) == 10 == ridges(by_rule(Scene()))


def test_default_ridges_are_enough_for_what_full_runs_touch(default):
    """Ridge 9 touches at full slip in all full runs of the default scene; ridge 10, the last, must not."""
    assert ridges(default.scene) > 9
    assert default.cost["last_ridge"] + touching.MARGIN == ridges(default.scene)


def test_coarse_solve_is_cheap(default):
    """A few thousand unknowns; the full run at 10 um takes 320 factorisations with some 1e5."""
    assert default.cost["unknowns"] < 5000
    assert default.cost["factorisations"] < 100


def test_sliding_rolls_the_finger_onto_its_leading_side(default):
    """Full runs: 8 ridges on either side when pressed, 9 on the leading one at full slip."""
    loads = [{"name": "press", "f_ext": 75.0}, {"name": "charge", "voltage": 200.0}]
    assert coarse.solve(from_data({"history": loads}), COMM).last == default.cost["last_ridge"] - 1


def test_voltage_acts_as_friction(monkeypatch):
    """mu of the dragged finger against mu_app of the full run at 75 N/m and 200 V, 0.5230; tolerance: rung 1's 5 %."""
    coefficients = []
    make = coarse.Interface
    monkeypatch.setattr(coarse, "Interface", lambda law, mu, *a, **k: coefficients.append(mu) or make(law, mu, *a, **k))
    coarse.solve(Scene(), COMM)
    assert coefficients[0] == Coulomb(0.25)
    assert coefficients[1] == pytest.approx(0.523, rel=0.05)


def test_bone_pressed_by_displacement_reaches_as_far_as_by_force():
    """The default finger bears 75 N/m at -0.74 mm in the full runs, with ridge 8 the last one that touches."""
    pressed = coarse.solve(from_data({"history": [{"name": "press", "bone_height": -0.74e-3}]}), COMM)
    assert pressed.last == coarse.solve(from_data({"history": [{"name": "press", "f_ext": 75.0}]}), COMM).last


# -- where it says nothing -------------------------------------------------------------------------------------
def test_number_that_is_given_stands(monkeypatch):
    monkeypatch.setattr(coarse, "solve", None)
    scene = from_data({"mesh": {"touching_half_arc": 1.3e-3}})
    found = decide(scene, COMM)
    assert found.scene is scene and found.cost == {}
    assert found.plan(plan(scene), scene) == plan(scene)


def test_rule_of_thumb_where_the_coarse_finger_fails():
    """Five ridges are too few for 75 N/m: the coarse finger touches with the last, of which nothing can be said."""
    scene = from_data({"geometry": {"ridge_count": 5}})
    found = decide(scene, COMM)
    assert found.scene == by_rule(scene)
    assert found.cost == {"failure": "it reaches the last of the ridges, 2"}


def test_no_equilibrium_is_no_answer():
    with pytest.raises(coarse.NoCoarseSolution, match="found no equilibrium"):
        coarse.solve(from_data({"history": [{"name": "press", "bone_height": -13e-3}]}), COMM)


def test_undecided_finger_is_refused():
    with pytest.raises(GeometryError, match="touching_half_arc is not given"):
        Simulation(Scene(), plan(Scene()), COMM, lambda step, done: None, lambda: None)


@pytest.mark.parametrize(
    ("data", "widened"),
    [
        ({"f_ext": 75}, False),
        ({"f_ext": 150}, True),
        ({"friction": 1.0}, True),
        ({"friction": 0.1, "f_ext": 20}, False),
        ({"history": [{"name": "a", "f_ext": 10}, {"name": "b", "f_ext": 150.0}]}, True),
    ],
)
def test_rule_of_thumb(data, widened):
    """More under a larger force or friction; what was chosen is among the parameters, which give the same run again."""
    scene = by_rule(from_data(data))
    assert (scene.mesh.touching_half_arc > 5e-3) == widened
    assert from_data(scene.parameters()) == scene


# -- runs ------------------------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def lean(tmp_path_factory):
    """A lightly pressed finger whose ridges the coarse finger chose."""
    folder = tmp_path_factory.mktemp("lean")
    return folder, run(from_data({"mesh": MESH, "history": [PRESS]}), folder, COMM)


def test_run_says_what_was_left_out_and_what_that_took(lean):
    """As the full run does, the coarse finger touches with three ridges; two more on either side are meshed."""
    folder, summary = lean
    assert summary["omitted"][-1] == {
        "what": "contact of the ridges beyond ±3",
        "reason": "a coarse solve shows ridge 1 to be the last that the screen reaches",
    }
    assert summary["coarse_solve"]["factorisations"] > 0
    assert "contact of the ridges beyond ±3 left out" in (folder / "run.log").read_text(encoding="utf-8")
    assert summary["woken"] == [] and summary["normal_ridges_in_contact"] == 3
    assert summary["parameters"]["mesh"]["touching_half_arc"] is None


def test_same_answer_with_fewer_unknowns(lean, tmp_path):
    """As with ridges -10 to 10, on meshes that differ from ridge 4 on.

    Tolerance: they grow by 0.8 a distance, and the finer skin of the other gives by 1.4e-3 of the force. Facets of
    30 um are few: a twelfth of the unknowns is spared.
    """
    whole = run(by_rule(from_data({"mesh": MESH, "history": [PRESS]})), tmp_path, COMM)
    for name in ("f_contact", "contact_length"):
        assert lean[1][f"normal_{name}"] == pytest.approx(whole[f"normal_{name}"], rel=3e-3), name
    assert lean[1]["unknowns"] < 0.95 * whole["unknowns"]
    assert whole["coarse_solve"] is None
