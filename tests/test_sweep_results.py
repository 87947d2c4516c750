"""A sweep over the force on the whole finger: each point is the run under its force."""

import html
import re
from dataclasses import replace

import numpy as np
import pytest
import xarray

import fingerpad as fp
from fingerpad.cli import main
from fingerpad.reduced import cylinder_errors
from fingerpad.report.write import write
from fingerpad.results.files import FORMAT, replace_json
from fingerpad.runs.sweep_results import Sweep
from fingerpad.slices.finger import WholeFinger
from tests.measures import rows_of
from tests.small_finger import small
from tests.test_loads_over_time import BY, PRESS, SLIDE, WAVE, scene

pytestmark = pytest.mark.slow
FORCES, VOLTAGES = (0.1, "200 mN", 0.5), (0.0, 200.0)
SMALL = {
    "output": {"receptors": False, "errors": False, "each_load": False},
    "slices": {"radius": 6e-3, "length": 8e-3},
}


@pytest.fixture(scope="module")
def found(tmp_path_factory) -> fp.Sweep:
    out = tmp_path_factory.mktemp("force")
    return fp.sweep(fp.Scene(), out, model="cylinders", voltage=VOLTAGES, force=FORCES)


def test_each_point_is_the_run_under_its_force(found):
    """In the order of the axes, to the last bit, cross-section and cautions included."""
    assert found.axes == {"voltage": VOLTAGES, "force": (0.1, 0.2, 0.5)}
    for point, result in zip(found.points(), found, strict=True):
        alone = fp.run(fp.Scene(**point), model="cylinders")
        assert result.scene.force == point["force"] and result.cautions == alone.cautions
        assert result.finger.values("full_slip") == alone.finger.values("full_slip")
        assert result.full_slip.f_ext == alone.full_slip.f_ext
    assert found.array("f_t").shape == (2, 3)
    assert found.array("f_t")[1, 2] == found[5].finger.values("full_slip")["f_t"]
    with pytest.raises(ValueError, match="quantity is 'contact_length'; it must be one of f_ext, mu_app"):
        found.array("contact_length")


def test_table_text_and_dataset_are_of_the_whole_finger(found):
    rows = rows_of(found.folder, "table")
    assert not [key for key in rows[0] if re.match(r"(slip|normal|uncharged)_(?!finger_)", key)]
    assert float(rows[4]["full_slip_finger_f_t"]) == found.array("f_t")[1, 1]
    title, heads, *lines = str(found).splitlines()
    assert title == "Whole finger, at full slip, under a voltage without losses (Eq. 3)"
    assert heads.split()[2:7] == ["force", "(N)", "µ_app", "F_T", "(N)"]
    assert lines[4].split()[:2] == ["200", "0.2"] and found[4].finger.shown("full_slip", "f_t") in lines[4]
    data = found.to_xarray()
    assert data["force"].attrs["units"] == "N" and data["finger_f_t"].dims == ("voltage", "force", "state")
    assert not [name for name in data if name.startswith("state_")]
    np.testing.assert_array_equal(data["finger_f_t"].sel(state="full_slip"), found.array("f_t"))


def test_report_has_newtons(found, tmp_path):
    page = write(found.folder).read_text(encoding="utf-8")
    mu = found.array("mu_app")
    ends = f"from {mu.min():.3f} to {mu.max():.3f}."
    assert f"<h1>At full slip the friction coefficient of the whole finger goes {ends}</h1>" in page
    assert "friction force F<sub>T</sub> (N)" in page and "F_T of the whole finger (N) over the sweep" in page
    study = page.partition("<script")[0].partition('id="study"')[2].partition('id="failed"')[0]
    assert "N/m" not in re.sub(r"\(200\sV rms, 75\sN/m: docs", "", study), "but for the note on Eq. 3"


def test_force_that_no_trace_reaches_fails_alone(tmp_path):
    """It says what to do; the others are there, and a chart has no point for it."""
    found = fp.sweep(fp.Scene(), tmp_path, model="cylinders", force=[0.2, 60.0])
    assert found[1].failure and found[1].finger is None and found[1].failure in str(found)
    assert found[0].failure == "" and np.isfinite(found.array("f_t")[0]) and np.isnan(found.array("f_t")[1])


