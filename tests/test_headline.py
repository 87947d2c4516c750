"""The head of a report: what its ± holds, and a waveform under which the finger sticks."""

import json
import math
from dataclasses import replace

import pytest

import fingerpad as fp
from fingerpad.report import trust
from fingerpad.report.run_page import page as page_of
from fingerpad.results.result import Result
from fingerpad.results.states import load_result
from fingerpad.scene import from_data
from fingerpad.slices import errors
from tests.measures import contact_state
from tests.test_slices import whole
from variational.state import ContactState, Errors

WAVE = {"waveform": "sine", "amplitude": 120.0, "frequency": 20.0, "offset": 200.0}
SCENE = from_data(
    {
        "history": [
            {"name": "press", "f_ext": 10.0},
            {"name": "wave", "bone_x_by": 1e-3, "duration": 0.1, "voltage": WAVE},
        ]
    }
)


def head(result: Result) -> str:
    """Return the head of a page with plain spaces in values, which do not break there."""
    return page_of(result).partition("<nav>")[0].replace("\u00a0", " ")


def state(time: float = math.nan, f_t: float = 4.0, **values) -> ContactState:
    given = {"f_ext": 10.0, "voltage": 100.0, "f_contact": 16.0, "f_electrostatic": 6.0, "load": "wave", "step": 9}
    return contact_state(**given | {"f_t": f_t, "mu_app": f_t / 10.0} | values, time=time)


def waved(*slips: bool) -> Result:
    """Return a run whose waveform begins in full slip, with states in full slip or not after that."""
    later = (state(0.1 * (k + 1) / len(slips), 1.0 + k, slip_began=9 * slip) for k, slip in enumerate(slips))
    load = load_result("wave", [state(0.0, slip_began=9), *later], None, (), SCENE.history[1].wave)
    return Result(SCENE, "full", None, state(), state(), loads=(load,))


# -- a waveform under which the finger sticks --------------------------------------------------------------
def test_waveform_without_full_slip_is_in_the_title():
    """Though it began in full slip, that of the slide before; the verdict and the printed result have it too."""
    found = waved(False, False, False, False)
    page = head(found)
    assert "goes from 1.0 to 4.0 N/m, without full slip.</h1>" in page and "</sub> from 0.1000 to 0.4000 <" in page
    words = "part of the skin sticks in every state, so that friction stays below that of sliding"
    assert page.count(words) == 2 and 'class="verdict care"' in page
    assert words in str(found)


@pytest.mark.parametrize("least", [0.0, 8.8e-15, -8.8e-15, 2e-4])
def test_waveform_from_rest_has_no_digits_of_roundoff(least):
    """Friction that is nothing beside the largest is 0 with the digits of the largest, and has no sign."""
    states = [state(0.0, least), state(0.1, 0.4902772)]
    load = load_result("wave", states, None, (), SCENE.history[1].wave)
    found = Result(SCENE, "full", None, state(), state(), loads=(load,)).headline
    assert "goes from 0.00 to 0.49 N/m, without full slip." in found.sentence


# -- what ± holds ------------------------------------------------------------------------------------------
def test_head_has_what_is_solved_and_what_was_examined(monkeypatch):
    """The error of the number is that of the solution alone; a link leads to what was examined."""
    monkeypatch.setattr(trust, "findings", lambda result: [trust.Finding("mesh", trust.GOOD, "small")])
    page = head(Result(fp.Scene(), "full", None, None, state(error=Errors(mu_app=0.0026))))
    assert "<b>Solved to ± 0.0026</b> (mesh)." in page and "= 0.4000 ± 0.0026 <" in page
    assert "What the finger and the model assume is not in it." in page
    assert '<a href="#trust">' in page and "can be used" not in page


def test_unknown_error_is_not_claimed():
    """The line above how far friction is known says so; of a whole finger the section's is missing in its ±."""
    page = head(Result(fp.Scene(), "full", None, None, state()))
    assert "<b>Solved to an error that is not estimated</b>." in page and "= 0.4000 <" in page
    finger = replace(whole(), carried={})
    solved = Result(fp.Scene(), "full", None, None, state(), finger=finger).headline.solved
    assert solved.endswith("(points of the traces; not in it: middle section, whose error is not estimated)")
    known = Result(fp.Scene(), "full", None, None, state(error=Errors(mu_app=0.004)), finger=whole()).headline.solved
    assert "not in it" not in known


# -- what a result prints --------------------------------------------------------------------------------------------


def test_states_of_two_meshes_name_them():
    """As with an accuracy, whose uncharged state is of the path's mesh."""
    coarse, fine = state(mesh_contact=20e-6, voltage=0.0), state(mesh_contact=5e-6)
    told = str(fp.Result(fp.Scene(), "full", coarse, fine, fine))
    assert "Facets of 20 µm (uncharged normal contact), 5 µm (charged normal contact), 5 µm (full slip): " in told
    assert "Facets of" not in str(fp.Result(fp.Scene(), "full", fine, fine, fine))


