"""Tables of measurements beside computed values: what is read, compared, and refused in one sentence."""

import csv
import re
import shutil

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

import fingerpad as fp
from fingerpad.cli import main
from fingerpad.cli.compare_data import _panel
from fingerpad.measurements.compare import beside
from fingerpad.measurements.computed import computed
from fingerpad.measurements.table import Measured, read
from fingerpad.runs.sweep import sweep
from fingerpad.scene import Scene, SceneError
from tests.commands import ROOT, refused
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
    assert one.attrs["source"] == one.attrs["table"] == str(lab)
    words = [f"--column={head}={name}" for head, name in MAPPING.items()]
    assert main(["compare-data", str(lab), *words, "--sweep", str(grid.folder)]) == 0
    assert "Columns not read: Subject, friction force (N/m), remark.\n" in capsys.readouterr().out


def test_page_runs_as_written(tmp_path, monkeypatch, grid):
    """The lines of docs/command.md."""
    monkeypatch.chdir(tmp_path)
    shutil.copytree(grid.folder, "results/sweep")
    (tmp_path / "lab.csv").write_text("Fn,voltage (V),CoF,person\n25,100,0.5,A\n")
    code = blocks((ROOT / "docs" / "command.md").read_text(encoding="utf-8"))[0][0]
    assert "measured  computed  relative_difference\n" in printed(code, {})


def test_data_frames_are_tables(grid):
    """As the file; its attributes stand for the comments, and NaN for an empty cell."""
    frame = pd.DataFrame({"force (N/m)": [25, 75], "voltage (V)": [0, 100.0], "CoF": [0.3, 0.5], "SD": [0.05, np.nan]})
    frame.attrs = {"source": "Somebody 2020", "other": 5}
    found = fp.compare(frame, grid, {"CoF": "friction (1)", "SD": "spread (1)"})
    assert found.attrs["source"] == "Somebody 2020" and found.spread.isna().tolist() == [False, True]
    frame["CoF"] = [0.3, np.nan]
    with pytest.raises(SceneError, match=r"the table, row 1, column 3: the friction is missing; leave the row out or"):
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
        (
            {},
            "no quantity; it has the columns Fn .N., U, CoF, and must have one of .* as in {'CoF': 'friction .1.'}",
        ),
        ({"CoF": "friction"}, "column 3: 'CoF' has no unit; write 'friction .1.' in the head or by columns"),
        ({"CoF": "frction (1)"}, "the column 'CoF' is 'frction'; it must be one of force, voltage, friction,"),
        ({"Cof": "friction (1)"}, "the table has no column 'Cof'; it has Fn .N., U, CoF$"),
        ({"CoF": "friction (1)", "Fn (N)": "force"}, "has no voltage, and its column 'U' may be one; name it"),
        ({"CoF": "friction (1)", "U": ""}, "has no force, and its column .* it out by {'Fn .N.': ''}"),
        ({"CoF": "friction (1)", "Fn (N)": "voltage"}, "unit of voltage is 'N'; its unit is not a unit of voltage"),
        ({"CoF": "friction (1)", "U": "friction (1)"}, "two columns have the name friction; give one, and leave out"),
    ],
)
def test_no_column_is_guessed(grid, columns, words):
    """A name, a unit or a condition that is not given is refused, and no column that may be it is passed over."""
    frame = pd.DataFrame({"Fn (N)": [0.5], "U": [100], "CoF": [0.3]})
    with pytest.raises(SceneError, match=words):
        fp.compare(frame, grid, columns)


def test_column_may_be_left_out(grid):
    """Of two that could be a condition, or of two quantities."""
    frame = pd.DataFrame({"force (N/m)": [25], "V": [7], "friction (1)": [0.3], "attraction (N/m)": [1.0]})
    one = [result for result in grid if result.scene.voltage == 0]
    found = fp.compare(frame, one, {"V": "", "attraction (N/m)": None})
    assert found.voltage.tolist() == [0] and found.attrs["quantity"] == "friction" and not found.attrs["ignored"]


