"""Sweeps of full slip from point to point: order, chains, paths in between, and tables."""

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from mpi4py import MPI

import fingerpad as fp
from fingerpad.accuracy.states import Solve
from fingerpad.model.full_slip import Solved
from fingerpad.results.data import Cost
from fingerpad.results.result import Result
from fingerpad.runs import batch as of_sweep
from fingerpad.runs import full_slip
from fingerpad.runs.batch import chains
from fingerpad.runs.full_slip import Chain, Fine
from fingerpad.runs.sweep import _neighbours
from fingerpad.scene import SceneError, from_data
from geometry.parameters import MeshSize
from tests.small_finger import NINE
from variational.solvers.continuation import StepFailed
from variational.solvers.outcome import Counts
from variational.state import ContactState, Errors

SCENE = NINE | {"f_ext": 1.0, "voltage": 100.0, "output": {"errors": False, "receptors": False}}


def scenes(**axis):
    ((key, values),) = axis.items()
    return {str(value): from_data(SCENE | {key: value}) for value in values}


def test_each_point_is_beside_the_one_before():
    """From the least voltage and force on, one axis and one value at a time; voltages are the fastest."""
    axes = {"voltage": (0.0, 200.0, -100.0), "f_ext": (10.0, 30.0, 20.0, 40.0), "numerics.element": ("P1", "P2")}
    along = _neighbours(axes)
    assert sorted(along) == list(range(24))
    places = np.array(np.unravel_index(along, (3, 4, 2))).T
    ranks = np.column_stack([np.array([0, 2, 1])[places[:, 0]], np.array([0, 2, 1, 3])[places[:, 1]], places[:, 2]])
    assert (np.abs(np.diff(ranks, axis=0)).sum(axis=1) == 1).all()
    assert (np.diff(ranks[:, 0]) != 0).sum() == 8 * 2
    assert (axes["voltage"][places[0, 0]], axes["f_ext"][places[0, 1]]) == (0.0, 10.0)


def test_chains_share_a_mesh_and_a_law():
    """Loads, laws' numbers, roughness and insulators leave the mesh as it is; sizes and another law do not."""
    free = [{}, {"voltage": 50.0}, {"f_ext": 2.0}, {"friction": 0.3}, {"electric": {"d_i": 2e-6}}]
    law = {"law": "Derjaguin", "mu_f": 0.3, "tau_0": 10.0}
    other = [{"mesh": NINE["mesh"] | {"contact": 30e-6}}, {"friction": law}]
    every = {str(k): from_data(SCENE | each) for k, each in enumerate([*free, *other])}
    assert list(chains(every, 2)) == [["0", "1", "2", "3", "4"], ["5"], ["6"]]


def test_closures_are_no_neighbours():
    """Numbers of one closure are; another closure, or another field in contact, is far away."""
    law = {"law": "BoundaryElements"}
    one = [law, law | {"shortest_wave": 3e-6}, law | {"hurst": 0.8}]
    other = [{}, {"law": "Persson"}, law | {"field_in_contact": False}]
    every = {str(k): from_data(SCENE | {"roughness": each}) for k, each in enumerate([*one, *other])}
    assert list(chains(every, 1)) == [["0", "1", "2"], ["3"], ["4"], ["5"]]


class Skin:
    """In place of a finger: below 60 V there are 3 ridges, above 80 V 5, and between as many as there were before."""

    def __init__(self, missing=()):
        self.missing, self.paths = missing, 0
        interface = SimpleNamespace(formulation=None)
        solver = SimpleNamespace(counts=Counts(), iteration=SimpleNamespace(free=lambda: None))
        self.finger = SimpleNamespace(
            solver=solver, unknowns=7, force_error=1e-9, problem=SimpleNamespace(interface=interface), size=MeshSize()
        )

    def _found(self, conditions, ridges, reached):
        f_t = 0.25 * ridges
        state = ContactState(
            f_ext=1.0, voltage=conditions.voltage, f_t=f_t, mu_app=f_t, f_contact=f_t / 0.25,
            f_electrostatic=f_t / 0.25 - 1.0, ridges_in_contact=ridges, contact_length=0.0, slip_held=True,
            reached=reached,
        )  # fmt: skip
        return Solved(conditions, state, None)

    def first(self, conditions):
        if conditions.voltage in self.missing:
            raise StepFailed("no path")
        self.paths += 1
        return self._found(conditions, 3 if conditions.voltage < 60 else 5, "path")

    def solve(self, conditions, start):
        if conditions.voltage in self.missing or (start.conditions.voltage == 90.0 and conditions.voltage == 75.0):
            raise StepFailed("not found")
        u = conditions.voltage
        ridges = 3 if u < 60 else 5 if u > 80 else start.state.ridges_in_contact
        return self._found(conditions, ridges, f"full slip from {start.conditions.difference(conditions)}")


