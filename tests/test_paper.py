"""The paper's statements of a skin that is made up, and its figures from their kept numbers."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.harness import Made, keep, kept
from benchmarks.paper import fields, states
from benchmarks.paper.figures import FIGURES, draw, main
from benchmarks.paper.statement import BUILT, HOLDS
from fingerpad.scene import Scene

MU_0 = 0.25


MADE = Made("0.1.0", "abc1234", "2026-11-21")


def by(statements, words):
    return next(s for s in statements if words in s.paper)


POINTS = 8  # of a ridge under pressure
RIDGES = np.arange(-4, 5)


# -- tractions -------------------------------------------------------------------------------------
def skin(**changes):
    """Return the skin of nine ridges: tension at the edges, shear odd in x, slip at the edges; leading slip in part."""
    n = POINTS + 2  # one without pressure on either side
    x = (RIDGES[:, None] + np.linspace(-0.3, 0.3, n)) * 1e-3
    p = np.tile([0.0, 0.4, *[2.0] * (n - 4), 0.4, 0.0], (len(RIDGES), 1))
    slip = np.tile([True, True, *[False] * (n - 4), True, True], (len(RIDGES), 1))
    normal = {"p": p, "p_el": np.full(x.shape, 0.5), "t": MU_0 * p * np.where(slip, 1.0, 0.5) * np.sign(x)}
    partial = normal | {"t": MU_0 * p * np.where(x > 0, 1.0, 0.5)}
    states = {"charged": normal | changes, "partial": partial, "full_slip": normal}
    found = {f"{s}_{name}": values.ravel() for s, a in states.items() for name, values in a.items()}
    for s in states:
        found |= {f"{s}_x": x.ravel(), f"{s}_ridge": np.repeat(RIDGES, n).astype(float)}
    return found


def run_of(arrays, gaps=None, partial=None):
    """Return a run with a skin; ``gaps``: air gaps (m) by ridge in normal contact and at full slip."""
    gaps = gaps or ([3, 3, 2, 2, 1, 2, 2, 3, 3],) * 2
    arrays = arrays | {f"partial_{name}": values for name, values in (partial or {}).items()}
    steps = {"f_ext": np.full(4, 10.0), "contact_length": np.array([2.5, 2.0, 4.0, 5.0])}
    of_row = {0: gaps[0], 3: gaps[1]}
    return SimpleNamespace(
        arrays=lambda _: arrays, steps=steps, charged=0, full_slip=3, scene=Scene(),
        on_ridges=lambda row, name: (RIDGES, np.array(of_row[row], dtype=float)),
    )  # fmt: skip


def test_section_of_a_skin_as_the_paper_has_it():
    found = fields.section(run_of(skin()), run_of(skin()))
    assert [s.verdict for s in found] == [HOLDS, BUILT, BUILT, HOLDS, HOLDS]
    assert by(found, "leading").numbers == {"leading": 1.0, "trailing": 0.0}
    tension = by(found, "tensile").numbers
    assert (tension["points"], tension["near"], tension["of"]) == (54, 54, 27 * POINTS)
    assert (tension["edges"], tension["of_edges"]) == (54, 54)
    assert tension["most"] == pytest.approx(0.1 / 4)
    assert by(found, "slipping areas").numbers == {
        "ridges_0": 9, "ridges_1": 9, "of": 9, "ends_0": 18, "ends_1": 18, "ends": 18,
    }  # fmt: skip


def test_states_without_paths_are_compared_with_paths(tmp_path):
    """Equal to one of a load's states, or listed with all of them; a path that failed is left out.

    A path that ends elsewhere with the same ridges in contact is no second state, but unlike.
    """
    rows = [
        {"f_ext": 5.0, "voltage": u, "f_t": f_t, "ridges": 7, "reached": reached, "other": other, "factorisations": n,
         "processor_seconds": seconds}
        for u, f_t, reached, other, n, seconds in (
            (200.0, 7.4, "path", None, 90, 30.0), (150.0, 4.0, "full slip from voltage 200 V", 3.9, 6, 2.0),
            (100.0, 2.0, "full slip from voltage 150 V", None, 3, 1.0), (50.0, 1.4, "path", None, 80, 30.0),
        )
    ]  # fmt: skip
    of_paths = {200.0: 7.4 * (1 + 1e-7), 150.0: 3.9, 100.0: 2.1, 50.0: None}
    found = {
        (5.0, u): {"full_slip_f_t": f_t, "full_slip_ridges_in_contact": 7, "processor_seconds": 10.0}
        for u, f_t in of_paths.items()
    }
    listed = states.beside(rows, found)
    assert [each["voltage"] for each in listed] == [200.0, 150.0, 100.0]
    numbers = {"default": rows, "larger": rows, "beside": listed, "seconds_of_paths": [10.0]}
    numbers["seconds_of_sweep"] = 70.0
    keep("paper_states", numbers, MADE, tmp_path)
    shown = states.shown(tmp_path)
    assert [each.voltage for each in shown["equal"]] == [200.0, 150.0]
    assert [each.voltage for each in shown["two"]] == [150.0, 100.0]
    assert [each.voltage for each in shown["beside"] if not each.alike] == [100.0]
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
