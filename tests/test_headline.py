"""The head of a report: what its ± holds, and a waveform under which the finger sticks."""

import math
import re
from dataclasses import replace

import pytest

import fingerpad as fp
from fingerpad.report import trust
from fingerpad.report.trust import head
from fingerpad.results.quantities import PLUS_MINUS
from fingerpad.results.result import Result
from fingerpad.results.states import load_result
from fingerpad.scene import from_data
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
    assert "from 0.1000 to 0.4000, without full slip</h1>" in page
    words = "part of the skin sticks in every state, so that friction stays below that of sliding"
    assert page.count(words) == 2 and 'class="verdict care"' in page
    assert words in str(found)


def test_waveform_with_some_full_slip_says_in_how_much():
    """Of the states after its begin; no reason for a caution, and nothing where all are of full slip."""
    some, every = waved(True, False, True, False), waved(True, True, True, True)
    words = "full slip in 50 % of its states; in the others part of the skin sticks"
    assert words in head(some) and words in str(some) and "without full slip" not in head(some)
    assert "sticks" not in head(every) + str(every)
    for found in (some, every):
        assert not any(each.what == "no full slip under a waveform" for each in trust.findings(found))


# -- what ± holds ------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("error", "words"),
    [(0.0026, "solved to ± 0.0026, the error of the mesh alone; what"), (math.nan, "holds: solved; what")],
)
def test_verdict_has_the_error_of_the_headline(monkeypatch, error, words):
    """It is of the solution alone; a link leads to what is not in it."""
    monkeypatch.setattr(trust, "findings", lambda result: [trust.Finding("mesh", trust.GOOD, "small")])
    page = head(Result(fp.Scene(), "full", None, None, state(error=Errors(mu_app=error))))
    assert f"{words} the finger and the model assume is not in it." in page
    assert '<a href="#trust">' in page and "can be used" not in page
    assert bool(re.search(r"= 0\.4000 ± 0\.0026</h1>", page)) == (error == 0.0026)


def test_plus_minus_is_explained_where_it_is_printed():
    shown = str(Result(fp.Scene(), "full", None, None, state(error=Errors(mu_app=0.0026))))
    assert PLUS_MINUS in shown and "what the finger and the model assume is not in it" in PLUS_MINUS
    assert PLUS_MINUS not in str(Result(fp.Scene(), "full", None, None, state()))


# -- what a result prints --------------------------------------------------------------------------------------------
def test_cautions_follow_the_notes_with_a_mark():
    lines = str(fp.Result(fp.Scene(), "cylinders", None, None, state(), notes=("a note",), cautions=("mind this",)))
    assert lines.startswith("Result (model 'cylinders')")
    assert lines.splitlines()[-2:] == ["  a note", "  ! mind this"]
    assert ["friction", "force", "f_T", "(N/m)", "4.000"] in [line.split() for line in lines.splitlines()]


def test_states_of_two_meshes_name_them():
    """As with an accuracy, whose uncharged state is of the path's mesh."""
    coarse, fine = state(mesh_contact=20e-6, voltage=0.0), state(mesh_contact=5e-6)
    told = str(fp.Result(fp.Scene(), "full", coarse, fine, fine))
    assert "Facets of 20 µm (uncharged normal contact), 5 µm (charged normal contact), 5 µm (full slip): " in told
    assert "Facets of" not in str(fp.Result(fp.Scene(), "full", fine, fine, fine))


def test_whole_finger_comes_first_where_newtons_were_asked_for():
    run = fp.Result(fp.Scene(), "full", None, None, state(), finger=whole())
    assert str(run).startswith("Section at the centre of the finger\n") and str(run).endswith(str(run.finger))
    asked = replace(run, scene=fp.Scene(force=0.5))
    assert str(asked).startswith(str(run.finger))
    assert "\nSection at the centre of the finger\n" in str(asked)
    assert str(replace(asked, finger=None)).startswith("Result\n"), "a trace was interrupted"


def test_cheaper_models_say_what_computed_them(tmp_path):
    """In their files and reports, as a full run does."""
    fp.run(model="cylinders", out=tmp_path)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert f"<blockquote>fingerpad {fp.__version__}: two-scale" in page
    assert fp.__version__ in fp.Result.load(tmp_path).to_xarray().attrs["provenance"]