@pytest.mark.parametrize(
    ("axes", "words"),
    [
        ({"force": [0.1], "f_ext": [75.0]}, "force is 0.1 N and f_ext is 75 N/m; give one of the two"),
        ({"force": [0.1, "100 mN"]}, "each value must be there once"),
        ({"force": 0.1}, "force of the sweep is 0.1; it must be a list, such as [0.1]"),
        ({"force": [0.1], "history[0].f_ext": [75.0]}, "force is 0.1 N and history is given; a force on the whole"),
    ],
)
def test_what_is_no_sweep_over_the_force(tmp_path, axes, words):
    scene = fp.Scene()
    if "history[0].f_ext" in axes:
        scene = fp.Scene(history=[{"name": "press", "f_ext": 75.0}])
    with pytest.raises(fp.SceneError) as refused:
        fp.sweep(scene, tmp_path / "out", model="cylinders", **axes)
    assert words in str(refused.value)


def test_command_and_measurements(tmp_path, capsys):
    """Newtons of a table beside those of a sweep; a power law between its forces."""
    out, table = tmp_path / "sweep", tmp_path / "mine.csv"
    words = ["sweep", "--over", "force=100,400 mN", "--over", "voltage=200", "--model", "cylinders", "--out", str(out)]
    assert main(words) == 0 and "Whole finger, at full slip" in capsys.readouterr().out
    table.write_text("# source: X 2020\nforce (mN), friction force (N)\n100, 0.09\n200, 0.15\n", encoding="utf-8")
    assert main(["compare", str(table), "--sweep", str(out), "--csv", str(tmp_path / "both.csv")]) == 0
    low, high = (float(row["full_slip_finger_f_t"]) for row in rows_of(out, "table"))
    ours = [float(row["computed"]) for row in rows_of(tmp_path, "both")]
    assert ours == pytest.approx([low, np.sqrt(low * high)], rel=1e-9)


def test_full_model_in_processes_of_its_own(tmp_path, capfd):
    """The force of a run by itself; a second sweep takes it from there, without a run.

    Tolerance: with cells renumbered, which other processes have not, a trace may have other points.
    """
    scene, alone = small(**SMALL), fp.run(small(**SMALL).replace(force="2 mN"))
    found = fp.sweep(scene, tmp_path, force=["2 mN"])
    assert found[0].failure == "" and "force 0.002" in capfd.readouterr().out
    assert found.array("f_t")[0] == pytest.approx(alone.finger.values("full_slip")["f_t"], rel=1e-3)
    again = fp.sweep(scene, tmp_path, force=[0.002])
    assert "force 0.002 (" not in capfd.readouterr().out and again.array("f_t") == found.array("f_t")


