"""What a run says of itself: of which state, under which loads, on which mesh, and nothing of a state it rejects."""

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from mpi4py import MPI
from petsc4py import PETSc

from fingerpad.accuracy.solves import StateRecorder
from fingerpad.model import report
from fingerpad.model.checks import FullSlip
from fingerpad.model.state import force_error
from fingerpad.results import fields
from fingerpad.results.pictures import drawing
from fingerpad.results.quantities import RESULTS
from fingerpad.results.result import Result
from fingerpad.results.states import named
from fingerpad.scene import from_data
from tests.measures import rows_of
from tests.runs import followed, path_of, run
from tests.small_finger import NINE
from variational.contact.friction import CONE_ROUNDOFF
from variational.solvers.iteration import PREFIX
from variational.solvers.newton import Solver
from variational.state import Skin

pytestmark = pytest.mark.slow
MU_0 = 0.25
LEAN = NINE | {"output": {"errors": False, "receptors": False}}
PRESS, SLIDE = {"name": "press", "f_ext": 1.0}, {"name": "slide", "bone_x": 1e-3, "until_full_slip": True}


def kept_titles(monkeypatch: pytest.MonkeyPatch) -> dict[str, str]:
    """Return titles of the pictures that later runs would draw, by file; of the surface's panels, by state."""
    found: dict[str, str] = {}

    def finger(path, snapshot, sites, title, *more):
        found[Path(path).stem] = title

    def surface(path, states, title):
        found[Path(path).stem] = title
        found.update({state.title: drawing.curves._surface_title("A", state) for state in states})

    def history(path, states, title, mu_0, named):
        found[Path(path).stem] = title

    for module, function in (("finger_picture", finger), ("curves", surface), ("curves", history)):
        monkeypatch.setattr(getattr(drawing, module), function.__name__, function)
    return found


@pytest.fixture
def titles(monkeypatch) -> dict[str, str]:
    return kept_titles(monkeypatch)


# -- which full slip ---------------------------------------------------------------------------------------
def test_charged_while_it_slides(tmp_path, titles):
    """The README's second example, small: the headline is the charged full slip at the end, and titles say so."""
    charge = {"name": "charge while sliding", "f_ext": 1.0, "voltage": 100.0, "bone_x": 0.6e-3}
    summary = run(from_data(LEAN | {"history": [PRESS, SLIDE, charge]}), tmp_path, MPI.COMM_WORLD, pictures=True)
    rows = rows_of(tmp_path)
    last, seconds = rows[-1], [float(row["processor_seconds"]) for row in rows]
    assert "accuracy" not in summary and "full_slip_mu_app_error" not in summary, "none were estimated"
    assert 0 < seconds[0] < seconds[-1] <= summary["processor_seconds"] and seconds == sorted(seconds)
    assert summary["full_slip"] is True
    assert summary["full_slip_step"] == len(rows) and summary["full_slip_load"] == "charge while sliding"
    assert summary["full_slip_mu_app"] == float(last["mu_app"]) > 0.5
    assert (summary["full_slip_voltage"], summary["full_slip_bone_x"]) == (100.0, pytest.approx(0.6e-3, rel=1e-12))
    assert (summary["charged_voltage"], summary["charged_load"]) == (0.0, "press")
    press, slide, end = Result.load(tmp_path).loads
    assert (press.full_slip_reached, slide.full_slip_held, end.full_slip_held) == (False, True, True)
    assert slide.end.mu_app == pytest.approx(MU_0, rel=1e-6)
    assert slide.stable is press.stable is True
    assert end.extremes["mu_app"].max_step == summary["full_slip_step"]
    assert "U = 100 V, bone at x = 0.6 mm" in titles["finger"]
    assert "U = 0 V" in titles["Normal contact"] and "U = 100 V" in titles["Full slip"]
    assert "f_ext = 1 N/m, U = 0 to 100 V" in titles["history"] and "U = 0 to 100 V" in titles["surface"]


CHARGE, SLIDE_ON = {"name": "charge", "voltage": 60.0}, {"name": "slide on", "bone_x": 0.6e-3}
TURN = {"name": "turn", "bone_x": 0.258e-3}  # after 0.26 mm: too little for a slip the other way


@pytest.mark.parametrize(("more", "load"), [([CHARGE, SLIDE_ON], "slide on"), ([TURN], "slide")])
def test_errors_are_estimated_of_the_headline(more, load):
    """The states kept for it are the last full slip that was held and normal contact, not those of another load."""
    numerics = LEAN.get("numerics", {}) | {"step_scale": 0.5}
    scene = from_data(LEAN | {"history": [PRESS, SLIDE, *more], "numerics": numerics})
    simulation = path_of(scene, lambda step, done: keeper.record(step))
    keeper = StateRecorder(simulation)
    simulation.run()
    found, kept = named(simulation.states), keeper.solve().states
    assert found["full_slip"].load == load and found["charged"].load == "press"
    for state in ("charged", "full_slip"):
        for name in RESULTS:
            assert getattr(kept[state].state, name) == getattr(found[state], name), (state, name)
        assert kept[state].snapshot.voltage == found[state].voltage


