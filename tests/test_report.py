"""The report of a folder and its moving picture: the folder's numbers; bad folders are refused."""

import math
import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.collections import LineCollection
from PIL import Image

from fingerpad.cli import main
from fingerpad.report import run_page, trust
from fingerpad.report.write import NAME
from fingerpad.results import fields
from fingerpad.results.pictures import animation
from fingerpad.results.quantities import QUANTITIES
from fingerpad.results.result import Result
from fingerpad.runs.context import RunContext
from fingerpad.runs.solve import find, solved
from tests.browser import SIZES, asked
from tests.small_finger import small
from variational.attraction.dielectric import VACUUM_PERMITTIVITY

pytestmark = pytest.mark.slow
FEW = "contacts of few facets"
STEPS = """
const slider = document.getElementById("state"), seen = [], view = document.defaultView;
for (let k = 0; k <= Number(slider.max); k++) {
  slider.value = String(k);
  slider.dispatchEvent(new Event("input"));
  const shown = [...document.querySelectorAll(".frame")].filter((each) => !each.hidden);
  const curve = shown[0].querySelector('[data-name="contact pressure"] path').getAttribute("d");
  seen.push([shown.length, shown[0].querySelector(".about").textContent.replaceAll("\u00a0", " "), curve]);
}
const svg = [...document.querySelectorAll(".frame .chart > svg")].pop(), box = svg.getBoundingClientRect();
const [low, high] = svg.dataset.scale.split(" ").map(Number);
const [left, right] = [svg.dataset.left, svg.dataset.right].map(Number);
const [begin, end] = JSON.parse(svg.dataset.spans).find((each) => each[2].includes("contact length"));
const x = left + ((begin + end) / 2 - low) / (high - low) * (right - left);
const where = { clientX: box.left + x / svg.viewBox.baseVal.width * box.width, clientY: box.top + 9 };
svg.dispatchEvent(new view.PointerEvent("pointermove", where));
const tip = [...svg.parentNode.querySelectorAll(".tip p")].map((each) => each.textContent);
const fetched = performance.getEntriesByType("resource").map((e) => e.name).filter((n) => !n.startsWith("data:"));
const root = document.documentElement, charts = document.querySelectorAll(".chart").length;
return { seen, tip, fetched, charts, wide: root.scrollWidth, width: root.clientWidth };
"""
FIRST = """
const box = (element) => element.getBoundingClientRect();
function lines(cell) {
  const all = document.createRange();
  all.selectNodeContents(cell);
  return new Set([...all.getClientRects()].map((r) => r.bottom)).size;
}
const order = [...document.querySelectorAll("h1, #state, h2")].map((e) => e.id || e.tagName);
const values = [...document.querySelectorAll(".numbers td")];
return { order: order.slice(0, 3), slider: box(document.getElementById("state")).bottom,
  broken: values.filter((cell) => lines(cell) > 1).map((cell) => cell.textContent), values: values.length,
  right: Math.max(...[...document.querySelectorAll("section")].map((e) => box(e).right)) };
"""
TEXT = """
const hidden = [...document.querySelectorAll(".needs-js")].every((e) => getComputedStyle(e).display === "none");
return { text: document.body.textContent, hidden, wide: document.documentElement.scrollWidth };
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """The folder of a run of the small finger to full slip, with its pictures and report."""
    place = tmp_path_factory.mktemp("report") / "run"
    solved(small(), find("full"), RunContext(place))
    return place


@pytest.fixture(scope="module")
def page(folder) -> str:
    return (folder / NAME).read_text(encoding="utf-8")


@pytest.fixture
def copy(folder, tmp_path) -> Path:
    """A copy of the run's folder, to be spoilt."""
    return Path(shutil.copytree(folder, tmp_path / "copy", ignore=shutil.ignore_patterns("*.png")))


# -- a run -------------------------------------------------------------------------------------------------
def test_page_is_small_and_has_no_library(page):
    """A megabyte with its pictures, most of which they are; its script is our own."""
    assert len(page.encode()) < 1e6
    assert len(page.rpartition("<script>")[2]) < 8000 and page.count("<script>") == 1
    assert "prefers-color-scheme: dark" in page


