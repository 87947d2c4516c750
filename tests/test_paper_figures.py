"""The paper's figures: names, numbers of runs that are made up, pictures of the kept ones."""

import json

import pytest

from benchmarks.harness import kept
from benchmarks.paper.figures import FIGURES, draw, main


def test_closed_forms(tmp_path):
    """Figs. 4 and 5 need no run; Fig. 4 ends at the least air gap and Fig. 5 has tension at 200 V alone."""
    assert main(["4", "5", "--out", str(tmp_path)]) == 0
    assert (tmp_path / "figure_5.png").exists()
    gap = json.loads((tmp_path / "figure_4.json").read_text(encoding="utf-8"))
    assert gap["d_eq"][0] == pytest.approx(1.489e-6, abs=5e-10)
    curves = json.loads((tmp_path / "figure_5.json").read_text(encoding="utf-8"))
    assert [min(p_ext) < 0 for p_ext in curves["p_ext"]] == [False] * 4 + [True]


GRID = kept("paper").numbers["grid"]
KEPT = kept("paper_figures").numbers | {name: GRID for name, figure in FIGURES.items() if figure.of_loads}


@pytest.mark.parametrize("name", KEPT)
def test_pictures_of_the_kept_numbers(name, tmp_path):
    """Those of docs/paper.json and docs/paper_figures.json; null is no number."""
    figure, numbers = FIGURES[name], KEPT[name]
    draw(figure, numbers, tmp_path / "picture.png")
    assert (tmp_path / "picture.png").stat().st_size > 5000
