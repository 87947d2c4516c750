"""The report of a folder: its numbers are the folder's, a browser opens it, and bad folders are refused or told."""

import csv
import html
import itertools
import json
import re
import shlex
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from fingerpad.cli import main
from fingerpad.cli import sweep as cli_sweep
from fingerpad.io.result import Result
from fingerpad.report import parameters, run_page, source, trust
from fingerpad.report.write import NAME, write
from fingerpad.runs.solve import solved
from fingerpad.runs.sweep import sweep
from fingerpad.scene import Scene, SceneError, from_data, override
from tests.browser import asked
from tests.small_finger import small

FEW = "contacts of few facets"
SIZES = {"laptop": (1366, 768), "phone": (390, 844)}
STEPS = """
const seen = [];
const slider = document.getElementById("state");
for (let k = 0; k <= Number(slider.max); k++) {
  slider.value = String(k);
  slider.dispatchEvent(new Event("input"));
  const curve = document.querySelectorAll("#skin .scatterlayer .trace path.js-line")[0];
  seen.push([document.getElementById("about").textContent, curve ? curve.getAttribute("d") : ""]);
}
const ridges = document.getElementById("ridge"), values = [];
for (const option of ridges.options) {
  ridges.value = option.value;
  ridges.dispatchEvent(new Event("change"));
  values.push(document.getElementById("under").textContent);
}
const charts = [...document.querySelectorAll(".chart")].map((c) => [c.id, c.querySelectorAll("svg.main-svg").length]);
const fetched = performance.getEntriesByType("resource").map((e) => e.name).filter((n) => !n.startsWith("data:"));
const root = document.documentElement;
return { seen, values, charts, fetched, wide: root.scrollWidth, width: root.clientWidth };
"""
TEXT = """
const hidden = [...document.querySelectorAll(".needs-js")].every((e) => getComputedStyle(e).display === "none");
return { text: document.body.textContent, hidden, wide: document.documentElement.scrollWidth };
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """The folder of a run of the small finger to full slip, with its pictures and report."""
    place = tmp_path_factory.mktemp("report") / "run"
    solved(small(), "full", place)
    return place


@pytest.fixture(scope="module")
def page(folder) -> str:
    return (folder / NAME).read_text(encoding="utf-8")


@pytest.fixture
def copy(folder, tmp_path) -> Path:
    """A copy of the run's folder, to be spoilt."""
    return Path(shutil.copytree(folder, tmp_path / "copy", ignore=shutil.ignore_patterns("*.bp", "*.png")))


