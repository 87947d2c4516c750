"""Errors of viscous runs: the whole path on two meshes, over time, failures, and what the two have not in common."""

import math
import signal
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from mpi4py import MPI

import fingerpad as fp
from fingerpad.accuracy import whole_path
from fingerpad.accuracy.richardson import TWO, of_two_meshes, value
from fingerpad.accuracy.states import Solve
from fingerpad.accuracy.whole_path import WholePath, differences
from fingerpad.model.options import FingerModel, by_rule, plan
from fingerpad.model.simulation import Simulation
from fingerpad.results import dataset
from geometry.parameters import MeshSize
from tests.measures import contact_state
from tests.runs import followed, tables_alone
from tests.small_finger import SMALL
from tests.test_accuracy import change, known
from variational.solvers.continuation import StepFailed

LAYERS = {name: {"viscosity": {"preset": "fingerpad"}} for name in ("dermis", "stratum_corneum")}
PRESS = {"name": "press", "f_ext": 1.0, "duration": 0.05}
WAVE = {
    "name": "wave", "bone_x_by": 50e-6, "duration": 2.5e-3,
    "voltage": {"waveform": "sine", "amplitude": 100.0, "frequency": 200.0},
}  # fmt: skip
GIVEN, ARC = fp.Scene.load(SMALL), {"touching_half_arc": 1.9e-3}
SIZES = GIVEN.mesh.model_dump() | ARC
SOFT = ("subcutis", "dermis", "viable_epidermis", "stratum_corneum")


def scene(*history, **more) -> fp.Scene:
    given = {"mesh": SIZES, "materials": LAYERS, "output": {"receptors": False}}
    return GIVEN.replace(**given | {"history": list(history or (PRESS, WAVE))} | more)


def coarser(given: fp.Scene) -> fp.Scene:
    """Return the same with elements twice as large, and no errors."""
    sizes = MeshSize(**SIZES).scaled(2.0).model_copy(update={"touching_half_arc": SIZES["touching_half_arc"]})
    return given.replace(mesh=sizes.model_dump(), output={"receptors": False, "errors": False})


@pytest.fixture(autouse=True)
def bare():
    """Nothing but tables and the summary is written."""
    with tables_alone():
        yield


# -- whole runs ------------------------------------------------------------------------------------------
@pytest.mark.slow
def test_errors_are_the_difference_to_the_path_on_elements_twice_as_large():
    """That path is followed here by itself. Tolerance: the lengths of single ridges add to the whole change."""
    asked = scene()
    found = fp.run(asked)
    length, other = found.charged.contact_length, fp.run(coarser(asked)).charged.contact_length
    assert abs(other - length) > 0.05 * length
    assert found.charged.error.contact_length >= TWO * abs(other - length) * (1 - 1e-6)
    fine, coarse = (each["mesh"] for each in found.record["accuracy"]["solves"])
    assert fine == found.record["path_mesh"] == found.record["accuracy"]["mesh"]
    assert [coarse[name] / fine[name] for name in ("contact", "interface", "coarsest")] == [2.0] * 3
    paths = [followed(each).states for each in (asked, coarser(asked))]
    over_time = found.record["accuracy"]["over_time"]
    assert over_time["f_t"]["difference"] == pytest.approx(differences(*paths)["f_t"], rel=1e-4)
    assert 1e-3 < over_time["f_t"]["error"] == pytest.approx(TWO * over_time["f_t"]["difference"], rel=1e-12)
    assert any(note.startswith("Over time, friction has an estimated discretisation error") for note in found.notes)
    assert not any("errors" in each["what"] for each in found.record["omitted"])


@pytest.mark.slow
@pytest.mark.mpi
@pytest.mark.skipif(MPI.COMM_WORLD.size == 1, reason="one rank has no other to agree with")
def test_same_errors_on_all_ranks():
    """As on one rank. Tolerance: that of the solves, of which the errors are differences."""
    alone = MPI.COMM_WORLD.bcast(_errors(fp.run(scene(), comm=MPI.COMM_SELF)) if MPI.COMM_WORLD.rank == 0 else None)
    assert _errors(fp.run(scene())) == pytest.approx(alone, rel=1e-4)


