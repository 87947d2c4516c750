"""Tables of measurements beside computed values: what is read, compared, and refused in one sentence."""

import json
import re
import shutil

import numpy as np
import pandas as pd
import pytest

import fingerpad as fp
from fingerpad.cli import main
from fingerpad.measurements.compare import computed
from fingerpad.measurements.table import Measured, read
from fingerpad.runs.sweep import sweep
from fingerpad.scene import Scene, SceneError
from tests.commands import ROOT, refused
from tests.measures import rows_of
from tests.pages import blocks, printed


@pytest.fixture(scope="module")
def grid(tmp_path_factory):
    """A sweep of the closed form over three voltages and two forces."""
    place = tmp_path_factory.mktemp("sweep")
    return sweep(Scene(), place, model="cylinders", voltage=[0, 100, 200], f_ext=[25, 75])


@pytest.fixture(scope="module")
def folder(grid):
    return grid.folder


# -- tables --------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("mark", [", ", ";", "\t"])
def test_units_are_converted(table, mark):
    """To SI; comments, empty lines and a mark of the byte order are no rows."""
    head, row = ["Force (N/mm)", "contact length [mm]", "spread (um)"], ["0.05", "1.2", "30"]
    lines = f"# people: 5\n# state: uncharged\n# else\n\n{mark.join(head)}\n{mark.join(row)}\n"
    found = read(table(lines, "\ufeff# source: Somebody 2020\n"))
    assert (found.quantity, found.state, found.about["people"]) == ("contact length", "uncharged", "5")
    assert found.rows.to_dict("list") == {
        "force": [pytest.approx(50.0)],
        "measured": [pytest.approx(1.2e-3)],
        "spread": [pytest.approx(3e-5)],
    }


PUBLISHED = """# from the supplement
Subject\tFn [N/m]\tU_pp\tCoF\tSD\tfriction force (N/m)\tremark
A\t25\t0\t0.3\t0.05\t7\tsweaty, warm
B\t75\t-100\t0.5\t\t30\t
"""
MAPPING = {"Fn [N/m]": "force", "U_pp": "voltage (V)", "CoF": "friction (1)", "SD": "spread (1)"}


def test_tables_as_labs_publish_them(tmp_path, grid, capsys):
    """Other names by a mapping, further columns, tabs, no source: as the same numbers in the names of this program."""
    lab, ours = tmp_path / "lab.csv", tmp_path / "ours.csv"
    lab.write_text(PUBLISHED)
    ours.write_text("force (N/m), voltage (V), friction (1), spread (1)\n25, 0, 0.3, 0.05\n75, 100, 0.5,\n")
    one, other = fp.compare(lab, grid, MAPPING), fp.compare(ours, grid)
    np.testing.assert_array_equal(one, other)
    assert one.attrs["ignored"] == ("Subject", "friction force (N/m)", "remark") and one.index.tolist() == [3, 4]
    assert one.attrs["source"] == one.attrs["table"] and one.attrs["table"].endswith("lab.csv")
    words = [f"--column={head}={name}" for head, name in MAPPING.items()]
    assert main(["compare", str(lab), *words, "--sweep", str(grid.folder)]) == 0
    assert "Columns not read: Subject, friction force (N/m), remark.\n" in capsys.readouterr().out


def test_page_runs_as_written(tmp_path, monkeypatch, grid):
    """The lines of docs/command.md."""
    monkeypatch.chdir(tmp_path)
    shutil.copytree(grid.folder, "results/sweep")
    (tmp_path / "lab.csv").write_text("Fn,voltage (V),CoF,person\n25,100,0.5,A\n")
    page = blocks((ROOT / "docs" / "command.md").read_text(encoding="utf-8"))
    (code,) = (code for code, *_ in page if "measured" in code)
    assert "measured  computed  relative_difference\n" in printed(code, {})


