"""The report of a sweep: curves, failed points, and the command that makes the sweep again."""

import csv
import html
import itertools
import json
import re
import shlex
from pathlib import Path

import pytest

from fingerpad.cli import main
from fingerpad.cli import sweep as cli_sweep
from fingerpad.installed import version
from fingerpad.report import parameters, source
from fingerpad.report.write import NAME, write
from fingerpad.runs.sweep import sweep
from fingerpad.scene import Scene, SceneError, from_data, override
from tests.browser import SIZES, asked


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


def test_swept_key_has_its_own_unit_and_the_page_its_version(tmp_path):
    """A friction coefficient has none; a page of a folder that has no version names none."""
    sweep(Scene(), tmp_path, model="cylinders", friction=[0.2, 0.3], **{"mesh.contact": [5e-6]})
    page = write(tmp_path).read_text(encoding="utf-8")
    assert '<th scope="col">friction</th><th scope="col">mesh.contact (m)</th>' in page
    assert "over friction: 0.2, 0.3; mesh.contact (m): 5e-06" in page
    assert f"<blockquote>fingerpad {version()}: two-scale" in page
    kept = json.loads((tmp_path / "sweep.json").read_text(encoding="utf-8"))
    (tmp_path / "sweep.json").write_text(json.dumps({key: kept[key] for key in ("model", "parameters")}))
    assert "<blockquote>fingerpad: two-scale" in write(tmp_path).read_text(encoding="utf-8")


def test_failed_points_are_listed_with_their_reason(table):
    page = (table / NAME).read_text(encoding="utf-8")
    assert "1 of 6 points failed" in page
    assert "voltage = 200, f_ext = 75</th><td>no equilibrium at part 0.31 of &lt;slide&gt;" in page


def test_points_without_a_coefficient_have_slid(tmp_path):
    """Their force is the headline, and no point is said to have no full slip."""
    sweep(Scene(), tmp_path, model="cylinders", voltage=[100, 200])
    with (tmp_path / "table.csv").open(encoding="utf-8", newline="") as file:
        rows = [row | {"full_slip_mu_app": ""} for row in csv.DictReader(file)]
    with (tmp_path / "table.csv").open("w", encoding="utf-8", newline="") as file:
        out = csv.DictWriter(file, list(rows[0]))
        out.writeheader()
        out.writerows(rows)
    page = write(tmp_path).read_text(encoding="utf-8")
    forces = [float(row["full_slip_f_t"]) for row in rows]
    assert f"f<sub>T</sub> from {min(forces):.3f} to {max(forces):.3f} N/m" in page
    assert "no full slip" not in page and "Every point was computed." in page


def test_files_of_an_earlier_sweep_do_not_stay_beside_a_new_table(tmp_path, monkeypatch, capsys):
    """Where the new dataset and report are not written; the command names the files that are there."""
    words = ["sweep", "--model", "cylinders", "--over", "voltage=0,100", "--out", str(tmp_path)]
    assert main(words) == 0 and "sweep.nc, report.html, sweep.json" in capsys.readouterr().out
    monkeypatch.setattr("fingerpad.runs.sweep.attempt", lambda folder: None)
    monkeypatch.setattr("fingerpad.runs.sweep_results.Sweep.save", lambda sweep: "sweep.nc is missing: no room")
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
