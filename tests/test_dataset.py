"""A run and a sweep as NetCDF: the numbers of the tables, with units; a file that cannot be written loses nothing."""

import errno
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray
from mpi4py import MPI

import fingerpad as fp
from fingerpad.results import dataset, quantities
from fingerpad.results.over_time import OverTime
from fingerpad.results.result import Result
from fingerpad.runs import sweep_results
from fingerpad.runs.sweep_results import Sweep
from fingerpad.scene import from_data
from tests.measures import rows_of
from tests.runs import run
from tests.small_finger import NINE

pytestmark = pytest.mark.slow
SCENE = NINE | {
    "output": {"errors": False},
    "history": [
        {"name": "press", "f_ext": 1.0},
        {"name": "charge", "voltage": 50.0},
        {"name": "nudge", "bone_x": "10 um"},
    ],
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """A run with three loads, of seconds."""
    found = tmp_path_factory.mktemp("run")
    run(from_data(SCENE), found, MPI.COMM_SELF)
    return found


@pytest.fixture(scope="module")
def data(folder) -> xarray.Dataset:
    return xarray.load_dataset(folder / "result.nc")


def test_steps_are_those_of_the_table(folder, data):
    """Bit for bit: both hold the same doubles."""
    rows = rows_of(folder, "steps")
    assert data.sizes["step"] == len(rows) > 3
    for name in rows[0]:
        values = data["load_name" if name == "load" else name]
        for row, value in zip(rows, values.values, strict=True):
            assert row[name] == str(value) if values.dtype.kind in "OUb" else float(row[name]) == value, name


def test_states_are_those_of_the_result(folder, data):
    result = Result.load(folder)
    for name, state in result.named.items():
        for key in ("step", "mu_app", "f_t", "contact_length", "ridges_in_contact", "bone_height"):
            assert float(data[f"state_{key}"].sel(state=name)) == getattr(state, key)
    assert np.isnan(data["state_mu_app"].sel(state="full_slip"))
    missing = [int(data[f"state_{name}"].sel(state="full_slip")) for name in ("step", "ridges_in_contact", "stable")]
    assert missing == [-1] * 3, "0 ridges would be a lifted finger"
    assert list(data["load"].values) == [load.name for load in result.loads]


def test_loads_are_those_of_the_summary(folder, data):
    """Extremes, and in a load over time the means and the spectrum; no value for the other loads."""
    result = Result.load(folder)
    for load in result.loads:
        for name, extremes in load.extremes.items():
            at = data.sel(load=load.name)
            assert (float(at[f"load_{name}_min"]), float(at[f"load_{name}_max"])) == (extremes.min, extremes.max)
    means = {name: 1.0 + k for k, name in enumerate(quantities.EXTREMES)}
    timed = OverTime(0.5, 2.0, means, 2, (1.0, 2.0), (0.3, 0.1))
    loads = (replace(result.loads[0], over_time=timed), *result.loads[1:])
    at = dataset.dataset(replace(result, loads=loads)).isel(load=0)
    assert {name: float(at[f"load_{name}_mean"]) for name in means} == means
    assert (float(at["load_start"]), float(at["load_seconds"])) == (0.5, 2.0)
    assert list(at["load_f_t_amplitude"].values) == [0.3, 0.1] and list(at["load_frequency"].values) == [1.0, 2.0]
    others = dataset.dataset(replace(result, loads=loads)).isel(load=slice(1, None))
    assert others["load_f_t_mean"].isnull().all() and others["load_f_t_amplitude"].isnull().all()


def test_skin_is_along_facets_and_points(data):
    """Under pressure are facets of the ridges that have values in that step, and of no others."""
    skin = data.sel(state="charged")
    assert skin["skin_p_n"].dims == ("facet", "point") and skin.sizes["point"] == 4
    bears = skin["ridge_f_contact"].sel(step=int(skin["state_step"])) > 0
    touching = skin["skin_ridge"].where((skin["skin_p_n"] > 0).any("point"))
    assert set(touching.values[touching.notnull()]) == set(data["ridge"].values[bears.values])


def test_every_variable_has_a_unit_and_a_name(data):
    about = {name: {"units", "long_name"} <= set(value.attrs) for name, value in data.variables.items()}
    assert all(about.values()), about


def test_dataset_of_a_result_that_was_read_back(folder):
    """The same file, to the last byte."""
    again = Result.load(folder).to_xarray()
    assert bytes(again.to_netcdf(engine="scipy", format="NETCDF3_64BIT")) == (folder / "result.nc").read_bytes()


def test_dataset_that_is_not_whole_is_refused(folder, tmp_path):
    (tmp_path / "result.nc").write_bytes((folder / "result.nc").read_bytes()[:-5000])
    with pytest.raises(fp.SceneError, match="cannot be read: result.nc is not whole, or not of a run"):
        Result.load(tmp_path)


# -- sweeps ----------------------------------------------------------------------------------------------
def test_swept_keys_are_coordinates(tmp_path):
    found = fp.sweep(fp.Scene(), tmp_path, model="cylinders", voltage=[0, 100, 200], f_ext=["25 N/m", 75])
    data = xarray.load_dataset(tmp_path / "sweep.nc")
    assert data["state_mu_app"].dims == ("voltage", "f_ext", "state")
    assert data["f_ext"].values.tolist() == [25.0, 75.0] and data["f_ext"].attrs["units"] == "N/m"
    np.testing.assert_array_equal(data["state_mu_app"].sel(state="full_slip"), found.array("mu_app"))
    for row in rows_of(tmp_path, "table"):
        at = data.sel(voltage=float(row["voltage"]), f_ext=float(row["f_ext"]), state="full_slip")
        assert float(at["state_f_t"]) == float(row["full_slip_f_t"])
    assert "voltage" not in data.attrs and data.attrs["friction"] == 0.25


# -- faults ----------------------------------------------------------------------------------------------
def full(file, text):
    if Path(file).suffix == ".nc":
        raise OSError(errno.ENOSPC, "No space left on device")
    Path(file).write_bytes(text.encode() if isinstance(text, str) else text)


def test_full_disk_loses_no_table_of_a_sweep(tmp_path, monkeypatch):
    monkeypatch.setattr(sweep_results, "replace", full)
    found = fp.sweep(fp.Scene(), tmp_path, model="cylinders", voltage=[0, 100])
    assert found.notes[1:] == ("sweep.nc was not written: No space left on device; all other files are complete",)
    assert str(found).endswith(found.notes[1]) and len(rows_of(tmp_path, "table")) == 2


# -- Energy densities at the mechanoreceptors' sites in the named states: in sweeps and reports, as  ---
def test_sites_of_a_sweep_are_those_of_its_states(folder, tmp_path):
    data = xarray.load_dataset(folder / "result.nc")
    found = Sweep({"voltage": (50.0,)}, (Result.load(folder),), tmp_path)
    swept = found.to_xarray()
    assert swept["state_merkel_sed"].dims == ("voltage", "state", "ridge")
    assert swept["state_meissner_sed"].dims == ("voltage", "state", "ridge", "side")
    state = found[0].charged
    ridges = swept["ridge"].values
    mine = swept.sel(voltage=50.0, state="charged")
    for name in ("merkel_sed", "meissner_sed"):
        np.testing.assert_array_equal(mine[f"state_{name}"], data[name].sel(step=state.step, ridge=ridges))
        assert mine[f"state_{name}"].notnull().all()
        assert swept[f"state_{name}"].sel(state="full_slip").isnull().all()
        assert swept[f"state_{name}"].attrs == data[name].attrs
