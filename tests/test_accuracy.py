"""Accuracy asked for: the search on errors that are known, and a small finger from scene to summary."""

import csv
import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from fingerpad.accuracy import solves
from fingerpad.accuracy.refinement import Refinement, with_errors
from fingerpad.accuracy.rigid_screen import ORDER
from fingerpad.accuracy.solves import Solve, State
from fingerpad.model.options import FingerModel, plan
from fingerpad.model.touching import by_rule
from fingerpad.richardson import MORE, ONCE
from fingerpad.scene import from_data
from tests.runs import run
from variational.contact.penalty import Penalty
from variational.solvers.continuation import StepFailed
from variational.solvers.equations import Control
from variational.solvers.transfer import StateSnapshot
from variational.state import ContactState

NOTHING = StateSnapshot(*(np.zeros(0) for _ in range(2)), {}, {}, {}, {}, np.zeros(2), Control(), 0.0)
EXACT = 0.5


# -- the search, on a finger whose errors are known -----------------------------------------------------------
def mu_app(mesh) -> float:
    """An error of first order in the contact size and second in the growth; sites have one of second in theirs."""
    return EXACT * (1 + 0.08 * mesh.contact / 20e-6 - 0.02 * (mesh.growth / 0.5) ** 2)


def contact(**values) -> ContactState:
    """Return a state whose other results do not matter."""
    rest = {"f_ext": 75.0, "voltage": 200.0, "f_contact": 100.0, "f_electrostatic": 25.0, "ridges_in_contact": 17}
    return ContactState(**(rest | {"contact_length": 1e-3, "mu_app": 0.5, "f_t": 37.5} | values))


def change(solve: Solve, **values) -> None:
    """Change results of full slip."""
    kept = solve.states["full_slip"]
    solve.states["full_slip"] = replace(kept, state=replace(kept.state, **values))


def model_of(data) -> FingerModel:
    """Return the model of a scene as a run makes it."""
    scene = from_data(data)
    return FingerModel(by_rule(scene), plan(scene))


def known(model, states, comm, views=False) -> Solve:
    row = contact(mu_app=mu_app(model.mesh), f_t=75 * mu_app(model.mesh))
    sed = {0: 1e3 * (1 + (model.mesh.receptor / 60e-6) ** 2), 1: 10.0}
    return Solve({"full_slip": State(NOTHING, 1, row, np.full(17, 1e-3 / 17), sed)}, model.mesh, 1000, 10, 1.0)


def search(monkeypatch, asked, solve=known, pause=lambda: None) -> Refinement:
    memory = {"numerics": {"memory": 1e15}}  # of solves that are none
    model = model_of(({"accuracy": asked} if asked else {}) | memory)
    monkeypatch.setattr(solves, "solve_again", solve)
    found = Refinement(model, known(model, {}, MPI.COMM_SELF), MPI.COMM_SELF, lambda text: None, pause)
    found.run()
    return found


@pytest.mark.parametrize("asked", [{"mu_app": 0.01}, {"contact_length": 0.02}])
def test_no_more_solves_are_announced_than_come(monkeypatch, asked):
    """At least so many; in the last round all of them."""
    told, own = [], Refinement.__init__

    def start(self, model, path, comm, show, pause):
        own(self, model, path, comm, show, lambda: told.append((self.to_come, self.solves.least())))

    monkeypatch.setattr(Refinement, "__init__", start)
    found = search(monkeypatch, asked)
    count = len(found.solves.found) - 1
    assert len(told) == count and all(0 < number <= count - k for k, (number, _) in enumerate(told))
    assert [number for number, _ in told[-2:]] == [2, 1], (
        "the last of the meshes, and the screen of twice the stiffness"
    )
    assert [seconds for _, seconds in told] == [0.0] + [1.0] * (count - 1), "of the solve before, on another mesh"


@pytest.mark.parametrize("tolerance", [0.05, 0.01, 0.002])
def test_true_error_is_within_what_is_asked_for(monkeypatch, tolerance):
    found = search(monkeypatch, {"mu_app": tolerance})
    assert not found.failure
    assert found.estimates()["full_slip_mu_app"] <= tolerance * mu_app(found.base.mesh)
    assert abs(mu_app(found.base.mesh) / EXACT - 1) <= tolerance


