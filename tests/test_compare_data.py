"""Tables of measurements beside ours: what is read, what is compared, and what is refused in one sentence."""

import csv
import re
import shutil

import numpy as np
import pytest
from matplotlib.figure import Figure

from fingerpad.cli import main, ours
from fingerpad.cli.compare_data import _Compared, _panel
from fingerpad.cli.measured import Measured, read
from fingerpad.runs.sweep import sweep
from fingerpad.scene import Scene
from tests.commands import ROOT, refused


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A sweep of the closed form over three voltages and two forces."""
    place = tmp_path_factory.mktemp("sweep")
    sweep(Scene(), place, model="cylinders", voltage=[0, 100, 200], f_ext=[25, 75])
    return place


# -- tables --------------------------------------------------------------------------------------------------
def test_units_are_converted(table):
    """To SI; comments, empty lines and a mark of the byte order are no rows."""
    lines = "# people: 5\n# state: uncharged\n# else\n\nForce (N/mm), contact length (mm), spread (um)\n0.05, 1.2, 30\n"
    found = read(table(lines, "\ufeff# source: Somebody 2020\n"))
    assert (found.quantity, found.state, found.about["people"]) == ("contact length", "uncharged", "5")
    assert found.conditions == {"f_ext": pytest.approx((50.0,))}
    assert found.values == pytest.approx((1.2e-3,)) and found.spread == pytest.approx((3e-5,))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("force, friction (1)\n1, 2\n", "line 2, column 1: 'force' has no unit; write 'name (unit)', and (1) for"),
        ("force (furlong), friction (1)\n1, 2\n", "line 2, column 1: the unit of force is 'furlong'; its unit is not"),
        ("force (g), friction (1)\n1, 2\n", "force per length; it must be in N/m, or in N for a whole finger"),
        ("force (N/m), friction force (N)\n1, 2\n", "it must be in N, as another column is of a whole finger"),
        ("voltage (g), friction (1)\n1, 2\n", "its unit is not a unit of voltage; it must be in V"),
        ("force (wibble), friction (1)\n1, 2\n", "the unit of force is 'wibble'; its unit is not known"),
        ("voltage (V), friction (N)\n1, 2\n", "line 2, column 2: the unit of friction is 'N'; it must be 1"),
        (
            "force (N), contact length (mm)\n1, 2\n",
            "column 2: ours has no 'contact length'; columns are voltage, force",
        ),
        ("force (N/m), contact area (mm^2)\n1, 2\n", "column 1: the unit of force is 'N/m'; its unit is not a unit of"),
        (
            "force (N), area (mm^2)\n1, 2\n",
            "column 2: ours has no 'area'; columns are voltage, force, friction force, ",
        ),
        ("force (N/m), perceived intensity (1)\n1, 2\n", "ours has no 'perceived intensity'; columns are force, volt"),
        ("force (N/m), friction (1)\n1, 2\n3,\n", "line 4, column 2: the friction is missing; leave the row out"),
        ("force (N/m), friction (1)\n1, 2\n\n3\n", "line 5, column 2: the friction is missing"),
        ("force (N/m), friction (1)\n, 2\n", "line 3, column 1: the force is missing"),
        ("force (N/m), friction (1)\n1, nan\n", "line 3, column 2: the friction is nan; it must be finite and greater"),
        ("force (N/m), friction (1)\n1, -0.2\n", "the friction is -0.2; it must be finite and greater than 0"),
        ("voltage (V), friction (1)\ninf, 0.2\n", "the voltage is inf; it must be finite"),
        ("friction (1), spread (1)\n0.2, -1\n", "the spread is -1; it must be finite and 0 or more"),
        ("force (N/m), friction (1)\n1, 1_0\n", "line 3, column 2: the friction is '1_0'; it must be a number"),
        ("force (N/m); friction (1)\n1; 2\n", "line 2 is 'force (N/m); friction (1)'; columns must be separated by"),
        ("# state: charged\nforce (N/m), friction (1)\n1, 2\n", "has friction at the state charged; before the"),
        ("# State: Charged\nforce (N/m), friction force (N/m)\n1, 2\n", "has friction at the state charged; before"),
        ("force (N/m), friction (1)\n1, high\n", "line 3, column 2: the friction is 'high'; it must be a number"),
        ("force (N/m), friction (1)\n1, 0,2\n", "line 3 has 3 cells below 2 columns; decimals have points"),
        ("force (N/m), friction (1)\n", "has no rows of numbers below a header"),
        ("", "has no rows of numbers below a header"),
        ("force (N/m), voltage (V)\n1, 2\n", "must have one quantity out of friction, friction force"),
        ("friction (1), attraction (N/m)\n1, 2\n", "it has friction, attraction"),
        ("force (N/m), force (N/mm), friction (1)\n1, 2, 3\n", "two columns have the name force"),
        ("force (N/m), friction (1), spread (mm)\n1, 2, 3\n", "column 3: the unit of spread is 'mm'; it must be 1"),
        (
            "# state: sideways\nforce (N/m), friction (1)\n1, 2\n",
            "state is 'sideways'; it must be one of uncharged, ch",
        ),
        (f"force (N/m), friction (1)\n1, {'2' * 200_000}\n", "is no table in CSV: field larger than field limit"),
    ],
)
def test_tables_are_refused(table, capsys, text, words):
    """In one sentence, before the folder of ours is looked at."""
    assert words in refused(capsys, "compare-data", str(table(text)), "--run", "nowhere")


def test_source_is_asked_for(table, capsys):
    file = table("force (N/m), friction (1)\n1, 2\n", source="")
    assert "has no source; add a first line such as '# source:" in refused(
        capsys, "compare-data", str(file), "--run", "x"
    )


def test_files_that_are_no_text(table, tmp_path, capsys):
    (tmp_path / "mine.csv").write_bytes(b"\xff\xfe\x00")
    assert "is not text in UTF-8" in refused(capsys, "compare-data", str(tmp_path / "mine.csv"), "--run", "x")
    assert "cannot be read" in refused(capsys, "compare-data", str(tmp_path / "none.csv"), "--run", "x")


def test_tables_in_the_repository_are_read():
    """Each has its source and a DOI or a link."""
    files = sorted((ROOT / "data" / "measured").glob("*.csv"))
    assert files
    for file in files:
        assert {"source", "people"} <= set(read(file).about) and {"doi", "url"} & set(read(file).about)


def test_sign_of_a_measured_voltage_is_left_out(table):
    """The attraction goes with U²."""
    assert read(table("voltage (V), friction (1)\n-100, 0.2\n0, 0.2\n")).conditions == {"voltage": (100.0, 0.0)}


def test_row_without_a_spread_is_one(folder, table, capsys):
    """The empty cell may also be missing; the others are counted."""
    text = "force (N/m), voltage (V), friction (1), spread (1)\n25, 0, 0.25, 0.1\n25, 100, 0.1,\n75, 0, 0.25\n"
    np.testing.assert_array_equal(read(table(text)).spread, [0.1, np.nan, np.nan])
    assert main(["compare-data", str(table(text)), "--sweep", str(folder)]) == 0
    assert "Within the spread: 1 of 1 rows that have a spread.\n" in capsys.readouterr().out


# -- ours ----------------------------------------------------------------------------------------------------
def known(folder, **values):
    """Return ours of a sweep's folder for a table of friction."""
    table = Measured(ROOT / "x.csv", "X", "full_slip", "friction", values, (0.3,), (np.nan,))
    return ours.ours(ours.read([folder], sweep=True), table)


