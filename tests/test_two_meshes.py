"""An accuracy at 0 V: which states are of the final mesh."""

import numpy as np
import pytest
from mpi4py import MPI

from fingerpad.accuracy import solves
from fingerpad.accuracy.refinement import Refinement, with_errors
from fingerpad.accuracy.solves import Solve, State
from tests.test_accuracy import NOTHING, contact, model_of


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