def test_probe_of_full_slip_leaves_no_trace(monkeypatch):
    """A slide that ends before it was held for 0.2 mm is probed; what follows is as without, bit for bit."""
    slides = [{"name": f"to {x:g} mm", "bone_x": x * 1e-3} for x in (0.12, 0.16)]
    scene = from_data(LEAN | {"history": [PRESS, CHARGE, *slides]})
    probed, plain = [], []
    for rows in (probed, plain):
        simulation = followed(scene)
        rows += [state.row() for state in simulation.states]
        monkeypatch.setattr(FullSlip, "_holds", lambda self: False)
    assert probed[-1]["slip_held"] and not plain[-1]["slip_held"]
    left = {"slip_held": None}
    assert [row | left for row in probed] == [row | left for row in plain]


COARSE_RUNS = {
    "loose": {"numerics": {"tolerance": 1e-7}},
    "heavy": {"f_ext": 3.0, "voltage": 150.0, "mesh": LEAN["mesh"] | {"touching_half_arc": 1.4e-3}},
    "slippery": {"friction": 0.02},
    "nitsche": {"contact": {"formulation": "nitsche"}, "voltage": 60.0},
    "augmented": {"contact": {"formulation": "augmented"}, "voltage": 60.0},
}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.long) if name == "heavy" else name for name in COARSE_RUNS]
)
def test_force_error_bounds_the_balance(tmp_path, name):
    """Bone, screen and cone of full slip agree within what the solve's tolerance guarantees, on coarse runs."""
    data = LEAN | {"f_ext": 1.0, "voltage": 100.0} | COARSE_RUNS[name]
    s = run(scene := from_data(data), tmp_path, MPI.COMM_WORLD)
    assert "failure" not in s
    cone = data.get("friction", MU_0) * s["full_slip_f_contact"]
    assert abs(s["full_slip_f_contact"] - s["full_slip_f_electrostatic"] - s["full_slip_f_ext"]) <= s["force_error"]
    assert abs(s["full_slip_f_t"] - cone) <= s["force_error"] + CONE_ROUNDOFF * cone
    # Charged before it slides, in whatever formulation: some hundred nodal imbalances of the tolerance times the load.
    assert s["charged_f_electrostatic"] > 0
    force = s["charged_f_contact"] - s["charged_f_electrostatic"]
    assert force == pytest.approx(s["f_ext"], abs=100 * scene.numerics.tolerance * s["f_ext"])


def test_force_error():
    """Of a hundred equal forces with the norm 1e-9 of 2 N/m each is a tenth of that, their sum ten times."""
    forces = np.full(100, 2e-10)
    assert np.linalg.norm(forces) == pytest.approx(2e-9)
    assert forces.sum() == pytest.approx(force_error(100, 1e-9, 2.0), rel=1e-12)


# -- states that are no equilibrium ------------------------------------------------------------------------
@pytest.fixture
def ksponly():
    """One linear solve for Newton's method, which PETSc calls converged."""
    options = PETSc.Options()
    options.setValue(f"{PREFIX}snes_type", "ksponly")
    yield
    options.delValue(f"{PREFIX}snes_type")


def test_state_that_is_no_equilibrium_is_neither_written_nor_kept(tmp_path, ksponly):
    """The run stops at its first step, names the force that is left, and leaves no row, no picture and no state."""
    summary = run(from_data(LEAN | {"history": [{"name": "press", "bone_height": -20e-6}]}), tmp_path, MPI.COMM_WORLD)
    assert "is left at a node; forces are not balanced to 1e-06" in summary["failure"]
    assert not (tmp_path / "steps.csv").exists() and not list(tmp_path.glob("*.png"))
    assert summary["steps"] == 0 and summary["charged_f_contact"] is None
    assert Result.load(tmp_path).loads == ()


