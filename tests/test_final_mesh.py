"""Named states on the final mesh: their errors from two meshes, finer paths, and where ridges adhere."""

import signal
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

import fingerpad as fp
from fingerpad.accuracy import refinement as refining
from fingerpad.accuracy import solves
from fingerpad.accuracy.richardson import SITES, TWO, of_two_meshes, value
from fingerpad.accuracy.solves import StateSolver
from fingerpad.model.options import FingerModel, by_rule, plan
from fingerpad.model.simulation import Simulation
from fingerpad.results.interrupt import Interrupted
from fingerpad.runs import restarts
from fingerpad.scene import from_data, load
from tests.runs import run
from tests.small_finger import NINE, SMALL
from tests.test_accuracy import change, known, model_of, mu_app, refinement, search
from variational.solvers.continuation import StepFailed
from variational.solvers.outcome import NotConverged

pytestmark = pytest.mark.slow


# -- errors from two meshes, on a finger whose errors are known --------------------------------------------
def test_estimate_is_of_the_path_and_the_final_mesh(monkeypatch):
    """The path's elements are twice as large, and no further mesh is solved on; second order, with a factor of two."""
    meshes = []

    def noted(model, states, comm, views=False, stiffer=None):
        meshes.append(model.mesh)
        return known(model, states, comm)

    found = search(monkeypatch, {}, noted)
    own, path = found.model.final, found.model.mesh
    assert meshes == [own] and found.base.mesh == own
    names = ("contact", "growth", "receptor", "interface", "coarsest")
    assert [getattr(path, name) / getattr(own, name) for name in names] == [2.0] * 5
    error = found.estimates()["full_slip_mu_app"]
    assert error == pytest.approx(TWO * abs(mu_app(path) - mu_app(own)) / 3, rel=1e-12)
    assert found.summary()["quantities"]["full_slip_mu_app"]["estimate"] == pytest.approx(error / TWO, rel=1e-12)


@pytest.mark.parametrize(("receptor", "estimated"), [(5e-6, True), (20e-6, False)])
def test_energy_densities_on_large_elements_have_no_error(monkeypatch, receptor, estimated):
    """On elements larger than the tips at the sites, of a radius of 6 µm, two meshes do not show it."""
    monkeypatch.setattr(refining, "solve_again", lambda model, states, comm, *more: known(model, states, comm))
    model = model_of({"mesh": {"receptor": receptor}})
    found = refinement(model, known(model, {}, MPI.COMM_SELF))
    found.run()
    sites = [name for name in found.estimates() if "_sed_" in name]
    assert bool(sites) is estimated and found.estimates()["full_slip_mu_app"] > 0


def test_length_has_the_error_of_the_facets_at_its_ends():
    """Of first order in these: one 16 times shorter leaves a fifteenth of the change. Friction is of all elements."""
    coarse = {"full_slip_contact_length": [0.9e-3], "full_slip_f_t": 39.0, "full_slip_sed_0": 100.0}
    fine = {"full_slip_contact_length": [1.05e-3], "full_slip_f_t": 39.3, "full_slip_sed_0": 103.0}
    found = of_two_meshes(coarse, fine, {"full_slip": (16e-6, 1e-6)})
    assert found == pytest.approx(
        {"full_slip_contact_length": TWO * 1e-5, "full_slip_f_t": TWO * 0.1, "full_slip_sed_0": TWO * 1.0}, rel=1e-9
    )


def test_friction_that_goes_by_the_area_has_the_error_of_lengths():
    coarse, fine = {"full_slip_f_t": 39.0, "full_slip_mu_app": 0.39}, {"full_slip_f_t": 40.5, "full_slip_mu_app": 0.405}
    found = of_two_meshes(coarse, fine, {"full_slip": (16e-6, 1e-6)}, by_area=True)
    assert found == pytest.approx({"full_slip_f_t": TWO * 0.1, "full_slip_mu_app": TWO * 1e-3}, rel=1e-9)


def test_site_that_changes_by_accident_less_than_others_has_half_their_error():
    """Of three sites, two change by 6 % of their densities and one does not. Other states do not count."""
    fine = {"charged_sed_0": 100.0, "charged_sed_1": 50.0, "charged_sed_2": 10.0, "full_slip_sed_0": 7.0}
    coarse = {"charged_sed_0": 106.0, "charged_sed_1": 53.0, "charged_sed_2": 10.0, "full_slip_sed_0": 7.0}
    found = of_two_meshes(coarse, fine, {})
    assert found["charged_sed_0"] == pytest.approx(TWO * 2.0, rel=1e-9)
    assert found["charged_sed_2"] == pytest.approx(SITES * TWO * 0.02 * 10.0, rel=1e-9)
    assert found["full_slip_sed_0"] == 0.0