def test_ours_is_the_sweep(folder):
    """At its points to roundoff; between them a power law of the force, and linear in U²; not beyond."""
    with (folder / "table.csv").open(encoding="utf-8", newline="") as file:
        rows = {(float(r["f_ext"]), float(r["voltage"])): float(r["slip_mu_app"]) for r in csv.DictReader(file)}
    found = known(folder)
    for (force, voltage), value in rows.items():
        assert found.at(np.array([force * (1 + 1e-9)]), np.array([voltage]))[0] == pytest.approx(value, rel=1e-12)
    between = found.at(np.array([50.0, 25.0]), np.array([100.0, 50.0]))
    power = np.log(rows[75, 100] / rows[25, 100]) / np.log(3)
    assert between[0] == pytest.approx(rows[25, 100] * 2**power, rel=1e-12)
    assert between[1] == pytest.approx(0.75 * rows[25, 0] + 0.25 * rows[25, 100], rel=1e-12)
    assert np.isnan(found.at(np.array([10.0, 25.0]), np.array([100.0, 201.0]))).all()


def test_sign_of_a_voltage_does_not_count(folder, tmp_path):
    """A sweep over both signs is the one over one of them, between its points too."""
    sweep(Scene(), tmp_path, model="cylinders", voltage=[-200, -100, 0, 100, 200], f_ext=[25, 75])
    at = np.array([30.0, 50.0, 75.0]), np.array([150.0, -30.0, -200.0])
    np.testing.assert_allclose(known(tmp_path).at(*at), known(folder).at(at[0], abs(at[1])), rtol=1e-12)


