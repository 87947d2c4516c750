"""The paper's figures: names, numbers of runs that are made up, pictures of the kept ones."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.harness import kept
from benchmarks.paper import loads, maps, scenes, section, sine
from benchmarks.paper.figures import FIGURES, draw, main
from benchmarks.runs import Unfinished
from variational.snapshot import Snapshot


def test_closed_forms(tmp_path):
    """Figs. 4 and 5 need no run; Fig. 4 ends at the least air gap and Fig. 5 has tension at 200 V alone."""
    assert main(["4", "5", "--out", str(tmp_path)]) == 0
    assert (tmp_path / "figure_5.png").exists()
    gap = json.loads((tmp_path / "figure_4.json").read_text(encoding="utf-8"))
    assert gap["d_eq"][0] == pytest.approx(1.489e-6, abs=5e-10)
    curves = json.loads((tmp_path / "figure_5.json").read_text(encoding="utf-8"))
    assert [min(p_ext) < 0 for p_ext in curves["p_ext"]] == [False] * 4 + [True]


def test_a_run_that_fails(tmp_path, monkeypatch):
    """It is named; no picture is made of others."""
    monkeypatch.setattr("fingerpad.runs.batch.sweep", lambda *_: {})
    monkeypatch.setattr("fingerpad.runs.batch.result", lambda *_: {"failure": "Newton's method"})
    with pytest.raises(Unfinished, match="did not reach its end: Newton's method"):
        main(["9A", "--out", str(tmp_path)])
    assert not (tmp_path / "figure_9A.png").exists()


def test_sites_by_what_voltage_does():
    """The site that hardly changes is one that stays in contact."""
    before, after = np.array([1, 1, 1, 0, 0], bool), np.array([0, 1, 1, 1, 0], bool)
    found = sine.by_kind(np.array([0.1, 0.7, 1.1, 9.0, 1.0]), before, after, 1)
    assert {kind: sites.tolist() for kind, sites in found.items()} == {
        "highest": [1], "enters": [3], "leaves": [0], "changes least": [2],
    }  # fmt: skip
    assert set(found) == set(scenes.NAMED)


def test_reduction_of_a_line():
    """A loss that is in proportion to the shear stress has that slope."""
    stress = np.array([[1e3, 2e3], [4e3, 8e3]])
    after = 1e-3 * np.ones((2, 2))
    grid = {
        "full_slip_f_t": stress * after,
        "full_slip_contact_length": after,
        "charged_contact_length": after / (1 - 1e-5 * stress),
    }
    found = loads.reduction(grid)
    assert found.slope == pytest.approx(1e-5) and found.r_squared == pytest.approx(1)


def test_map_keeps_what_is_in_view():
    """Triangles outside are left out, those beside a line in view are not; places come back to a micrometre."""
    x = 1e-3 * np.array([[0, 0.2], [1, 0.2], [0, 1.0], [0.5, 0.2], [1, 9], [0, 9], [0.5, 9]])
    body = Snapshot(
        x, np.full_like(x, 1e-7), np.array([[0, 1, 2], [4, 5, 6]]), np.array([123.4, 5.0]), np.array([1, 2]),
        np.array([[0, 3, 1]]), np.array([[0, -1]]),
    )  # fmt: skip
    near = maps._near(body) | {"merkel": np.zeros((0, 2))}
    back = maps._snapshot({name: maps._pack(name, values) for name, values in near.items()})
    assert back.triangles.tolist() == [[0, 1, 2]] and back.beside.tolist() == [[0, -1]]
    assert back.lines.tolist() == [[0, 3, 1]] and back.tag.tolist() == [1]
    assert np.abs(back.x - x[:4]).max() <= 6e-7
    assert back.sed == pytest.approx([123.4], rel=5e-4)


GRID = kept("paper").numbers["grid"]
KEPT = kept("paper_figures").numbers | {name: GRID for name, figure in FIGURES.items() if figure.of_loads}


@pytest.mark.parametrize("name", KEPT)
def test_pictures_of_the_kept_numbers(name, tmp_path):
    """Those of docs/paper.json and docs/paper_figures.json; null is no number."""
    figure, numbers = FIGURES[name], KEPT[name]
    draw(figure, numbers, tmp_path / "picture.png")
    assert (tmp_path / "picture.png").stat().st_size > 5000


def test_ridges_of_the_section(tmp_path, monkeypatch):
    """Points under pressure are kept with those beside them; a gap parts ridges."""
    ridge, p = np.repeat([0.0, 1.0, 2.0], 4), np.array([0, 5.0, 6.0, 0, 0, 0, 0, 0, 0, 0, 1.0, 0])
    columns = {"x": np.arange(12.0), "p": p, "p_el": p, "t": p, "d_eq": p, "ridge": ridge}
    states = ("charged", "partial", "full_slip")
    skin = {f"{state}_{name}": values for state in states for name, values in columns.items()}
    steps = {"f_ext": np.array([6.0]), "contact_length": np.array([2.0])}
    made = SimpleNamespace(charged=0, steps=steps, arrays=lambda _: skin)
    monkeypatch.setattr(section, "computed", lambda *_: {"section": made})
    found = section.numbers(tmp_path, 1)
    assert found["scale"] == 3.0
    assert np.array(found["states"]["partial"]["x"]) == pytest.approx([0, 1, 2, 3, np.nan, 9, 10, 11], nan_ok=True)