def _errors(result: fp.Result) -> dict[str, float]:
    accuracy = result.record["accuracy"]
    errors = {name: each["error"] for name, each in accuracy["quantities"].items() if "sed" not in name}
    return errors | {f"{name} over time": each["error"] for name, each in accuracy["over_time"].items()}


@pytest.mark.slow
@pytest.mark.long
def test_error_covers_the_change_on_a_finer_mesh():
    """Of friction, lengths and highest pressures with facets of 10 µm, from paths with 20, 10 and 5 µm; over time too.

    Energy densities are left out: the junctions of this finger are too coarse for them, elastic or not.
    """
    layers = {name: {"viscosity": {"preset": "fingerpad"}} for name in SOFT}
    charge, slide = {"name": "charge", "voltage": 100.0}, {"name": "slide", "bone_x": 0.8e-3, "speed": 0.02}
    asked = scene(PRESS | {"duration": 0.1}, slide, charge, slide | {"name": "on", "bone_x": 1.3e-3}, materials=layers)
    sizes = [MeshSize(**SIZES).scaled(k).model_copy(update=ARC) for k in (0.5, 0.25)]
    own, finer = (fp.run(asked.replace(mesh=size)) for size in sizes)
    quantities, over_time = (own.record["accuracy"][name] for name in ("quantities", "over_time"))
    finest = finer.record["accuracy"]["quantities"]
    errors = {name: each["error"] for name, each in quantities.items() if "sed" not in name}
    changes = {name: abs(finest[name]["value"] - quantities[name]["value"]) for name in errors}
    assert len(errors) == 10 and {name for name, error in errors.items() if error < changes[name]} == set()
    known = differences(own.steps, finer.steps)
    assert {"f_t"} < set(known) and {name for name in known if over_time[name]["error"] < known[name]} == set()


@pytest.mark.slow
def test_afferents_state_the_errors_of_their_stimuli():
    """Of a run with receptors, at their sites."""
    asked = scene(PRESS, output={"receptors": True})
    (note, *_) = fp.run(asked).afferents("SA1").notes
    assert "Estimated discretisation errors over time" in note and "stress at Merkel sites" in note


@pytest.mark.slow
@pytest.mark.long
def test_runs_that_start_again_with_more_ridges():
    """The second path has the elements of the last one, twice as large, and may start again by itself."""
    found = fp.run(scene(PRESS, mesh=SIZES | {"touching_half_arc": 0.1e-3}))
    assert len(found.record["restarts"]) == 1
    fine, coarse = (each["mesh"] for each in found.record["accuracy"]["solves"])
    assert coarse["contact"] == 2 * fine["contact"] and coarse["touching_half_arc"] == fine["touching_half_arc"]
    assert found.charged.error.contact_length > 0


# -- what can go wrong ---------------------------------------------------------------------------------------
@pytest.mark.slow
def test_path_that_is_lost_on_the_coarser_mesh(monkeypatch):
    """Where a load is lost there alone, the results stay, and a note has the reason."""
    run = Simulation.run

    def lost(self):
        if self.model.mesh.contact > SIZES["contact"]:
            raise StepFailed("press: no equilibrium was found")
        return run(self)

    monkeypatch.setattr(Simulation, "run", lost)
    found = fp.run(scene(PRESS))
    assert "errors could not be estimated: on elements twice as large, press: no equilibrium" in "\n".join(found.notes)
    assert not found.failure and math.isnan(found.charged.error.contact_length)