def test_failed_run_leaves_the_uncharged_state_of_another(folder, tmp_path):
    """All voltages of a force have the same uncharged state; here the last run has none."""
    table = tmp_path / "table.csv"
    table.write_text("f_ext,voltage,uncharged_contact_length,failure\n25,0,1e-3,\n25,100,1e-3,\n25,200,,lost\n")
    asked = Measured(ROOT / "x.csv", "X", "uncharged", "contact length", {}, (1e-3,), (np.nan,))
    assert ours.ours(ours.read([tmp_path], sweep=True), asked).at(np.array([25.0]), np.array([0.0]))[0] == 1e-3


def test_missing_points_are_not_compared(folder):
    """A failed run leaves its neighbours as they are."""
    found = known(folder)
    found.curves[1].values[0] = np.nan
    at = found.at(np.array([25.0, 25.0, 75.0, 50.0]), np.array([0.0, 100.0, 100.0, 100.0]))
    assert list(np.isnan(at)) == [False, True, False, True]


# -- the command ---------------------------------------------------------------------------------------------
def test_misfit_is_printed_and_drawn(folder, table, tmp_path, capsys):
    """Measured as twice ours: the ratio is a half everywhere and the shape is exact."""
    found = known(folder)
    lines = [f"75, {u:g}, {2 * v:.17g}, {3 * v:g}" for u, v in ((c.voltage, c.values[1]) for c in found.curves)]
    file = table(
        "\n".join(["# doi: 10.1/x", "force (N/m), voltage (V), friction (1), spread (1)", *lines, "500, 0, 1, 1"])
    )
    assert main(["compare-data", str(file), "--sweep", str(folder), "--out", str(tmp_path / "out.png")]) == 0
    out = capsys.readouterr().out
    assert "friction at full slip: Somebody 2020\ndoi 10.1/x\n" in out
    assert "Misfit: ours over measured 0.5 (geometric mean of 3), at most a factor of 2.\n" in out
    assert "ours scaled by one factor (2): at most a factor of 1.\n" in out
    assert "±" not in out and "Within the spread: 3 of 3." in out and "no result there: 1 of 4 rows." in out
    assert re.search(r"^ +75 +0 +0\.5 +0\.75 +0\.25 +0\.5$", out, re.MULTILINE)
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
    assert float(rows[0]["ratio"]) == float(rows[0]["ours"]) / 1e-3
    assert [rows[1][key] for key in ("spread", "ours", "error", "ratio")] == [""] * 4
    assert float(rows[2]["ours"]) == known(folder).at(np.array([75.0]), np.array([100.0]))[0]
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
    each = _Compared(found, ours.ours(ours.read([folder], sweep=True), found))
    ax = Figure().subplots()
    _panel(ax, each)
    drawn = {line.get_label(): line.get_xydata() for line in ax.lines if line.get_label().startswith("ours")}
    for force in (25, 50):
        volts, friction = drawn[f"ours, {force} N/m"].T
        np.testing.assert_array_equal(friction, each.known.at(np.full(len(volts), force), volts))
        assert len(volts) > 100
    marked = [line.get_xdata() for line in ax.lines if line.get_marker() == "."]
    assert [list(volts) for volts in marked] == [[0, 100, 200], []]


