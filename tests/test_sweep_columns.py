"""A sweep over the amplitude of a drive: what its table, its dataset, its text and its report have of it."""

import csv
import json
import math
from dataclasses import replace

import numpy as np
import pytest
import xarray

import fingerpad as fp
from fingerpad.runs.sweep_results import Sweep, _stacked
from fingerpad.slices.finger import WholeFinger
from tests.test_loads_over_time import BY, PRESS, SLIDE, WAVE, scene

pytestmark = pytest.mark.slow
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
    asked = {"parameters": results[0].scene.parameters(), "model": "full"}
    (place / "sweep.json").write_text(json.dumps(asked), encoding="utf-8")
    assert not done.save()
    return done


def test_table_has_loads_over_time(folder):
    """Extremes, mean and largest amplitude of each; empty where a run failed."""
    with (folder.folder / "table.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    for row, result in zip(rows[:2], folder.results, strict=False):
        load = result.loads[2]
        assert float(row[f"load_{NAME}_mu_app_max"]) == load.extremes["mu_app"].max > 0.25
        assert float(row[f"load_{NAME}_f_t_mean"]) == load.over_time.mean["f_t"]
        assert float(row[f"load_{NAME}_f_t_amplitude"]) == max(load.over_time.f_t_amplitude)
        assert float(row[f"load_{NAME}_f_t_frequency"]) == pytest.approx(2 * WAVE["frequency"])
        assert float(row["full_slip_mu_app"]) == pytest.approx(0.25)  # before the drive: the same at each point
    assert rows[2][f"load_{NAME}_mu_app_max"] == "" and rows[2]["failure"] == "no equilibrium"
    assert not any(key.startswith("load_press") for key in rows[0])  # it takes no time


def test_text_has_a_table_of_each_load_over_time(folder):
    lines = str(folder).splitlines()
    at = lines.index(f"Over time, in the load {NAME}")
    assert lines[at + 1].split("   ")[1:4] == ["least µ_app", "largest µ_app", "mean µ_app"]
    assert lines[at + 2].split()[0] == "40" and lines[at + 4].split() == ["120", *"–" * 8]


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


def test_places_along_a_dimension_are_those_of_labels():
    """Points that have other ridges than the first one."""
    about = {"units": "1", "long_name": "x"}
    points = [
        {"ridge": (("ridge",), np.array(numbers), about), "x": (("ridge",), np.array(numbers, float), about)}
        for numbers in ([0, 1], [-1, 0])
    ]
    found = _stacked([*points, {}], ("voltage",), [3])
    assert found["ridge"][1].tolist() == [-1, 0, 1]
    dims, values, _ = found["x"]
    assert dims == ("voltage", "ridge")
    np.testing.assert_array_equal(values, [[math.nan, 0, 1], [-1, 0, math.nan], [math.nan] * 3])


def test_newtons_of_a_whole_finger(tmp_path):
    """A sweep whose points have one shows its friction in the last column, and has it in table and dataset."""
    result = replace(fp.run(fp.Scene(force="0.5 N"), model="cylinders"), scene=fp.Scene())
    assert isinstance(result.finger, WholeFinger)
    done = Sweep({"friction": (0.25,)}, (result,), tmp_path)
    totals = result.finger.states["full_slip"].totals
    row = done.rows()[0]
    assert row["full_slip_finger_f_t"] == totals["f_t"] and row["charged_finger_f_ext"] == pytest.approx(0.5)
    assert "charged_finger_f_t" not in row
    heads, line = str(done).splitlines()[1:3]
    assert heads.endswith("F_T (N)") and line.endswith(result.finger.shown("full_slip", "f_t"))
    data = done.to_xarray()
    assert float(data["finger_f_t"].sel(state="full_slip")[0]) == totals["f_t"]


def test_cautions_of_points_are_the_sweep_s(tmp_path):
    """Each with its number of points, in the text, in the file and on the page."""
    found = fp.sweep(
        fp.Scene(), tmp_path, model="cylinders", voltage=[200.0, 400.0], **{"electric.d_i": [1e-6, 100e-6, 50e-6]}
    )
    cautions = found.cautions()
    ours = next(text for text in cautions if text.startswith("the error of this model is known of full runs"))
    assert ours.endswith("and not at this load (3 of 6 points)")
    places = [text for text in cautions if "the closure is out of its range" in text and "d_eq rises" in text]
    count = sum(any("the closure is out of its range" in text for text in each.cautions) for each in found)
    assert len(places) == 1 and places[0].endswith(f"({count} of 6 points)") and 1 < count < 6
    assert f"! {ours}" in str(found).splitlines()
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "Limits of validity are reached: " in page and ours in page
    assert not fp.sweep(fp.Scene(), tmp_path / "known", model="cylinders", voltage=[0.0, 200.0]).cautions()