def test_data_frames_are_tables(grid):
    """As the file; its attributes stand for the comments, and NaN for an empty cell."""
    frame = pd.DataFrame({"force (N/m)": [25, 75], "voltage (V)": [0, 100.0], "CoF": [0.3, 0.5], "SD": [0.05, np.nan]})
    frame.attrs = {"source": "Somebody 2020", "other": 5}
    found = fp.compare(frame, grid, {"CoF": "friction (1)", "SD": "spread (1)"})
    assert found.attrs["source"] == "Somebody 2020" and found.spread.isna().tolist() == [False, True]
    frame["CoF"] = [0.3, np.nan]
    with pytest.raises(SceneError, match=r"the table has nothing in row 1 of 'CoF'; it must be a finite number"):
        fp.compare(frame, grid, {"CoF": "friction (1)"})


def test_what_is_compared(grid):
    """Computed less measured, and the same over the measured value; the misfit as ratios."""
    frame = pd.DataFrame({"force (N/m)": [25, 75, 500], "voltage (V)": [0, 0, 0], "friction (1)": [0.2, 0.5, 1.0]})
    found = fp.compare(frame, list(grid))
    np.testing.assert_allclose(found.computed, [0.25, 0.25, np.nan], rtol=1e-12)
    np.testing.assert_allclose(found.difference, [0.05, -0.25, np.nan], rtol=1e-12)
    np.testing.assert_allclose(found.relative_difference, [0.25, -0.5, np.nan], rtol=1e-12)
    misfit = {"ratio": np.sqrt(1.25 * 0.5), "factor": 2.0, "shape_factor": np.sqrt(2.5)}
    assert found.attrs["misfit"] == pytest.approx(misfit | {"rows": 2, "spreads": 0, "within": 0})
    assert (found.attrs["unit"], found.attrs["force_unit"], found.attrs["state"]) == ("1", "N/m", "full_slip")


@pytest.mark.parametrize(
    ("columns", "words"),
    [
        ({}, "no quantity; it has the columns Fn .N., U, CoF, and must have one of .* as in {'CoF': 'friction .1.'}"),
        ({"CoF": "friction"}, "has 'CoF' without a unit; write 'friction .1.' in the head or by columns"),
        ({"CoF": "friction (1)", "Fn (N)": "force"}, "has no voltage, and its column 'U' may be one; name it"),
        ({"CoF": "friction (1)", "U": ""}, "has no force, and its column .* it out by {'Fn .N.': ''}"),
    ],
)
def test_no_column_is_guessed(grid, columns, words):
    """A name, a unit or a condition that is not given is refused, and no column that may be it is passed over."""
    frame = pd.DataFrame({"Fn (N)": [0.5], "U": [100], "CoF": [0.3]})
    with pytest.raises(SceneError, match=words):
        fp.compare(frame, grid, columns)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"table": [[75, 0.3]]}, "table is of the type list; it must be a DataFrame of pandas, or the path"),
        ({"result": [Scene()]}, "result is of the type Scene; it must be a result of fp.run, a sweep"),
        ({"columns": ["friction"]}, "columns is of the type list; it must be names by heads, as {'CoF'"),
    ],
)
def test_arguments_of_other_types(grid, given, words):
    """In one sentence with the argument's name."""
    frame = pd.DataFrame({"force (N/m)": [75.0], "voltage (V)": [100.0], "friction (1)": [0.3]})
    with pytest.raises(SceneError, match=f"^{re.escape(words)}"):
        fp.compare(**{"table": frame, "result": grid} | given)


HEADS = "force (N/m), friction (1)\n"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("force, friction (1)\n1, 2\n", "has 'force' without a unit; write 'force (N/m)' in the head"),
        ("force (N/m), friction force (N)\n1, 2\n", "it must be in N, as another column is of a whole finger"),
        (
            "voltage (g), friction (1)\n1, 2\n",
            "has 'voltage (g)' in 'g', which is not a unit of voltage; it must be in V",
        ),
        ("voltage (V), friction (N)\n1, 2\n", "has 'friction (N)' in 'N', which is not a number; it must be in 1 or %"),
        ("force (N), contact length (mm)\n1, 2\n", "has contact length, and a whole finger, which has a column in new"),
        (HEADS + "1, 2\n3,\n", "has nothing in line 4 of 'friction (1)'; it must be a finite number"),
        (
            "force (N/m); friction (1)\n1; 1.000,5\n",
            "in line 3 of 'friction (1)'; it must be a finite number; decimals have",
        ),
        (HEADS + "1, 0,2\n", "has more cells in line 3 than its 2 heads; decimals have points"),
        ("# state: sideways\n" + HEADS + "1, 2\n", "has the state 'sideways'; it must be one of uncharged, ch"),
        ("force (N/m), force (N/mm), friction (1)\n1, 2, 3\n", "has two columns with the name force"),
    ],
)
def test_tables_are_refused(table, capsys, text, words):
    """In one sentence, before the folder of results is looked at."""
    assert words in refused(capsys, "compare", str(table(text)), "--run", "nowhere")