@pytest.mark.parametrize("size", SIZES)
def test_browser_opens_it_and_steps_through_the_states(page, tmp_path, size):
    """No error, nothing wider than the window, nothing fetched; one state at a time, and values below a pointer."""
    width, height = SIZES[size]
    found = asked(page, STEPS, tmp_path, width=width, height=height)
    assert found["wide"] <= found["width"] <= width
    assert found["fetched"] == []
    shown, labels, curves = zip(*found["seen"], strict=True)
    states = [re.search(r": (.*?)\.", label)[1] for label in labels]
    assert states[:2] == ["end of press", "end of charge"] and set(shown) == {1}
    assert states[-3:] == ["end of slide", "charged normal contact, final mesh", "full slip, final mesh"]
    assert all(curves) and curves[0] != curves[-1]
    assert any(words.startswith("ridge ") and "air gap" in words for words in found["tip"])
    assert any(words.startswith("attraction: ") for words in found["tip"])
    assert found["charts"] == len(states) + 1, "over sliding"


@pytest.mark.parametrize("size", [*SIZES.values(), (1920, 1080)])
def test_slider_is_in_the_first_screen(page, tmp_path, size):
    """Beside or below the finding; sections fill the window, and no value is broken into lines."""
    width, height = size
    found = asked(page, FIRST, tmp_path, width=width, height=height)
    assert found["order"] == ["H1", "state", "H2"] and found["slider"] < height
    assert found["broken"] == [] and found["values"] > 30
    assert found["right"] > width - 40


def test_numbers_stand_there_without_scripts(page, folder, tmp_path):
    result = Result.load(folder)
    found = asked(page, TEXT, tmp_path, width=390, height=844, scripts=False)
    slip = result.full_slip
    shown = QUANTITIES["f_electrostatic"].shown(slip.f_electrostatic, slip.error.f_electrostatic)
    assert shown in found["text"].replace("\u00a0", " ")
    assert found["hidden"], "controls that do nothing are shown"
    assert found["wide"] <= 390


# -- pictures ----------------------------------------------------------------------------------------------
def test_field_lines_are_as_dense_as_the_field_is_strong(folder, tmp_path):
    """They end on the screen; between the same number of lines lies the same flux of E = sqrt(2 p_el / eps_0).

    Tolerance: flux is summed over 2000 places.
    """
    result = Result.load(folder)
    drawn = result.plot("field", tmp_path / "field.png")
    (lines,) = [each for each in drawn.axes[0].collections if isinstance(each, LineCollection)]
    (top, foot), strength = np.moveaxis(np.array(lines.get_segments()), 1, 0), np.asarray(lines.get_array())
    assert (foot[:, 1] == 0).all() and (top[:, 1] > 0).all() and (top[:, 0] == foot[:, 0]).all()
    flux = np.diff(foot[:, 0]) * (strength[1:] + strength[:-1]) / 2
    assert np.median(np.abs(flux / np.median(flux) - 1)) < 0.02
    p_el = fields.read(folder)["states/full_slip"]["skin"][fields.ALONG.index("p_el")]
    assert strength.max() <= 1e-6 * math.sqrt(2 * np.nanmax(p_el) / VACUUM_PERMITTIVITY) * (1 + 1e-6)


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


@pytest.mark.parametrize(
    ("error", "what", "words"),
    [
        (0.019, "mesh", "1.9 % of its value"),
        (0.11, "the mesh is coarse", "too coarse for more than a trend"),
        (float("nan"), "errors are not estimated", "did not estimate"),
    ],
)
def test_size_of_the_error_is_told(folder, error, what, words):
    result = Result.load(folder)
    errors = replace(result.full_slip.error, mu_app=error, contact_length=0.0)
    state = replace(result.full_slip, mu_app=1.0, error=errors)
    found = {each.what: each for each in trust.findings(replace(result, full_slip=state))}
    assert words in found[what].words
    assert found[what].verdict == (trust.GOOD if error < 0.02 else trust.CARE)


def test_full_slip_without_a_coefficient_has_its_force(folder):
    """As of a finger that slides while nothing presses it: no number is nan, and errors are known."""
    result = Result.load(folder)
    lost = {"mu_app": math.nan}
    slip = result.full_slip
    slip = replace(slip, **lost, error=replace(slip.error, **lost), penalty=replace(slip.penalty, **lost))
    found = replace(result, full_slip=slip, finger=None)
    page = run_page.page(found)
    text = re.sub(r"<script.*?</script>", "", page, flags=re.DOTALL)
    assert f"f<sub>T</sub> = {QUANTITIES['f_t'].shown(slip.f_t, slip.error.f_t)} N/m" in text.replace("\u00a0", " ")
    assert not re.search(r"\bnan\b", text)
    told = [each.what for each in trust.findings(found)]
    assert "errors are not estimated" not in told and {"mesh", "the mesh is coarse"} & set(told)


# -- folders -----------------------------------------------------------------------------------------------
def test_ends_of_loads_are_said_to_be_of_the_path(page):
    """Their friction is not that of the key numbers, which are of the final mesh."""
    assert page.count("States at the ends of loads are of the path") == 1