HEADS = "force (N/m), friction (1)\n"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("force, friction (1)\n1, 2\n", "column 1: 'force' has no unit; write 'force (N/m)' in the head or by columns"),
        ("force (furlong), friction (1)\n1, 2\n", "column 1: the unit of force is 'furlong'; its unit is not"),
        ("force (g), friction (1)\n1, 2\n", "force per length; it must be in N/m, or in N for a whole finger"),
        ("force (N/m), friction force (N)\n1, 2\n", "it must be in N, as another column is of a whole finger"),
        ("voltage (g), friction (1)\n1, 2\n", "its unit is not a unit of voltage; it must be in V"),
        ("force (wibble), friction (1)\n1, 2\n", "the unit of force is 'wibble'; its unit is not known"),
        ("voltage (V), friction (N)\n1, 2\n", "column 2: the unit of friction is 'N'; it must be 1"),
        ("force (N), contact length (mm)\n1, 2\n", "has contact length, and a whole finger, which has a column in new"),
        ("force (N/m), contact area (mm^2)\n1, 2\n", "column 1: the unit of force is 'N/m'; its unit is not a unit of"),
        ("force (N), area (mm^2)\n1, 2\n", "has the columns force (N), area (mm^2), and must have one of"),
        (HEADS + "1, 2\n3,\n", "line 4, column 2: the friction is missing; leave the row out"),
        (HEADS + "1, 2\n\n3\n", "line 5, column 2: the friction is missing"),
        (HEADS + ", 2\n", "line 3, column 1: the force is missing"),
        (HEADS + "1, nan\n", "line 3, column 2: the friction is 'nan'; it must be a finite number greater than 0"),
        (HEADS + "1, -0.2\n", "the friction is '-0.2'; it must be a finite number greater than 0"),
        ("voltage (V), friction (1)\ninf, 0.2\n", "the voltage is 'inf'; it must be a finite number"),
        ("friction (1), spread (1)\n0.2, -1\n", "the spread is '-1'; it must be a finite number, 0 or more"),
        (HEADS + "1, 1_0\n", "line 3, column 2: the friction is '1_0'; it must be a finite number"),
        (HEADS + "1, high\n", "line 3, column 2: the friction is 'high'; it must be a finite number"),
        (HEADS + "1, 0,2\n", "line 3 has 3 cells below 2 columns; decimals have points"),
        ("force (N/m); friction (1)\n1; 0,2\n", "line 3, column 2: the friction is '0,2'; it must be a finite number"),
        ("# state: charged\n" + HEADS + "1, 2\n", "has friction at the state charged; before the"),
        ("# State: Charged\nforce (N/m), friction force (N/m)\n1, 2\n", "has friction force at the state charged; bef"),
        ("# state: sideways\n" + HEADS + "1, 2\n", "state is 'sideways'; it must be one of uncharged, ch"),
        (HEADS, "has no rows of numbers below a header"),
        ("", "has no rows of numbers below a header"),
        ("force (N/m), voltage (V)\n1, 2\n", "and must have one of friction, friction force"),
        ("friction (1), attraction (N/m)\n1, 2\n", "has friction, attraction, and must have one of"),
        ("force (N/m), force (N/mm), friction (1)\n1, 2, 3\n", "two columns have the name force"),
        ("force (N/m), friction (1), spread (mm)\n1, 2, 3\n", "column 3: the unit of spread is 'mm'; it must be 1"),
        (f"{HEADS}1, {'2' * 200_000}\n", "column 2: the friction is '2222"),
        ("a," * 200_000 + "friction (1)\n1, 2\n", "line 2 has 200001 columns; at most 1000 are read"),
        (f"# source: a{' ' * 200_000}b\nforce{' ' * 200_000}(N/m), sum (1)\n1, 2\n", "has the columns force "),
        (f'{HEADS}1, "2\n3, 4\n', "is no table in CSV: "),
        (f'{HEADS}1, "2\n3"\n4, 5\n', "is no table in CSV: a cell in quotation marks does not end in its line"),
    ],
)
def test_tables_are_refused(table, capsys, text, words):
    """In one sentence, before the folder of results is looked at."""
    assert words in refused(capsys, "compare-data", str(table(text)), "--run", "nowhere")


def test_command_line_is_refused(table, tmp_path, capsys):
    (tmp_path / "mine.csv").write_bytes(b"\xff\xfe\x00")
    assert "is not text in UTF-8" in refused(capsys, "compare-data", str(tmp_path / "mine.csv"), "--run", "x")
    assert "cannot be read" in refused(capsys, "compare-data", str(tmp_path / "none.csv"), "--run", "x")
    file = str(table(HEADS + "1, 2\n"))
    assert "--column is 'CoF'; it must be HEAD=NAME" in refused(
        capsys, "compare-data", file, "--column", "CoF", "--run", "x"
    )
    assert "state is 'no'; it must be one of" in refused(capsys, "compare-data", file, "--state", "no", "--run", "x")