@pytest.fixture(scope="module")
def table(tmp_path_factory) -> Path:
    """The folder of a sweep in which one of six points failed."""
    place = tmp_path_factory.mktemp("sweep")
    sweep(Scene(), place, model="cylinders", voltage=[0, 100, 200], f_ext=[25, 75])
    with (place / "table.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    rows[-1] = {key: value if key in ("voltage", "f_ext") else "" for key, value in rows[-1].items()}
    rows[-1]["failure"] = "no equilibrium at part 0.31 of <slide>"
    with (place / "table.csv").open("w", encoding="utf-8", newline="") as file:
        out = csv.DictWriter(file, list(rows[0]))
        out.writeheader()
        out.writerows(rows)
    write(place)
    return place


# -- a run -------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("size", SIZES)
def test_browser_opens_it_and_steps_through_the_states(page, tmp_path, size):
    """No error, nothing wider than the window, nothing fetched; each state of the slider has words and a curve."""
    width, height = SIZES[size]
    found = asked(page, STEPS, tmp_path, width=width, height=height)
    assert found["wide"] <= found["width"] <= width
    assert found["fetched"] == []
    labels, curves = zip(*found["seen"], strict=True)
    assert [re.search(r": (.*?)\.", label)[1] for label in (labels[0], labels[1], labels[-1])] == [
        "end of press", "end of charge", "end of slide",
    ]  # fmt: skip
    assert len(set(curves)) == len(curves) and all(curves)
    assert any("air gap" in words for words in found["values"])
    assert {name for name, drawn in found["charts"] if drawn} >= {"body", "skin", "one", "friction", "work"}
    assert all(drawn for _, drawn in found["charts"])


def test_key_numbers_fit_a_phone(page, tmp_path):
    """All columns at once: that of full slip is the last."""
    program = """
    const tables = [...document.querySelectorAll(".wide")].filter((box) => box.querySelector("table.numbers"));
    return tables.slice(0, 2).map((box) => [box.scrollWidth, box.clientWidth]);"""
    found = asked(page, program, tmp_path, width=390, height=844)
    assert len(found) == 2 and all(needed <= there for needed, there in found)


def test_numbers_stand_there_without_scripts(page, folder, tmp_path):
    result = Result.load(folder)
    found = asked(page, TEXT, tmp_path, width=390, height=844, scripts=False)
    assert f"{result.full_slip.f_electrostatic:.3f}" in found["text"]
    assert found["hidden"], "controls that do nothing are shown"
    assert found["wide"] <= 390


@pytest.mark.parametrize("way", [1, -1])
def test_friction_over_that_without_attraction_has_no_sign(folder, way):
    result = Result.load(folder)
    slip = replace(result.full_slip, mu_app=way * 0.5)
    assert ", 2.00 times the 0.25 without attraction" in run_page.page(replace(result, full_slip=slip))


def test_contact_lengths_of_the_ridges_add_up(page, folder):
    """In every saved state; each length is rounded to 0.05 µm."""
    frames = data(page)["finger"]["frames"]
    assert len(frames) >= 3
    for frame in frames:
        whole = float(re.search(r"L_R = ([0-9.]+) mm", frame["about"])[1])
        assert sum(ridge["length"] for ridge in frame["skin"]) == pytest.approx(whole, abs=1.5e-3)


def test_every_parameter_is_listed_with_its_unit(page):
    rows = re.findall(r'<tr><th scope="row">([\w.]+)</th><td>(.*?)</td><td>(.*?)</td>', page)
    found = {key: (value, unit) for key, value, unit in rows}
    assert found["roughness.h_rms"] == ("3.1e-06", "m")
    assert found["geometry.width"] == ("0.004", "m")


def test_picture_that_is_no_picture_is_left_out(copy):
    (copy / "surface.png").write_bytes(b"")
    (copy / "surface_press.npz").write_bytes(b"PK")
    assert "data:image/png" not in write(copy).read_text(encoding="utf-8")


def test_jumps_are_marked(folder):
    result = Result.load(folder)
    middle = result.steps[-3]
    jumped = replace(middle, record=replace(middle.record, jump=True, energy_released=1e-3, released_error=1e-6))
    steps = tuple(jumped if state is middle else state for state in result.steps)
    shown = data(run_page.page(replace(result, steps=steps)))["steps"]
    assert shown["jump"][shown["step"].index(middle.step)] == 1
    words = {each.what: each.words for each in trust.findings(replace(result, steps=steps))}["jumps"]
    assert f"{middle.step} (slide)" in words


# -- trust -------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("changes", "what", "kind"),
    [
        ({"stable": False}, "a state is unstable", trust.BAD),
        ({"f_contact": 2.0}, "forces do not balance", trust.BAD),
        ({"stable": True}, "stability", trust.GOOD),
        ({"contact_length": 3.9 * 2 * 40e-6, "ridges_in_contact": 2, "mesh_contact": 40e-6}, FEW, trust.CARE),
    ],
)
def test_what_is_wrong_is_told(folder, changes, what, kind):
    result = Result.load(folder)
    found = trust.findings(replace(result, full_slip=replace(result.full_slip, **changes)))
    assert {each.what: each.verdict for each in found}[what] == kind


def test_worst_finding_leads(folder):
    found = trust.findings(replace(Result.load(folder), failure="the load slide was not reached"))
    kind, words = trust.verdict(found)
    assert kind == trust.BAD and "the load slide was not reached" in words


def test_contacts_of_enough_facets_and_other_formulations_are_not_told(folder):
    result = Result.load(folder)
    state = replace(result.full_slip, contact_length=4.1 * 2 * 40e-6, ridges_in_contact=2, mesh_contact=40e-6)
    assert FEW not in [each.what for each in trust.findings(replace(result, full_slip=state))]
    nitsche = result.scene.replace(contact={"formulation": "nitsche"})
    few = replace(result, scene=nitsche, full_slip=replace(state, contact_length=40e-6))
    assert FEW not in [each.what for each in trust.findings(few)]


