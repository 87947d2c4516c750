"""One number, one error: a question asked at every door gives one string, whose ± is the whole known error."""

import csv
import json
from dataclasses import replace

import pytest
import xarray

import fingerpad as fp
from fingerpad.reduced import cylinder_errors, press
from fingerpad.reduced.cylinders import over_forces
from fingerpad.results.printing import cells
from fingerpad.results.quantities import FINGER
from fingerpad.scene.parameters import Slices
from fingerpad.slices.total import at_force, profile
from fingerpad.slices.trace import trace
from fingerpad.slices.traces import grid
from variational.state import Errors

SLIP = "full_slip"
ASKED = {"a force at the centre": {}, "newtons": {"force": 0.5}}


@pytest.fixture(scope="module", params=ASKED.values(), ids=ASKED)
def asked(request, tmp_path_factory):
    """A scene, its result, and its folder."""
    scene, folder = fp.Scene(voltage=200.0, **request.param), tmp_path_factory.mktemp("run")
    return scene, fp.run(scene, model="cylinders", out=folder), folder


def answers(scene, result, folder, key: str) -> dict[str, str]:
    """Return a quantity of the whole finger at full slip with its error, as every door gives it."""
    shown, files = FINGER[key].shown, [json.loads((folder / "summary.json").read_text(encoding="utf-8"))]
    found = {"result": shown(*result.number(SLIP, key, whole=True)[:2])}
    found["summary.json"] = shown(*(files[0][f"{SLIP}_finger_{name}"] for name in (key, f"{key}_error")))
    values = xarray.load_dataset(folder / "result.nc")
    found["result.nc"] = shown(*(float(values[name][2]) for name in (f"finger_{key}", f"finger_{key}_error")))
    swept = fp.sweep(scene, folder / "sweep", model="cylinders", quiet=True, voltage=[scene.voltage])
    with (folder / "sweep" / "table.csv").open(encoding="utf-8", newline="") as file:
        (row,) = csv.DictReader(file)
    names = (f"full_slip_finger_{key}", f"full_slip_finger_{key}_error")
    found["table.csv"] = shown(*(float(row[name]) for name in names))
    values = xarray.load_dataset(folder / "sweep" / "sweep.nc")
    found["sweep.nc"] = shown(*(float(values[name][0, 2]) for name in (f"finger_{key}", f"finger_{key}_error")))
    if key in ("mu_app", "f_t"):
        target = {key: result.finger.values(SLIP)[key]}
        solution = fp.solve(scene, between=[0.9 * scene.voltage, 1.1 * scene.voltage], **target)
        found["solve"] = shown(*solution.roots[0].numbers[0][:2])
        assert found["solve"] in str(solution)
    for words, text in {"printed": str(result), "sweep": str(swept)}.items():
        found[words] = found["result"] if found["result"] in text else text
    return found


@pytest.mark.slow
@pytest.mark.parametrize("key", ["mu_app", "f_t", "contact_area"])
def test_every_door_gives_one_string(asked, key):
    """Value and ± of the closed form at 200 V; equal as text, to the last digit that is shown."""
    found = answers(*asked, key)
    assert len(set(found.values())) == 1 and "±" in found["result"], found


def test_error_is_that_of_the_model_and_of_the_points(asked):
    """As relative errors of the attraction, times its share in the contact force; tolerance: roundoff."""
    scene, result, _ = asked
    total, number = result.finger.values(SLIP), result.number(SLIP, "mu_app", whole=True)
    region = cylinder_errors.find(scene, total["f_electrostatic"] / total["f_ext"])
    share = total["f_electrostatic"] / (total["f_ext"] + total["f_electrostatic"])
    model = region.errors[cylinder_errors.WHOLE]["f_electrostatic"] * share
    assert number.error > model * number.value
    section = result.number(SLIP, "mu_app")
    slip = result.full_slip
    known = region.errors[SLIP]["f_electrostatic"] * slip.f_electrostatic / slip.f_contact
    assert section.error == pytest.approx(known * section.value, rel=1e-12)


def test_where_the_model_is_not_known_no_error_is_claimed():
    """That of the points alone is not the whole one."""
    result = fp.run(fp.Scene(friction=0.02), model="cylinders")
    assert not result.finger.error[SLIP] and not result.full_slip.error.known()
    assert "±" not in str(result.finger)


def test_longer_trace_has_the_same_sum():
    """A monotone cubic takes its slopes from its neighbours. Tolerance: the root of the force."""

    def under(top):
        forces = grid(70.0, top)
        states = over_forces(fp.Scene(voltage=200.0), forces, SLIP)
        depth = press.of(fp.Scene()).indentation(forces, SLIP)
        made = trace([replace(s, bone_height=-d) for s, d in zip(states, depth, strict=True)], 0.4e-3)
        return at_force(profile(Slices()), made, 0.5, 16).values["mu_app"]

    assert under(75.0) == pytest.approx(under(300.0), rel=1e-12)


def test_error_of_an_output_is_read_as_it_was_written():
    """And printed as any other."""
    result = fp.run(model="cylinders", outputs=[fp.Output("p_mean", "kPa", lambda s: s.f_contact / s.contact_length)])
    slip = result.full_slip
    slip = replace(slip, error=Errors.of({"f_t": 0.5, "p_mean": 2e3}))
    again = fp.Result.from_xarray(replace(result, full_slip=slip).to_xarray())
    assert again.full_slip.error.known() == {"f_t": 0.5, "p_mean": 2e3}
    assert cells(again, "p_mean")[-1] == f"{1e-3 * slip.p_mean:.1f} ± 2.0"
