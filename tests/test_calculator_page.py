"""The calculator's page in a real browser: map, target, two screens, presets, address, and its ±."""

import json
import re

import pytest

import fingerpad as fp
from fingerpad.calculator import page as calculator
from fingerpad.calculator.page import page
from fingerpad.reduced import cylinder_errors, cylinders
from fingerpad.scene import Scene
from fingerpad.scene.reading import put
from tests.browser import asked
from tests.test_calculator import FIELDS, SET, by_script

FIND = "const find = (id) => document.getElementById(id), text = (id) => find(id).textContent;"


@pytest.fixture(scope="module")
def whole() -> str:
    return page()


# -- the map -------------------------------------------------------------------------------------------
def test_map_has_the_target_and_takes_clicks_and_keys(whole, tmp_path):
    """The line of 2x goes through the voltage that doubles friction; the ring follows fields."""
    program = f"""{SET}{FIND}
    set({{ force: 0.5, target: "2x" }});
    const words = text("caption_voltage"), svg = find("map").querySelector("svg"), rect = svg.getBoundingClientRect();
    const hit = (x, y) => ({{ clientX: rect.left + x * rect.width, clientY: rect.top + y * rect.height }});
    svg.dispatchEvent(new PointerEvent("pointermove", hit(0.5, 0.5)));
    const under = svg.querySelector(".hover").textContent;
    svg.dispatchEvent(new MouseEvent("click", hit(0.3, 0.4)));
    const after = [find("voltage").value, find("electric.d_i").value];
    find("map").dispatchEvent(new KeyboardEvent("keydown", {{ key: "ArrowUp", bubbles: true }}));
    return [words, under, after, find("voltage").value, svg.querySelectorAll("image").length];"""
    words, under, after, up, images = asked(whole, program, tmp_path)
    root = float(re.search(r"reached at ([0-9.]+) V\.", words)[1])
    doubled = fp.run(fp.Scene(force=0.5, voltage=root), model="cylinders").finger.states["full_slip"].mu_app
    assert doubled == pytest.approx(2 * 0.25, rel=1e-3)
    assert re.fullmatch(r"[0-9.]+ µm, [0-9.]+ V: [0-9.]+", under)
    assert float(after[0]) not in (0, 200) and float(after[1]) not in (1, 0.1)
    assert float(up) == pytest.approx(float(after[0]) + 400 / 20, rel=2e-2) and images == 1


# -- two screens, presets ------------------------------------------------------------------------------
def test_two_screens_are_beside_each_other(whole, tmp_path):
    program = f"""{SET}{FIND}
    set({{ force: 0.5 }});
    find("keep").click();
    find("electric.d_i").value = "20"; find("electric.d_i").dispatchEvent(new Event("change"));
    find("electric.d_i").value = "20"; find("electric.d_i").dispatchEvent(new Event("input"));
    find("friction").dispatchEvent(new Event("change"));
    const rows = [...find("point").rows].map((row) => [...row.cells].map((cell) => cell.textContent));
    const dotted = document.querySelectorAll("#over_voltage .other").length;
    find("drop").click();
    return [rows, dotted, find("point").rows[0].cells.length];"""
    rows, dotted, after = asked(whole, program, tmp_path)
    runs = [fp.run(fp.Scene(force=0.5, electric={"d_i": d}), model="cylinders") for d in (1e-6, 20e-6)]
    thin, thick = (each.finger.states["full_slip"].mu_app for each in runs)
    number = runs[0].number("full_slip", "mu_app", True)
    known, unknown = (each.record["model_error"].get(cylinder_errors.WHOLE, {}) for each in runs)
    assert rows[0] == ["", "this screen", "kept screen", "this over kept"] and dotted == 1 and after == 2
    assert known and not unknown, "no full run has a coating of 20 µm"
    band = f"{thin:.3f} ± {number.error:.3f}"
    assert rows[1][1:] == [f"{thick:.3f}", band, f"−{100 * (1 - thick / thin):.1f} %"]


def test_presets_are_scenes():
    """Each has a source, and values that a scene takes for fields of the page."""
    for each in calculator.SCREENS:
        data: dict = {}
        for key, value in each.values.items():
            put(data, key, value)
        assert Scene(**data) and set(each.values) <= set(FIELDS) and each.source


def test_preset_fills_fields_and_names_its_source(whole, tmp_path):
    program = f"""{FIND}
    const select = find("preset_Screen");
    select.value = [...select.options].find((each) => each.textContent.startsWith("parylene")).value;
    select.dispatchEvent(new Event("change"));
    return [find("electric.d_i").value, find("electric.eps_i").value, text("preset_said")];"""
    thickness, permittivity, said = asked(whole, program, tmp_path)
    assert (thickness, permittivity) == ("5", "3.1") and said.startswith("Parylene C, 5 µm: Assumption:")


