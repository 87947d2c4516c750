"""The calculator's ±, band and solid line are where full runs are, and nowhere else."""

import json
import re

import pytest

from fingerpad.calculator import fields
from fingerpad.calculator.page import page
from fingerpad.reduced import cylinder_errors, cylinders
from fingerpad.scene import Scene
from tests.browser import asked
from tests.commands import kept

BANDS = cylinder_errors.KNOWN_ERROR["full_slip"]
# Sets values into fields; returns what the page shows of its error.
SHOWN = """
function shown(values) {
  for (const number of document.querySelectorAll("input[type=number]")) number.value = number.defaultValue;
  document.getElementById("finger_" + ("length" in values ? "given" : "default")).checked = true;
  for (const [key, value] of Object.entries(values)) document.getElementById(key).value = value;
  document.getElementById("f_ext").dispatchEvent(new Event("change"));
  const curve = (id) => {
    const lines = [...document.querySelectorAll(`#${id} polyline`)];
    const solid = lines.filter((each) => !each.getAttribute("stroke-dasharray"));
    const ticks = [...document.querySelectorAll(`#${id} text`)].map((each) => each.textContent);
    const points = (list) => list.flatMap((each) => each.getAttribute("points").split(" ").map((p) => parseFloat(p)));
    const all = points(lines.filter((each) => each.getAttribute("stroke") !== "#555")), known = points(solid);
    return { bands: document.querySelectorAll(`#${id} .band`).length, solid: solid.length,
      ends: [known, all].map((list) => [Math.min(...list), Math.max(...list)]) };
  };
  const cells = [...document.querySelectorAll("#point td")].map((td) => [td.id.slice(6), td.textContent]);
  const text = (id) => document.getElementById(id).textContent;
  return { cells: Object.fromEntries(cells), always: text("always"), notes: text("notes"),
    caption: document.querySelector("#point caption").textContent,
    captions: [...document.querySelectorAll("figcaption")].map((each) => each.textContent),
    voltage: curve("over_voltage"), force: curve("over_force") };
}
"""


@pytest.fixture(scope="module")
def whole() -> str:
    return page()


def shown(whole: str, folder, *values: dict) -> list[dict]:
    """Return what the page shows with each of some sets of values."""
    return asked(whole, f"{SHOWN} return {json.dumps(values)}.map(shown);", folder)


def test_ranges_are_those_of_the_kept_runs():
    """Forces and voltages from the first to the last of docs/models.json; all else is the default there."""
    numbers = kept("models.json")
    loads = [[float(part.split()[0]) for part in name.split(",")] for name in numbers["scenes"] | numbers["held_out"]]
    data = fields.data()["known"]
    assert data["forces"] == (min(f for f, _ in loads), max(f for f, _ in loads))
    assert data["voltages"] == (min(u for _, u in loads), max(u for _, u in loads))
    assert data["error"] == BANDS and data["runs"] == len(loads)


def test_known_point_has_its_errors(whole, tmp_path):
    """Of friction, attraction and contact length, in the digits of the value."""
    (found,) = shown(whole, tmp_path, {})
    state = cylinders.solve(Scene()).full_slip
    for key, band, per in (("mu_app", "mu_app", 1), ("f_t", "mu_app", 1), ("f_electrostatic", "f_electrostatic", 1),
                           ("contact_length", "contact_length", 1e3)):  # fmt: skip
        error = float(re.search(r"± ([0-9.]+)", found["cells"][key])[1])
        assert error == pytest.approx(BANDS[band] * getattr(state, key) * per, abs=6e-3)
    assert "±" not in found["cells"]["d_eq"] and found["caption"] == "Section at the centre of the finger"
    assert found["voltage"]["bands"] == found["force"]["bands"] == 1


def test_point_that_no_run_is_at_has_no_error(whole, tmp_path):
    beyond = [{"voltage": 201}, {"f_ext": 151}, {"f_ext": 4.9}]
    other = [{"friction": 0.26}, {"electric.d_i": 2}, {"roughness.h_rms": 4}, {"roughness.gamma": 0.4}]
    for found in shown(whole, tmp_path, *beyond, *other, {"length": 1.5, "ridges": 16}):
        assert not any("±" in cell for cell in found["cells"].values())
        assert found["caption"] == "Section at the centre of the finger: error not known" and found["always"].endswith(
            ", error not known"
        )
        assert "not known" in found["notes"]


def test_line_is_solid_up_to_the_last_run(whole, tmp_path):
    """At 300 V it is dashed from 200 V on, exactly; below 5 N/m and above 150 N/m likewise."""
    over, low, high = shown(whole, tmp_path, {"voltage": 300}, {"f_ext": 1}, {"f_ext": 300})
    (first, last), (begin, end) = over["voltage"]["ends"]
    assert (last - begin) / (end - begin) == pytest.approx(200 / 300, abs=1e-3) and first == begin
    assert over["voltage"]["solid"] == 1 and over["force"]["solid"] == over["force"]["bands"] == 0
    assert over["captions"][1].endswith("The curve is dashed, since its error is not known.")
    for found, part in ((low, (5 - 1) / (150 - 1)), (high, 0.0)):
        (first, _), (begin, end) = found["force"]["ends"]
        assert (first - begin) / (end - begin) == pytest.approx(part, abs=1e-3)
        assert found["voltage"]["solid"] == 0
    (_, last), (begin, end) = high["force"]["ends"]
    assert (last - begin) / (end - begin) == pytest.approx((150 - 5) / (300 - 5), abs=1e-3)


def test_no_line_is_solid_with_another_skin_or_screen(whole, tmp_path):
    for found in shown(whole, tmp_path, {"roughness.h_rms": 4}, {"friction": 0.3}, {"length": 1.5, "ridges": 16}):
        for curve in (found["voltage"], found["force"]):
            assert curve["solid"] == curve["bands"] == 0
        assert all("dashed, since its error is not known" in words for words in found["captions"])