@pytest.mark.parametrize(
    ("error", "what", "words"),
    [
        (0.019, "mesh", "1.9 % of its value"),
        (0.09, "the mesh is coarse", "good for trends"),
        (0.11, "the mesh is coarse", "too coarse for more than a trend"),
        (float("nan"), "errors are not estimated", "no estimate"),
    ],
)
def test_size_of_the_error_is_told(folder, error, what, words):
    result = Result.load(folder)
    state = replace(result.full_slip, mu_app=1.0, error=replace(result.full_slip.error, mu_app=error))
    found = {each.what: each for each in trust.findings(replace(result, full_slip=state))}
    assert words in found[what].words
    assert found[what].verdict == (trust.GOOD if error < 0.02 else trust.CARE)


@pytest.mark.parametrize(("energy", "words"), [(1e-3, "released 0.001 J/m"), (1e-7, "released less than 1e-06 J/m")])
def test_energy_of_jumps_is_told_where_it_is_known(folder, energy, words):
    result = Result.load(folder)
    step = result.steps[-1]
    jumped = replace(step, record=replace(step.record, jump=True, energy_released=energy, released_error=1e-6))
    found = trust.findings(replace(result, steps=(*result.steps[:-1], jumped)))
    assert words in {each.what: each.words for each in found}["jumps"]


@pytest.mark.parametrize(("failure", "kind"), [("the load slide was not reached", trust.BAD), ("", trust.CARE)])
def test_slide_without_full_slip_is_told(folder, failure, kind):
    found = trust.findings(replace(Result.load(folder), full_slip=None, failure=failure))
    assert {each.what: each.verdict for each in found}["full slip was not reached"] == kind


# -- a sweep -----------------------------------------------------------------------------------------------
@pytest.mark.parametrize("size", SIZES)
def test_browser_opens_a_sweep(table, tmp_path, size):
    width, height = SIZES[size]
    program = """
    const charts = [...document.querySelectorAll(".chart")];
    const drawn = charts.map((c) => c.querySelectorAll(".scatterlayer .trace").length);
    return { drawn, wide: document.documentElement.scrollWidth };"""
    page = (table / NAME).read_text(encoding="utf-8")
    found = asked(page, program, tmp_path, width=width, height=height)
    assert found["drawn"] == [2, 2, 2], "a curve for each force, in three charts"
    assert found["wide"] <= width


def test_failed_points_are_listed_with_their_reason(table):
    page = (table / NAME).read_text(encoding="utf-8")
    assert "1 of 6 points failed" in page
    assert "voltage = 200, f_ext = 75</th><td>no equilibrium at part 0.31 of &lt;slide&gt;" in page


