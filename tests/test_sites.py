"""Energy densities at the mechanoreceptors' sites in the named states: in sweeps and reports, as in the tables."""

from pathlib import Path

import numpy as np
import pytest
import xarray
from mpi4py import MPI

import fingerpad as fp
from fingerpad.io.result import Result
from fingerpad.report import run_page
from fingerpad.runs.sweep_results import Sweep
from fingerpad.scene import from_data
from tests.runs import run
from tests.test_dataset import SCENE, rows_of


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """A run with three loads, of seconds."""
    found = tmp_path_factory.mktemp("run")
    run(from_data(SCENE), found, MPI.COMM_SELF)
    return found


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


def test_sites_without_a_voltage_are_those_of_both_names(tmp_path):
    """Uncharged and charged normal contact are one step then."""
    run(from_data(SCENE | {"history": SCENE["history"][:1]}), tmp_path, MPI.COMM_SELF)
    result = Result.load(tmp_path)
    assert result.uncharged.step == result.charged.step
    np.testing.assert_array_equal(result.uncharged.sites.merkel, result.charged.sites.merkel)
    assert np.isfinite(result.charged.sites.merkel).all() and 'id="receptors"' in run_page.page(result)


def test_report_has_the_sites_of_the_table(folder):
    """The largest energy density of each named state, and that of each ridge."""
    result = Result.load(folder)
    page = run_page.page(result)
    assert 'href="#receptors"' in page
    part = page[page.index('id="receptors"') :]
    part = part[: part.index("</section>")]
    rows = [row for row in rows_of(folder, "receptors") if int(row["step"]) == result.charged.step]
    most = max(rows, key=lambda row: float(row["merkel_sed"]))
    first = part[: part.index("Every ridge")]
    assert f"<td>{1e-3 * float(most['merkel_sed']):.4g}</td>" in first and f"<td>{most['ridge']}</td>" in first
    for row in rows:
        assert f"<td>{1e-3 * float(row['merkel_sed']):.4g}</td>" in part
    assert "receptors" not in run_page.page(fp.run(model="cylinders")).partition("</nav>")[0]