def test_tables_in_the_repository_are_read():
    """Each has its source and a DOI or a link."""
    files = sorted((ROOT / "data" / "measured").glob("*.csv"))
    assert files
    for file in files:
        assert {"source", "people"} <= set(read(file).about) and {"doi", "url"} & set(read(file).about)


# -- computed values -----------------------------------------------------------------------------------------
def asked(quantity="friction", state="full_slip"):
    return Measured("x.csv", {}, state, quantity, False, pd.DataFrame({"measured": [0.3], "spread": [np.nan]}))


def at(known, force, voltage):
    """Return the values at pairs of force and voltage."""
    return known.at(np.array(force), np.array(voltage))[0]


def test_computed_values_are_those_of_the_sweep(folder):
    """At its points to roundoff; between them a power law of the force, and linear in U²; not beyond."""
    rows = {(float(r["f_ext"]), float(r["voltage"])): float(r["full_slip_mu_app"]) for r in rows_of(folder, "table")}
    found = computed(folder, asked())
    for (force, voltage), value in rows.items():
        assert at(found, [force * (1 + 1e-9)], [voltage])[0] == pytest.approx(value, rel=1e-12)
    between = at(found, [50.0, 25.0], [100.0, 50.0])
    power = np.log(rows[75, 100] / rows[25, 100]) / np.log(3)
    assert between[0] == pytest.approx(rows[25, 100] * 2**power, rel=1e-12)
    assert between[1] == pytest.approx(0.75 * rows[25, 0] + 0.25 * rows[25, 100], rel=1e-12)
    assert np.isnan(at(found, [10.0, 25.0], [100.0, 201.0])).all()


# -- the command ---------------------------------------------------------------------------------------------
def test_misfit_is_printed_and_drawn(folder, table, tmp_path, capsys):
    """Measured as twice the computed values: the ratio is a half everywhere and the shape is exact."""
    volts = [50.0, 100.0, 200.0]
    found = at(computed(folder, asked()), [75.0] * 3, volts)
    lines = [f"75, {u:g}, {2 * v:.17g}, {3 * v:g}" for u, v in zip(volts, found, strict=True)]
    file = table(
        "\n".join(["# doi: 10.1/x", "force (N/m), voltage (V), friction (1), spread (1)", *lines, "500, 100, 1, 1"])
    )
    assert main(["compare", str(file), "--sweep", str(folder), "--out", str(tmp_path / "out.png")]) == 0
    out = capsys.readouterr().out
    assert "friction at full slip: Somebody 2020\ndoi 10.1/x\n" in out
    assert "Misfit: computed over measured 0.5 (geometric mean of 3), at most a factor of 2. " in out
    assert "Scaled by one factor (2): at most a factor of 1.\n" in out
    assert "Within the spread plus the error of the computed value: 3 of 3." in out
    assert "a value is 0 or is not computed there: 1 of 4 rows." in out
    *cells, difference = [f"{k * found[0]:.4f}" for k in (2, 3, 1, -1)]
    assert re.search(rf"^ *75\.000 +50\.0 +{' +'.join(cells)} +[\d.]+ +{difference} +-50\.0$", out, re.MULTILINE)
    assert (tmp_path / "out.png").stat().st_size > 10_000


