"""The report of a sweep: curves, failed points, and the command that makes the sweep again."""

import html
import json
import re
from pathlib import Path

import pytest

from fingerpad.cli import main
from fingerpad.cli import sweep as cli_sweep
from fingerpad.report.write import NAME, write
from fingerpad.runs.sweep import sweep
from fingerpad.scene import Scene, from_data
from tests.browser import SIZES, asked


@pytest.fixture(scope="module")
def table(tmp_path_factory) -> Path:
    """The folder of a sweep in which one of six points failed."""
    place = tmp_path_factory.mktemp("sweep")
    sweep(Scene(), place, model="cylinders", voltage=[0, 100, 200], f_ext=[25, 75])
    kept = json.loads((place / "sweep.json").read_text(encoding="utf-8"))
    last = kept["rows"][-1]
    last |= {key: None for key in last if key not in kept["axes"]}
    last["failure"] = "no equilibrium at part 0.31 of <slide>"
    (place / "sweep.json").write_text(json.dumps(kept), encoding="utf-8")
    write(place)
    return place


@pytest.mark.parametrize("size", SIZES)
def test_browser_opens_a_sweep(table, tmp_path, size):
    """A curve for each force in four charts, whose words are inside of them."""
    width, height = SIZES[size]
    program = """
    const charts = [...document.querySelectorAll(".chart > svg")], box = (each) => each.getBoundingClientRect();
    const curves = charts.map((c) => c.querySelectorAll('.series path.both[d^="M"]').length);
    const beyond = (c, each) => box(each).right > box(c).right + 1 || box(each).left < box(c).left - 1;
    const cut = charts.flatMap((c) => [...c.querySelectorAll("text")].filter((each) => beyond(c, each)));
    const legend = [...charts[0].parentNode.querySelectorAll(".legend li")].map((each) => each.textContent.trim());
    return { curves, legend, cut: cut.map((each) => each.textContent), wide: document.documentElement.scrollWidth };"""
    found = asked((table / NAME).read_text(encoding="utf-8"), program, tmp_path, width=width, height=height)
    assert found["curves"] == [2, 2, 2, 2] and found["cut"] == []
    assert [each.replace("\u00a0", " ") for each in found["legend"]] == ["fext = 25 N/m", "fext = 75 N/m"]
    assert found["wide"] <= width


def test_failed_points_are_listed_with_their_reason(table):
    page = (table / NAME).read_text(encoding="utf-8").replace("\u00a0", " ")
    assert "1 of 6 points failed" in page
    assert "voltage = 200, f<sub>ext</sub> = 75</th><td>no equilibrium at part 0.31 of &lt;slide&gt;" in page


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
    assert command == "fingerpad sweep mine.toml --model cylinders --out results/again"
    (tmp_path / "mine.toml").write_text("\n".join(study), encoding="utf-8")
    data, along = cli_sweep.study(tmp_path / "mine.toml", [], [])
    assert from_data(data).parameters() == scene.parameters()
    assert {key: tuple(values) for key, values in along.items()} == found.axes


def test_files_of_an_earlier_sweep_do_not_stay_beside_a_new_table(tmp_path, monkeypatch, capsys):
    """Where the new dataset and report are not written; the command names the files that are there."""
    words = ["sweep", "--model", "cylinders", "--over", "voltage=0,100", "--out", str(tmp_path)]
    assert main(words) == 0 and "sweep.nc, report.html, sweep.json" in capsys.readouterr().out
    monkeypatch.setattr("fingerpad.runs.sweep.attempt", lambda folder: None)
    monkeypatch.setattr("fingerpad.runs.sweep_results.Sweep.save", lambda sweep: "sweep.nc is missing: no room")
    assert main(words) == 0
    assert not (tmp_path / "sweep.nc").exists() and not (tmp_path / "report.html").exists()
    assert capsys.readouterr().out.strip().endswith("table.csv, sweep.json")
