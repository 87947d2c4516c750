"""The ladder's rungs: one set of keys, forces in balance, sources named, and what they cannot answer refused."""

import json
from pathlib import Path

import pytest

from benchmarks import ladder as page
from fingerpad import closed_form, ladder, ridge_cell, start
from fingerpad.processes import End
from fingerpad.rungs import NAMES
from fingerpad.scene import SceneError, from_data
from fingerpad.states import RESULTS
from variational.continuation import StepFailed


def scene(**data):
    return from_data(data)


def test_keys_are_those_of_the_full_summary():
    assert set(NAMES) == set(RESULTS)


# -- rung 1 ------------------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def default():
    return closed_form.solve(scene())


@pytest.mark.parametrize("state", ["normal", "slip"])
def test_forces_balance(default, state):
    """The screen bears the load and the attraction: one subtraction, to roundoff of the scalar root."""
    s = default.summary
    assert s[f"{state}_f_contact"] - s[f"{state}_f_electrostatic"] == pytest.approx(75.0, rel=1e-9)


def test_friction_is_the_cone(default):
    """By definition, to roundoff."""
    assert default.summary["slip_f_t"] == pytest.approx(0.25 * default.summary["slip_f_contact"], rel=1e-12)
    assert default.summary["slip_mu_app"] == pytest.approx(default.summary["slip_f_t"] / 75.0, rel=1e-12)


def test_default_scene_is_near_the_full_model(default):
    """The full run has mu_app 0.5230 and 1.580 mm at 10 um (docs/traces.md); rung 1 is 1.2 and 0.1 % off."""
    assert default.summary["slip_mu_app"] == pytest.approx(0.5230, rel=0.02)
    assert default.summary["slip_contact_length"] == pytest.approx(1.580e-3, rel=0.02)


def test_what_it_cannot_know_is_absent(default):
    assert default.missing() == ["normal_bone_height", "slip_bone_height"]
    assert any("bone's height" in note for note in default.notes)


def test_uncharged_length_is_the_runs(default):
    """At a force of the runs nothing is interpolated; they are kept with four digits."""
    s = closed_form.solve(scene(f_ext=50.0, voltage=0.0)).summary
    assert s["normal_contact_length"] == pytest.approx(1.0116e-3, rel=1e-9)
    assert s["slip_contact_length"] == pytest.approx(0.9843e-3, rel=1e-9)
    assert s["slip_mu_app"] == pytest.approx(0.25, rel=1e-12)
    assert (s["normal_ridges_in_contact"], s["slip_ridges_in_contact"]) == (15, 14)


def test_length_that_is_given_is_kept():
    answer = closed_form.solve(scene(), closed_form.given(1.5e-3, 16))
    assert answer.summary["slip_contact_length"] == pytest.approx(1.5e-3, rel=1e-12)
    assert "as given" in answer.notes[0]


def test_force_beyond_the_runs_is_said():
    assert "extrapolated" in closed_form.solve(scene(f_ext=2.0)).notes[0]


def test_state_past_the_end_of_the_closure_is_said():
    """A tenth of the length bears ten times the pressure, beyond zero separation."""
    notes = closed_form.solve(scene(voltage=0.0), closed_form.given(0.15e-3, 16)).notes
    assert any("beyond zero separation" in note for note in notes)


@pytest.mark.parametrize(
    ("data", "sentence"),
    [
        ({"geometry": {"width": 19e-3}}, "geometry is not that of the default finger"),
        ({"materials": {"dermis": {"shear_modulus": 3e3}}}, "materials is not that of the default finger"),
        ({"history": [{"name": "press", "f_ext": 5.0}]}, "history is given; rung 1"),
    ],
)
def test_scene_it_does_not_know_is_refused(data, sentence):
    with pytest.raises(SceneError, match=sentence):
        closed_form.solve(scene(**data))


def test_other_finger_with_its_length_is_answered():
    other = scene(geometry={"width": 19e-3})
    assert closed_form.solve(other, closed_form.given(1.5e-3, 16)).summary["slip_mu_app"] > 0.4


def test_ridge_without_a_round_tip_is_refused():
    with pytest.raises(SceneError, match="gives a ridge 2 crests; rung 1 takes ridges for cylinders"):
        closed_form.solve(scene(geometry={"ridge_profile": [1.0, -0.5]}), closed_form.given(1.5e-3, 16))


# -- lengths of a run --------------------------------------------------------------------------------------
def keep(folder, **values):
    names = {f"{state}_{name}": 1.0 for state in ("normal", "slip") for name in NAMES}
    lengths = {"normal_contact_length": 1.7e-3, "slip_contact_length": 1.6e-3}
    ridges = {"normal_ridges_in_contact": 17, "slip_ridges_in_contact": 16}
    cost = {"wall_seconds": 9.0, "factorisations": 3, "unknowns": 5, "full_slip": True}
    summary = {"f_ext": 75.0, "voltage": 200.0} | names | lengths | ridges | cost | values
    (folder / "summary.json").write_text(json.dumps(summary), encoding="utf-8")
    return summary


def test_length_of_a_run(tmp_path):
    keep(tmp_path)
    s = closed_form.solve(scene(), closed_form.from_run(scene(), tmp_path)).summary
    assert s["normal_contact_length"] == pytest.approx(1.7e-3, rel=1e-12)
    assert s["slip_contact_length"] == pytest.approx(1.6e-3, rel=1e-12)
    assert s["slip_ridges_in_contact"] == 16


@pytest.mark.parametrize(
    ("values", "sentence"),
    [({"voltage": 50.0}, "is one at voltage 50 V"), ({"slip_contact_length": None}, "did not reach full slip")],
)
def test_run_of_no_use_is_refused(tmp_path, values, sentence):
    keep(tmp_path, **values)
    with pytest.raises(SceneError, match=sentence):
        closed_form.from_run(scene(), tmp_path)