# -- the address ---------------------------------------------------------------------------------------
def test_address_has_all_that_is_shown(tmp_path):
    """A round trip of fields, choices, target and a kept screen; what is not changed is not in it."""
    program = """
    const texts = { ...state.start(), voltage: "150", "electric.d_i": "0.5", target: "2x", load: "metre", f_ext: "30" };
    const kept = { ...state.start(), friction: "0.4" };
    const fragment = state.to_fragment(texts, kept), back = state.from_fragment("#" + fragment);
    console.log(JSON.stringify([fragment, JSON.stringify(back.texts) === JSON.stringify(texts),
      JSON.stringify(back.kept) === JSON.stringify(kept), back.said, state.to_fragment(state.start(), null)]));"""
    fragment, same, same_kept, said, empty = by_script(program, tmp_path)
    assert set(fragment.split("&")) == {
        "voltage=150", "electric.d_i=0.5", "target=2x", "load=metre", "f_ext=30", "kept.friction=0.4"
    }  # fmt: skip
    assert same and same_kept and said == [] and empty == ""


NONSENSE = {
    "zebra=3": "zebra is no field of this page",
    "voltage=abc": "voltage is abc, which is no number; it must be 0 or from 0.001 to 5000 V",
    "force=0,5": "force is 0,5; write it with a point, as 0.5",
    "voltage=1e999": "voltage is 1e999, which is no number",
    "load=tons": "load is tons, which is no choice",
    "__proto__=1": "__proto__ is no field of this page",
    "kept.zebra=1": "zebra is no field of this page",
    "target=much": "target is much; write a number such as 0.5, or 2x for twice",
    "x=" + "y" * 400: "x is yyy",
}


def test_nonsense_in_the_address_is_one_sentence_each(tmp_path):
    program = f"""console.log(JSON.stringify({json.dumps(list(NONSENSE))}.map((text) => {{
      const {{ texts, said }} = state.from_fragment("#" + text);
      return [said, JSON.stringify(texts) === JSON.stringify(state.start())];
    }})));"""
    for (text, words), (said, unchanged) in zip(NONSENSE.items(), by_script(program, tmp_path), strict=True):
        assert len(said) == 1 and said[0].startswith(f"In the address {words}"), text
        assert said[0].endswith("; it is left out.") and len(said[0]) < 160 and unchanged, text


def test_nonsense_in_fields_is_one_sentence_beside_them(whole, tmp_path):
    wrong = [{"force": "0,5"}, {"force": "0"}, {"force": "-1"}, {"force": ""}, {"target": "2,5x"}]
    program = f"""{SET}{FIND}
    return {json.dumps(wrong)}.map((values) => {{
      set({{ force: 0.5, ...values }});
      const said = [...document.querySelectorAll("[role=alert]")].map((each) => each.textContent).filter(Boolean);
      return said;
    }});"""
    stale = "A field is refused; the numbers below are those before."
    for said, words in zip(
        asked(whole, program, tmp_path),
        ("write it with a point, as 0.5.", "force is 0 N; it must be from", "force is -1 N;", "force is no number;",
         "target is 2,5x; write it with a point, as 2.5x."),
        strict=True,
    ):  # fmt: skip
        assert len(said) == 2 and stale in said and words in "".join(said)


# -- to be read ----------------------------------------------------------------------------------------
@pytest.mark.parametrize("width", [390, 1366, 1920])
def test_nothing_is_cut_off(whole, tmp_path, width):
    """On a phone, a laptop and a large screen no part is wider than the page, and the curves fill their places."""
    program = """
    const beyond = [...document.querySelectorAll("body *")].filter(
      (each) => each.getBoundingClientRect().right > innerWidth + 0.5 || each.scrollWidth > each.clientWidth + 1 &&
        ["P", "LABEL", "PRE", "TD", "TH", "FIGURE", "DIV"].includes(each.tagName) && each.clientWidth);
    return [document.documentElement.scrollWidth, beyond.map((each) => each.outerHTML.slice(0, 80)),
      [...document.querySelectorAll("svg")].map((each) => each.clientWidth)];"""
    whole_width, beyond, curves = asked(whole, program, tmp_path, width=width, height=800)
    assert beyond == [] and whole_width <= width
    assert len(curves) == 3 and min(curves) > 0.8 * min(width, 800)


def test_page_needs_no_network(whole):
    """It names no address but a DOI in words, which nothing fetches."""
    asks = r"""(src|href)="(?!data:)|@import|url\((?!#)|fetch\(|https?://(?!www\.w3\.org/2000/svg)"""
    assert not re.search(asks, whole)


# -- dark and light ------------------------------------------------------------------------------------
def test_dark_and_light_are_legible(whole, tmp_path):
    """Contrast of text, lines, targets and refusals with the page, of either theme: at least 4.5 (WCAG 2.1, AA)."""
    program = f"""{FIND}
    const channel = (c) => (c <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
    const light = (hex) => [1, 3, 5].map((k) => channel(parseInt((hex.length < 5 ? hex.replace(/\\w/g, "$&$&") : hex)
      .slice(k, k + 2), 16) / 255)).reduce((sum, c, k) => sum + c * [0.2126, 0.7152, 0.0722][k], 0);
    return [1, 2].map(() => {{
      find("theme").click();
      const paper = light(plot.colour("paper"));
      return ["ink", "line", "other", "goal", "wrong"].map((name) => light(plot.colour(name)))
        .map((l) => (Math.max(l, paper) + 0.05) / (Math.min(l, paper) + 0.05));
    }});"""
    themes = asked(whole, program, tmp_path)
    assert all(ratio >= 4.5 for theme in themes for ratio in theme)


# -- the calculator's ±, band and solid line are where full runs are, and nowhere else -------------------------------
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