def test_estimate_is_of_the_true_errors_size(monkeypatch):
    """Magnitudes of two errors of other signs add up, and one halving takes second order for first: up to 3."""
    found = search(monkeypatch, {"mu_app": 0.01})
    mesh = found.base.mesh
    parts = EXACT * (0.08 * mesh.contact / 20e-6 + 0.02 * (mesh.growth / 0.5) ** 2)
    told = found.summary()["quantities"]["full_slip_mu_app"]
    assert parts * (1 - 1e-9) <= told["estimate"] <= 3 * parts
    assert MORE * told["estimate"] * (1 - 1e-9) <= told["error"] <= ONCE * told["estimate"] * (1 + 1e-9)


def test_only_what_costs_accuracy_is_refined(monkeypatch):
    """Each once, for its share; then 0.08 is asked for: the contact's, twice 0.04, is more than half of it, the
    growth's, twice 0.015, is not."""
    found = search(monkeypatch, {"mu_app": 0.08})
    assert found.refinements == {"contact": 2, "bulk": 1}


def test_steps_are_halved_where_normal_contact_feels_them(monkeypatch):
    """An error of first order in the steps, a tenth with the scene's: two halvings leave 2.5 %, and 4 % are asked for.

    States solved again keep the steps of the path that they came from.
    """
    paths = []

    def stepped(scale: float, mesh) -> Solve:
        length = 1e-3 * (1 + 0.1 * scale)
        row = contact(contact_length=length)
        return Solve({"charged": State(NOTHING, 0, row, np.array([length]), {})}, mesh, 1000, 10, 1.0)

    def with_steps(search, scale: float) -> Solve:
        paths.append(scale)
        found = stepped(scale / 2, model.mesh)
        search.found.append(found)
        return found

    monkeypatch.setattr(solves.Solves, "with_steps", with_steps)
    monkeypatch.setattr(
        solves,
        "solve_again",
        lambda model, states, comm, views: Solve(dict(states), model.mesh, 1000, 10, 1.0),
    )
    model = model_of({"accuracy": {"contact_length": 0.04}, "numerics": {"step_scale": 2.0}})
    path = stepped(1.0, model.mesh)
    found = Refinement(model, path, MPI.COMM_SELF, lambda text: None, lambda: None)
    found.run()
    assert paths == [4.0, 1.0, 0.5]
    assert found.refinements == {"contact": 1, "bulk": 1, "steps": 2}
    assert found.base.values()["charged_contact_length"] == pytest.approx(1.025e-3, rel=1e-12)
    assert found.estimates()["charged_contact_length"] == pytest.approx(MORE * 0.025e-3, rel=1e-9)
    assert found.summary()["step_scale"] == 0.5, "a quarter of the scene's"


def test_receptors_are_halved_where_energy_density_is_asked_for(monkeypatch):
    """What is allowed is a part of the largest site's; of the second site's own it is never asked for."""
    found = search(monkeypatch, {"sed": 0.005})
    assert found.refinements["receptor"] > 1
    assert found.refinements["contact"] == 1
    largest = found.base.values()["full_slip_sed_0"]
    assert found.allowed() == pytest.approx(
        {"full_slip_sed_0": 0.005 * largest, "full_slip_sed_1": 0.005 * largest}, rel=1e-12
    )


def test_estimate_alone_refines_nothing(monkeypatch):
    """Coarser meshes tell the error: none is finer than the scene's. The last one tells of the penalty."""
    sizes = []

    def noted(model, states, comm, views=False):
        sizes.append(model.mesh)
        return known(model, states, comm)

    found = search(monkeypatch, {}, noted)
    own = found.model.mesh
    assert found.base.mesh == own
    assert [(m.contact / own.contact, m.growth / own.growth, m.receptor / own.receptor) for m in sizes] == [
        (2, 1, 1),
        (1, 2, 1),
        (1, 1, 2),
        (1, 1, 1),
    ]
    parts = EXACT * (0.08 * own.contact / 20e-6 + 0.02 * (own.growth / 0.5) ** 2)
    told = found.summary()["quantities"]["full_slip_mu_app"]
    assert parts * (1 - 1e-9) <= told["estimate"] <= 3 * parts
    assert told["error"] == pytest.approx(ONCE * told["estimate"], rel=1e-12)


