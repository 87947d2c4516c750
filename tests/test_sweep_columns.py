"""A sweep over the amplitude of a drive: what its table, its dataset, its text and its report have of it."""

import csv
import json
import math
from dataclasses import replace

import numpy as np
import pytest
import xarray

import fingerpad as fp
from fingerpad.report.write import write
from fingerpad.runs.sweep_results import Sweep, _stacked
from fingerpad.slices.finger import WholeFinger
from tests.test_loads_over_time import BY, PRESS, SLIDE, WAVE, scene

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


def test_report_begins_with_the_load_over_time(folder):
    page = write(folder.folder).read_text(encoding="utf-8")
    most = folder.results[1].loads[2].extremes["mu_app"].max
    assert f"<h1>µ<sub>app</sub> from 0.250 to {most:.3f}</h1>" in page
    assert f"in the load {NAME}, over {KEY} (V): 40, 80, 120; µ_app from 0.250 to 0.250 at full slip" in page
    assert page.index("Loads over time") < page.index("Friction and contact at full slip")
    assert f"over {KEY}</title>" in page  # and over nothing else: a load's column is no swept key


def test_headline_of_a_sweep_is_of_its_waveform(folder, tmp_path):
    """Not of a press that takes time before it, nor of a wave in which the finger rests; both cares are told."""
    press = {"load_press_mu_app_min": -1e-18, "load_press_mu_app_max": 1e-18, "load_press_contact_length_mean": 1.0}
    rest = {f"load_rest_{key}": 0.0 for key in ("mu_app_min", "mu_app_max", "f_t_amplitude", "contact_length_mean")}
    rows = [
        {"voltage": 1.0, "full_slip_contact_length": 1e-3, **press, **more, **rest, "failure": ""}
        for more in (
            {f"load_w_{key}": value for key, value in zip(WAVES, (0.2, 0.3, 0.1, 1.0), strict=True)},
            {f"load_w_{key}": "" for key in WAVES},
        )
    ]
    rows[1] |= {"voltage": 2.0, "full_slip_contact_length": ""}
    with (tmp_path / "table.csv").open("w", encoding="utf-8", newline="") as file:
        out = csv.DictWriter(file, list(rows[0]))
        out.writeheader()
        out.writerows(rows)
    asked = {"parameters": fp.Scene().parameters(), "model": "full", "cautions": ["a", "b", "c", "d"]}
    (tmp_path / "sweep.json").write_text(json.dumps(asked), encoding="utf-8")
    page = write(tmp_path).read_text(encoding="utf-8")
    assert "<h1>µ<sub>app</sub> from 0.200 to 0.300</h1>" in page and "in the load w, over" in page
    assert "1 of 2 points have no full slip. Limits of validity are reached: a; b; c; and 1 more." in page
    assert "<li>d</li>" in page
    (tmp_path / "table.csv").write_text(
        (tmp_path / "table.csv").read_text(encoding="utf-8").replace("1.0,0.001,", "1.0,,"), encoding="utf-8"
    )
    none = write(tmp_path).read_text(encoding="utf-8")
    assert "2 of 2 points have no full slip." in none and "No point reached" not in none


WAVES = ("mu_app_min", "mu_app_max", "f_t_amplitude", "contact_length_mean")


def test_cautions_that_differ_in_numbers_are_one(tmp_path):
    cautions = [f"roughness.wavelength is {x:.3g} m, above half" for x in (2.6e-4, 3e-4, 1e-3)]
    results = [fp.Result(fp.Scene(), "full", None, None, None, cautions=(text, "another")) for text in cautions]
    found = Sweep({"voltage": (1.0, 2.0, 3.0)}, tuple(results), tmp_path).cautions()
    assert found == [f"{cautions[0]} (3 of 3 points)", "another (3 of 3 points)"]


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
