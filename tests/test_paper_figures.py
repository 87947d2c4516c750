"""The paper's figures: names, numbers of runs that are made up, pictures of the kept ones."""

import json

import numpy as np
import pytest

from benchmarks.harness import kept
from benchmarks.paper import loads, scenes, sine
from benchmarks.paper.figures import FIGURES, draw, main


def test_closed_forms(tmp_path):
    """Figs. 4 and 5 need no run; Fig. 4 ends at the least air gap and Fig. 5 has tension at 200 V alone."""
    assert main(["4", "5", "--out", str(tmp_path)]) == 0
    assert (tmp_path / "figure_5.png").exists()
    gap = json.loads((tmp_path / "figure_4.json").read_text(encoding="utf-8"))
    assert gap["d_eq"][0] == pytest.approx(1.489e-6, abs=5e-10)
    curves = json.loads((tmp_path / "figure_5.json").read_text(encoding="utf-8"))
    assert [min(p_ext) < 0 for p_ext in curves["p_ext"]] == [False] * 4 + [True]


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


GRID = kept("paper").numbers["grid"]
KEPT = kept("paper_figures").numbers | {name: GRID for name, figure in FIGURES.items() if figure.of_loads}


@pytest.mark.parametrize("name", KEPT)
def test_pictures_of_the_kept_numbers(name, tmp_path):
    """Those of docs/paper.json and docs/paper_figures.json; null is no number."""
    figure, numbers = FIGURES[name], KEPT[name]
    draw(figure, numbers, tmp_path / "picture.png")
    assert (tmp_path / "picture.png").stat().st_size > 5000