def test_missing_run_is_refused(tmp_path):
    with pytest.raises(SceneError, match="cannot be read"):
        closed_form.from_run(scene(), tmp_path)


def test_full_summary_is_an_answer(tmp_path):
    answer = ladder.from_summary(keep(tmp_path))
    assert answer.missing() == []
    assert (answer.cost.seconds, answer.cost.factorisations, answer.cost.unknowns) == (9.0, 3, 5)


def test_errors_of_a_run_are_the_answer_s(tmp_path):
    """Beside their values, with what ± is; a state that comes without has its value alone."""
    answer = ladder.from_summary(keep(tmp_path, slip_contact_length_error=2e-5))
    assert answer.errors == {"slip_contact_length": 2e-5}
    lines = ladder.table([answer]).splitlines()
    assert next(line for line in lines if line.startswith("slip contact_length")).endswith("0.0016 ± 2e-05")
    assert next(line for line in lines if line.startswith("normal contact_length")).endswith("  0.0017")
    assert "±: estimated discretisation error" in lines


def test_closed_form_has_no_discretisation_error(default):
    assert default.errors == {}
    assert any("no discretisation error" in note for note in default.notes)


# -- a start from rung 2 -------------------------------------------------------------------------------------------
def test_full_model_without_a_start_follows_the_path(monkeypatch, tmp_path):
    """Rung 2's state does not serve: the answer is the path's, and a note says why."""

    def lost(*_):
        raise StepFailed("full slip was not found")

    monkeypatch.setattr(start, "answer", lost)
    monkeypatch.setattr(ladder, "full", lambda scene, folder: ladder.from_summary(keep(tmp_path)))
    answer = ladder.started(scene(), tmp_path)
    assert answer.missing() == []
    assert answer.notes == ("full slip was not found; the path was followed instead",)


# -- the benchmark -----------------------------------------------------------------------------------------
MORE = {"table_version": ridge_cell.VERSION}


def test_answers_are_kept_and_failures_asked_again(monkeypatch, tmp_path):
    """Of two scenes one fails: it says how, has no error, and is the only one that is run again."""
    asked = []

    def ask(kind, scene, tables):
        assert kind == "2"
        asked.append(scene.voltage)
        if scene.voltage:
            return End(1, "TIME_LIMIT", "not done", "")
        return End(0, "", "", json.dumps({"summary": {"slip_mu_app": 0.25}, "cost": {}, "more": MORE}))

    monkeypatch.setattr(page, "grid", lambda size: {(75.0, u): scene(voltage=u) for u in (0.0, 200.0)})
    monkeypatch.setattr(page, "ask", ask)
    file = tmp_path / "ladder.json"
    for _ in range(2):
        known = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
        page.collect(known, tmp_path / "runs", ["2"], 1, file)
    assert asked == [0.0, 200.0, 200.0]
    known = json.loads(file.read_text(encoding="utf-8"))
    assert known["75 N/m, 200 V"]["2"] == {"failure": "TIME_LIMIT: not done"}
    assert known["75 N/m, 0 V"]["2"]["summary"] == {"slip_mu_app": 0.25}
    assert page.error(known["75 N/m, 200 V"], 2, "slip_mu_app") is None


# -- the page ----------------------------------------------------------------------------------------------
def test_lengths_in_the_program_are_the_runs():
    """Those that rung 1 interpolates are the full runs' of docs/ladder.json, to the four digits they are kept with."""
    known = json.loads((Path(page.__file__).parents[1] / "docs" / "ladder.json").read_text(encoding="utf-8"))
    for state in ("normal", "slip"):
        for k, f in enumerate(closed_form._FORCES):
            full = known[page.name(f, 0.0)]["3"]["summary"]
            assert closed_form._LENGTHS[state][k] == pytest.approx(full[f"{state}_contact_length"], abs=0.5e-7)
            assert closed_form._RIDGES[state][k] == full[f"{state}_ridges_in_contact"]


def test_errors_are_against_the_full_model():
    """A rung that is not there, or a full run that is not, has none."""
    found = {"1": {"summary": {"slip_mu_app": 0.5}}, "3": {"summary": {"slip_mu_app": 0.4}}}
    assert page.error(found, 1, "slip_mu_app") == pytest.approx(0.25, rel=1e-12)
    assert page.error(found, 2, "slip_mu_app") is None
    assert page.error({"1": found["1"]}, 1, "slip_mu_app") is None


def test_page_compares_a_start_with_the_path():
    """A hundredth more friction with a ridge less, at a quarter of the cost: 10 x 10 and 5 x 30 over 10 x 100."""
    own = {"slip_f_t": 1.01, "slip_contact_length": 0.99, "slip_ridges_in_contact": 15}
    full = {"slip_f_t": 1.0, "slip_contact_length": 1.0, "slip_ridges_in_contact": 16}
    started = {
        "summary": own,
        "cost": {"factorisations": 10, "unknowns": 10},
        "more": MORE | {"rung_2_factorisations": 5, "rung_2_unknowns": 30},
    }
    path = {"summary": full, "cost": {"factorisations": 10, "unknowns": 100, "seconds": 1.0}}
    known = {"75 N/m, 200 V": {page.START: started, "3": path}, "10 N/m, 0 V": {page.START: {"failure": "lost"}}}
    text = page.page(known)
    assert "| 75 N/m, 200 V | +1 | -1 | 15 | 16 | 0.25 |" in text
    assert "| 10 N/m, 0 V | lost |" in text
    assert "| 25 N/m, 0 V | not run |" in text
