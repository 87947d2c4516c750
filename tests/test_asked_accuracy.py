"""Accuracies that scenes ask for: what is read and refused, how results are printed, where a run starts again finer."""

import signal

import numpy as np
import pytest
from mpi4py import MPI

from fingerpad.accuracy import solves
from fingerpad.accuracy.refinement import Refinement, with_errors
from fingerpad.accuracy.solves import Solve, State
from fingerpad.io.interrupt import Interrupted
from fingerpad.richardson import plus_minus
from fingerpad.runs import attempt
from fingerpad.scene import SceneError, from_data
from tests.test_accuracy import NOTHING, change, contact, known, model_of, search
from variational.solvers.continuation import StepFailed
from variational.solvers.failure import NotConverged

# -- scenes ------------------------------------------------------------------------------------------------


def test_scene_that_asks_starts_coarse_where_it_gives_no_size():
    mesh = from_data({"accuracy": {"mu_app": 0.01}, "mesh": {"growth": 0.3}}).mesh
    assert (mesh.contact, mesh.growth, mesh.receptor) == (20e-6, 0.3, 40e-6)
    assert from_data({"accuracy": {"sed": 0.01}}).mesh.receptor == 10e-6, "coarser sites do not see the tips"


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"accuracy": {"mu_app": 1.5}}, "accuracy.mu_app is 1.5; it must be from 1e-06 to 0.5"),
        ({"accuracy": {"f_n": 0.1}}, "accuracy.f_n is not a key of accuracy"),
        ({"accuracy": {}}, "accuracy is empty; give at least one of accuracy.mu_app, accuracy.f_t"),
        (
            {"accuracy": {"sed": 0.1}, "output": {"receptors": False}},
            "accuracy.sed is 0.1 and output.receptors is false, without which there are no sites",
        ),
        (
            {"accuracy": {"f_t": 0.1}, "friction": 0},
            "accuracy.f_t is 0.1 and friction is 0, with which the quantity is zero and has no relative accuracy",
        ),
        (
            {"accuracy": {"f_t": 0.1}, "history": [{"name": "Full_slip", "f_ext": 1.0}]},
            "history.0..name is 'Full_slip' and accuracy is given, with which the state of that name has files",
        ),
    ],
)
def test_impossible_accuracy_is_refused(given, words):
    with pytest.raises(SceneError, match=words):
        from_data(given)


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [(0.47512, 0.0041, "0.4751 ± 0.0041"), (39.226, 12.0, "39 ± 12"), (1.0, 0.0, "1.000000 ± 0.000000")]
    + [(-1e-9, 0.01, "0.000 ± 0.010")],
)
def test_plus_minus(value, error, text):
    assert plus_minus(value, error) == text


# -- from which mesh ---------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("start", "helps", "finer"),
    [(20e-6, True, 10e-6), (20e-6, False, None), (8e-6, True, None)],
)
@pytest.mark.parametrize("asked", [{"mu_app": 0.01}, {}])
def test_starts_again_finer_where_the_path_is_lost(asked, start, helps, finer):
    """With half the contact size; not where that cannot help, nor below the limit."""
    model = model_of(({"accuracy": asked} if asked else {}) | {"mesh": {"contact": start}})
    lost: StepFailed = StepFailed("no equilibrium")
    lost.__cause__ = NotConverged("DIVERGED_LOCAL_MIN" if helps else "NOT_A_NUMBER", False)
    if asked and not helps:  # any loss of a mesh to start from may be its coarseness
        lost = Interrupted(signal.SIGTERM, 3)
    restart = attempt._finer(model, lost)
    assert (restart and restart.model.mesh.contact) == finer


def test_interrupted_search_reached_nothing(monkeypatch):
    """Neither before its first solve nor between two, and that is no accuracy out of reach; what ends by itself did."""
    model, lines = model_of({"accuracy": {"mu_app": 0.01}, "numerics": {"memory": 1e15}}), []
    monkeypatch.setattr(solves, "solve_again", known)
    for solves_before in (0, 2):
        to_come = iter(range(solves_before))

        def pause(to_come=to_come):
            if next(to_come, None) is None:
                raise Interrupted(signal.SIGINT, 3)

        found = Refinement(model, known(model, {}, MPI.COMM_SELF), MPI.COMM_SELF, lines.append, pause)
        with pytest.raises(Interrupted):
            found.run()
        assert not found.failure and not found.summary()["reached"]
    assert search(monkeypatch, {"mu_app": 0.01}).summary()["reached"]


# -- without a force that presses ---------------------------------------------------------------------------
def test_errors_without_a_force_are_those_of_the_friction_force(monkeypatch):
    """There is no coefficient then, and no line that says nan ± nan."""

    def unpressed(model, states, comm, views=False):
        solve = known(model, states, comm)
        change(solve, mu_app=np.nan)
        return solve

    model, shown = model_of({"numerics": {"memory": 1e15}}), []
    monkeypatch.setattr(solves, "solve_again", unpressed)
    found = Refinement(model, unpressed(model, {}, MPI.COMM_SELF), MPI.COMM_SELF, shown.append, lambda: None)
    found.run()
    assert "full_slip_f_t" in found.estimates() and "full_slip_mu_app" not in found.estimates()
    assert any("friction force" in line for line in shown) and not any("nan" in line for line in shown)


def test_coefficient_without_a_force_is_refused():
    """A finger that slides while nothing presses it has a friction force, and no coefficient to be within 1 %."""
    model = model_of({"accuracy": {"mu_app": 0.01}})
    path = known(model, {}, None)
    change(path, mu_app=np.nan)
    with pytest.raises(StepFailed, match="at full slip no force presses the finger.* ask for accuracy.f_t"):
        Refinement(model, path, MPI.COMM_SELF, lambda text: None, lambda: None)


# -- An accuracy at 0 V: which states are of the final mesh ---
@pytest.mark.parametrize(("step", "final"), [(7, True), (3, False)])
def test_uncharged_state_that_is_the_charged_one_is_of_the_final_mesh(monkeypatch, step, final):
    """At 0 V they are one step of the path. Another step is solved on no other mesh, and stays."""

    def solve(model, states, comm, views=()):
        row = contact(contact_length=1e-3)
        return Solve({"charged": State(NOTHING, 0, row, np.array([1e-3]), {})}, model.mesh, 1000, 10, 1.0)

    monkeypatch.setattr(solves, "solve_again", solve)
    model = model_of({"contact": {"formulation": "nitsche"}})
    found = Refinement(model, solve(model, {}, None), MPI.COMM_SELF, lambda text: None, lambda: None)
    found.run()
    path = {name: contact(contact_length=2e-3, step=at) for name, at in (("uncharged", step), ("charged", 7))}
    states = with_errors(found, path)
    assert states["charged"].contact_length == 1e-3
    assert states["uncharged"].contact_length == (1e-3 if final else 2e-3)