def followed(monkeypatch, skin, voltages):
    monkeypatch.setattr(Chain, "_path", lambda self, model: skin)
    made = Chain([*scenes(voltage=voltages).values()], None, MPI.COMM_SELF)
    written = list(made.follow())
    return made.results, written


def test_chain_reports_the_state_on_its_side(monkeypatch):
    """Down from 100 V five ridges touch at 70 V, where up from 50 V three do."""
    down, _ = followed(monkeypatch, Skin(), [100.0, 70.0, 65.0, 50.0])
    up, _ = followed(monkeypatch, Skin(), [50.0, 65.0, 70.0, 100.0])
    assert [r.full_slip.ridges_in_contact for r in down] == [5, 5, 5, 3]
    assert [r.full_slip.ridges_in_contact for r in up] == [3, 3, 3, 5]
    assert down[1].record["reached"] == "full slip from voltage 100 V"


def test_point_not_found_from_its_neighbour_has_a_path(monkeypatch):
    skin = Skin()
    results, _ = followed(monkeypatch, skin, [100.0, 90.0, 75.0, 70.0])
    assert [r.full_slip.reached for r in results[1:3]] == ["full slip from voltage 100 V", "path"]
    assert "It was not found from its neighbour: not found." in results[2].notes
    assert results[3].full_slip.reached == "full slip from voltage 75 V"
    assert results[3].notes[0].endswith("it was reached by: full slip from voltage 75 V.")
    assert skin.paths == 2


def test_point_without_full_slip_has_its_failure(monkeypatch):
    """The others go on from the last one that was found."""
    results, _ = followed(monkeypatch, Skin(missing=(90.0,)), [100.0, 90.0, 85.0])
    assert results[1].failure == "no path" and results[1].full_slip is None
    assert results[2].full_slip.reached == "full slip from voltage 100 V"


def sharp(state, **changes):
    """Return a state as on another mesh, and what it took there."""
    found = replace(state, error=Errors(f_t=0.1), **changes)
    return Fine(found, Solve({}, MeshSize(), 100, 5, 1.0, 9))


def test_point_has_the_values_and_errors_of_the_scenes_mesh(monkeypatch):
    """And what both meshes took; where other ridges touch on the two, a caution gives both."""
    monkeypatch.setattr(Chain, "_final", lambda self, model, state: sharp(state, ridges_in_contact=4, f_t=0.99))
    (result,), _ = followed(monkeypatch, Skin(), [100.0])
    assert (result.full_slip.f_t, result.full_slip.error.f_t) == (0.99, 0.1)
    cost = result.cost
    assert (cost.unknowns, cost.factorisations, cost.newton_iterations) == (100, 5, 9)
    assert result.record["accuracy"]["mesh"] == MeshSize().model_dump() and "path_mesh" in result.record
    assert any(
        "0.99 N/m with 4 ridges on the scene's mesh, and 1.25 N/m with 5" in text.text for text in result.cautions
    )
    monkeypatch.setattr(Chain, "_final", lambda self, model, state: sharp(state))
    (result,), _ = followed(monkeypatch, Skin(), [100.0])
    assert not any("mesh" in text.text for text in result.cautions)


def test_point_not_found_on_the_scenes_mesh_is_a_run(monkeypatch):
    """The next one goes on from the state of the chain's mesh."""
    run = ContactState(
        f_ext=1.0, voltage=70.0, f_t=0.5, mu_app=0.5, f_contact=2.0, f_electrostatic=1.0, ridges_in_contact=5,
        contact_length=1e-3,
    )  # fmt: skip
    made = Result(from_data(SCENE), "full", None, None, run, cost=Cost(factorisations=70), record={"restarts": []})
    monkeypatch.setattr("fingerpad.runs.full.run", lambda scene, context: made)

    def missing(self, model, state):
        if state.voltage == 70.0:
            raise StepFailed("not there")

    monkeypatch.setattr(Chain, "_final", missing)
    results, _ = followed(monkeypatch, Skin(), [100.0, 70.0, 65.0])
    assert results[1].full_slip is run and results[1].cost.factorisations == 70
    assert results[1].record == {"restarts": [], "reached": "path"}
    assert results[1].notes[0].endswith("since it was not found from a state on larger elements: not there.")
    assert results[2].full_slip.reached == "full slip from voltage 70 V"