def test_tables_in_the_repository_are_read():
    """Each has its source and a DOI or a link."""
    files = sorted((ROOT / "data" / "measured").glob("*.csv"))
    assert files
    for file in files:
        assert {"source", "people"} <= set(read(file).about) and {"doi", "url"} & set(read(file).about)


def test_sign_of_a_measured_voltage_is_left_out(table):
    """The attraction goes with U²."""
    assert read(table("voltage (V), friction (1)\n-100, 0.2\n0, 0.2\n")).rows.voltage.tolist() == [100.0, 0.0]


def test_row_without_a_spread_is_one(folder, table, capsys):
    """The empty cell may also be missing; the others are counted."""
    text = "force (N/m), voltage (V), friction (1), spread (1)\n25, 0, 0.25, 0.1\n25, 100, 0.1,\n75, 0, 0.25\n"
    np.testing.assert_array_equal(read(table(text)).rows.spread, [0.1, np.nan, np.nan])
    assert main(["compare-data", str(table(text)), "--sweep", str(folder)]) == 0
    assert "Within the spread: 1 of 1 rows that have a spread.\n" in capsys.readouterr().out


# -- computed values -----------------------------------------------------------------------------------------
def asked(quantity="friction", state="full_slip"):
    return Measured("x.csv", {}, state, quantity, False, pd.DataFrame({"measured": [0.3], "spread": [np.nan]}))


def at(known, force, voltage):
    """Return the values at pairs of force and voltage."""
    return known.at(np.array(force), np.array(voltage))[0]


def test_computed_values_are_those_of_the_sweep(folder):
    """At its points to roundoff; between them a power law of the force, and linear in U²; not beyond."""
    with (folder / "table.csv").open(encoding="utf-8", newline="") as file:
        rows = {(float(r["f_ext"]), float(r["voltage"])): float(r["full_slip_mu_app"]) for r in csv.DictReader(file)}
    found = computed(folder, asked())
    for (force, voltage), value in rows.items():
        assert at(found, [force * (1 + 1e-9)], [voltage])[0] == pytest.approx(value, rel=1e-12)
    between = at(found, [50.0, 25.0], [100.0, 50.0])
    power = np.log(rows[75, 100] / rows[25, 100]) / np.log(3)
    assert between[0] == pytest.approx(rows[25, 100] * 2**power, rel=1e-12)
    assert between[1] == pytest.approx(0.75 * rows[25, 0] + 0.25 * rows[25, 100], rel=1e-12)
    assert np.isnan(at(found, [10.0, 25.0], [100.0, 201.0])).all()


def test_folder_and_sweep_are_alike(grid):
    """A sweep is its runs, and its folder is its table."""
    np.testing.assert_array_equal(computed(grid, asked()).points, computed(grid.folder, asked()).points)


def test_sign_of_a_voltage_does_not_count(folder, tmp_path):
    """A sweep over both signs is the one over one of them, between its points too."""
    sweep(Scene(), tmp_path, model="cylinders", voltage=[-200, -100, 0, 100, 200], f_ext=[25, 75])
    force, voltage = np.array([30.0, 50.0, 75.0]), np.array([150.0, -30.0, -200.0])
    both, one = computed(tmp_path, asked()), computed(folder, asked())
    np.testing.assert_allclose(at(both, force, voltage), at(one, force, abs(voltage)), rtol=1e-12)


def test_failed_run_leaves_the_uncharged_state_of_another(tmp_path):
    """All voltages of a force have the same uncharged state; here the first and the last run have none."""
    table = tmp_path / "table.csv"
    rows = "25,0,,lost\n25,50,1e-3,\n25,100,1e-3,\n25,200,,lost\n"
    table.write_text(f"f_ext,voltage,uncharged_contact_length,failure\n{rows}")
    assert at(computed(tmp_path, asked("contact length", "uncharged")), [25.0], [0.0])[0] == 1e-3


