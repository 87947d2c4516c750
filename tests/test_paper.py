"""The paper's grid without paths, and its figures from their kept numbers."""

import json

import pytest

from benchmarks.harness import Made, keep, kept
from benchmarks.paper import states
from benchmarks.paper.figures import FIGURES, draw, main

MADE = Made("0.1.0", "abc1234", "2026-11-21")


def test_states_without_paths_are_compared_with_paths(tmp_path):
    """One state, or listed with both; a path that failed is left out."""
    rows = [
        {"f_ext": 5.0, "voltage": u, "f_t": f_t, "ridges": 7, "reached": reached, "factorisations": n,
         "processor_seconds": seconds}
        for u, f_t, reached, n, seconds in (
            (200.0, 7.4, "path", 90, 30.0), (150.0, 4.0, "full slip from voltage 200 V", 6, 2.0),
            (100.0, 2.0, "full slip from voltage 150 V", 3, 1.0), (50.0, 1.4, "path", 80, 30.0),
        )
    ]  # fmt: skip
    of_paths = {200.0: 7.4 * (1 + 1e-7), 150.0: 3.9, 100.0: 2.0, 50.0: None}
    found = {
        (5.0, u): {"full_slip_f_t": f_t, "full_slip_ridges_in_contact": 7, "processor_seconds": 10.0}
        for u, f_t in of_paths.items()
    }
    listed = states.beside(rows, found)
    assert [each["voltage"] for each in listed] == [200.0, 150.0, 100.0]
    numbers = {"default": rows, "larger": rows, "beside": listed, "seconds_of_paths": [10.0]}
    keep("paper_states", numbers, MADE, tmp_path)
    shown = states.shown(tmp_path)
    assert [each.voltage for each in shown["equal"]] == [200.0, 100.0]
    assert [each.voltage for each in shown["other"]] == [150.0]
    assert (shown["direct"], shown["factorisations"]) == (2, 4.5)


# -- the paper's figures: names, numbers of runs that are made up, pictures of the kept ones -------------------------
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