def test_highest_pressure_that_changes_by_accident_less_than_other_ridges_has_the_error_of_these_on_average():
    """Ridges of less than half of the highest pressure do not count, and the values are the highest, not the sums."""
    coarse, fine = {"full_slip_p_max": [101e3, 98e3, 90e3, 20e3]}, {"full_slip_p_max": [100e3, 101e3, 94e3, 40e3]}
    expected = TWO * np.sqrt((1e3**2 + 3e3**2 + 4e3**2) / 3) / (2**1.5 - 1)
    assert of_two_meshes(coarse, fine, {})["full_slip_p_max"] == pytest.approx(expected, rel=1e-9)
    assert value("full_slip_p_max", fine["full_slip_p_max"]) == 101e3


def test_friction_of_ridges_whose_changes_cancel_has_the_root_of_their_squares_as_its_change():
    coarse, fine = {"full_slip_f_t": [10.03, 9.96, 10.0]}, {"full_slip_f_t": [10.0, 10.0, 10.0]}
    assert of_two_meshes(coarse, fine, {})["full_slip_f_t"] == pytest.approx(TWO * 0.05 / 3, rel=1e-9)


@pytest.mark.parametrize("lost_there", [False, True])
def test_path_is_followed_on_the_final_mesh_where_other_ridges_touch_there(monkeypatch, lost_there):
    """Or where a state is not found again. From the finer path a coarser mesh gives the estimate."""
    meshes, failures = [], ["once"] if lost_there else []

    def other(model, states, comm, views=False, stiffer=None):
        meshes.append(model.mesh)
        if failures:
            failures.clear()
            raise StepFailed("full slip found no equilibrium")
        solve = known(model, states, comm)
        change(solve, ridges_in_contact=16 if model.mesh.contact < 20e-6 else 17)
        return solve

    monkeypatch.setattr(refining, "solve_again", other)
    model = model_of({"numerics": {"memory": 1e15}})
    restart = refinement(model, known(model, {}, None)).run()
    words = "found no equilibrium" if lost_there else "16 ridges touch at full slip on the final mesh"
    assert words in restart.reason and restart.reason.endswith("the path is followed on the final mesh")
    assert restart.model.mesh == restart.model.final == model.final
    meshes.clear()
    again = refinement(restart.model, known(restart.model, {}, None))
    assert again.run() is None and again.estimates()
    assert meshes == [model.final, model.mesh]


# -- from which mesh ---------------------------------------------------------------------------------------
def test_path_that_is_lost_is_followed_on_the_final_mesh():
    """Whatever the reason: its elements are twice as large as those that a person gave. Once."""
    model = model_of({})
    restart = restarts.finer(model, StepFailed("no equilibrium"), MPI.COMM_SELF)
    assert restart is not None and restart.model.mesh == model.final
    assert restarts.finer(restart.model, StepFailed("no equilibrium"), MPI.COMM_SELF) is None
    lost = StepFailed("no equilibrium")
    lost.__cause__ = NotConverged("DIVERGED_LOCAL_MIN", False)
    again = restarts.finer(restart.model, lost, MPI.COMM_SELF)
    assert again is None or again.model.mesh == again.model.final, "not a path on smaller elements than its states"
    assert restarts.finer(model, Interrupted(signal.SIGTERM, 3), MPI.COMM_SELF) is None


@pytest.mark.parametrize(("start", "helps", "finer"), [(20e-6, True, 10e-6), (20e-6, False, None), (8e-6, True, None)])
@pytest.mark.parametrize("asked", [{"mu_app": 0.01}, {}])
def test_starts_again_finer_where_the_path_is_lost(asked, start, helps, finer):
    """With half the contact size; not where that cannot help, nor below the limit."""
    scene = from_data(({"accuracy": asked} if asked else {}) | {"mesh": {"contact": start}})
    model = FingerModel(by_rule(scene), plan(scene))
    failed: StepFailed = StepFailed("no equilibrium")
    failed.__cause__ = NotConverged("DIVERGED_LOCAL_MIN" if helps else "NOT_A_NUMBER", False)
    if asked and not helps:  # any loss of a mesh to start from may be its coarseness
        failed = Interrupted(signal.SIGTERM, 3)
    restart = restarts.finer(model, failed, MPI.COMM_SELF)
    assert (restart and restart.model.mesh.contact) == finer


