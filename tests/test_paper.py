"""The paper's statements and picture from runs that are made up, so that their numbers are known."""

import csv
import json
from dataclasses import asdict
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure

from benchmarks.harness import DOCS, Made, keep, kept
from benchmarks.paper import __main__ as command
from benchmarks.paper import fields, friction, page, scenes
from benchmarks.paper.statement import HOLDS, IN_PART, NOT, Statement, statement
from benchmarks.runs import FORCES, VOLTAGES, Run
from fingerpad.io import style
from fingerpad.runs.batch import key
from fingerpad.scene import Scene
from geometry import tags

MU_0 = 0.25


def state(f_ext, voltage, lost=0.0, ridges=10.0):
    """Return steps of a run in which attraction is U^2 / 1000 and contact 1 mm a ridge, less what sliding loses."""
    f_t = MU_0 * (f_ext + voltage**2 / 1000)
    length = 1e-3 * ridges * (1 + voltage / 1000)
    rows = {
        "f_t": [0.0, f_t / 2, f_t],
        "contact_length": [length, length * (1 - lost / 3), length * (1 - lost)],
        "ridges_in_contact": [ridges, ridges, ridges - 1],
    }
    steps = {name: np.array(values) for name, values in rows.items()} | {"mu_app": np.array(rows["f_t"]) / f_ext}
    return SimpleNamespace(steps=steps, normal=0, slip=2)


RISES = {"0": 2.0, "200": 1.0}
MADE = Made("0.1.0", "abc1234", "2026-11-21")


@pytest.fixture
def grid():
    """Runs that lose contact in proportion to their mean shear stress."""
    found = {}
    for f in FORCES:
        for u in VOLTAGES:
            plain = state(f, u)
            x = plain.steps["f_t"][-1] / plain.steps["contact_length"][-1]
            found[f, u] = state(f, u, lost=2e-5 * x)
    return friction.gather(found)


def by(statements, words):
    return next(s for s in statements if words in s.paper)


def test_friction_statements(grid):
    """The largest rise of F_T is that at the smallest force, where the attraction is eight times the force."""
    found = by(friction.statements(grid, RISES), "more than 100 %")
    assert found.numbers["largest"] == pytest.approx(1 + 40 / 5)
    assert found.numbers["least"] == pytest.approx(1 + 40 / 150)
    assert found.verdict == IN_PART
    assert by(friction.statements(grid, RISES), "0.55").numbers["mu_app"] == pytest.approx(MU_0 * 115 / 75)
    assert by(friction.statements(grid, RISES), "below 50 V").verdict == IN_PART
    assert by(friction.statements(grid, RISES), "ridges fewer").numbers == {"least": 1, "largest": 1}


def test_reduction_is_fitted(grid):
    """Nearly linear, since the stress counts with the length that is left."""
    found = friction.reduction(grid)
    assert found.stress.size == 40
    assert found.slope == pytest.approx(2e-5, rel=0.1)
    assert found.r_squared > 0.99


def test_markers_of_the_reductions_are_of_their_voltage(grid):
    """A colour a voltage, over f_T / L_R of its runs in kPa."""
    figure = Figure()
    friction.paint(figure, grid)
    markers = {line.get_color(): line for line in figure.axes[1].lines if line.get_linestyle() == "None"}
    for k, voltage in enumerate(VOLTAGES):
        stress = 1e-3 * grid["slip_f_t"][:, k] / grid["slip_contact_length"][:, k]
        assert markers[style.voltage(voltage)].get_xdata() == pytest.approx(stress, rel=1e-12)


def test_waves_are_counted_by_voltage(grid):
    found = by(friction.statements(grid, RISES), "wavy")
    assert (found.numbers, found.verdict) == ({"rises_0": 2.0, "rises_200": 1.0}, HOLDS)
    assert by(friction.statements(grid, {"0": 0.0, "200": 1.0}), "wavy").verdict == IN_PART


def charged(run_x, tag, before, after):
    """Return a run whose layers' triangles have energy densities before and after charging."""
    triangles = np.arange(3 * len(tag)).reshape(-1, 3)
    finger = {"x": run_x, "u": np.zeros_like(run_x), "triangles": triangles, "tag": np.array(tag)}
    arrays = {"finger_press": finger | {"sed": np.array(before)}, "finger_charge": finger | {"sed": np.array(after)}}
    return SimpleNamespace(
        arrays=arrays.__getitem__, normal=0, on_ridges=lambda row, name: (np.array([-1, 0, 1]), None), scene=Scene()
    )


def test_change_of_a_layer_is_weighed_by_area():
    """One triangle of 1 and one of 3 area units: 100 % of the small and 20 % of the large are 40 %; one far off."""
    small, wide = np.array([[0, 0], [2, 0], [0, 1]]), np.array([[0, 0], [6, 0], [0, 1]])
    layers = [tags.LAYERS[name] for name in ("stratum corneum", "viable epidermis", "dermis")]
    corners = [1e-5 * small, 1e-5 * wide, 1e-5 * small + [5e-3, 0], 1e-5 * small, 1e-5 * small]
    tag = [layers[0], layers[0], layers[0], layers[1], layers[2]]
    run = charged(np.concatenate(corners), tag, [1.0, 1.0, 1.0, 2.0, 4.0], [2.0, 0.8, 9.0, 2.0, 5.0])
    assert list(fields.changes(run).values()) == pytest.approx([0.4, 0.0, 0.25], rel=1e-12)


