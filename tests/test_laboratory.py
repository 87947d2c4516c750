"""Tables as laboratories write them, and the friction coefficient that is fitted to their rows without voltage."""

import re

import numpy as np
import pandas as pd
import pytest

import fingerpad as fp
from fingerpad.cli import main
from fingerpad.cli.output import write
from fingerpad.measurements.fit import ALL
from fingerpad.measurements.table import read
from fingerpad.results.quantities import Output
from fingerpad.runs.sweep import sweep
from fingerpad.scene import Scene
from tests.commands import refused
from tests.measures import rows_of


@pytest.fixture(scope="module")
def grid(tmp_path_factory):
    """A sweep of the closed form over three voltages and two forces, with a coefficient of 0.25."""
    return sweep(Scene(), tmp_path_factory.mktemp("sweep"), model="cylinders", voltage=[0, 100, 200], f_ext=[25, 75])


LABORATORY = """# source: Größe und Söhne
Prüfling;Force [N/m];Voltage [V];Friction [%];Spread [%];Temperature (°C)
A;25,0;0;31,5;10;23,5
A;25;-100;-42;;23
B;75;0;2,0e1;5;22
"""


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
def test_semicolons_commas_percent_and_signs(tmp_path, encoding):
    """As the same table with points and in numbers, whatever the encoding."""
    file = tmp_path / "lab.csv"
    file.write_bytes(LABORATORY.replace("µ", "u").encode(encoding))
    found = read(file, {"Prüfling": "participant"})
    assert found.rows.to_dict("list") == {
        "spread": [pytest.approx(0.1), pytest.approx(np.nan, nan_ok=True), pytest.approx(0.05)],
        "force": [25.0, 25.0, 75.0],
        "voltage": [0.0, 100.0, 0.0],
        "measured": [pytest.approx(0.315), pytest.approx(0.42), pytest.approx(0.2)],
        "participant": ["A", "A", "B"],
    }
    assert (found.turned, found.ignored, found.about["source"]) == (1, ("Temperature (°C)",), "Größe und Söhne")


def test_percent_in_cells_and_of_friction(tmp_path):
    """In cells as in the head; a spread in percent of a friction without is a part of that."""
    file = tmp_path / "lab.csv"
    file.write_text("force (N/m),friction,spread (%)\n25,31 %,4\n50,28%,\n")
    found = read(file).rows
    assert found.measured.tolist() == pytest.approx([0.31, 0.28])
    assert found.spread.iloc[0] == pytest.approx(0.04)
    file.write_text("force (N/m),contact length (mm),spread\n25,2,5%\n")
    assert read(file).rows.spread.iloc[0] == pytest.approx(0.05 * 2e-3)


def frame(**columns):
    heads = {"force": "force (N/m)", "voltage": "voltage (V)", "friction": "friction (1)", "who": "participant"}
    return pd.DataFrame({heads.get(name, name): values for name, values in columns.items()})


def test_coefficient_is_fitted_without_voltage(grid):
    """Measured as 1.6 times the computed friction: with the coefficient of the rows at 0 V nothing is left."""
    charged = [1.6 * each.full_slip.mu_app for each in grid if each.scene.f_ext == 75 and each.scene.voltage]
    table = frame(force=[25, 75, 75, 75], voltage=[0, 0, 100, 200], friction=[0.38, 0.42, *charged])
    found = fp.compare(table, grid)
    (fit,) = found.attrs["fits"]
    assert (fit.who, fit.rows, found.attrs["mu_0"]) == (ALL, 2, 0.25)
    assert (fit.mu_0, fit.spread) == (pytest.approx(0.4), pytest.approx(0.02 * np.sqrt(2)))
    assert found.mu_0.tolist() == pytest.approx([0.4] * 4)
    np.testing.assert_allclose(found.computed, [0.4, 0.4, *charged], rtol=1e-12)
    assert found.attrs["misfit"] == pytest.approx(
        {"ratio": 1.0, "factor": 1.0, "shape_factor": 1.0, "rows": 2, "spreads": 0, "within": 0}
    )


