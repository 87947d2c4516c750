"""Outputs: one entry, of a user or of the package, is in text, tables, files, sweeps and reports, and read back."""

import json
import math
from dataclasses import replace

import pytest
import xarray
from mpi4py import MPI

import fingerpad as fp
from fingerpad.results import quantities
from fingerpad.scene import from_data
from tests.measures import rows_of
from tests.runs import no_pictures
from tests.test_dataset import SCENE

pytestmark = pytest.mark.slow
P_MEAN = fp.Output(
    "p_mean", "kPa", lambda state: state.f_contact / state.contact_length, words="mean pressure p_m", digits=2
)
MERKEL = fp.Output("merkel_max", "J/m^3", lambda state: state.sites.merkel.max())


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    with no_pictures():
        return fp.run(from_data(SCENE), out=folder, comm=MPI.COMM_SELF, outputs=[P_MEAN, MERKEL])


def values_of(result):
    return [state.f_contact / state.contact_length for state in result.steps]


def test_output_is_in_the_tables_in_si(result):
    assert [float(row["p_mean"]) for row in rows_of(result.folder, "steps")] == values_of(result)
    summary = json.loads((result.folder / "summary.json").read_text(encoding="utf-8"))
    assert summary["charged_p_mean"] == result.charged.p_mean
    most = max(values_of(result)[k] for k, state in enumerate(result.steps) if state.load == "nudge")
    assert result.loads[2].extremes["p_mean"].max == most
    with pytest.raises(AttributeError, match="'p_min'"):
        _ = result.charged.p_min


def test_output_is_in_the_dataset(result):
    data = xarray.load_dataset(result.folder / "result.nc")
    assert data["p_mean"].values.tolist() == values_of(result)
    assert data["p_mean"].attrs == {"units": "Pa", "long_name": "mean pressure p_m"}
    assert float(data["state_p_mean"].sel(state="charged")) == result.charged.p_mean
    assert math.isnan(data["state_p_mean"].sel(state="full_slip"))
    assert "load_p_mean_max" in data


def test_output_is_read_back(result):
    """Values, words and unit; the sites as well, of which one of them is computed."""
    again = fp.Result.load(result.folder)
    assert [state.row() for state in again.steps] == [state.row() for state in result.steps]
    assert str(again) == str(result)
    more = again.with_outputs([fp.Output("twice", "J/m^3", lambda state: 2 * state.sites.merkel.max())])
    assert more.charged.twice == 2 * result.charged.merkel_max == 2 * more.steps[8].merkel_max
    assert [output.name for output in more.outputs] == ["p_mean", "merkel_max", "stuck_share", "shear_stress", "twice"]


def test_output_of_a_sweep(tmp_path):
    hidden = fp.Output("hidden", "N/m", lambda state: state.f_t, tables={"result"})
    found = fp.sweep(fp.Scene(), tmp_path, model="cylinders", voltage=[0, 200], outputs=[P_MEAN, hidden])
    assert found.array("hidden")[0] > 0 and "hidden" in str(found[0]) and "hidden" not in str(found)
    assert not any("hidden" in row for row in found.rows())
    values = [each.full_slip.f_contact / each.full_slip.contact_length for each in found]
    assert found.array("p_mean").tolist() == values
    assert [float(row["full_slip_p_mean"]) for row in rows_of(tmp_path, "table")] == values
    assert found.to_xarray()["state_p_mean"].sel(state="full_slip").values.tolist() == values
    cell = f"{1e-3 * values[1]:.2f}"
    assert str(found).splitlines()[3].split()[-1] == cell
    assert f"<td>{cell}</td>" in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_entry_of_the_package_is_everywhere(tmp_path, monkeypatch):
    """The recipe of CONTRIBUTING: an entry of OUTPUTS, and no other line."""
    monkeypatch.setattr(quantities, "OUTPUTS", (P_MEAN,))
    found = fp.run(fp.Scene(), model="cylinders", out=tmp_path)
    assert "mean pressure p_m (kPa)" in str(found)
    assert float(xarray.load_dataset(tmp_path / "result.nc")["state_p_mean"].sel(state="full_slip")) > 1e3
    assert fp.Result.load(tmp_path).full_slip.p_mean == found.full_slip.p_mean


@pytest.mark.parametrize(
    ("outputs", "words"),
    [
        (P_MEAN, "it must be a list of fingerpad.Output"),
        (["p_mean"], "it must be a list of fingerpad.Output"),
        ([fp.Output("p_mean", "Pa", max, tables={"report"})], "has the table 'report'; tables are result, sweep"),
        ([P_MEAN, fp.Output("p_mean", "Pa", max)], "called .*p_mean.*; it must have a name of its own"),
        ([fp.Output("f_t", "N/m", max)], "called .*f_t.*; it must have a name of its own"),
        ([fp.Output("mean p", "Pa", max)], "called .*mean p.*; it must have a name of its own"),
        ([fp.Output("p_mean", "Pa")], "must have a unit, such as 'kPa', and a function"),
    ],
)
def test_refused_outputs(outputs, words):
    with pytest.raises(fp.SceneError, match=words):
        fp.run(fp.Scene(), model="cylinders", outputs=outputs)


@pytest.mark.parametrize("compute", [lambda state: state.pressure, lambda state: "high"])
def test_output_that_cannot_be_computed_is_a_note(compute):
    """A run has its other numbers all the same; asked for by itself, it is refused."""
    output = fp.Output("p_mean", "Pa", compute)
    result = fp.run(fp.Scene(), model="cylinders", outputs=[output])
    assert result.full_slip.mu_app > 0.25 and "p_mean of step 0 cannot be computed" in result.notes[-1]
    with pytest.raises(fp.SceneError, match="p_mean of step 0 cannot be computed"):
        result.with_outputs([output])


@pytest.mark.parametrize(
    ("unit", "found"),
    [("kPa", ("Pa", 1e-3)), ("N/mm", ("N/m", 1e-3)), ("µm", ("m", 1e6)), ("J/m^3", ("J/m^3", 1.0)), ("", ("1", 1.0))]
    + [("clicks", ("clicks", 1.0))],
)
def test_units_of_outputs_are_turned_into_si(unit, found):
    output = fp.Output("own", unit)
    assert (output.si, output.scale) == found


def test_outputs_of_the_package():
    """A point in four sticks; the shear stress is the friction force over the length in contact, to either side."""
    slip = fp.run(model="cylinders").full_slip
    found = {each.name: each.compute for each in quantities.OUTPUTS}
    assert found["stuck_share"](replace(slip, slipping=0.75)) == 0.25
    for sign in (1, -1):
        state = replace(slip, f_t=sign * slip.f_t)
        assert found["shear_stress"](state) == pytest.approx(0.25 * slip.f_contact / slip.contact_length, rel=1e-6)
    assert found["shear_stress"](replace(slip, contact_length=0.0)) == 0.0