def test_contact_lengths_of_the_ridges_add_up(page):
    """In every state of the slider; each length is rounded to 0.5 µm."""
    frames = page.split('<div class="frame"')[1:]
    assert len(frames) >= 3
    for frame in frames:
        whole = float(re.search(r"L<sub>R</sub>\s=\s([0-9.]+)\smm", frame)[1])
        lengths = re.findall(r"contact length ([0-9.]+) mm", frame)
        assert sum(map(float, lengths)) == pytest.approx(whole, abs=1.5e-3)


def test_run_without_an_accepted_step_is_read_back(folder):
    """Its first step failed: there is a failure and no state."""
    bare = replace(Result.load(folder), steps=(), loads=(), uncharged=None, charged=None, full_slip=None, finger=None)
    failed = Result.from_xarray(replace(bare, failure="no equilibrium").to_xarray())
    assert failed.failure == "no equilibrium" and not failed.steps and not failed.named


@pytest.mark.parametrize(
    ("files", "words"),
    [
        ({}, "holds no results of fingerpad"),
        ({"summary.json": '{"f_ext": 75,'}, "is not a folder of a finished run"),
        ({"result.nc": "CDF"}, "result.nc is not whole, or not of a run"),
        ({"summary.json": '{"failure": "f_ext is too large"}'}, "was refused and has no results: f_ext is too large"),
        ({"sweep.json": '{"axes": ['}, "sweep.json in"),
        ({"sweep.json": '{"axes": ["a"], "rows": [{"b": 1}]}'}, "its rows have no value of a varied key"),
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


# -- the moving picture of a run: its frames, what they are drawn from, and what is left of one that is stopped ------
@pytest.mark.parametrize("ending", [".webp", pytest.param(".gif", marks=pytest.mark.long)])
def test_animation_has_a_frame_for_each_state(folder, tmp_path, capsys, ending):
    """And some between states, each load at least as many as it is said to have; the last frame stands longest."""
    file = tmp_path / f"run{ending}"
    assert main(["report", str(folder), "--animate", "--out", str(file)]) == 0 and str(file) in capsys.readouterr().out
    with Image.open(file) as shown:
        assert shown.size == (810, 540) and shown.n_frames > len(Result.load(folder).steps)
        first = shown.convert("RGB").tobytes()
        shown.seek(shown.n_frames - 1)
        assert shown.convert("RGB").tobytes() != first
    assert file.stat().st_size < 3e6


def test_motion_ends_in_the_last_state(folder):
    """Its skin is that of the last step, in single precision, and its places are the reference plus displacements."""
    kept, state = animation.motion_of(folder), Result.load(folder).steps[-1]
    assert kept.step[-1] == state.step and len(kept.step) == len(Result.load(folder).steps)
    xy, skin = kept.between(len(kept.step) - 1, 0.0)
    last = dict(zip(fields.ALONG, fields.read(folder)["loads/slide"]["skin"], strict=True))
    assert skin == pytest.approx(np.stack([last[name] for name in animation.ROWS]), rel=1e-6, abs=1e-9, nan_ok=True)
    assert xy.min(axis=0)[1] == pytest.approx(0.0, abs=1e-6), "the skin is not on the screen"


@pytest.mark.parametrize(
    ("name", "words"),
    [("a.mp4", "must end with one of .webp, .gif"), ("a.webp", "has no motion of a run in fields")],
)
def test_animation_that_cannot_be_made_is_refused(copy, capsys, name, words):
    (copy / fields.FILE).unlink()
    assert main(["report", str(copy), "--animate", "--out", str(copy / name)]) == 2
    printed, said = capsys.readouterr()
    assert words in said and said.count("\n") == 1 and printed == ""


@pytest.mark.parametrize("where", ["fingerpad.results.pictures.animation._words", "pathlib.Path.replace"])
def test_animation_that_is_stopped_leaves_what_was_there(copy, capsys, monkeypatch, where):
    """By Ctrl-C while a frame is drawn, and before the file is put in place; one sentence, and no part of a file."""

    def stop(*args):
        raise KeyboardInterrupt

    (file := copy / "animation.webp").write_bytes(b"earlier")
    there = set(copy.iterdir())
    frames = animation._frames
    monkeypatch.setattr(animation, "_frames", lambda states: frames(states)[:2])
    monkeypatch.setattr(where, stop)
    assert main(["report", str(copy), "--animate"]) == 130
    said = capsys.readouterr().err
    assert said.startswith("fingerpad: stopped by Ctrl-C") and said.count("\n") == 1
    assert file.read_bytes() == b"earlier" and set(copy.iterdir()) == there