def test_each_participant_and_all(grid):
    """Each has the coefficient of the own rows at 0 V, who has none that of all; below all are taken together."""
    table = frame(
        who=["A", "A", "A", "B", "B", "C"],
        force=[75] * 6,
        voltage=[0, 0, 200, 0, 200, 200],
        friction=[0.3, 0.34, 0.6, 0.2, 0.5, 0.7],
    )
    found = fp.compare(table, grid)
    a, b, c, every = found.attrs["fits"]
    assert [(each.who, each.rows) for each in (a, b, c, every)] == [("A", 2), ("B", 1), ("C", 0), (ALL, 3)]
    assert [each.mu_0 for each in (a, b, c, every)] == pytest.approx([0.32, 0.2, 0.28, 0.28])
    assert np.isnan(b.spread) and found.participant.tolist() == ["A", "A", "A", "B", "B", "C"]
    full = next(each.full_slip.mu_app for each in grid if each.scene.voltage == 200 and each.scene.f_ext == 75)
    ratios = np.array([0.32 / 0.6, 0.2 / 0.5, 0.28 / 0.7]) * full / 0.25
    assert [each.misfit["ratio"] for each in (a, b, c)] == pytest.approx(list(ratios))
    assert found.attrs["misfit"]["ratio"] == pytest.approx(np.prod(ratios) ** (1 / 3))
    together = np.array([0.28 / 0.6, 0.28 / 0.5, 0.28 / 0.7]) * full / 0.25
    assert every.misfit["ratio"] == pytest.approx(np.prod(together) ** (1 / 3))


def test_forces_are_divided(grid):
    """A friction force at 0 V is one of a coefficient, too."""
    table = pd.DataFrame({"force (N/m)": [25, 75], "voltage (V)": [0, 200], "friction force (N/m)": [-10.0, -30.0]})
    found = fp.compare(table, grid)
    assert found.attrs["fits"][0].mu_0 == pytest.approx(0.4) and found.attrs["turned"] == 2


@pytest.mark.parametrize("columns", [{"voltage": [0, 0]}, {"voltage": [100, 200]}])
def test_nothing_is_fitted_to_one_kind_of_rows(grid, columns):
    """Without rows at 0 V, or with no others, computed friction is that of the scene."""
    found = fp.compare(frame(force=[25, 75], friction=[0.3, 0.4], **columns), grid)
    assert found.attrs["fits"] == [] and "mu_0" not in found


def test_rows_without_voltage_alone_are_told(grid, tmp_path, capsys):
    """Their misfit is that of the scene's friction coefficient."""
    for volts, told in ((0, True), (100, False)):
        (tmp_path / "t.csv").write_text(f"force (N/m),voltage (V),friction (1)\n25,{volts},0.3\n75,{volts},0.3\n")
        main(["compare-data", str(tmp_path / "t.csv"), "--sweep", str(grid.folder)])
        assert ("No row is under a voltage: attraction is not compared.\n" in capsys.readouterr().out) == told


def test_other_laws_have_no_coefficient(tmp_path):
    """Derjaguin's friction without voltage is not one number."""
    law = {"law": "Derjaguin", "mu_f": 0.25, "tau_0": 1e3}
    other = sweep(Scene(friction=law), tmp_path, model="cylinders", voltage=[0, 200], f_ext=[75])
    assert fp.compare(frame(force=[75, 75], voltage=[0, 200], friction=[0.3, 0.5]), other).attrs["fits"] == []


def test_attraction_is_zero_without_voltage(grid):
    """It is read, and has no ratio."""
    table = pd.DataFrame({"force (N/m)": [75, 75], "voltage (V)": [0, 200], "attraction (N/m)": [0.0, 60.0]})
    found = fp.compare(table, grid)
    assert found.computed.iloc[0] == 0 and np.isnan(found.relative_difference.iloc[0])
    assert found.attrs["misfit"]["rows"] == 1