def test_missing_points_are_not_compared(tmp_path):
    """A failed run leaves its neighbours as they are."""
    rows = "25,0,0.2,\n75,0,0.2,\n25,100,,lost\n75,100,0.3,\n"
    (tmp_path / "table.csv").write_text(f"f_ext,voltage,full_slip_mu_app,failure\n{rows}")
    found = at(computed(tmp_path, asked()), [25.0, 25.0, 75.0, 50.0], [0.0, 100.0, 100.0, 100.0])
    assert list(np.isnan(found)) == [False, True, False, True]


# -- the command ---------------------------------------------------------------------------------------------
def test_misfit_is_printed_and_drawn(folder, table, tmp_path, capsys):
    """Measured as twice the computed values: the ratio is a half everywhere and the shape is exact."""
    volts = [0.0, 100.0, 200.0]
    found = at(computed(folder, asked()), [75.0] * 3, volts)
    lines = [f"75, {u:g}, {2 * v:.17g}, {3 * v:g}" for u, v in zip(volts, found, strict=True)]
    file = table(
        "\n".join(["# doi: 10.1/x", "force (N/m), voltage (V), friction (1), spread (1)", *lines, "500, 0, 1, 1"])
    )
    assert main(["compare-data", str(file), "--sweep", str(folder), "--out", str(tmp_path / "out.png")]) == 0
    out = capsys.readouterr().out
    assert "friction at full slip: Somebody 2020\ndoi 10.1/x\n" in out
    assert "Misfit: computed over measured 0.5 (geometric mean of 3), at most a factor of 2.\n" in out
    assert "scaled by one factor (2): at most a factor of 1.\n" in out
    assert "±" not in out and "Within the spread: 3 of 3." in out and "no value is computed there: 1 of 4 rows." in out
    assert re.search(r"^ +75 +0 +0\.5 +0\.75 +0\.25 +-0\.25 +-50$", out, re.MULTILINE)
    assert (tmp_path / "out.png").stat().st_size > 10_000


def test_numbers_are_written(folder, table, tmp_path, capsys):
    """In SI units and unrounded, a row for each row of every table; what is missing is empty."""
    first = table("force (N/mm), voltage (V), contact length (mm), spread (um)\n0.025, 100, 1, 20\n0.9, 0, 1,\n")
    second = first.rename(tmp_path / "first.csv"), table("force (N/m), voltage (V), friction (1)\n75, 100, 0.3\n")
    csv_file = tmp_path / "out.csv"
    argv = ["compare-data", *map(str, second), "--sweep", str(folder), "--csv", str(csv_file)]
    assert main(argv) == 0
    assert capsys.readouterr().out.endswith(f"Written: {csv_file}\n")
    rows = list(csv.DictReader(csv_file.read_text(encoding="utf-8").splitlines()))
    assert [(row["quantity"], row["state"], row["unit"]) for row in rows] == [
        *[("contact length", "full slip", "m")] * 2,
        ("friction", "full slip", "1"),
    ]
    assert rows[0]["table"] == str(tmp_path / "first.csv") and rows[0]["force_unit"] == "N/m"
    numbers = [float(rows[0][key]) for key in ("force", "voltage", "measured", "spread")]
    assert numbers == pytest.approx([25, 100, 1e-3, 2e-5], rel=1e-12)
    assert float(rows[0]["difference"]) == float(rows[0]["computed"]) - float(rows[0]["measured"])
    empty = ("spread", "computed", "error", "difference", "relative_difference")
    assert [rows[1][key] for key in empty] == [""] * 5
    assert float(rows[2]["computed"]) == at(computed(folder, asked()), [75.0], [100.0])[0]
    said = refused(capsys, *argv, "--out", str(csv_file))
    assert "out.csv cannot be a picture" in said
    measured = str(tmp_path / "first.csv")
    before = (tmp_path / "first.csv").read_bytes()
    assert "first.csv is there and is not a table of this command" in refused(capsys, *argv[:-1], measured)
    assert (tmp_path / "first.csv").read_bytes() == before


