"""The calculator: its closed form is Python's; its page, in a real browser, answers, has a scene's bounds, is legible.

The closed form alone takes an interpreter of JavaScript and no browser.
"""

import json
import random
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

import fingerpad as fp
from fingerpad.calculator import page as fields
from fingerpad.calculator.page import page
from fingerpad.cli import main
from fingerpad.reduced import cylinder_errors, cylinders
from fingerpad.scene import Scene, SceneError
from fingerpad.scene.reading import put
from tests.browser import asked

FIELDS = {field.key: field for field in fields.fields()}
NUMBERS = ("mu_app", "f_t", "f_electrostatic", "contact_length", "ridges_in_contact")
SAME = 1e-9  # relative; both find the same roots to the last digits
# What a person does: choices and values into fields, and the next field.
SET = """
function set(values) {
  const newtons = "force" in values;
  const turn = (id, name) => document.getElementById(id).dispatchEvent(new Event(name));
  document.getElementById("defaults").click();
  turn(newtons ? "load_whole" : "load_metre", "change");
  for (const [key, value] of Object.entries(values)) {
    document.getElementById(key).value = value;
    turn(key, "input");
  }
  turn("friction", "change");
}
"""


@pytest.fixture(scope="module")
def whole() -> str:
    return page()


def sets() -> list[dict[str, float]]:
    """Return values by field, in the units of the fields: each alone at its ends and beyond, corners, and others."""
    found: list[dict[str, float]] = [{}]
    scene = [key for key in FIELDS if key != "force"]
    for key in scene:
        found += [{key: end} for end in FIELDS[key].slider]
    corner = ("voltage", "f_ext", "electric.d_i", "roughness.h_rms")
    for k in range(16):
        found.append({key: FIELDS[key].slider[k >> j & 1] for j, key in enumerate(corner)})
    found += [{"voltage": 0.0}, {"friction": 0.0}, {"voltage": 400.0}, {"f_ext": 1000.0}, {"f_ext": 0.01}]
    found += [{"roughness.h_rms": 0.001}, {"roughness.p_floor": 1e8}, {"electric.d_i": 1e4}, {"roughness.gamma": 10.0}]
    found += [{"f_ext": 0.001}, {"f_ext": 0.001, "voltage": 0.0}, {"f_ext": 5000.0}, {"voltage": 5000.0}]
    chance = random.Random(21)
    for _ in range(12):
        values = {key: chance.uniform(*FIELDS[key].slider) for key in scene}
        found.append({key: float(f"{value:.4g}") for key, value in values.items()})
    return found


def in_si(values: dict[str, float]) -> dict[str, float]:
    """Return values by field in SI units."""
    return {key: value / FIELDS[key].per if FIELDS[key].per >= 1 else value * round(1 / FIELDS[key].per)
            for key, value in values.items()}  # fmt: skip


def by_python(values: dict[str, float]) -> dict[str, float] | str:
    """Return full slip by the Python program, or why there is none."""
    data: dict[str, Any] = {}
    for key, value in in_si(values).items():
        put(data, key, value)
    try:
        found = cylinders.solve(Scene(**data))
    except SceneError as error:
        return str(error)
    assert found.full_slip is not None
    more = {key: found.record[f"full_slip_{key}"] for key in ("p_c", "d_eq")}
    return {key: getattr(found.full_slip, key) for key in NUMBERS} | more