def springs(model, states, comm, views=False) -> Solve:
    """A contact that springs of the screen make longer, by their law."""
    solve = known(model, states, comm)
    if isinstance(model.contact, Penalty):
        change(solve, contact_length=1e-3 + 1e-5 * (model.contact.eps_n / 1.5e12) ** -ORDER)
    return solve


def test_what_the_penalty_changes_is_told_beside_the_error(monkeypatch):
    """A rigid screen takes off what the springs put on, and no part of that is in the error of the mesh."""
    monkeypatch.setattr(solves, "solve_again", springs)
    model, lines = model_of({}), list[str]()
    path = springs(model, {}, MPI.COMM_SELF)
    found = Refinement(model, path, MPI.COMM_SELF, lines.append, lambda: None)
    found.run()
    state = with_errors(found, {"full_slip": contact()})["full_slip"]
    assert state.penalty.contact_length == pytest.approx(-1e-5, rel=1e-9)
    assert found.summary()["quantities"]["full_slip_contact_length"]["penalty"] == state.penalty.contact_length
    assert state.error.contact_length == 0
    assert "penalty: a rigid screen would change" in lines[-1]
    assert all("estimated discretisation error" in line for line in lines if "±" in line)


@pytest.mark.parametrize("formulation", ["nitsche", "augmented"])
def test_formulations_without_a_penalty_tell_none(monkeypatch, formulation):
    monkeypatch.setattr(solves, "solve_again", springs)
    model = model_of({"contact": {"formulation": formulation}})
    found = Refinement(model, springs(model, {}, None), MPI.COMM_SELF, lambda text: None, lambda: None)
    found.run()
    assert found.penalty == {}
    assert with_errors(found, {"full_slip": contact()})["full_slip"].penalty.known() == {}


def test_penalty_that_cannot_be_told_is_noted(monkeypatch):
    """The run and its error stay."""

    def lost(model, states, comm, views=False):
        if model.contact.eps_n > 1.5e12:
            raise StepFailed("full slip found no equilibrium")
        return known(model, states, comm)

    found = search(monkeypatch, {}, lost)
    assert not found.failure
    assert found.notes == ["the effect of the penalty could not be estimated: full slip found no equilibrium"]
    assert found.estimates()["full_slip_mu_app"] > 0


def test_says_when_the_accuracy_is_out_of_reach(monkeypatch):
    """An error that no refinement lowers."""

    def stubborn(model, states, comm, views=False):
        solve = known(model, states, comm)
        sign = 1 if round(np.log2(20e-6 / model.mesh.contact)) % 2 else -1
        change(solve, mu_app=EXACT * (1 + 0.1 * sign))
        return solve

    found = search(monkeypatch, {"mu_app": 0.01}, stubborn)
    assert "not within the accuracy asked for after" in found.failure
    assert found.summary()["reached"] is False


def test_says_when_a_state_is_lost(monkeypatch):
    def lost(model, states, comm, views=False):
        raise StepFailed("full slip found no equilibrium")

    found = search(monkeypatch, {"mu_app": 0.01}, lost)
    assert found.failure == "the accuracy asked for could not be established: full slip found no equilibrium"
    assert found.summary()["quantities"] == {}


def test_says_where_a_ridge_comes_or_goes(monkeypatch):
    def fewer(model, states, comm, views=False):
        solve = known(model, states, comm)
        change(solve, ridges_in_contact=16 if model.mesh.contact < 20e-6 else 17)
        return solve

    notes = search(monkeypatch, {"mu_app": 0.2}, fewer).notes
    assert notes == ["halving contact: 16 ridges in contact at full slip instead of 17"]


