"""A whole finger led by its half until the bone moves sideways: the same states, and a restart where it turns over."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from fingerpad.model import simulation
from fingerpad.model.options import FingerModel, plan
from fingerpad.model.simulation import RestartRequired, Simulation
from fingerpad.model.touching import by_rule
from fingerpad.runs import full
from fingerpad.scene import from_data
from tests.test_demo import MESH, NINE
from variational.state import ContactState

CLOSE = 1e-5  # relative: air gaps are within 1e-6
HISTORY = [
    {"name": "press", "f_ext": 1.0},
    {"name": "charge", "voltage": 100.0},
    {"name": "slide", "bone_x": 60e-6},
    {"name": "back", "bone_x": 0.0},
]


def follow(history, led: bool) -> list[ContactState]:
    """Return the states of a small finger's path, led by its half or not."""
    scene = by_rule(from_data(NINE | {"history": history, "mesh": MESH}))
    needed = plan(scene)
    assert needed.symmetric_start
    path = Simulation(FingerModel(scene, replace(needed, symmetric_start=led)), MPI.COMM_WORLD)
    assert path.run() is None
    return path.states


@pytest.mark.mpi
@pytest.mark.parametrize(
    "history",
    [
        HISTORY,
        [{"name": "lower", "bone_height": -60e-6}, *HISTORY[2:]],
        [HISTORY[0], {"name": "lift", "f_ext": 0.2}, *HISTORY[1:3]],
    ],
    ids=["press, charge, slide", "bone height", "lift"],
)
def test_half_leads_to_the_states_of_the_whole(history):
    led, whole = follow(history, True), follow(history, False)
    assert [state.load for state in led] == [state.load for state in whole]
    for mine, other in zip(led, whole, strict=True):
        for name in ("f_ext", "bone_height", "f_contact", "f_electrostatic", "contact_length", "slipping"):
            assert getattr(mine, name) == pytest.approx(getattr(other, name), rel=CLOSE, abs=1e-12), name
        assert mine.f_t == pytest.approx(other.f_t, rel=CLOSE, abs=1e-7)
        assert mine.ridges.d_eq == pytest.approx(other.ridges.d_eq, rel=CLOSE, nan_ok=True)


def test_state_that_the_half_leads_to_is_symmetric():
    last = [state for state in follow(HISTORY, True) if state.load == "charge"][-1]
    assert last.bone_x == 0.0
    assert abs(last.f_t) < 1e-12
    assert np.array_equal(last.ridges.d_eq, last.ridges.d_eq[::-1])


def test_whole_finger_from_the_start_where_the_symmetric_state_is_not_stable(monkeypatch):
    """Stability is examined on the whole finger, which a half may not lead where it turns over."""
    checks = simulation.StabilityChecks.check

    def unstable(self, load):
        found = checks(self, load)
        assert self._finger.options.both_halves
        return replace(found, frozen=replace(found.frozen, lambda_min=-1.0))

    monkeypatch.setattr(simulation.StabilityChecks, "check", unstable)
    result = full.run(from_data(NINE | {"history": HISTORY[:3], "mesh": MESH}), None, MPI.COMM_WORLD, lines=False)
    assert not result.failure
    (restart,) = result.record["restarts"]
    assert restart["load"] == "press"
    assert restart["both_halves"]
    assert "not stable" in restart["reason"]


def test_restart_does_not_lead_by_half_again():
    scene = by_rule(from_data(NINE | {"history": HISTORY, "mesh": MESH}))
    again = RestartRequired("", FingerModel(scene, plan(scene).with_both_halves())).model.options
    assert again.both_halves
    assert not again.symmetric_start