def sheared():
    """Return a run with a partial slip state in which the leading half slips, and symmetric normal contact."""
    x = np.linspace(-1, 1, 9)
    p = np.array([0.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 0.0])
    normal = {"x": x, "p": p, "p_el": np.where(p > 0, 0.5, 0.3), "t": 0.1 * x}
    partial = {"x": x, "p": p, "t": MU_0 * p * np.where(x > 0, 1.0, 0.5)}
    found = {f"{state}_{k}": v for state, a in (("normal", normal), ("partial", partial)) for k, v in a.items()}
    steps = {
        "f_ext": np.full(4, 10.0),
        "contact_length": np.array([1.0, 2.0, 4.0, 5.0]),
        "bone_x": np.array([0.0, 1e-4, 2e-4, 3e-4]),
        "slipping": np.array([0.5, 0.1, 0.6, 1.0]),
    }
    gaps = {0: np.linspace(2e-6, 4.8e-6, 9), 3: np.full(9, 2e-6)}
    return SimpleNamespace(
        arrays=lambda _: found, steps=steps, normal=0, slip=3, scene=Scene(),
        on_ridges=lambda row, name: (np.arange(-4, 5), gaps[row]),
    )  # fmt: skip


def test_section_statements():
    run = sheared()
    leading = by(fields.section(run), "leading")
    assert (leading.numbers, leading.verdict) == ({"leading": 1.0, "trailing": 0.0}, HOLDS)
    assert by(fields.section(run), "tensile").numbers["tension"] == pytest.approx(-0.03)
    assert by(fields.section(run), "point-symmetric").numbers["even"] == pytest.approx(0, abs=1e-15)
    assert by(fields.section(run), "1.7 to 3").numbers["share"] == pytest.approx(12 / 18)


def test_claim_is_judged_site_by_site():
    """At the three sites of which a ridge is in contact in either run."""

    def run(sed, touching):
        receptors = {"ridge": np.array([-3, -2, -1, 0]), "merkel_sed": np.array([sed])}
        return SimpleNamespace(receptors=receptors, slip=0, on_ridges=lambda row, name: (touching, None))

    found = fields.claim(run([9.0, 100.0, 200.0, 400.0], [-2, -1]), run([1.0, 80.0, 202.0, 400.0], [-1, 0]))
    assert found.numbers == pytest.approx({"median": 0.01, "largest": -0.2})
    assert "at ridge -2; 2 of 3 sites" in found.ours
    assert found.verdict == IN_PART


def test_picture_has_units(grid):
    figure = Figure()
    friction.paint(figure, grid)
    assert all(ax.has_data() and "(" in ax.get_ylabel() for ax in figure.axes)


def test_verdicts():
    found = [statement("wavy", {}, *given, steps="") for given in ((True,), (False, True), (False,))]
    assert [s.verdict for s in found] == [HOLDS, IN_PART, NOT]


def test_threshold_statements():
    """155.2 V by Eq. 15, 163.6 V by Eq. 9."""
    numbers = by(fields.microscale(), "155 V").numbers
    assert numbers["eq_15"] == pytest.approx(155.2, abs=0.06)
    assert numbers["eq_9"] == pytest.approx(163.6, abs=0.05)


# -- runs ----------------------------------------------------------------------------------------------
def leave(out, scene, columns, **summary):
    """Leave a run's tables in a sweep's folder."""
    folder = out / key(scene)
    folder.mkdir(parents=True)
    (folder / "summary.json").write_text(json.dumps({"full_slip": True} | summary), encoding="utf-8")
    for name, table in columns.items():
        with (folder / f"{name}.csv").open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(table)
            writer.writerows(zip(*table.values(), strict=True))


def test_run_is_read(tmp_path):
    scene = Scene()
    steps = {
        "step": [1, 2, 3, 4, 5],
        "load": ["press", "charge", "slide", "slide", "slide"],
        "bone_x": [0, 0, 1e-4, 2e-4, 4e-4],
        "ridges_in_contact": [5, 5, 5, 4, 4],
        "all_slip": [False, False, False, True, True],
    }
    ridges = {
        "step": [1, 2, 2, 4],
        "ridge": [0, 0, 1, 1],
        "d_eq": [3e-6, 2e-6, 2.5e-6, 2.6e-6],
        "state": ["", "", "", ""],
    }
    receptors = {"step": [1, 1, 2, 2], "ridge": [0, 1, 0, 1], "merkel_sed": [1.0, 2.0, 3.0, 4.0]}
    leave(tmp_path, scene, {"steps": steps, "ridges": ridges, "receptors": receptors}, normal_step=2, slip_step=4)
    run = Run(scene, tmp_path)
    assert (run.normal, run.slip) == (1, 3)
    assert [list(found) for found in run.on_ridges(1, "d_eq")] == [[0, 1], [2e-6, 2.5e-6]]
    assert run.receptors["merkel_sed"].tolist() == [[1.0, 2.0], [3.0, 4.0]]
    assert run.receptors["ridge"].tolist() == [0, 1]


