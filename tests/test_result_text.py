"""What a result prints: states side by side, remarks, and the order where newtons were asked for."""

from dataclasses import replace

import pytest

import fingerpad as fp
from tests.test_slices import whole
from variational.state import ContactState


def slip(**values) -> ContactState:
    given = {"f_ext": 10.0, "voltage": 100.0, "f_t": 4.0, "mu_app": 0.4, "f_contact": 16.0, "f_electrostatic": 6.0}
    return ContactState(**given | {"ridges_in_contact": 5, "contact_length": 1e-3} | values)


def test_cautions_follow_the_notes_with_a_mark():
    lines = str(fp.Result(fp.Scene(), "cylinders", None, None, slip(), notes=("a note",), cautions=("mind this",)))
    assert lines.startswith("Result (model 'cylinders')")
    assert lines.splitlines()[-2:] == ["  a note", "  ! mind this"]
    assert ["friction", "force", "f_T", "(N/m)", "4.000"] in [line.split() for line in lines.splitlines()]


def test_states_of_two_meshes_name_them():
    """As with an accuracy, whose uncharged state is of the path's mesh."""
    coarse, fine = slip(mesh_contact=20e-6, voltage=0.0), slip(mesh_contact=5e-6)
    told = str(fp.Result(fp.Scene(), "full", coarse, fine, fine))
    assert "Facets of 20 µm (uncharged normal contact), 5 µm (charged normal contact), 5 µm (full slip): " in told
    assert "Facets of" not in str(fp.Result(fp.Scene(), "full", fine, fine, fine))


def test_whole_finger_comes_first_where_newtons_were_asked_for():
    run = fp.Result(fp.Scene(), "full", None, None, slip(), finger=whole())
    assert str(run).startswith("Section at the centre of the finger\n") and str(run).endswith(str(run.finger))
    asked = replace(run, scene=fp.Scene(force=0.5))
    assert str(asked).startswith(str(run.finger))
    assert "\nSection at the centre of the finger\n" in str(asked)
    assert str(replace(asked, finger=None)).startswith("Result\n"), "a trace was interrupted"


def test_cheaper_models_say_what_computed_them(tmp_path):
    """In their files and reports, as a full run does."""
    result = fp.run(model="cylinders", out=tmp_path)
    assert result.record["provenance"]["versions"]["fingerpad"] == fp.__version__
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert f"<blockquote>fingerpad {fp.__version__}: two-scale" in page
    assert fp.__version__ in fp.Result.load(tmp_path).to_xarray().attrs["provenance"]
    with pytest.raises(fp.SceneError, match="its model was cylinders, and is full now"):
        fp.run(out=tmp_path)