def test_numbers_are_written(folder, table, tmp_path, capsys):
    """In SI units and unrounded, a row for each row of every table; what is missing is empty."""
    first = table("force (N/mm), voltage (V), contact length (mm), spread (um)\n0.025, 100, 1, 20\n0.9, 0, 1,\n")
    both = first.rename(tmp_path / "first.csv"), table("force (N/m), voltage (V), friction (1)\n75, 100, 0.3\n")
    csv_file = tmp_path / "out.csv"
    argv = ["compare", *map(str, both), "--sweep", str(folder), "--csv", str(csv_file)]
    assert main(argv) == 0
    assert capsys.readouterr().out.endswith(f"Written: {csv_file}\n")
    rows = rows_of(tmp_path, "out")
    kinds = [(row["quantity"], row["state"], row["unit"]) for row in rows]
    assert kinds == [*[("contact length", "full slip", "m")] * 2, ("friction", "full slip", "1")]
    numbers = [float(rows[0][key]) for key in ("force", "voltage", "measured", "spread")]
    assert numbers == pytest.approx([25, 100, 1e-3, 2e-5], rel=1e-12)
    assert float(rows[0]["difference"]) == float(rows[0]["computed"]) - float(rows[0]["measured"])
    assert [rows[1][key] for key in ("spread", "computed", "error", "difference", "relative_difference")] == [""] * 5
    assert float(rows[2]["computed"]) == at(computed(folder, asked()), [75.0], [100.0])[0]
    before = (tmp_path / "first.csv").read_bytes()
    said = refused(capsys, *argv[:-1], str(tmp_path / "first.csv"))
    assert "first.csv is there and is not a table of this command" in said
    assert (tmp_path / "first.csv").read_bytes() == before


def test_errors_of_a_sweep_count_with_the_spread(folder, table, tmp_path, capsys):
    """They are interpolated as the values are; a value without an error has a dash."""
    heads = ("f_ext", "voltage", "full_slip_mu_app", "full_slip_mu_app_error", "failure")
    points = (25, 0, 0.3, 0.02, ""), (25, 100, 0.4, 0.04, ""), (25, 200, 0.5, None, "")
    rows = {"rows": [dict(zip(heads, point, strict=True)) for point in points]}
    place = tmp_path / "kept"
    shutil.copytree(folder, place)
    (place / "sweep.json").write_text(json.dumps(json.loads((place / "sweep.json").read_text()) | rows))
    # 0.375 ± 0.035 at 86.6 V
    lines = "25, 50, 0.27, 0.04\n25, 86.602540378, 0.33, 0.011\n25, 100, 0.33, 0.02\n25, 200, 0.51, 0.02\n"
    file = table("force (N/m), voltage (V), friction (1), spread (1)\n" + lines)
    assert main(["compare", str(file), "--sweep", str(place)]) == 0
    out = capsys.readouterr().out
    assert re.search(r"^ *25.000 +86.6 +0.3300 +0.0110 +0.3750 +0.0350 +0.0450 +13.6$", out, re.MULTILINE)
    assert re.search(r"^ *25.000 +200.0 +0.5100 +0.0200 +0.5000 +– +-0.0100 +-2.0$", out, re.MULTILINE)
    assert "±: whole known error of the computed value.\n" in out
    assert "Within the spread plus the error of the computed value: 3 of 4.\n" in out


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (HEADS + "25, 0.3\n", "has no voltage, and the results have 3; add a column 'voltage (V)'"),
        ("voltage (V), friction (1)\n100, 0.3\n", "has no force, and the results have 2; add a column 'force (N/m)'"),
        (
            "force (N/m), voltage (V), friction (1)\n5, 0, 0.3\n",
            "is within the results, which have 25 to 75 N/m at 0 V, 25 to 75 N/m at 100 V, 25 to 75 N/m at 200 V",
        ),
        ("force (N/m), voltage (V), depth (mm)\n25, 0, 0.3\n", "the table of the sweep has no depth of full slip"),
    ],
)
def test_what_the_results_do_not_have(folder, table, capsys, text, words):
    assert words in refused(capsys, "compare", str(table(text)), "--sweep", str(folder))
