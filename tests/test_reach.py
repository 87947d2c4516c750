"""Which ridges are meshed to touch: enough for every full run there is, and what they spare."""

import json
from pathlib import Path

import pytest
from mpi4py import MPI

from fingerpad.model.options import FingerModel, by_rule, plan
from fingerpad.model.simulation import Simulation
from fingerpad.scene import Scene, from_data
from geometry.profiles import GeometryError
from geometry.sizing import touching_ridges
from tests.runs import run

pytestmark = pytest.mark.slow
COMM = MPI.COMM_WORLD
PRESS = {"name": "press", "bone_height": -50e-6}
MESH = {"contact": 30e-6, "receptor": 80e-6, "interface": 150e-6, "growth": 0.8}
LIGHT = {"mesh": MESH, "history": [PRESS], "output": {"errors": False}}
RUNS = json.loads((Path(__file__).parent / "reach.json").read_text(encoding="utf-8"))
"""The last ridge, on either side, that is in contact in any step of a full run, by scene."""


def last_ridge(data: dict) -> int:
    """Return the last ridge that is meshed to touch in a scene."""
    scene = by_rule(from_data(data))
    return touching_ridges(scene.geometry, scene.mesh)[-1]


# -- the rule ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", RUNS)
def test_ridges_are_enough_for_what_full_runs_touch(name):
    """The last ridge that is meshed to touch must not touch, or the run starts again with more."""
    assert last_ridge(RUNS[name]["scene"]) > RUNS[name]["touched"]


def test_ridges_are_not_many_more_than_full_runs_touch():
    """At most two to spare over all forces and voltages, and five at a friction coefficient of 1."""
    spare = {name: last_ridge(run["scene"]) - run["touched"] for name, run in RUNS.items()}
    assert max(spare.pop("friction coefficient 1"), 0) <= 5
    assert max(spare.values()) <= 3


@pytest.mark.parametrize(
    ("data", "last"),
    [
        ({"f_ext": 75.0}, 10),
        ({"f_ext": 150.0}, 13),
        ({"f_ext": 0.01}, 2),
        ({"friction": 1.0}, 16),
        ({"history": [{"name": "a", "f_ext": 10.0}, {"name": "b", "f_ext": 150.0}]}, 13),
        ({"history": [{"name": "retract", "bone_height": 0.3e-3}]}, 2),
        ({"geometry": {"ridge_wavelength": 483e-6 / 2, "ridge_count": 61}}, 20),
        ({"history": [PRESS]}, 3),
        ({"history": [{"name": "press", "bone_height": -0.74e-3}]}, 10),
        ({"geometry": {"ridge_count": 1}}, 0),
    ],
)
def test_rule_of_thumb(data, last):
    """More ridges under a larger force, depth or friction, never fewer than two of those there are."""
    assert last_ridge(data) == last


def test_number_that_is_given_stands():
    scene = from_data({"mesh": {"touching_half_arc": 1.3e-3}})
    assert by_rule(scene) is scene


def test_undecided_finger_is_refused():
    with pytest.raises(GeometryError, match="touching_half_arc is not given"):
        Simulation(FingerModel(Scene(), plan(Scene())), COMM)


# -- what is left out ------------------------------------------------------------------------------------------
@pytest.mark.parametrize(("half_arc", "words"), [(1.3e-3, ["contact of the ridges beyond ±3"]), (0.1, [])])
def test_ridges_left_out_are_named(half_arc, words):
    scene = from_data({"mesh": {"touching_half_arc": half_arc}})
    needed = plan(scene)
    omitted = FingerModel(scene, needed).omitted
    assert [omission.what for omission in omitted[len(needed.omitted) :]] == words


# -- runs ------------------------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def lean(tmp_path_factory):
    """A lightly pressed finger whose ridges the rule chose."""
    folder = tmp_path_factory.mktemp("lean")
    return folder, run(from_data(LIGHT), folder, COMM)


def test_run_reports_what_was_left_out(lean):
    folder, summary = lean
    assert summary["omitted"][-1] == {
        "what": "contact of the ridges beyond ±3",
        "reason": "they are not expected to touch, which each accepted step is checked for",
    }
    assert "contact of the ridges beyond ±3 left out" in (folder / "run.log").read_text(encoding="utf-8")
    assert summary["charged_ridges_in_contact"] == 3
    assert summary["parameters"]["mesh"]["touching_half_arc"] is None


@pytest.mark.long
def test_same_answer_with_fewer_unknowns(lean, tmp_path):
    """As with ridges -10 to 10, on meshes that differ from ridge 4 on.

    Tolerance: they grow by 0.8 a distance, and the finer skin of the other gives by 1.4e-3 of the force. Facets of
    30 um are few: a twelfth of the unknowns is spared.
    """
    whole = run(from_data(LIGHT | {"mesh": MESH | {"touching_half_arc": 5e-3}}), tmp_path, COMM)
    for name in ("f_contact", "contact_length"):
        assert lean[1][f"charged_{name}"] == pytest.approx(whole[f"charged_{name}"], rel=3e-3), name
    assert lean[1]["unknowns"] < 0.95 * whole["unknowns"]