@pytest.mark.slow
def test_sweep_of_full_slip_is_that_of_paths(tmp_path, monkeypatch):
    """To 1e-6, with its own mesh given; a sweep as before starts no process."""
    scene, axes = from_data(SCENE), {"friction": [0.0, 0.25], "voltage": [0, 60]}
    paths = fp.sweep(scene, tmp_path / "paths", quiet=True, voltage=[0, 60])
    direct = fp.sweep(scene, tmp_path / "direct", states="full_slip", quiet=True, **axes)
    assert [bool(r.failure) for r in direct] == [True, True, False, False]
    assert direct[0].failure.startswith("friction is 0")
    for quantity in ("f_t", "mu_app", "f_electrostatic"):
        assert direct.array(quantity)[1] == pytest.approx(paths.array(quantity), rel=1e-6), quantity
    assert direct.array("contact_length")[1] == pytest.approx(paths.array("contact_length"), rel=1e-5)
    assert [r.full_slip.reached for r in direct[2:]] == ["full slip from voltage 60 V", "path"]
    assert "1 of 2 full-slip states were continued from the neighbouring point, 1 computed along the load path." in str(
        direct
    )
    row = direct.rows()[2]
    assert row["full_slip_reached"] == "full slip from voltage 60 V"
    assert not any(column.startswith(("uncharged", "charged")) for column in row)
    assert "--states full_slip" in (tmp_path / "direct" / "report.html").read_text(encoding="utf-8")

    started, run = [], of_sweep.run
    monkeypatch.setattr(of_sweep, "run", lambda *args: started.append(args) or run(*args))
    again = fp.sweep(scene, tmp_path / "direct", states="full_slip", quiet=True, **axes)
    assert not started
    assert again.array("f_t")[1] == pytest.approx(direct.array("f_t")[1], rel=0, abs=0)


@pytest.mark.slow
def test_states_with_errors_are_those_of_runs(tmp_path):
    """A point's values and errors are of the meshes that a run has for its full slip.

    Tolerance: the air gaps' of 1e-6, which the ends of contact follow, and with them the places of facets.
    """
    scene = from_data(SCENE | {"output": {"errors": True, "receptors": False}})
    direct = fp.sweep(scene, tmp_path, states="full_slip", quiet=True, voltage=[60, 80])
    run = fp.run(scene.replace(voltage=60))
    mine, its = direct[0].full_slip, run.full_slip
    assert (mine.reached, direct[1].full_slip.reached) == ("path", "full slip from voltage 60 V")
    assert direct[1].notes[0].startswith("This is full slip alone, solved for again on the scene's mesh;")
    for name in ("f_t", "mu_app", "contact_length", "f_electrostatic", "p_max"):
        assert getattr(mine, name) == pytest.approx(getattr(its, name), rel=1e-4), name
    for name, error in mine.error.known().items():
        assert error == pytest.approx(its.error.known()[name], rel=1e-2), name
    assert set(mine.error.known()) == set(its.error.known())
    assert direct[1].full_slip.error.contact_length > 0
    assert direct[0].record["accuracy"]["mesh"] == run.record["accuracy"]["mesh"]
    row = direct.rows()[0]
    assert row["full_slip_f_t_error"] == mine.error.f_t and " ± " in str(direct)


@pytest.mark.slow
def test_chain_that_was_stopped_goes_on(tmp_path, monkeypatch):
    """Of its points those that are missing are followed, the first of them by a path; numbers as in one go."""
    voltages = [20.0, 40.0, 60.0, 80.0]
    scene, write, written = from_data(SCENE), full_slip.kept, []
    every = scenes(voltage=voltages)
    file = tmp_path / "asked.json"
    file.write_text(json.dumps({"half_arc": None, "scenes": [each.parameters() for each in every.values()]}))

    def stopped(*given):
        if len(written) == 2:
            raise KeyboardInterrupt
        written.append(write(*given))

    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(full_slip, "kept", stopped)
        full_slip.main(file, tmp_path / "cut" / "full_slip")
    asked, run = [], of_sweep.run

    def seen(module, given, *more):
        asked.append(json.loads(Path(given[0]).read_text()))
        return run(module, given, *more)

    monkeypatch.setattr(of_sweep, "run", seen)
    cut = fp.sweep(scene, tmp_path / "cut", states="full_slip", quiet=True, voltage=voltages)
    assert [[each["voltage"] for each in given["scenes"]] for given in asked] == [voltages[2:]]
    whole = fp.sweep(scene, tmp_path / "whole", states="full_slip", quiet=True, voltage=voltages)
    reached = [r.full_slip.reached for r in cut]
    assert reached[::2] == ["path", "path"] and reached[3] == "full slip from voltage 60 V"
    for quantity in ("f_t", "f_electrostatic", "contact_length"):
        assert cut.array(quantity) == pytest.approx(whole.array(quantity), rel=1e-5), quantity


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"accuracy": {"mu_app": 0.01}}, "accuracy is given"),
        ({"history": [{"name": "press", "f_ext": 1.0}]}, "history is given"),
        (
            {"materials": {"dermis": {"viscosity": {"preset": "fingerpad"}}}},
            "materials.dermis.viscosity is given, and a state needs the past of its layers; with states='full_slip' it",
        ),
        (
            {"friction": {"law": "Occlusion", "mu_dry": 0.2, "mu_wet": 0.8, "time": 0.5}},
            "friction has the law 'Occlusion', on whose memory full slip depends; with states='full_slip' it must have",
        ),
    ],
)
def test_other_scenes_are_refused(changes, message, tmp_path):
    with pytest.raises(SceneError, match=message):
        fp.sweep(fp.Scene(**changes), tmp_path, states="full_slip", **{"roughness.h_rms": [2e-6]})