# -- folders -----------------------------------------------------------------------------------------------
def test_half_written_run_is_reported_as_such(copy):
    """Killed in a row of the table: the whole rows count."""
    (copy / "summary.json").unlink()
    rows = (copy / "steps.csv").read_text(encoding="utf-8").splitlines(keepends=True)
    (copy / "steps.csv").write_text("".join(rows[:-1]) + rows[-1][:20], encoding="utf-8")
    assert f"has not ended, or was killed, after step {len(rows) - 2}" in write(copy).read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("files", "words"),
    [
        ({}, "holds no results of fingerpad"),
        ({"notes.txt": "hello"}, "holds no results of fingerpad"),
        ({"summary.json": '{"f_ext": 75,'}, "is not whole, or not of a run"),
        ({"summary.json": "[1, 2]"}, "is not whole, or not of a run"),
        ({"summary.json": '{"failure": "f_ext is too large"}'}, "was refused and has no results: f_ext is too large"),
        ({"table.csv": "a,b\n1,2\n"}, "is not the table of a sweep"),
        ({"table.csv": "voltage,slip_mu_app,failure\n100,0.3,\n200"}, "is cut short"),
        ({"scene.json": "{}"}, "has no accepted step yet"),
        ({"full/0123/asked.json": "{}"}, "has not ended (0 runs are there)"),
    ],
)
def test_bad_folder_is_refused_in_a_sentence(tmp_path, capsys, files, words):
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    assert main(["report", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert words in said and said.count("\n") == 1
    assert not (tmp_path / NAME).exists()


def test_folder_that_is_not_there(tmp_path):
    with pytest.raises(SceneError, match="is not a folder"):
        write(tmp_path / "nowhere")


def test_report_that_fails_does_not_cost_the_run(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(run_page, "page", lambda result: 1 / 0)
    result = solved(Scene(), "cylinders", tmp_path)
    assert result.full_slip.mu_app == json.loads((tmp_path / "summary.json").read_text())["slip_mu_app"]
    assert not (tmp_path / NAME).exists()
    assert "no report of" in capsys.readouterr().err


def data(page: str) -> dict:
    """Return what the charts of a page are drawn from."""
    return json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)[1])


def test_files_of_an_earlier_sweep_do_not_stay_beside_a_new_table(tmp_path, monkeypatch, capsys):
    """Where the new dataset and report are not written; the command names the files that are there."""
    words = ["sweep", "--model", "cylinders", "--over", "voltage=0,100", "--out", str(tmp_path)]
    assert main(words) == 0 and "sweep.nc, report.html, sweep.json" in capsys.readouterr().out
    monkeypatch.setattr("fingerpad.runs.sweep.attempt", lambda folder: None)
    monkeypatch.setattr("fingerpad.runs.sweep_dataset.save", lambda sweep: "sweep.nc is missing: no room")
    assert main(words) == 0
    assert not (tmp_path / "sweep.nc").exists() and not (tmp_path / "report.html").exists()
    assert capsys.readouterr().out.strip().endswith("table.csv, sweep.json")


def test_options_are_quoted_for_a_shell():
    assert parameters.option_of("friction", 0.3) == "--set friction=0.3"
    assert parameters.option_of("geometry.ridge_profile", [1.0, -0.1]) == "--set 'geometry.ridge_profile=[1.0, -0.1]'"


@pytest.mark.parametrize(
    "value", [0.3, 5, True, "penalty", "5", "true", "a b'c.msh", "[x].csv", [True, "a"], [1.0, -0.1]]
)
def test_option_is_read_as_its_value(value):
    flag, option = shlex.split(parameters.option_of("key", value))
    assert flag == "--set" and override(option) == ("key", value)


@pytest.mark.parametrize(
    "axes",
    [
        {"voltage": [100 / 3, 200], "geometry.ridge_count": [21, 23]},
        {"materials.exponent": ["printed", "abaqus"], "output.errors": [True, False]},
    ],
)
def test_sweep_is_reproduced_by_what_its_report_says(tmp_path, axes):
    """The values as they were, with an accuracy, three of whose keys are empty."""
    scene = Scene.model_validate({"accuracy": {"mu_app": 0.01}})
    found = sweep(scene, tmp_path, model="cylinders", **axes)
    code = html.unescape(re.search(r"<pre><code>(.*?)</code>", write(tmp_path).read_text("utf-8"), re.DOTALL)[1])
    *study, command = code.splitlines()
    (tmp_path / "study.toml").write_text("\n".join(study), encoding="utf-8")
    words = shlex.split(command)
    assert words[words.index("--model") + 1] == "cylinders"
    given = {name: [word for flag, word in itertools.pairwise(words) if flag == name] for name in ("--set", "--over")}
    data, along = cli_sweep.study(tmp_path / "study.toml" if study else None, given["--set"], given["--over"])
    assert from_data(data).parameters() == scene.parameters()
    assert {key: tuple(values) for key, values in along.items()} == found.axes


def test_sweep_is_reported_with_its_own_scene(tmp_path):
    """In a folder of several studies: the last one's, whatever runs of others are there."""
    other = tmp_path / "full" / "0" / "asked.json"
    other.parent.mkdir(parents=True)
    other.write_text(json.dumps(Scene(f_ext=4.0).parameters()), encoding="utf-8")
    sweep(Scene(f_ext=20.0, friction=0.4), tmp_path, model="cylinders", voltage=[0, 100])
    assert source.read(tmp_path).parameters["f_ext"] == 20
    page = html.unescape(write(tmp_path).read_text("utf-8"))
    command = "fingerpad sweep --set f_ext=20.0 --set friction=0.4 --model cylinders --over voltage=0.0,100.0"
    assert command in page


def test_sweep_of_an_earlier_version_has_no_scene(tmp_path):
    """And the page says so."""
    sweep(Scene(), tmp_path, model="cylinders", voltage=[0, 100])
    (tmp_path / "sweep.json").unlink()
    page = html.unescape(write(tmp_path).read_text("utf-8"))
    assert "has no sweep.json" in page and "Scene and model of the sweep are not in this line" in page
    (tmp_path / "sweep.json").write_text("[]")
    with pytest.raises(SceneError, match=r"sweep.json in .* cannot be read"):
        source.read(tmp_path)
