"""Outputs of one's own with a rule of sums: one that repeats a quantity of the whole finger has its value and its ±."""

import numpy as np
import pytest
import xarray

import fingerpad as fp
from fingerpad.results.states import STATES
from fingerpad.scene.parameters import Slices
from fingerpad.slices.total import at_indentation, profile
from fingerpad.slices.trace import Trace
from tests.runs import no_pictures
from tests.small_finger import small

pytestmark = pytest.mark.slow
PULL = fp.Output("pull", "N/m", lambda state: state.f_electrostatic, sum="slices")
TOUCH = fp.Output("touch", "mm", lambda state: state.contact_length, sum="slices")
BY_RIDGE = fp.Output("by_ridge", "m", lambda state: state.ridges.length.sum(), sum="slices")
SKIN = fp.Output("of_skin", "N/m", lambda state: state.skin.p_n.max(), sum="slices")
DEPTH = fp.Output("depth", "m", lambda state: -state.bone_height)
EVERY = [PULL, TOUCH, BY_RIDGE, SKIN, DEPTH]
SAME = {"pull": "f_electrostatic", "touch": "contact_area"}
SLICES = {"slices": {"radius": 6e-3, "length": 8e-3}}
FORCE = {"force": 2e-3, "mesh": {"touching_half_arc": 1.2e-3}}
FULL = {"in N/m": {}, "under a force": FORCE}


@pytest.fixture(scope="module", params=FULL)
def full(request, tmp_path_factory):
    with no_pictures():
        folder = tmp_path_factory.mktemp("full")
        return request.param, fp.run(small(**SLICES).replace(**FULL[request.param]), out=folder, outputs=EVERY)


@pytest.mark.parametrize("given", [{}, {"force": 0.3}], ids=["in N/m", "under a force"])
def test_closed_form(given):
    """Tolerance: roundoff. What the model is off by is not known of an own output: no ±."""
    finger = fp.run(fp.Scene(**given), model="cylinders", outputs=[PULL, TOUCH]).finger
    for state, values in ((name, finger.values(name)) for name in STATES):
        for own, name in SAME.items():
            assert values[own] == pytest.approx(values[name], rel=1e-12), (state, own)
            assert own not in finger.error[state]


def test_full_model(full):
    """Tolerance: roundoff of a ratio to the end of a trace."""
    for total in full[1].finger.states.values():
        assert [total.values[own] for own in SAME] == pytest.approx([total.values[k] for k in SAME.values()], rel=1e-9)
    assert "depth" not in full[1].finger.values("full_slip")


def test_error_is_that_of_the_repeated_quantity(full):
    """By mesh, penalty, correction and points; a run in N/m knows no error of its estimate of charged slices.

    Tolerance: a contact length has the root of squares of its ridges' changes where that is more, by mirror symmetry
    the same.
    """
    way, result = full
    for state in STATES[: 1 if way == "in N/m" else 3]:
        error = result.finger.error[state]
        assert error["touch"] == pytest.approx(error["contact_area"], rel=1e-6) and error["touch"] > 0
        assert error.get("pull", 0.0) == pytest.approx(error["f_electrostatic"], rel=1e-6)
    assert ("touch" in result.finger.error["full_slip"]) == (way != "in N/m")


def test_what_slices_lack_is_left_out(full):
    """Nobody knows the ridges of charged slices of a run in N/m, nor any slice's skin; all other numbers stay."""
    way, result = full
    there = [state for state in STATES if "by_ridge" in result.finger.values(state)]
    assert there == list(STATES[: 1 if way == "in N/m" else 3])
    assert not any("of_skin" in result.finger.values(state) for state in STATES)
    assert any("output of_skin" in note for note in result.notes)
    assert "touch (mm²)" in str(result.finger)


def test_files_have_the_sum(full):
    _, result = full
    again = fp.Result.load(result.folder)
    assert str(again.finger) == str(result.finger) and again.number("uncharged", "touch", whole=True).error > 0
    with xarray.open_dataset(result.folder / "result.nc", engine="scipy") as data:
        slip = data.sel(state="full_slip")
        assert float(slip.finger_touch) == result.finger.values("full_slip")["touch"]
        assert float(slip.slice_thickness @ slip.slice_touch) == pytest.approx(float(slip.finger_touch), rel=1e-12)
        assert data.finger_touch.attrs["units"] == "m^2" and data.slice_touch.attrs["units"] == "m"


@pytest.mark.parametrize("axes", [{"voltage": [100, 200]}, {"force": [0.2, 0.4]}], ids=["in N/m", "under forces"])
def test_sweep_of_the_closed_form(tmp_path, axes):
    found = fp.sweep(fp.Scene(), tmp_path, model="cylinders", outputs=[PULL, TOUCH], **axes)
    for own, name in SAME.items():
        for row in found.rows():
            values = row[f"full_slip_finger_{own}"], row[f"full_slip_finger_{name}"]
            assert values[0] == pytest.approx(values[1], rel=1e-12)
    if found.whole:
        assert found.array("touch") == pytest.approx(found.array("contact_area"), rel=1e-12)
    assert "touch (mm²)" in str(found) and "full_slip" in found.to_xarray().finger_touch.state


@pytest.mark.parametrize(("unit", "power"), [("N/m", 1), ("J/m", 2), ("m^2", 2)])
def test_slices_of_another_width_are_similar(unit, power):
    """Twice as wide and as deep, at equal stress: forces per metre twice, energies per metre four times as large."""
    own = fp.Output("own", unit, lambda state: 0.0, sum="slices")
    depth = np.array([1e-4, 2e-4, 4e-4])
    columns = {name: depth for name in ("f_ext", "f_t", "f_electrostatic", "contact_length", "gross_width")}
    trace = Trace(depth, columns | {"own": -(depth**1.5)}, own=(own,))
    shape = {"z": (-5e-3, 5e-3), "height": (0.0, 0.0)}
    one, two = (
        at_indentation(profile(Slices(**shape, width=(width, width))), trace, width * 3e-4, 8) for width in (1.0, 2.0)
    )
    assert one.totals["own"] == pytest.approx(-(3e-4**1.5) * 1e-2, rel=1e-12)
    assert two.totals["own"] == pytest.approx(2**power * one.totals["own"], rel=1e-12)
