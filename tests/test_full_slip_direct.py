"""Full slip solved for from full slip is that of the path, there and back; and what is refused."""

from dataclasses import replace

import pytest
from mpi4py import MPI

from fingerpad.model.full_slip import Conditions, FullSlips
from fingerpad.model.options import FingerModel, plan
from fingerpad.model.simulation import Simulation
from fingerpad.scene import from_data
from tests.small_finger import NINE
from variational.contact.friction import Derjaguin
from variational.solvers.continuation import StepFailed

pytestmark = pytest.mark.slow
SCENE = NINE | {"f_ext": 1.0, "voltage": 100.0, "output": {"errors": False, "receptors": False}}
CHAIN = (
    {"voltage": 50.0}, {"voltage": 0.0}, {"voltage": 80.0}, {"voltage": 80.0, "f_ext": 1.4}, {"f_ext": 0.8},
    {"friction": 0.4}, {"electric": {"d_i": 2e-6}}, {"roughness": {"h_rms": 2e-6}}, {},
)  # fmt: skip
"""Each from the one before; forces, voltage, friction, insulator and roughness go there and back."""


def model_of(changes):
    """Return the model of the scene with changes, with the attraction also where it has no voltage."""
    scene = from_data(SCENE | changes)
    return FingerModel(scene, plan(from_data(SCENE)))


def path_of(changes):
    simulation = Simulation(model_of(changes), MPI.COMM_WORLD)
    assert simulation.run() is None
    return simulation


@pytest.fixture(scope="module")
def solved():
    """The full slips of a path's end and of the chain from there."""
    slips = FullSlips(path_of({}))
    found = [slips.first(Conditions.of(model_of({})))]
    for changes in CHAIN:
        found.append(slips.solve(Conditions.of(model_of(changes)), found[-1]))
    return slips, found


@pytest.mark.mpi
def test_full_slip_is_that_of_the_path(solved):
    """Air gaps are solved to 1e-6, and forces depend on them less than in proportion."""
    for changes, direct in zip(CHAIN[:-1], solved[1][1:-1], strict=True):
        state = path_of(changes).states[-1]
        assert direct.state.f_t == pytest.approx(state.f_t, rel=1e-6), changes
        assert direct.state.contact_length == pytest.approx(state.contact_length, rel=1e-5), changes
        assert direct.state.ridges_in_contact == state.ridges_in_contact
        assert direct.state.f_ext == pytest.approx(state.f_ext, rel=1e-9)
        assert direct.state.slip_held and direct.state.stable


@pytest.mark.mpi
def test_chain_returns_to_where_it_began(solved):
    first, last = solved[1][0].state, solved[1][-1].state
    assert last.f_t == pytest.approx(first.f_t, rel=1e-6)
    assert last.bone_x == pytest.approx(first.bone_x, abs=1e-15), "the bone does not move with the chain"
    assert first.reached == "path"
    assert solved[1][1].state.reached == "full slip from voltage 100 V"
    assert "h_rms=2e-06" in last.reached


@pytest.mark.long
def test_voltage_that_changes_in_sliding_ends_in_direct_states(solved):
    """A waveform in steps, each slid on to full slip again: its ends are the states without a path, in its order."""
    slips, (first, *_) = solved
    far, voltages = 2e-3, (50.0, 0.0, 80.0)
    history = [{"name": "press", "f_ext": 1.0}, {"name": "charge", "voltage": 100.0}]
    history += [{"name": "slide", "bone_x": far, "until_full_slip": True}]
    for k, voltage in enumerate(voltages):
        history += [{"name": f"change {k}", "voltage": voltage, "bone_x_by": 0.1e-3}]
        history += [{"name": f"on {k}", "bone_x_by": 1e-3, "until_full_slip": True}]
    loads = {key: SCENE[key] for key in SCENE if key not in ("f_ext", "voltage")} | {"history": history}
    scene = from_data(loads)
    simulation = Simulation(FingerModel(scene, plan(scene)), MPI.COMM_WORLD)
    assert simulation.run() is None
    direct = first
    for k, voltage in enumerate(voltages):
        direct = slips.solve(replace(direct.conditions, voltage=voltage), direct)
        end = [state for state in simulation.states if state.load == f"on {k}"][-1]
        assert end.slip_held and end.f_t == pytest.approx(direct.state.f_t, rel=1e-6)
        assert end.ridges_in_contact == direct.state.ridges_in_contact


def test_what_is_not_found_is_refused(solved):
    """A ridge that cannot touch on this mesh; another law of friction, whose forms are others; no bad state is kept."""
    slips, (first, *_) = solved
    with pytest.raises(StepFailed, match="meshed to touch, is in contact"):
        slips.solve(replace(first.conditions, f_ext=40.0), first)
    with pytest.raises(ValueError, match="that law with other numbers"):
        slips.solve(replace(first.conditions, friction=Derjaguin(0.25, 1e3)), first)
    again = slips.solve(first.conditions, first)
    assert again.state.f_t == pytest.approx(first.state.f_t, rel=1e-6)


def test_unsteady_and_unstable_states_are_refused(solved, monkeypatch):
    slips, (first, *_) = solved
    there = replace(first.conditions, voltage=90.0)
    monkeypatch.setattr("fingerpad.model.checks.Checked.stable", False)
    with pytest.raises(StepFailed, match="not stable|lambda_min"):
        slips.solve(there, first)
    monkeypatch.setattr("fingerpad.model.state._STEADY", -1.0)
    with pytest.raises(StepFailed, match="not steady"):
        slips.solve(there, first)