def test_friction_without_full_slip_is_refused():
    model = model_of({"accuracy": {"mu_app": 0.01}})
    path = Solve({"charged": known(model, {}, None).states["full_slip"]}, model.mesh, 1000, 10, 1.0)
    with pytest.raises(StepFailed, match="accuracy.mu_app is 0.01, which full slip decides"):
        Refinement(model, path, MPI.COMM_SELF, lambda text: None, lambda: None)


# -- a small finger ----------------------------------------------------------------------------------------
SMALL = {
    "f_ext": 1.0,
    "voltage": 100.0,
    "geometry": {"ridge_count": 9},
    "mesh": {"contact": 40e-6, "receptor": 100e-6, "interface": 200e-6, "growth": 1.0, "touching_half_arc": 1.0e-3},
}


def test_small_finger_tells_what_its_penalty_changes(tmp_path: Path):
    """Springs make a contact longer, here by a hundredth of it; meshes of twice the sizes have no part in that.

    Facets of 15 um: where a ridge's contact is two or three facets long, springs move its edge by one or by none.
    """
    mesh = SMALL["mesh"] | {"contact": 15e-6}
    summary = run(from_data(SMALL | {"f_ext": 3.0, "mesh": mesh}), tmp_path, MPI.COMM_WORLD)
    quantities = summary["accuracy"]["quantities"]
    assert {
        "charged_contact_length",
        "full_slip_contact_length",
        "full_slip_f_t",
        "full_slip_mu_app",
        "full_slip_sed_0",
    } <= set(quantities)
    for name in ("full_slip_f_t", "full_slip_mu_app"):
        assert 0 < summary[f"{name}_error"] == quantities[name]["error"] < quantities[name]["value"]
    for name in (
        "charged_contact_length",
        "full_slip_contact_length",
    ):  # of few facets; below the value in test_results
        assert 0 < summary[f"{name}_error"] == quantities[name]["error"]
    for state in ("charged", "full_slip"):
        assert -0.03 < summary[f"{state}_contact_length_penalty"] / summary[f"{state}_contact_length"] < -0.003
    assert abs(summary["full_slip_mu_app_penalty"]) < 0.01 * summary["full_slip_mu_app"]
    spent = summary["accuracy"]["solves"]
    assert spent[-1]["mesh"] == spent[0]["mesh"], "on the same mesh"
    assert spent[-1]["factorisations"] < spent[0]["factorisations"] / 2


def test_run_without_errors_says_none(tmp_path: Path):
    """And what it took, which grows from step to step up to what the summary says."""
    summary = run(from_data(SMALL | {"output": {"errors": False}}), tmp_path, MPI.COMM_WORLD)
    assert "accuracy" not in summary and "full_slip_mu_app_error" not in summary
    with (tmp_path / "steps.csv").open(encoding="utf-8", newline="") as file:
        seconds = [float(row["processor_seconds"]) for row in csv.DictReader(file)]
    assert 0 < seconds[0]
    assert all(a <= b for a, b in itertools.pairwise([*seconds, summary["processor_seconds"]]))
    assert seconds[-1] > seconds[0]


@pytest.mark.parametrize(
    ("places", "kept"),
    [
        ((None, None, 1e-3), 2),
        ((2e-3, None, 3e-3), 2),
        ((2e-3, 2e-3, 1e-3), 2),
        ((2e-3, 3e-3, 4e-3), 1),
        ((None, None, None, 2e-3, None, 3e-3), 5),
    ],
)
def test_loads_to_normal_contact(places, kept):
    """A way through the air is none; a bone that is pressed and moved in one load slides in that load."""
    loads = [{"name": "away", "bone_height": 1e-5}, {"name": "press", "f_ext": 1.0}, {"name": "slide"}]
    if len(places) > 3:
        loads[2:] = [{"name": "lift", "bone_height": 1e-5}, {"name": "over"}, {"name": "again", "f_ext": 1.0}, loads[2]]
    moves = [{} if place is None else {"bone_x": place} for place in places]
    scene = from_data({"history": [load | move for load, move in zip(loads, moves, strict=True)]})
    assert solves.loads_to_normal_contact(scene.loads()) == scene.history[:kept]