def test_picture_has_the_values_of_the_table(folder, table):
    """Lines go as the table is interpolated, in U² and not straight; only computed points are marked."""
    lines = "25, 0, 1\n25, 50, 1\n25, 150, 1\n50, 0, 1\n50, 100, 1\n"
    found = read(table("force (N/m), voltage (V), friction (1)\n" + lines))
    known = computed(folder, found)
    ax = Figure().subplots()
    _panel(ax, beside(found, known), known)
    drawn = {line.get_label(): line.get_xydata() for line in ax.lines if line.get_label().startswith("computed")}
    for force in (25, 50):
        volts, friction = drawn[f"computed, {force} N/m"].T
        np.testing.assert_array_equal(friction, at(known, np.full(len(volts), force), volts))
        assert len(volts) > 100
    marked = [line.get_xdata() for line in ax.lines if line.get_marker() == "."]
    assert [list(volts) for volts in marked] == [[0, 100, 200], []]


def test_errors_of_a_sweep_count_with_the_spread(folder, table, tmp_path, capsys):
    """They are interpolated as the values are; a value without an error has a dash."""
    heads = "f_ext,voltage,full_slip_mu_app,full_slip_mu_app_error,failure"
    rows = f"{heads}\n25,0,0.30,0.02,\n25,100,0.40,0.04,\n25,200,0.5,,\n"
    place = tmp_path / "kept"
    shutil.copytree(folder, place)
    (place / "table.csv").write_text(rows)
    # 0.375 ± 0.035 at 86.6 V
    lines = "25, 0, 0.33, 0.011\n25, 86.602540378, 0.33, 0.011\n25, 100, 0.33, 0.02\n25, 200, 0.51, 0.02\n"
    file = table("force (N/m), voltage (V), friction (1), spread (1)\n" + lines)
    assert main(["compare-data", str(file), "--sweep", str(place)]) == 0
    out = capsys.readouterr().out
    assert re.search(r"^ +25 +86.6 +0.33 +0.011 +0.375 +0.035 +0.045 +13.6$", out, re.MULTILINE)
    assert re.search(r"^ +25 +200 +0.51 +0.02 +0.5 +– +-0.01 +-1.96$", out, re.MULTILINE)
    assert "±: estimated discretisation error of the computed value, of the mesh alone.\n" in out
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
        ("force (N), friction (1)\n25, 0.3\n", "is over voltage, f_ext, and"),
        ("force (N/m), voltage (V), depth (mm)\n25, 0, 0.3\n", "the table of the sweep has no depth of full slip"),
    ],
)
def test_what_the_results_do_not_have(folder, table, capsys, text, words):
    assert words in refused(capsys, "compare-data", str(table(text)), "--sweep", str(folder))


def test_rows_whose_value_is_zero_are_told_apart(folder, table, capsys):
    """They are within the results, and have no ratio."""
    text = "force (N/m), voltage (V), attraction (N/m)\n25, 0, 3\n"
    said = refused(capsys, "compare-data", str(table(text)), "--sweep", str(folder))
    assert "no attraction above 0 is computed in the 1 rows of" in said
    said = refused(capsys, "compare-data", str(table(text + "500, 100, 3\n")), "--sweep", str(folder))
    assert "in the 2 rows of" in said and said.rstrip().endswith("and 1 of them are not within the results")
    assert main(["compare-data", str(table(text + "25, 100, 3\n500, 100, 3\n")), "--sweep", str(folder)]) == 0
    out = capsys.readouterr().out
    assert "since no value is computed there: 1 of 3 rows." in out and "computed value is 0 there: 1 of 3 rows." in out


def test_folders_are_told_apart(folder, table, tmp_path, capsys):
    file = str(table("friction (1)\n0.3\n"))
    assert "is not a folder" in refused(capsys, "compare-data", file, "--run", str(tmp_path / "none"))
    assert "arguments are required: --run/--sweep" in refused(capsys, "compare-data", file)
    assert "its folder is not there" in refused(capsys, "compare-data", file, "--run", "x", "--out", "none/x.png")
    several = refused(capsys, "compare-data", file, "--run", str(folder), str(folder))
    assert "is given with others; give one sweep, or runs" in several
    third = tmp_path / "third"
    sweep(Scene(), third, model="cylinders", friction=[0.2, 0.3])
    words = "is over friction, and {} has forces in N/m; give one over f_ext and voltage alone, or runs"
    assert words.format(file) in refused(capsys, "compare-data", file, "--sweep", str(third))
    with pytest.raises(SceneError, match=r"friction is 0\.2 in .* and 0\.3 in .*; give runs that differ in force and"):
        fp.compare(file, fp.sweep(Scene(), model="cylinders", friction=[0.2, 0.3]))
