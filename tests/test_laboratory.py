"""Tables as laboratories write them, beside runs, and the friction coefficient of rows without voltage."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import fingerpad as fp
from fingerpad.cli import main
from fingerpad.measurements.compare import comparison, computed, refuse_mixed
from fingerpad.measurements.table import read
from fingerpad.results.result import Result
from fingerpad.runs.sweep import sweep
from fingerpad.scene import Scene, SceneError
from fingerpad.slices.errors import MESH
from fingerpad.slices.finger import WholeFinger
from fingerpad.slices.total import Total
from tests.measures import contact_state, rows_of
from variational.state import Errors


@pytest.fixture(scope="module")
def grid(tmp_path_factory):
    """A sweep of the closed form over three voltages and two forces, with a coefficient of 0.25."""
    return sweep(Scene(), tmp_path_factory.mktemp("sweep"), model="cylinders", voltage=[0, 100, 200], f_ext=[25, 75])


LABORATORY = """# source: Größe und Söhne
Force [N/m];Voltage [V];Friction [%];Spread [%];Temperature (°C)
25,0;0;31,5;10;23,5
25;-100;-42;;23
75;0;2,0e1;5;22
"""


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
def test_semicolons_commas_percent_and_signs(tmp_path, encoding):
    """As the same table with points and in numbers, whatever the encoding."""
    file = tmp_path / "lab.csv"
    file.write_bytes(LABORATORY.replace("µ", "u").encode(encoding))
    found = read(file)
    assert found.rows.to_dict("list") == {
        "spread": [pytest.approx(0.1), pytest.approx(np.nan, nan_ok=True), pytest.approx(0.05)],
        "force": [25.0, 25.0, 75.0],
        "voltage": [0.0, 100.0, 0.0],
        "measured": [pytest.approx(0.315), pytest.approx(0.42), pytest.approx(0.2)],
    }
    assert (found.turned, found.ignored, found.about["source"]) == (1, ("Temperature (°C)",), "Größe und Söhne")


def frame(**columns):
    heads = {"force": "force (N/m)", "voltage": "voltage (V)", "friction": "friction (1)"}
    return pd.DataFrame({heads.get(name, name): values for name, values in columns.items()})


def test_coefficient_is_fitted_without_voltage(grid):
    """Measured as 1.6 times the computed friction: with the coefficient of the rows at 0 V nothing is left."""
    charged = [1.6 * each.full_slip.mu_app for each in grid if each.scene.f_ext == 75 and each.scene.voltage]
    table = frame(force=[25, 75, 75, 75], voltage=[0, 0, 100, 200], friction=[0.38, 0.42, *charged])
    found = fp.compare(table, grid)
    assert found.attrs["mu_0"] == 0.25
    assert found.attrs["fit"] == pytest.approx({"mu_0": 0.4, "spread": 0.02 * np.sqrt(2), "rows": 2})
    assert found.mu_0.tolist() == pytest.approx([0.4] * 4)
    np.testing.assert_allclose(found.computed, [0.4, 0.4, *charged], rtol=1e-12)
    assert found.attrs["misfit"] == pytest.approx(
        {"ratio": 1.0, "factor": 1.0, "shape_factor": 1.0, "rows": 2, "spreads": 0, "within": 0}
    )


def test_command_prints_fit_and_remarks(grid, tmp_path, capsys):
    """Fit, signs and ignored columns in words; a column for the coefficient in the file; a picture."""
    file = tmp_path / "lab.csv"
    file.write_text(LABORATORY + "75;200;60;;23\n75;200;64;;23\n75;200;40;;22\n25;0;24;;22\n")
    argv = ["compare", str(file), "--sweep", str(grid.folder)]
    assert main([*argv, "--out", str(tmp_path / "lab.png"), "--csv", str(tmp_path / "out.csv")]) == 0
    out = capsys.readouterr().out
    assert "Columns not read: Temperature (°C).\n" in out
    assert "Rows with a friction below 0, of the other direction: 1. Magnitudes are compared.\n" in out
    assert (
        "µ_0 of the rows at 0 V (3): 0.2517, standard deviation 0.0584. Computed friction is scaled to it from" in out
    )
    assert float(rows_of(tmp_path, "out")[0]["mu_0"]) == pytest.approx(0.755 / 3)
    assert (tmp_path / "lab.png").stat().st_size > 10_000


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


def test_categorical_and_nullable_columns():
    """As the same numbers of NumPy: categories as groupby makes them, whole numbers and NA of pandas."""
    plain = pd.DataFrame(
        {"force (N)": [0.5, 1.0], "voltage (V)": [0, 100], "friction (1)": [0.25, 0.5], "spread (1)": [0.1, np.nan]}
    )
    kinds = plain.astype({"force (N)": "category", "voltage (V)": "Int64", "friction (1)": "Float64"})
    kinds["spread (1)"] = pd.array([0.1, pd.NA], dtype="Float64")
    found = read(kinds).rows
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


# -- runs beside tables of measurements: what of a run is compared, and which runs go together -----------------------
def state(step, f_ext, voltage=0.0, bone_x=0.0, **more):
    pressed = {"f_ext": f_ext, "f_contact": f_ext, "bone_height": -1e-5 * f_ext, "contact_length": 1e-4 * f_ext}
    return contact_state(step=step, voltage=voltage, bone_x=bone_x, **pressed | more)


def compared(runs, table):
    return comparison(table, computed(runs, table))


def ratio(runs, table):
    found = compared(runs, table)
    return found.computed.to_numpy() / found.measured.to_numpy()


def test_press_of_a_run_is_compared(table):
    """The states on the way down and no later ones; full slip is one state."""
    steps = (state(1, 10.0), state(2, 20.0), state(3, 20.0, 100.0), state(4, 20.0, 100.0, 1e-3, mu_app=0.4))
    run = Result(Scene(), "full", steps[1], steps[2], steps[3], steps=steps)
    pressed = read(table("# state: uncharged\nforce (N/m), depth (mm)\n15, 0.3\n"))
    assert compared(run, pressed).computed.tolist() == pytest.approx([1.5e-4])
    assert ratio(run, pressed) == pytest.approx([0.5])
    slip = read(table("friction (1)\n0.2\n"))
    assert ratio([run], slip) == pytest.approx([2.0])
    with pytest.raises(SceneError, match="have no state of full slip"):
        computed([Result(Scene(), "full", steps[1], None, None, steps=steps[:2])], slip)


def test_errors_of_named_states_are_carried(table):
    """Of the cross-section and of the whole finger; a step of the press has none, but for the named state's own."""
    steps = (state(1, 10.0), state(2, 20.0), state(4, 20.0, 100.0, 1e-3, mu_app=0.4))
    uncharged, slip = replace(steps[1], error=Errors(bone_height=2e-6)), replace(steps[2], error=Errors(mu_app=0.01))
    finger = WholeFinger({"full_slip": total(0.4, 8e-5)}, "test", {"full_slip": {MESH: {"contact_area": 3e-3}}})
    run = Result(Scene(), "full", uncharged, None, slip, steps=steps, finger=finger)
    for text, error in (
        ("# state: uncharged\nforce (N/m), depth (mm)\n20, 0.2\n10, 0.1\n", [2e-6, np.nan]),
        ("friction (1)\n0.2\n", [0.01]),
        ("contact area (mm^2)\n20\n", [3e-3 * finger.values("full_slip")["contact_area"]]),
        ("gross area (mm^2)\n20\n", [np.nan]),
    ):
        asked = read(table(text))
        np.testing.assert_array_equal(compared([run], asked).error, error)