@pytest.mark.slow
def test_signal_on_the_coarser_path(monkeypatch, tmp_path):
    """The run ends as at any signal, and goes on with the coarser path alone."""
    whole = fp.run(scene())
    plain = whole_path.follow

    def stopped(model, comm, on_step):
        signal.raise_signal(signal.SIGTERM)
        return plain(model, comm, on_step)

    monkeypatch.setattr(whole_path, "follow", stopped)
    with pytest.raises(SystemExit) as ended:
        fp.run(scene(), out=tmp_path)
    result, steps = ended.value.result, len(whole.steps)
    assert result.failure.startswith(f"stopped by SIGTERM after step {steps}") and "--resume" in result.failure
    monkeypatch.setattr(whole_path, "follow", plain)
    again = fp.run(scene(), out=tmp_path, resume=True)
    assert dataset.values(again) == dataset.values(whole) and again.notes == whole.notes
    assert again.record["accuracy"]["over_time"] == whole.record["accuracy"]["over_time"]
    assert again.cost.newton_iterations == whole.cost.newton_iterations


def _whole_path(monkeypatch, fine: Solve, coarse: Solve) -> WholePath:
    """Return the estimate of two paths whose states are given."""
    asked = scene(PRESS)
    model = FingerModel(by_rule(asked), plan(asked)).of_path()
    assert model.mesh.contact == SIZES["contact"] and model.final is None
    monkeypatch.setattr(whole_path, "follow", lambda *args: coarse)
    states = [next(iter(fine.states.values())).state]
    found = WholePath(model, fine, MPI.COMM_SELF, lambda text: None, states, lambda done: None)
    found.run()
    return found


def _known(contact: float) -> Solve:
    found = known(SimpleNamespace(mesh=MeshSize(contact=contact)), {}, None)
    change(found, contact_length=10 * 17 * contact)
    return found


def test_rule_is_that_of_two_meshes_without_short_facets(monkeypatch):
    """Friction is of first order there: the whole change, with its factor of safety."""
    fine, coarse = _known(20e-6), _known(40e-6)
    found = _whole_path(monkeypatch, fine, coarse)
    assert found.estimates() == of_two_meshes(coarse.parts(), fine.parts(), {"full_slip": (40e-6, 20e-6)}, short=False)
    changed = abs(value("full_slip_f_t", coarse.parts()["full_slip_f_t"]) - fine.values()["full_slip_f_t"])
    assert found.estimates()["full_slip_f_t"] == pytest.approx(TWO * changed, rel=1e-12) and found.notes == []


@pytest.mark.parametrize("other", [None, "back"])
def test_state_of_another_load_has_no_error(monkeypatch, other):
    fine, coarse = _known(20e-6), _known(40e-6)
    if other is None:
        coarse.states.clear()
    else:
        change(coarse, load=other)
    found = _whole_path(monkeypatch, fine, coarse)
    assert found.estimates() == {}
    where = "not reached" if other is None else "that of load 'back'"
    words = "full slip has no estimated discretisation error: on elements twice as large it was"
    assert found.notes == [f"{words} {where}"]


# -- over time -------------------------------------------------------------------------------------------
def path(*loads, scale: float = 1.0, more: float = 0.0):
    """Return states of loads, each of times (s) and values; ``more`` shifts the loads behind the first."""
    found, at = [], 0.0
    for number, (times, values) in enumerate(loads, start=1):
        begin = at + (more if number > 1 else 0.0)
        for time, friction in zip(times, values, strict=True):
            at = begin + time
            row = contact_state(load=f"load {number}", load_number=number, time=at, f_t=scale * friction)
            found.append(replace(row, contact_length=1e-3))
    return found


T = np.linspace(0.1, 1.0, 10)


def test_largest_difference_over_the_largest_amount():
    """At the end of the first load. Between states of other times the curve has a straight line to roundoff."""
    mine, theirs = path((T, T), (T, 1 - T)), path((T[1::2], 1.1 * T[1::2]), (T, 1 - T))
    assert differences(mine, theirs)["f_t"] == pytest.approx(0.1, rel=1e-9)


def test_jump_is_none_between_states():
    """A voltage that is switched on takes no time, and other steps beside it make no difference."""
    mine = path((T, T), ([0.0, *T], [2.0, *(2.0 + T)]))
    theirs = path((T[1::2], T[1::2]), ([0.0, 0.0, *T[1::2]], [1.5, 2.0, *(2.0 + T[1::2])]))
    assert differences(mine, theirs)["f_t"] == pytest.approx(0.0, abs=1e-12)