def test_rejected_state_leaves_the_one_before(tmp_path, monkeypatch):
    """From the third step on a force is left over: tables, fields, pictures and normal contact end with the second."""
    solve, count = Solver.imbalance, [0]

    def left_over(self):
        count[0] += 1
        return 1e-3 if any(row for row in tables if row >= 2) else solve(self)

    tables: list[int] = []
    step = report.Report.step

    def noted(self, given, done):
        tables.append(given.state.step)
        step(self, given, done)

    monkeypatch.setattr(Solver, "imbalance", left_over)
    monkeypatch.setattr(report.Report, "step", noted)
    history = [{"name": "press", "bone_height": -60e-6}, {"name": "charge", "voltage": 50.0}]
    summary = run(from_data(LEAN | {"history": history}), tmp_path, MPI.COMM_WORLD, pictures=True)
    assert "step 3 (charge): a force of 0.001 N/m is left at a node" in summary["failure"]
    assert [row["step"] for row in rows_of(tmp_path)] == ["1", "2"]
    assert (summary["charged_step"], summary["charged_voltage"]) == (2, 0.0)
    assert [name for name in fields.read(tmp_path) if name.startswith("loads/")] == ["loads/press"]


# -- on which mesh -----------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def refined(tmp_path_factory) -> tuple[Path, dict, dict[str, str]]:
    """A small finger with an accuracy: its folder, the summary on disk and the titles of its pictures."""
    folder = tmp_path_factory.mktemp("refined")
    scene = from_data(NINE | {"f_ext": 1.0, "voltage": 100.0, "accuracy": {"mu_app": 0.2}})
    with pytest.MonkeyPatch.context() as monkeypatch:
        titles = kept_titles(monkeypatch)
        run(scene, folder, MPI.COMM_WORLD, pictures=True)
    return folder, json.loads((folder / "summary.json").read_text(encoding="utf-8")), titles


def test_refined_states_come_with_their_errors(refined):
    """Estimated from two re-solved meshes, within the accuracy; contact lengths have errors below their values."""
    summary = refined[1]
    assert "failure" not in summary
    found = summary["accuracy"]
    assert found["reached"]
    assert 0 < summary["full_slip_mu_app_error"] <= 0.2 * summary["full_slip_mu_app"]
    for name in ("charged_contact_length", "full_slip_contact_length"):
        assert 0 < summary[f"{name}_error"] < summary[name]
    assert set(found["quantities"]["charged_contact_length"]["shares"]) == {"contact", "bulk"}
    assert set(found["quantities"]["full_slip_mu_app"]["shares"]) == {"contact", "bulk"}
    again = found["solves"][1]
    assert again["factorisations"] < found["solves"][0]["factorisations"]
    assert summary["full_slip_f_t"] == pytest.approx(0.25 * summary["full_slip_f_contact"], rel=1e-6)


def test_headline_states_are_shown_on_the_final_mesh(refined):
    """And the path, with its own unknowns, on the mesh that it started from, each with its label."""
    folder, summary, titles = refined
    final = summary["accuracy"]["mesh"]["contact"]
    assert summary["path_mesh"]["contact"] == 40e-6 > final
    *_, last, _ = summary["accuracy"]["solves"]  # that of the penalty's effect is the last one
    assert summary["unknowns_path"] < summary["unknowns"] == last["unknowns"]
    assert {float(row["mesh_contact"]) for row in rows_of(folder)} == {40e-6}
    path, end = "path on its own mesh, contact size 40 µm", f"final mesh, contact size {final * 1e6:.3g} µm"
    for name in ("history", "Partial slip"):
        assert path in titles.get(name, path), name
    for name in ("finger", "Charged normal contact", "Full slip"):
        assert end in titles[name], name
    result = Result.load(folder)
    slip = result.full_slip
    assert slip.ridges.f_friction.sum() == pytest.approx(-slip.f_t, abs=summary["force_error"])
    assert result.charged.mesh_contact == slip.mesh_contact == final
    on_path = next(state for state in result.steps if state.step == slip.step)
    assert 0.1 < abs(slip.sites.merkel / on_path.sites.merkel - 1).max() < 1, (
        "of the final mesh, not of the coarse path"
    )
    x, _, p, *_ = fields.read(folder)["states/full_slip"]["skin"]
    known = np.isfinite(x[1:] + x[:-1])
    force = float((np.diff(x) * (p[1:] + p[:-1]) / 2)[known].sum())
    assert force == pytest.approx(summary["full_slip_f_contact"], rel=0.1), "the trapezoidal rule on few facets"


def test_profile_is_sorted_along_each_ridge():
    """Two ridges, the second one's facets first: a line each, with a break between."""
    x = np.array([[3e-3, 2e-3], [1e-3, 0.0]])
    skin = Skin(np.array([1, 0]), x, *np.ones((4, 2, 2)))
    state = SimpleNamespace(ridges=SimpleNamespace(number=np.array([0, 1]), d_eq=np.array([1e-6, 2e-6])))
    found = fields.sorted_along(skin, state)
    assert found["x"][[0, 1, 3, 4]] == pytest.approx([0.0, 1e-3, 2e-3, 3e-3]) and np.isnan(found["x"][[2, 5]]).all()
    assert found["d_eq"][[0, 3]] == pytest.approx([1e-6, 2e-6])