def test_whole_finger_is_compared(table):
    """Newtons and mm² are of the runs' whole fingers, by force and voltage; a cross-section has none."""
    finger = [total(0.4, 8e-5), total(0.6, 1e-4)]
    slip = [state(4, 40.0, 100.0, mu_app=0.3), state(4, 60.0, 100.0, mu_app=0.3)]
    runs = [
        Result(Scene(), "full", None, None, s, finger=WholeFinger({"full_slip": f}, "test"))
        for s, f in zip(slip, finger, strict=True)
    ]
    area = read(table("force (mN), voltage (V), gross area (mm^2), spread (mm^2)\n500, 100, 45, 50\n"))
    assert area.whole and area.rows.iloc[0].to_dict() == pytest.approx(
        {"force": 0.5, "voltage": 100.0, "measured": 4.5e-5, "spread": 5e-5}
    )
    power = np.log(1e-4 / 8e-5) / np.log(0.6 / 0.4)
    assert ratio(runs, area) == pytest.approx([8e-5 * 1.25**power / 4.5e-5])
    friction = read(table("force (N), friction (1)\n0.4, 0.25\n"))
    assert ratio(runs[:1], friction) == pytest.approx([2.0])
    with pytest.raises(SceneError, match="the run has no newtons"):
        computed([Result(Scene(), "full", None, None, slip[0])], friction)


def total(force, area):
    """Return a whole finger of one slice, 1 mm thick, whose friction is half its force."""
    values = {"f_ext": force, "f_t": force / 2, "f_electrostatic": 0.0, "contact_length": area / 5, "gross_width": area}
    one = np.ones(1)
    return Total(1e-3, 0 * one, one, 1e-3 * one, force, {name: value * one for name, value in values.items()})


# -- runs together -------------------------------------------------------------------------------------------
def test_runs_of_other_models_and_screens_are_refused(tmp_path):
    """The model is no key of a scene."""
    runs = [Result(Scene(), model, None, None, None, folder=tmp_path / model) for model in ("full", "cylinders")]
    with pytest.raises(SceneError, match="model is 'full' in .*full and 'cylinders' in .*cylinders; give runs"):
        refuse_mixed(runs)
    runs = [Result(Scene(electric={"d_i": d_i}), "full", None, None, None) for d_i in (1e-6, 5e-6)]
    with pytest.raises(SceneError, match="electric.d_i is 1e-06 in a run and 5e-06 in a run; give runs that differ in"):
        refuse_mixed(runs)


def test_forces_on_the_finger_may_differ():
    """And be those at its centre; all else may not."""

    def under(force, **changes):
        return Result(Scene(force=force, **changes), "full", None, None, None)

    refuse_mixed([under(0.3, voltage=100), under(0.5, voltage=150), Result(Scene(), "full", *[None] * 3)])
    with pytest.raises(SceneError, match=r"friction is 0\.25 in a run and 0\.3 in a run"):
        refuse_mixed([under(0.3), under(0.5, friction=0.3)])