@pytest.mark.parametrize("summary", [{"failure": "stuck"}, {"interrupted": True}])
def test_unfinished_run_is_refused(tmp_path, summary):
    leave(tmp_path, Scene(), {}, **summary)
    with pytest.raises(FileNotFoundError, match=key(Scene())):
        Run(Scene(), tmp_path)


def test_missing_runs_are_named(tmp_path, capsys):
    """Without a run the statements on the microscale are made all the same, and the page lists what is missing."""
    numbers = command.collect(tmp_path / "runs")
    assert [s["figure"] for s in numbers["statements"]] == ["4, Eq. 14", "5, Eq. 15"]
    keep("paper", numbers, MADE, tmp_path)
    assert "**Not run yet:** Fig. 2, Figs. 6 to 8" in page.draw(tmp_path).read_text(encoding="utf-8")
    assert "missing: Fig. 2, run" in capsys.readouterr().out


def test_grid_of_runs_is_collected(monkeypatch, tmp_path):
    """Friction and lengths of all runs, and the waves of the path; runs without their fields are named."""

    class Fields(SimpleNamespace):
        def arrays(self, name):
            raise FileNotFoundError(name)

        receptors = property(lambda self: self.arrays("receptors"))

    def run(scene, out):
        found = state(scene.f_ext, scene.voltage, lost=0.03)
        return Fields(scene=scene, **vars(found), on_ridges=lambda row, name: ([0], None), loads=["slide"] * 3)

    monkeypatch.setattr(command, "Run", run)
    numbers = command.collect(tmp_path)
    assert np.shape(numbers["grid"]["slip_f_t"]) == (len(FORCES), len(VOLTAGES))
    assert {s["figure"] for s in numbers["statements"]} == {"4, Eq. 14", "5, Eq. 15", "6", "7", "8"}
    wavy = next(s for s in numbers["statements"] if "wavy" in s["paper"])
    assert wavy["numbers"] == {f"rises_{u:g}": 0.0 for u in VOLTAGES}
    assert numbers["missing"] == ["Fig. 2", "Fig. 9A", "Fig. 9B", "section 5"]


# -- scenes, page - ------------------------------------------------------------------------------
def test_sine_is_a_valid_scene():
    """From 0 V over the peak and back to 0 V, each reached before the finger slides on to full slip, ever farther."""
    loads = scenes.sine().loads()[1:]
    voltages = [load.voltage for load in loads if load.voltage is not None]
    assert voltages == pytest.approx([scenes.PEAK * np.sin(np.pi * k / 12) for k in range(1, 13)], abs=1e-9)
    assert np.all(np.diff([load.bone_x for load in loads]) > 0)
    assert [load.until_full_slip for load in loads] == [True] + [False, True] * 12


def numbers_with(*statements):
    return {"contact_size": scenes.SIZE, "missing": [], "statements": [asdict(s) for s in statements]}


def test_page(tmp_path):
    good = Statement("6", "it rises", "by 3 %", {"rise": 0.03}, HOLDS, "never shown")
    bad = Statement("7", "it falls", "by 1 %", {"fall": 0.01}, NOT, "it is flat")
    keep("paper", numbers_with(good, bad), MADE, tmp_path)
    text = page.draw(tmp_path).read_text(encoding="utf-8")
    assert "Of 2 statements of the paper, 1 hold" in text
    assert "**does not hold**: it is flat" in text
    assert "never shown" not in text
    assert "| equivalent air gap | 1.5e-6 | 2.5e-6 | m | Guo" in text
    assert "version 0.1.0 before 2026-11-21" in text
    assert kept("paper", tmp_path).numbers["statements"][1]["numbers"] == {"fall": 0.01}


def test_page_in_git_is_of_its_numbers(tmp_path):
    """Drawn anew from the kept numbers, text and statements on the grid are those of the page."""
    (tmp_path / "paper.json").write_bytes((DOCS / "paper.json").read_bytes())
    numbers = kept("paper", tmp_path).numbers
    grid = {name: np.array(values) for name, values in numbers["grid"].items()}
    rises = next(s["numbers"] for s in numbers["statements"] if "wavy" in s["paper"])
    again = friction.statements(grid, {name.removeprefix("rises_"): n for name, n in rises.items()})
    assert [asdict(s) for s in again] == [s for s in numbers["statements"] if s["figure"] in ("6", "7", "8")]
    assert page.draw(tmp_path).read_text(encoding="utf-8").count("| **") == len(numbers["statements"])


def test_paper_numbers_its_sites_along_the_arc():
    """Ridge k is the paper's M(k + 28): the centre of the ridges, counted from one."""
    assert scenes.CENTRE == (Scene().geometry.ridge_count + 1) // 2