def test_command_says_what_it_did(grid, tmp_path, capsys):
    """Fit, participants, signs and ignored columns in words; a column for the coefficient in the file; a picture."""
    file = tmp_path / "lab.csv"
    file.write_text(LABORATORY + "A;75;200;60;;23\nA;75;200;64;;23\nB;75;200;40;;22\nB;25;0;24;;22\n")
    argv = ["compare-data", str(file), "--sweep", str(grid.folder), "--column", "Prüfling=participant"]
    assert main([*argv, "--out", str(tmp_path / "lab.png"), "--csv", str(tmp_path / "out.csv")]) == 0
    out = capsys.readouterr().out
    assert "Columns not read: Temperature (°C).\n" in out
    assert "1 of 7 rows have a friction below 0, of the other direction; its magnitude is compared.\n" in out
    assert "µ_0 is fitted to 3 rows at 0 V: 0.2517, with a standard deviation of 0.0584. The results have 0.25." in out
    assert re.search(r"^ *A +1 +0\.3150 +– +3 +\d\.\d+ +\d\.\d+$", out, re.MULTILINE)
    assert re.search(r"^ *B +2 +0\.2200 +0\.0283 +1 ", out, re.MULTILINE) and "\nall together  " in out
    rows = rows_of(tmp_path, "out")
    assert [row["participant"] for row in rows] == list("AABAABB") and rows[0]["mu_0"] == "0.315"
    assert (tmp_path / "lab.png").stat().st_size > 10_000


def test_table_is_named_by_the_end_of_its_path(tmp_path, capsys):
    """Where its name is, however long its folder is."""
    folder = tmp_path / ("a" * 90)
    folder.mkdir()
    (folder / "lab.csv").write_bytes(b"")
    assert "lab.csv has no numbers" in refused(capsys, "compare-data", str(folder / "lab.csv"), "--run", "nowhere")


@pytest.mark.parametrize("content", [b"\x89PNG\r\n\x1a\n\0\0", b"", b"\xff\xfe", b"\n\n;;;\n", b"a;b\n" + b"1;" * 3000])
def test_files_that_are_no_tables(tmp_path, capsys, content):
    """One sentence each."""
    file = tmp_path / "lab.csv"
    file.write_bytes(content)
    assert "lab.csv" in refused(capsys, "compare-data", str(file), "--run", "nowhere")


# -- voltages, units and kinds of columns --------------------------------------------------------------------------
def voltages(frame, columns=None):
    return read(frame, columns).rows.voltage.tolist()


@pytest.mark.parametrize(
    ("head", "effective"),
    [
        *(("voltage (V)", 100), ("voltage (Vrms)", 100), ("voltage [V eff]", 100), ("voltage_kV", 1e5)),
        *(("voltage (Vpp)", 35.355339), ("voltage (V peak to peak)", 35.355339), ("voltage (mV pk-pk)", 0.035355339)),
        *(("voltage (V amplitude)", 70.710678), ("voltage Vpeak", 70.710678)),
    ],
)
def test_voltages_are_effective(head, effective):
    """Of a sine: its amplitude over the root of 2."""
    frame = pd.DataFrame({"force (N)": [0.5], head: [100], "friction [-]": [0.3]})
    assert voltages(frame.assign(remark=["moist"])) == pytest.approx([effective], rel=1e-7)


def test_measure_of_a_voltage_is_offered_with_its_factor():
    """A column that may be a voltage is not taken for one; the name to give it has the measure of its head."""
    frame = pd.DataFrame({"force (N)": [0.5], "Vpp (V)": [100.0], "friction (1)": [0.3]})
    said = "{'Vpp (V)': 'voltage (V peak to peak)'}, which is taken times 0.354, or leave it out by {'Vpp (V)': ''}"
    with pytest.raises(fp.SceneError, match=re.escape(said)):
        read(frame)
    assert voltages(frame, {"Vpp (V)": "voltage (V peak to peak)"}) == pytest.approx([35.355339])
    with pytest.raises(fp.SceneError, match=re.escape("{'Vrms': 'voltage'}, or leave")):
        read(frame.rename(columns={"Vpp (V)": "Vrms"}).assign(Vrms=[3.0]))