def by_script(program: str, folder: Path) -> Any:
    """Return what a program prints beside the closed form of the page; in a browser where there is no interpreter."""
    interpreter = shutil.which("qjs") or shutil.which("node")
    parts = map(fields.part, fields.SCRIPTS[: fields.SCRIPTS.index("plot.js")])
    text = "\n".join([f"const data = {json.dumps(fields.data())};", *parts, program])
    if not interpreter:
        begin, end = "const lines = []; console.log = (line) => lines.push(line);", "return JSON.parse(lines.join(''));"
        return asked("<!DOCTYPE html><title>no page</title>", "\n".join([begin, text, end]), folder)
    script = folder / "script.js"
    script.write_text(text, encoding="utf-8")
    done = subprocess.run([interpreter, str(script)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads(done.stdout)


def agree(asked_for: list[dict[str, float]], answers: list[Any]) -> None:
    """Compare answers with Python's: where one of the two refuses, so does the other."""
    answered = 0
    for values, found in zip(asked_for, answers, strict=True):
        expected = by_python(values)
        if isinstance(expected, str):
            assert isinstance(found, str), (values, expected, found)
        else:
            assert {name: found[name] for name in expected} == pytest.approx(expected, rel=SAME), values
            answered += 1
    assert answered > 0.6 * len(answers)


# -- numbers -------------------------------------------------------------------------------------------


def test_whole_finger_is_that_of_python(tmp_path):
    """To 1e-9: each trace is made to the same force as in Python, so that its points are the same."""
    scenes: list[dict[str, Any]] = [
        {"voltage": voltage, "force": force, "friction": 0.25}
        for voltage in (0.0, 120.0, 200.0)
        for force in (0.03, 0.6)
    ]
    scenes += [{"voltage": 120.0, "force": 0.6, "friction": friction} for friction in (0.15, 0.9)]
    scenes += [{"voltage": 200.0, "force": force, "friction": 0.25} for force in (1e-5, 50.0, 200.0)]
    default = in_si({key: field.value for key, field in FIELDS.items()})
    program = f"""console.log(JSON.stringify({json.dumps([default | scene for scene in scenes])}.map((p) => {{
      try {{
        return closedForm.whole(p);
      }} catch (error) {{
        if (!(error instanceof closedForm.NoEquilibriumError)) throw error;
        return error.message;
      }}
    }})));"""
    answers = by_script(program, tmp_path)
    assert [isinstance(found, str) for found in answers] == [False] * 9 + [True] * 2
    for scene, found in zip(scenes, answers, strict=True):
        if isinstance(found, str):
            with pytest.raises(SceneError):
                fp.run(Scene(**scene), model="cylinders")
            continue
        result = fp.run(Scene(**scene), model="cylinders")
        expected = result.finger.values("full_slip")
        names = ("mu_app", "f_t", "f_electrostatic", "contact_area", "gross_area", "indentation")
        assert {name: found[name] for name in names} == pytest.approx(
            {name: expected[name] for name in names}, rel=SAME
        )
        assert found["section"]["mu_app"] == pytest.approx(result.full_slip.mu_app, rel=SAME)


def test_numbers_are_those_of_python(whole, tmp_path):
    """To 1e-9, by the fields of the page."""
    program = f"""{SET}
    return {json.dumps(sets())}.map((values) => {{
      set(values);
      const refused = [...document.querySelectorAll("[role=alert]")].map((each) => each.textContent).join("");
      const cells = [...document.querySelectorAll("[data-value]")];
      return refused || Object.fromEntries(cells.map((cell) => [cell.id.slice(6), Number(cell.dataset.value)]));
    }});"""
    agree(sets(), asked(whole, program, tmp_path))


# -- bounds --------------------------------------------------------------------------------------------
@pytest.mark.parametrize("key", list(FIELDS))
def test_bounds_are_those_of_a_scene(key):
    """Python accepts both ends, and refuses what is beyond them."""
    field = FIELDS[key]
    for end, beyond in ((field.low, 0.999), (field.high, 1.001)):
        assert "must be" not in str(by_python({key: end})) or "p_floor" in str(by_python({key: end}))
        assert f"{key} is" in str(by_python({key: end * beyond}))


# -- to be read ----------------------------------------------------------------------------------------
def test_numbers_stand_without_javascript(whole, tmp_path):
    """On a phone too: a table of the default finger, and why there are no fields."""
    program = """return [document.getElementById("fields").checkVisibility(),
      document.getElementById("without").checkVisibility(), document.documentElement.scrollWidth,
      [...document.querySelectorAll("#default tbody tr")].map((row) => [...row.cells].map((td) => td.innerText))];"""
    shown, said, width, rows = asked(whole, program, tmp_path, width=390, scripts=False)
    assert (shown, said) == (False, True) and width <= 390
    assert len(rows) == 5
    for force, *cells in rows:
        scenes = (Scene(force=float(force.removesuffix(" N")), voltage=u) for u in (0.0, 50.0, 100.0, 150.0, 200.0))
        found = [fp.run(each, model="cylinders").finger.states["full_slip"].mu_app for each in scenes]
        assert cells == [f"{each:.3f}" for each in found]


def test_command_writes_the_page(tmp_path, capsys, whole):
    file = tmp_path / "mine.html"
    assert main(["report", "--calculator", "--out", str(file)]) == 0
    assert file.read_text(encoding="utf-8") == whole and str(file) in capsys.readouterr().out
    assert main(["report", "--calculator", "--out", str(tmp_path / "none" / "mine.html")]) == 2


def test_errors_of_the_script_are_those_of_python(tmp_path):
    """Whole ones, with the points of the traces; and the keys for which none is known, at the ends of all ranges,
    beyond them, and for each field."""
    some = sets()
    for key, (low, high) in cylinder_errors.REGIONS[-1].ranges.items():
        per = FIELDS[key].per if key in FIELDS else 0.0
        some += [{key: end * per} for end in (low, high, low * 0.999, high * 1.001) if end * per]
    some = [values for values in some if not isinstance(by_python(values), str)]
    fixed = in_si({key: field.value for key, field in FIELDS.items()})
    asked_for = [fixed | in_si(values) | {"newtons": "force" in values} for values in some]
    program = (
        f"const asked = {json.dumps(asked_for)};\nconsole.log(JSON.stringify(asked.map((values) => {{"
        "const answer = values.newtons ? closedForm.whole(values) : closedForm.solve(values);"
        "return [modelErrors.of(values, answer), modelErrors.outside(values, answer)]; })));"
    )
    inside = 0
    for values, (error, outside) in zip(some, by_script(program, tmp_path), strict=True):
        data: dict[str, Any] = {}
        for key, value in in_si(values).items():
            put(data, key, value)
        found = fp.run(Scene(**data), model="cylinders")
        whole = "force" in values
        known = found.record["model_error"].get(cylinder_errors.WHOLE if whole else "full_slip", {})
        numbers = {key: found.number("full_slip", key, whole) for key in known}
        whole_errors = {key: each.error / each.value if each.value else known[key] for key, each in numbers.items()}
        assert found.full_slip is not None
        force, pull = found.scene.f_ext, found.full_slip.f_electrostatic
        if "force" in values:
            force, pull = found.finger.f_ext, found.finger.values("full_slip")["f_electrostatic"]
        keys = {each.key for each in cylinder_errors.outside(found.scene, pull / force)}
        assert {each["key"] for each in outside} == keys and bool(keys) == (not known), values
        assert (error or {}) == pytest.approx(whole_errors, rel=1e-6 if whole else SAME), values
        inside += bool(error)
    assert 0 < inside < len(some)