# -- a small finger ----------------------------------------------------------------------------------------
PRESSED = NINE | {"f_ext": 1.0, "voltage": 100.0}


def test_small_finger_tells_what_its_penalty_changes(tmp_path: Path):
    """Springs make a contact longer, here by a hundredth of it; meshes of twice the sizes have no part in that.

    Facets of 7 um: where a ridge's contact is two or three facets long, springs move its edge by one or by none.
    """
    mesh = PRESSED["mesh"] | {"contact": 7e-6}
    summary = run(from_data(PRESSED | {"f_ext": 3.0, "mesh": mesh}), tmp_path, MPI.COMM_WORLD)
    quantities = summary["accuracy"]["quantities"]
    assert "full_slip_sed_0" not in quantities, "elements at the sites are above 5 µm"
    for name in ("full_slip_f_t", "full_slip_mu_app"):
        whole = quantities[name]["error"] + abs(summary[f"{name}_penalty"])
        assert 0 < whole == pytest.approx(summary[f"{name}_error"]) and whole < quantities[name]["value"]
    for name in ("charged_contact_length", "full_slip_contact_length"):  # of few facets
        whole = quantities[name]["error"] + abs(summary[f"{name}_penalty"])
        assert 0 < whole == pytest.approx(summary[f"{name}_error"])
    for state in ("charged", "full_slip"):
        assert -0.04 < summary[f"{state}_contact_length_penalty"] / summary[f"{state}_contact_length"] < -0.003
    assert abs(summary["full_slip_mu_app_penalty"]) < 0.01 * summary["full_slip_mu_app"]
    path, final = summary["accuracy"]["solves"]
    assert final["mesh"]["contact"] == mesh["contact"] == path["mesh"]["contact"] / 2
    assert final["factorisations"] < path["factorisations"]


# -- states solved for again where ridges adhere: what restarts, notes and cautions say of them ----------------------
LAW = {"law": "BoundaryElements"}
ADHERES = " without a load at 100 V: by the closure BoundaryElements ridges adhere without a load from 78.4 V on"


def adhering(**keys):
    """Return the small finger whose ridges adhere, at coarse elements."""
    return load(SMALL).replace(mesh={"contact": 40e-6}, roughness=LAW, **keys)


@pytest.mark.parametrize(
    ("where", "method"), [pytest.param(StateSolver, "_balance", marks=pytest.mark.long), (Simulation, "run")]
)
def test_restart_names_the_ridge_that_adheres(monkeypatch, where, method):
    """Where a state is not found on the final mesh, and where the path is lost."""
    found, once = getattr(where, method), ["full slip found no equilibrium"]

    def failing(self, *args):
        restart = found(self, *args)
        if once and self.states[-1].voltage and (where is Simulation or args[0] == "full slip"):
            raise StepFailed(once.pop())
        return restart

    monkeypatch.setattr(where, method, failing)
    result = fp.run(adhering())
    (restart,) = result.record["restarts"]
    assert restart["reason"].startswith("full slip found no equilibrium; ridge ") and ADHERES in restart["reason"]
    assert not result.failure


def test_state_that_roundoff_may_choose_is_a_caution():
    """The finger has three states of full slip on its final mesh, 1 % apart: changes of 1e-12 lead to each of them."""
    words = "full slip, solved again with a contact size of 4e-05 m: skin jumped on the way, and roundoff"
    (said,) = [text for text in map(str, fp.run(adhering()).cautions) if text.startswith(words)]
    assert ADHERES in said


def test_meshes_too_coarse_to_be_of_one_shape_are_noted(monkeypatch):
    """The run keeps its path's states, without errors; it ended in a traceback."""

    def refused(*_):
        raise ValueError("a node lies 1.08 triangles outside the state's mesh; it is of another body")

    monkeypatch.setattr(solves, "restore", refused)
    output = {"receptors": False, "each_load": False}
    result = fp.run(from_data(NINE | {"f_ext": 1.0, "voltage": 100.0, "output": output}))
    assert result.full_slip.f_t > 0 and not result.failure
    assert [text for text in result.notes if "could not be estimated" in text and "1.08 triangles" in text]