def test_categorical_and_nullable_columns():
    """As the same numbers of NumPy: categories as groupby makes them, whole numbers and NA of pandas."""
    plain = pd.DataFrame(
        {"force (N)": [0.5, 1.0], "voltage (V)": [0, 100], "friction (1)": [0.25, 0.5], "spread (1)": [0.1, np.nan]}
    )
    kinds = plain.assign(participant=["A", "B"]).astype(
        {"force (N)": "category", "voltage (V)": "Int64", "friction (1)": "Float64", "participant": "category"}
    )
    kinds["spread (1)"] = pd.array([0.1, pd.NA], dtype="Float64")
    found = read(kinds).rows
    assert found.pop("participant").tolist() == ["A", "B"]
    pd.testing.assert_frame_equal(found, read(plain).rows)
    kinds["friction (1)"] = pd.array([0.25, pd.NA], dtype="Float64")
    with pytest.raises(fp.SceneError, match=r"the table has nothing in row 1 of 'friction \(1\)'"):
        read(kinds)


@pytest.mark.parametrize(
    "text",
    [
        "force;gross area;index\nN;mm2;-\n0,5;120;1\n",
        'sep=;\n"force_N";"gross area/mm2"\n0,5;120\n',
        "force N\tgross area [mm²]\t\n0.5\t120\t\n",
        ",force (mN),gross area (cm^2)\n0,500,1.2\n",
    ],
)
def test_units_stand_where_they_stand(text, tmp_path):
    """In a line of their own, behind a mark, with an index of pandas before them."""
    (tmp_path / "lab.csv").write_text(text, encoding="utf-8")
    found = read(tmp_path / "lab.csv", {} if "index" not in text else {"index": ""})
    assert found.rows[["force", "measured"]].iloc[0].tolist() == pytest.approx([0.5, 120e-6], rel=1e-12)


# -- the command ---------------------------------------------------------------------------------------------------
def test_cells_are_no_formulas(grid, tmp_path):
    """A participant named like one has an apostrophe before it in the table; numbers below 0 have none."""
    (tmp_path / "lab.csv").write_text('participant,force (N/m),voltage (V),friction (1)\n"=HYPERLINK(1)",75,200,0.9\n')
    argv = ["compare-data", str(tmp_path / "lab.csv"), "--sweep", str(grid.folder), "--csv", str(tmp_path / "out.csv")]
    assert main(argv) == 0
    (row,) = rows_of(tmp_path, "out")
    assert row["participant"] == "'=HYPERLINK(1)" and float(row["difference"]) < 0


@pytest.mark.parametrize("mark", "=+-@＝\t")
def test_first_letters_of_formulas(mark, tmp_path):
    write(tmp_path / "out.csv", [Output("a", "")], [{"a": f"{mark}1+1"}, {"a": "1+1"}])
    assert (tmp_path / "out.csv").read_text() == f"a\n'{mark}1+1\n1+1\n"


@pytest.mark.parametrize(
    ("heads", "row", "said"),
    [
        ("friction (1)", "0.5", "rows are at 0 V: the misfit is that of µ_0 alone, 0.25 in the results, and not"),
        ("contact length (mm)", "9", "rows are at 0 V: the misfit is that of contact without voltage, and not of the"),
    ],
)
def test_misfit_without_voltage_is_named(grid, tmp_path, capsys, heads, row, said):
    """It says nothing of the attraction; one row under voltage and the sentence is gone."""
    for more in ("", f"75,200,{row}\n"):
        (tmp_path / "lab.csv").write_text(f"force (N/m),voltage (V),{heads}\n75,0,{row}\n{more}", encoding="utf-8")
        assert main(["compare-data", str(tmp_path / "lab.csv"), "--sweep", str(grid.folder)]) == 0
        out = capsys.readouterr().out
        assert (said in out) == (more == "") and "(V rms)" in out