def test_errors_of_a_sweep_count_with_the_spread(folder, table, tmp_path, capsys):
    """They are interpolated as the values are; a value without an error has a dash."""
    rows = "f_ext,voltage,slip_mu_app,slip_mu_app_error,failure\n25,0,0.30,0.02,\n25,100,0.40,0.04,\n25,200,0.5,,\n"
    place = tmp_path / "kept"
    shutil.copytree(folder, place)
    (place / "table.csv").write_text(rows)
    # 0.375 ± 0.035 at 86.6 V
    lines = "25, 0, 0.33, 0.011\n25, 86.602540378, 0.33, 0.011\n25, 100, 0.33, 0.02\n25, 200, 0.51, 0.02\n"
    file = table("force (N/m), voltage (V), friction (1), spread (1)\n" + lines)
    assert main(["compare-data", str(file), "--sweep", str(place)]) == 0
    out = capsys.readouterr().out
    assert re.search(r"^ +25 +86.6 +0.33 +0.011 +0.375 +0.035 +1.14$", out, re.MULTILINE)
    assert re.search(r"^ +25 +200 +0.51 +0.02 +0.5 +– +0.98$", out, re.MULTILINE)
    assert "±: estimated discretisation error of ours, of the mesh alone.\n" in out
    assert "Within the spread plus the error of ours: 3 of 4.\n" in out


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("force (N/m), friction (1)\n25, 0.3\n", "has no voltage, and ours has 3; add a column 'voltage (V)'"),
        ("voltage (V), friction (1)\n100, 0.3\n", "has no force, and ours has 2; add a column 'force (N/m)'"),
        ("force (N/m), voltage (V), friction (1)\n5, 0, 0.3\n", "is within ours, which has 25 to 75 N/m, 0 to 200 V"),
        ("force (N), friction (1)\n25, 0.3\n", "has forces in N; sweep force, or give runs by --run"),
        ("force (N/m), voltage (V), depth (mm)\n25, 0, 0.3\n", "the table of the sweep has no depth of full slip"),
    ],
)
def test_what_ours_does_not_have(folder, table, capsys, text, words):
    assert words in refused(capsys, "compare-data", str(table(text)), "--sweep", str(folder))


def test_rows_where_ours_is_zero_are_told_apart(folder, table, capsys):
    """They are within ours, and have no ratio."""
    text = "force (N/m), voltage (V), attraction (N/m)\n25, 0, 3\n"
    said = refused(capsys, "compare-data", str(table(text)), "--sweep", str(folder))
    assert "ours has no attraction above 0 in the 1 rows of" in said
    said = refused(capsys, "compare-data", str(table(text + "500, 100, 3\n")), "--sweep", str(folder))
    assert "in the 2 rows of" in said and said.rstrip().endswith("and 1 of them are not within ours")
    assert main(["compare-data", str(table(text + "25, 100, 3\n500, 100, 3\n")), "--sweep", str(folder)]) == 0
    out = capsys.readouterr().out
    assert "since ours has no result there: 1 of 3 rows." in out and "since ours is 0 there: 1 of 3 rows." in out


def test_folders_are_told_apart(folder, table, tmp_path, capsys):
    file = str(table("friction (1)\n0.3\n"))
    assert "holds a sweep; give it by --sweep" in refused(capsys, "compare-data", file, "--run", str(folder))
    assert "is not a folder" in refused(capsys, "compare-data", file, "--run", str(tmp_path / "none"))
    assert "one of the arguments --run --sweep is required" in refused(capsys, "compare-data", file)
    assert "its folder is not there" in refused(capsys, "compare-data", file, "--run", "x", "--out", "none/x.png")
    other = tmp_path / "other"
    sweep(Scene(), other, model="cylinders", voltage=[0, 100])
    (other / "sweep.json").unlink()  # as an earlier version left it
    assert "does not give its force" in refused(capsys, "compare-data", file, "--sweep", str(other))
    third = tmp_path / "third"
    sweep(Scene(), third, model="cylinders", friction=[0.2, 0.3])
    assert "is over friction, which no measurement has" in refused(capsys, "compare-data", file, "--sweep", str(third))
