"""The door: what import fingerpad gives, a run with and without a folder, results that are read again, sweeps."""

import json

import numpy as np
import pytest
from mpi4py import MPI

import fingerpad as fp
from fingerpad.results.quantities import CONDITIONS, RESULTS
from fingerpad.results.states import STATES
from fingerpad.runs import full
from fingerpad.scene import SceneError, from_data
from tests.runs import no_pictures
from tests.small_finger import NINE
from variational.solvers.continuation import StepFailed
from variational.solvers.outcome import NotConverged

pytestmark = pytest.mark.slow
SMALL = NINE | {"f_ext": 1.0, "voltage": 60.0, "output": {"receptors": False}}


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run") / "out"
    with no_pictures():
        return fp.run(from_data(SMALL), out=folder), folder


# -- the door ----------------------------------------------------------------------------------------------
def test_every_name_is_there():
    assert [name for name in fp.__all__ if getattr(fp, name, None) is None] == []


# -- a run -------------------------------------------------------------------------------------------------
@pytest.mark.mpi
def test_run_without_a_folder_writes_nothing(ran, tmp_path, monkeypatch):
    """And its result is that of the run with a folder, bit for bit on one rank.

    On more ranks sums have no fixed order, and solves end within their tolerance of 1e-9 of the force.
    """
    monkeypatch.chdir(tmp_path)
    found = fp.run(from_data(SMALL))
    assert list(tmp_path.iterdir()) == []
    same = 1e-12 if MPI.COMM_WORLD.size == 1 else 1e-8
    assert found.full_slip.mu_app == pytest.approx(ran[0].full_slip.mu_app, rel=same)


def test_changes_of_the_scene_are_arguments(ran):
    """A formulation and a number beside the scene, or of the default scene, are those of a scene with them."""
    given = from_data(SMALL).replace(contact=fp.Nitsche())
    found = fp.run(from_data(SMALL), contact=fp.Nitsche())
    assert found.scene == given and found.scene.contact.law == fp.Nitsche()
    assert found.full_slip.f_t == pytest.approx(fp.run(given).full_slip.f_t, rel=1e-12)
    # Springs on these coarse facets: the tractions of Nitsche's method differ by their error.
    assert found.full_slip.f_t == pytest.approx(ran[0].full_slip.f_t, rel=0.1)
    assert found.full_slip.f_t != ran[0].full_slip.f_t
    assert fp.run(model="cylinders", voltage=100.0).full_slip.voltage == 100.0
    with pytest.raises(SceneError, match="voltge is not a key of a scene"):
        fp.run(voltge=100.0)
    with pytest.raises(SceneError, match="contact"):
        fp.run(contact=3)


def test_summary_is_the_result(ran):
    """summary.json is to_dict(), in JSON's numbers; each state is there flat, by its prefix."""
    result, folder = ran
    kept = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    assert kept == json.loads(json.dumps(result.to_dict()))
    for name in STATES:
        state = getattr(result, name)
        for key in (*CONDITIONS, *RESULTS):
            assert kept[f"{name}_{key}"] == getattr(state, key), key


def test_arrays_have_documented_shapes(ran):
    """By ridge, and by facet and point; the pressure along the skin carries what the ridges do, on coarse facets."""
    result, _ = ran
    slip = result.full_slip
    ridges, skin = slip.ridges, slip.skin
    assert ridges.number.shape == ridges.p_c.shape == ridges.d_eq.shape == slip.p_c.shape == (5,)
    assert skin.p_n.shape == skin.x.shape == skin.t_t.shape == skin.p_el.shape and skin.ridge.shape == skin.x.shape[:1]
    assert ridges.f_contact.sum() == pytest.approx(slip.f_contact, rel=1e-9)
    touching = skin.p_n > 0
    # Coulomb's law at each point, at the cone's roundoff.
    np.testing.assert_allclose(np.abs(skin.t_t[touching]), 0.25 * skin.p_n[touching], rtol=1e-7)


def test_failure_is_a_warning():
    """A finger without enough ridges; the states before are there."""
    few = {"f_ext": 10.0, "geometry": {"ridge_count": 5}, "output": {"receptors": False, "errors": False}}
    scene = from_data(SMALL | few)
    with pytest.warns(UserWarning, match="the finger has no more ridges"):
        found = fp.run(scene)
    assert found.full_slip is None and found.steps and "no more ridges" in str(found)


@pytest.mark.parametrize(("name", "error"), [("SIGINT", KeyboardInterrupt), ("SIGTERM", SystemExit)])
def test_signal_ends_the_program_after_the_step(monkeypatch, name, error):
    """A loop over runs ends with the first Ctrl-C, as any Python program does."""
    ended = fp.Result(fp.Scene(), "full", None, None, None, failure="stopped", interrupted=name)
    monkeypatch.setattr(full, "run", lambda *_: ended)
    with pytest.raises(error) as caught:
        fp.run(from_data(SMALL))
    assert caught.value.result is ended


# -- smaller elements by itself ----------------------------------------------------------------------------


def test_a_run_starts_again_with_smaller_elements(monkeypatch):
    """Every solve of 40 um elements fails; with 20 um the loads are reached, and the result says what was tried."""
    solve = full.Simulation.run

    def lost(self):
        if self.finger.contact_size > 30e-6:
            raise StepFailed("no equilibrium") from NotConverged("DIVERGED_LOCAL_MIN", False)
        return solve(self)

    monkeypatch.setattr(full.Simulation, "run", lost)
    lean = {"history": [{"name": "press", "f_ext": 0.5}], "output": {"receptors": False, "errors": False}}
    found = fp.run(from_data({key: SMALL[key] for key in ("geometry", "mesh")} | lean))
    assert not found.failure and found.charged.mesh_contact == 20e-6
    assert [restart["contact"] for restart in found.to_dict()["restarts"]] == [20e-6]
    assert "contact size of 40 µm; the run started again" in str(found)


# -- sweeps ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("axes", "words"),
    [
        ({}, "the sweep has no axis"),
        ({"geometry.ridge_profile": [[1.0], [1.0, -0.1]]}, "it must be a list of at least one value, none a list"),
        (dict.fromkeys(("voltage", "f_ext"), list(range(1, 201))), "the sweep has 40000 points; at most 10000"),
    ],
)
def test_sweep_that_makes_no_sense_is_refused(tmp_path, axes, words):
    with pytest.raises(fp.SceneError, match=words):
        fp.sweep(fp.Scene(), tmp_path, model="cylinders", **axes)


def test_sweep_under_a_launcher_of_mpi_is_refused(monkeypatch, tmp_path):
    monkeypatch.setenv("OMPI_COMM_WORLD_SIZE", "2")
    with pytest.raises(fp.SceneError, match="start it without mpirun"):
        fp.sweep(fp.Scene(), tmp_path, voltage=[0.0])