def test_whole_finger_comes_first():
    """With or without a force in newtons; the middle section follows."""
    run = fp.Result(fp.Scene(), "full", None, None, state(), finger=whole())
    asked = replace(run, scene=fp.Scene(force=0.5))
    for each in (run, asked):
        text = str(each)
        assert text.index("Whole finger, as a sum of slices") < text.index("\nMiddle section of the finger\n")
        assert each.headline.of == "whole finger" and each.headline.value == whole().states["full_slip"].mu_app
    assert "\nResult\n" in str(replace(asked, finger=None)), "a trace was interrupted"


# -- the sentence ----------------------------------------------------------------------------------------------------
def sentence(model: str = "cylinders", **scene) -> str:
    return fp.run(fp.Scene(**scene), model=model).headline.sentence


@pytest.mark.parametrize(
    ("scene", "words"),
    [
        ({"force": "0.5 N"}, "At 0.5 N, 200 V raise the friction force from 0.13 to 0.30 N."),
        ({}, "At 0.54 N, 200 V raise the friction force from 0.13 to 0.32 N."),
        ({"voltage": 0.0}, "At 0.54 N and 0 V the friction force is 0.13 N."),
        ({"voltage": 1.0}, "At 0.54 N, 1 V leaves the friction force at 0.1344 N."),
        ({"friction": 0.0}, "At 0.54 N, 200 V raise the ridge contact area from 11 to 16 mm²."),
        ({"friction": fp.Derjaguin(0.2, 1e4)}, "At 0.54 N and 200 V the friction force is 0.39 N."),
        (
            {"slices": {"length": 5e-3}},
            "At 75 N/m, 200 V raise the friction force of the middle section from 19 to 39 N/m.",
        ),
    ],
)
def test_sentence(scene, words):
    """Coulomb's friction without attraction is its coefficient times the force; of another law it is not known."""
    assert sentence(**scene) == words


def test_voltage_does_not_change_what_the_force_changes():
    """Of a finger that was unloaded under a voltage; the force that is left is roundoff."""
    loads = [{"name": "press", "f_ext": 10.0}, {"name": "charge", "voltage": 100.0}, {"name": "unload", "f_ext": 0.0}]
    last = state(f_ext=1.2e-15, contact_length=23e-6)
    found = Result(from_data({"history": loads}), "full", state(voltage=0.0), last, None).headline
    assert found.sentence == "At 0 N/m and 100 V the contact length of the middle section is 0.023 mm."


def test_sentence_of_a_slide_without_full_slip():
    stuck = fp.Result(fp.Scene(), "full", state(voltage=0.0), state(), None)
    words = "At 10 N/m and 100 V full slip was not reached, so there is no friction force of sliding."
    assert stuck.headline.sentence == words and f"<header><h1>{words}</h1>" in head(stuck)


def test_number_is_the_first_line_of_all_that_is_written(tmp_path):
    """Of the printed result, of summary.json, which a reader has back, and of the report."""
    found = fp.run(fp.Scene(force="0.5 N"), model="cylinders", out=tmp_path)
    words = found.headline.sentence
    kept = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))["headline"]
    assert str(found).startswith(f"{words}\n  µ_app of the whole finger = 0.605 ± 0.021")
    assert kept["sentence"] == words and kept["of"] == "whole finger" and kept["value"] == found.headline.value
    assert fp.Result.load(tmp_path).headline.to_dict() == kept
    assert f"<header><h1>{words}</h1>" in head(found)
    assert f"<title>fingerpad: {words}</title>" in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_solved_has_the_penalty():
    """It is a part of the section's error, and of the whole finger's in proportion."""
    slip = state(error=Errors(mu_app=0.006), penalty=Errors(mu_app=-0.002))
    section = fp.Result(fp.Scene(), "full", None, None, slip).headline
    assert section.error == 0.006 and section.parts == ("mesh", "penalty")
    carried = errors.of_section(slip, 5e-4)
    assert carried["penalty"]["mu_app"] == pytest.approx(0.002 / slip.mu_app)
    assert carried[errors.MESH]["mu_app"] == pytest.approx(0.004 / slip.mu_app)
    alone, both = (replace(whole(), carried={"full_slip": each}) for each in ({}, carried))
    found = fp.Result(fp.Scene(), "full", None, None, slip, finger=both).headline
    more = found.error - alone.error["full_slip"]["mu_app"]
    assert more == pytest.approx(0.006 / slip.mu_app * found.value, rel=1e-9) and "penalty" in found.parts