# -- a sweep over the amplitude of a drive ---------------------------------------------------------------------------
KEY, NAME = "history[2].voltage.amplitude", "my drive"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The folder of a sweep over two amplitudes, and over a third of which the run failed."""
    place = tmp_path_factory.mktemp("sweep")
    results = [
        fp.run(scene(PRESS, SLIDE, BY | {"name": NAME, "voltage": WAVE | {"amplitude": amplitude, "offset": 0.0}}))
        for amplitude in (40.0, 80.0)
    ]
    failed = fp.Result(results[0].scene, "full", None, None, None, failure="no equilibrium")
    done = Sweep({KEY: (40.0, 80.0, 120.0)}, (*results, failed), place)
    done.to_csv(place / "table.csv")
    asked = {"format": FORMAT, "parameters": results[0].scene.parameters(), "model": "full", "outputs": []}
    asked |= {"axes": [KEY], "rows": done.table(), "cautions": [], "notes": []}
    replace_json(place / "sweep.json", asked)
    assert not done.save()
    return done


def test_table_has_loads_over_time(folder):
    """Extremes, mean and largest amplitude of each; empty where a run failed."""
    rows = rows_of(folder.folder, "table")
    for row, result in zip(rows[:2], folder.results, strict=False):
        load = result.loads[2]
        assert float(row[f"load_{NAME}_mu_app_max"]) == load.extremes["mu_app"].max > 0.25
        assert float(row[f"load_{NAME}_f_t_mean"]) == load.over_time.mean["f_t"]
        assert float(row[f"load_{NAME}_f_t_amplitude"]) == max(load.over_time.f_t_amplitude)
        assert float(row[f"load_{NAME}_f_t_frequency"]) == pytest.approx(2 * WAVE["frequency"])
        assert float(row["full_slip_mu_app"]) == pytest.approx(0.25)  # before the drive: the same at each point
    assert rows[2][f"load_{NAME}_mu_app_max"] == "" and rows[2]["failure"] == "no equilibrium"
    assert not any(key.startswith("load_press") for key in rows[0])  # it takes no time


def test_dataset_has_the_loads_of_all_points(folder):
    """By their names; NaN where a point has none."""
    data = xarray.load_dataset(folder.folder / "sweep.nc")
    assert data["load"].values.tolist() == ["press", "slide", NAME]
    most = data["load_mu_app_max"]
    assert most.dims == (KEY, "load") and most.attrs["units"] == "1"
    for k, result in enumerate(folder.results[:2]):
        assert most[k].values.tolist() == [load.extremes["mu_app"].max for load in result.loads]
        amplitudes = data["load_f_t_amplitude"][k].sel(load=NAME)
        np.testing.assert_array_equal(amplitudes, result.loads[2].over_time.f_t_amplitude)
    assert most[2].isnull().all() and data["failure"].values[2] == "no equilibrium"


def test_newtons_of_a_whole_finger(tmp_path):
    """A sweep whose points have one shows it first, the section second, and has it in table and dataset."""
    result = replace(fp.run(fp.Scene(force="0.5 N"), model="cylinders"), scene=fp.Scene())
    assert isinstance(result.finger, WholeFinger)
    done = Sweep({"friction": (0.25,)}, (result,), tmp_path)
    totals = result.finger.states["full_slip"].totals
    row = done.rows()[0]
    assert row["full_slip_finger_f_t"] == totals["f_t"] and row["charged_finger_f_ext"] == pytest.approx(0.5)
    assert "charged_finger_f_t" not in row
    title, heads, line = str(done).splitlines()[:3]
    assert title.startswith(
        "Whole finger, and middle section per metre of finger, at full slip, under a voltage without"
    )
    assert heads.index("F_T (N)") < heads.index("µ_app of section") < heads.index("f_T of section (N/m)")
    assert re.search(rf" {re.escape(result.finger.shown('full_slip', 'mu_app'))} ", line)
    data = done.to_xarray()
    assert float(data["finger_f_t"].sel(state="full_slip")[0]) == totals["f_t"]


def test_cautions_of_points_are_the_sweep_s(tmp_path):
    """Each with its number of points, in the text, in the file and on the page."""
    found = fp.sweep(
        fp.Scene(), tmp_path, model="cylinders", voltage=[200.0, 400.0], **{"electric.d_i": [1e-6, 100e-6, 50e-6]}
    )
    cautions = found.cautions()
    start = "the error of this model is not known here: "
    unknown = [text for text in cautions if text.startswith(start)]
    low, high = cylinder_errors.REGIONS[1].ranges["electric.d_i"]
    ours = f"{start}electric.d_i is 0.0001 m, and it is known for {low:g} to {high:g} m (2 of 6 points"
    ours += ", numbers of the first)"
    assert unknown[0] == ours, "of two thicknesses at 200 V"
    places = [text for text in cautions if "the closure is out of its range" in text and "d_eq rises" in text]
    count = sum(any("the closure is out of its range" in text.text for text in each.cautions) for each in found)
    assert len(places) == 1 and f"({count} of 6 points" in places[0] and 1 < count < 6
    assert f"! {ours}" in str(found).splitlines()
    page = (tmp_path / "report.html").read_text(encoding="utf-8").replace("\u00a0", " ")
    assert "Limits of validity are reached: " in page and all(html.escape(text) in page for text in unknown)
    assert not fp.sweep(fp.Scene(), tmp_path / "known", model="cylinders", voltage=[0.0, 200.0]).cautions()
