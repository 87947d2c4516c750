"""The calculator's ±, band and solid line are where full runs are, and nowhere else."""

import json
import re

import pytest

from fingerpad.calculator.page import page
from fingerpad.reduced import cylinder_errors, cylinders
from fingerpad.scene import Scene
from tests.browser import asked
from tests.test_calculator import SET

# Sets values into fields; returns what the page shows of its error.
SHOWN = """
function shown(values) {
  set(values);
  const curve = (id) => {
    const lines = [...document.querySelectorAll(`#${id} polyline`)];
    const solid = lines.filter((each) => !each.getAttribute("stroke-dasharray"));
    const ticks = [...document.querySelectorAll(`#${id} text`)].map((each) => each.textContent);
    const points = (list) => list.flatMap((each) => each.getAttribute("points").split(" ").map((p) => parseFloat(p)));
    const own = lines.filter((each) => !["other", "goal"].includes(each.getAttribute("class")));
    const all = points(own), known = points(solid);
    return { bands: document.querySelectorAll(`#${id} .band`).length, solid: solid.length,
      ends: [known, all].map((list) => [Math.min(...list), Math.max(...list)]) };
  };
  const cells = [...document.querySelectorAll("#point td")].map((td) => [td.id.slice(6), td.textContent]);
  const text = (id) => document.getElementById(id).textContent;
  return { cells: Object.fromEntries(cells), always: text("always"), notes: text("notes"),
    caption: document.querySelector("#point caption").textContent,
    captions: ["voltage", "force"].map((id) => text("caption_" + id)),
    voltage: curve("over_voltage"), force: curve("over_force") };
}
"""


@pytest.fixture(scope="module")
def whole() -> str:
    return page()


def shown(whole: str, folder, *values: dict) -> list[dict]:
    """Return what the page shows with each of some sets of values."""
    return asked(whole, f"{SET}{SHOWN} return {json.dumps(values)}.map(shown);", folder)


def test_point_that_no_run_is_at_has_no_error(whole, tmp_path):
    """Nor has a curve of another skin or screen a solid line; its end is at the largest known voltage exactly."""
    ranges = [each.ranges for each in cylinder_errors.REGIONS]
    of_default = [each for each in ranges if "friction" not in each or cylinder_errors.within(0.25, each["friction"])]
    end_of_known = max(each["voltage"][1] for each in of_default)
    beyond = [{"voltage": end_of_known + 1}, {"f_ext": 451}, {"f_ext": 0.9}]
    other = [{"friction": 1.1}, {"electric.d_i": 20}, {"roughness.h_rms": 4}]
    pages = shown(whole, tmp_path, *beyond, *other, {"voltage": 400})
    for found in pages:
        assert not any("±" in cell for cell in found["cells"].values())
        assert found["caption"].endswith("error not known") and found["always"].endswith(", error not known")
        assert "not known" in found["notes"]
    for found in pages[len(beyond) : -1]:
        assert [found[curve][part] for curve in ("voltage", "force") for part in ("solid", "bands")] == [0] * 4
        assert all("dashed, since its error is not known" in words for words in found["captions"])
    (first, last), (begin, end) = pages[-1]["voltage"]["ends"]
    assert (last - begin) / (end - begin) == pytest.approx(end_of_known / 400, abs=1e-3) and first == begin


def test_known_point_has_its_errors(whole, tmp_path):
    """Of friction, attraction and contact length, with two digits: half of the second is 5 % at most."""
    (found,) = shown(whole, tmp_path, {})
    result = cylinders.solve(Scene())
    state, bands = result.full_slip, result.record["model_error"]["full_slip"]
    for key, band, per in (("mu_app", "mu_app", 1), ("f_t", "mu_app", 1), ("f_electrostatic", "f_electrostatic", 1),
                           ("contact_length", "contact_length", 1e3)):  # fmt: skip
        error = float(re.search(r"± ([0-9.]+)", found["cells"][key])[1])
        assert error == pytest.approx(bands[band] * getattr(state, key) * per, rel=0.05)
    assert "±" not in found["cells"]["d_eq"] and found["caption"] == "Middle section of the finger"
    assert found["voltage"]["bands"] == found["force"]["bands"] == 1
