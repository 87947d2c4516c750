"""Full slip is steady or the slide ends; solved for from full slip it is that of the path."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from mpi4py import MPI

from fingerpad.model.checks import FullSlip
from fingerpad.model.full_slip import Conditions, FullSlips
from fingerpad.model.options import FingerModel, plan
from fingerpad.model.simulation import Simulation
from fingerpad.scene import from_data
from tests.runs import followed, path_of
from tests.small_finger import NINE, small
from tests.test_body import FORCE, MU_F, RIDGE, SKIN, SPRINGS, VOLTAGE, Body
from variational.contact.augmented import AugmentedLagrangian
from variational.contact.friction import Derjaguin
from variational.contact.nitsche import Nitsche
from variational.roughness.bam import BearingArea
from variational.solvers.continuation import StepFailed

pytestmark = pytest.mark.slow
SCENE = NINE | {"f_ext": 1.0, "voltage": 100.0}


def test_slip_that_is_never_steady_ends_with_the_slide(monkeypatch):
    """The bone never goes back to where the slide should have ended."""
    monkeypatch.setattr("fingerpad.model.state._STEADY", -1.0)
    scene, places = from_data(SCENE | {"slide_length": 0.9e-3}), []
    simulation = path_of(scene, lambda step, done: places.append(step.state.bone_x))
    simulation.run()
    assert not any(state.slip_held for state in simulation.states)
    assert places == sorted(places)
    assert 0.9e-3 <= places[-1] <= 1.11e-3


@pytest.mark.parametrize("end", [-30e-6, 20e-6])
def test_slide_goes_on_the_way_it_came(end):
    """Full slip is first found at the slide's end or before it; the bone moves on by 0.2 mm and does not turn round."""
    press, slide = {"name": "press", "f_ext": 1.0}, {"name": "slide", "bone_x": end, "until_full_slip": True}
    scene = small(output={"receptors": False}).replace(history=[press, slide])
    simulation = followed(scene)
    slid = [state for state in simulation.states if state.load == "slide"]
    first = next(state.bone_x for state in slid if state.all_slip)
    assert abs(first) <= abs(end)
    places = np.array([0.0, *(state.bone_x for state in slid)]) * np.sign(end)
    assert (np.diff(places) > 0).all()
    assert places[-1] == pytest.approx(abs(first) + 0.2e-3, rel=1e-9)
    assert slid[-1].f_t == pytest.approx(np.sign(end) * 0.25, rel=1e-6)


class Slid:
    """In place of a continuation: each load changes f_t by a given part."""

    def __init__(self, solver, change):
        self.solver, self.change, self.slip = solver, change, (1.0, True)
        solver.reaction = np.array([-1.0, 1.0])

    def run(self, target):
        self.solver.reaction = self.solver.reaction * (1 + self.change)

    def begun(self):
        return SimpleNamespace(reaction=self.solver.reaction.copy(), control=self.solver.control)


@pytest.mark.parametrize(
    ("formulation", "change", "steady"),
    [("penalty", 0.9e-6, True), ("penalty", 1.3e-6, False), ("augmented", 1e-3, True), ("augmented", 1e-2, False)],
)
def test_force_of_full_slip_is_as_steady_as_its_gaps(formulation, change, steady):
    """5 nm left of an air gap and insulators of some 2 um: 5e-3 of the attraction, 1e-6 where none are left."""
    scene = from_data(SCENE | {"contact": {"formulation": formulation}})
    finger = path_of(scene).finger
    finger.coupling.set_air_gaps(np.full(len(finger.ridges), 1.5e-6))
    finger.continuation = Slid(finger.solver, change)
    assert FullSlip(finger).slides_on("slide", 1) is steady


# -- where full slip begins ------------------------------------------------------------------------------------------
def charged(contact, step_scale=1.0) -> Body:
    roughness = BearingArea(0.51e-6)
    skin = {"contact": contact, "friction": MU_F, "roughness": roughness}
    return Body(RIDGE, SKIN, **skin, step_scale=step_scale).press(FORCE).charge(VOLTAGE)


@pytest.mark.parametrize(
    ("contact", "way"),
    [(SPRINGS, 1), (Nitsche(10.0), -1), (AugmentedLagrangian(1.5e12, 5e10, 5e-9), 1)],
    ids=["penalty", "nitsche", "augmented"],
)
def test_place_of_full_slip_does_not_depend_on_the_step(contact, way):
    """Steps of 60 and of 15 um end 67 um from the start, and not up to a step further.

    The tolerance of 0.3 um is what longer steps change in the slip of single points on the way there: measured 0.1 um
    and less. Without the way back the places are 105 um apart.
    """
    long, short = (charged(contact, scale).slide(way * 0.3e-3, until_full_slip=True) for scale in (1.0, 0.25))
    assert long.state.all_slip and short.state.all_slip
    assert long.state.bone_x == pytest.approx(short.state.bone_x, abs=0.3e-6)
    assert way * long.state.f_t == pytest.approx(MU_F * long.state.f_contact, rel=1e-8)


# -- full slip solved for from full slip is that of the path, there and back; and what is refused --------------------
LEAN = NINE | {"f_ext": 1.0, "voltage": 100.0, "output": {"errors": False, "receptors": False}}
CHAIN = (
    {"voltage": 50.0}, {"voltage": 0.0}, {"voltage": 80.0}, {"voltage": 80.0, "f_ext": 1.4}, {"f_ext": 0.8},
    {"friction": 0.4}, {"electric": {"d_i": 2e-6}}, {"roughness": {"h_rms": 2e-6}}, {},
)  # fmt: skip
"""Each from the one before; forces, voltage, friction, insulator and roughness go there and back."""


def model_of(changes):
    """Return the model of the scene with changes, with the attraction also where it has no voltage."""
    scene = from_data(LEAN | changes)
    return FingerModel(scene, plan(from_data(LEAN)))


def path_to(changes):
    simulation = Simulation(model_of(changes), MPI.COMM_WORLD)
    assert simulation.run() is None
    return simulation


@pytest.fixture(scope="module")
def solved():
    """The full slips of a path's end and of the chain from there."""
    slips = FullSlips(path_to({}))
    found = [slips.first(Conditions.of(model_of({})))]
    for changes in CHAIN:
        found.append(slips.solve(Conditions.of(model_of(changes)), found[-1]))
    return slips, found


def test_full_slip_is_that_of_the_path(solved):
    """Every second state. Air gaps are solved to 1e-6, and forces depend on them less than in proportion."""
    for changes, direct in zip(CHAIN[1:-1:2], solved[1][2:-1:2], strict=True):
        state = path_to(changes).states[-1]
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
    loads = {key: LEAN[key] for key in LEAN if key not in ("f_ext", "voltage")} | {"history": history}
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
