"""What needs no finite elements imports none, and libraries take no configuration from a run's folder."""

import subprocess
from pathlib import Path

import pytest

from tests.commands import python

pytestmark = pytest.mark.slow
HEAVY = ("dolfinx", "ufl", "basix", "ffcx", "petsc4py", "mpi4py", "gmsh")
LIGHT = (
    "fingerpad.runs.solve",
    "fingerpad.runs.sweep",
    "fingerpad.runs.sweep_results",
    "fingerpad.results.result",
    "fingerpad.scene",
    "fingerpad.reduced.cylinders",
    "fingerpad.runs.context",
    "fingerpad.calculator.page",
    "fingerpad.model.options",
    "fingerpad.results.folder",
    "fingerpad.cli",
    "fingerpad.cli.arguments",
    "fingerpad.cli.estimate",
    "fingerpad.cli.report",
    "fingerpad.cli.roughness",
    "fingerpad.cli.params",
    "fingerpad.results.terminal",
    "variational.attraction.cylinder",
    "variational.state",
    "variational.roughness.bam",
    "variational.roughness.heightfile",
    "variational.roughness.spectrum",
    "variational.roughness.spectrum",
    "geometry.profiles",
    "geometry.sizing",
)
WORK = """
import sys
import fingerpad as fp
from fingerpad.model.options import check
from fingerpad.scene import scene
found = scene.load(None, {"voltage": 100.0})
check(found)
assert 0.25 < fp.run(found, model="cylinders").full_slip.mu_app < 0.5
assert found.closure()(1e4).d_eq > 0
table = fp.sweep(found.replace(f_ext="75 N/m"), sys.argv[1], model="cylinders", voltage=[0.0, 100.0])
assert table.array("mu_app")[1] == fp.run(found, model="cylinders").full_slip.mu_app
fp.run(fp.Scene(friction=fp.Derjaguin(0.3, 5e3)), model="cylinders")
fp.Coulomb(0.3)
"""


def without(code: str, *blocked: str, argument: str = "") -> subprocess.CompletedProcess[str]:
    """Run code where modules cannot be imported; None in ``sys.modules`` is Python's own way of saying so."""
    block = f"import sys; sys.modules.update(dict.fromkeys({blocked!r}))\n"
    return python("-c", block + code, argument)


def test_modules_import_no_finite_elements():
    """One process: a module that imports them ends it and is named."""
    code = "\n".join(f"import {module}" for module in LIGHT)
    done = without(code, *HEAVY, "pint", "rich", "SurfaceTopography")
    assert done.returncode == 0, done.stderr


def test_closed_form_works_without_finite_elements(tmp_path):
    """Read, check, run and sweep: all that a newcomer does before the first run; laws of friction are formulas.

    Nor with Matplotlib, whose import takes longer than the sweep; xarray writes its dataset.
    """
    done = without(WORK, *HEAVY, "pint", "rich", "matplotlib", argument=str(tmp_path))
    assert (done.returncode, done.stderr) == (0, "")
    assert {"report.html", "sweep.nc", "table.csv"} <= {file.name for file in tmp_path.iterdir()}


def test_scene_is_read_without_parts_of_scipy():
    """They take longer to import than all the rest that a command starts with."""
    code = "import sys, fingerpad.cli; print(*sys.modules.keys() & {'scipy.optimize', 'scipy.special', 'scipy.linalg'})"
    done = python("-c", code)
    assert done.returncode == 0 and done.stdout.strip() == "", done.stdout + done.stderr


# -- libraries take no configuration from the folder that a run is started in, and none from the home folder ---------
# A file that each library reads when it is started in its folder, and what shows that it was read.
FOUND = {
    ".petscrc": "-found 1",
    "petscrc": "-found 1",
    "petsc.cfg": "PETSC_ARCH = {folder}",
    "dolfinx_jit_options.json": '{{"cffi_libraries": ["found"]}}',
    "ffcx_options.json": '{{"epsilon": 77}}',
    "matplotlibrc": "lines.linewidth: 77",
    "ucx.conf": "UCX_LOG_LEVEL=debug",
    "sitecustomize.py": "raise SystemExit('found')",
    "usercustomize.py": "raise SystemExit('found')",
    "mpi4py.py": "raise SystemExit('found')",
}
STATE = """
import dolfinx.jit, ffcx.options, matplotlib
from petsc4py import PETSc
print(PETSc.Options().hasName("found"), dolfinx.jit.get_options()["cffi_libraries"])
print(ffcx.options.get_options()["epsilon"], matplotlib.rcParams["lines.linewidth"])
"""


def run(folder: Path, code: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return python("-P", "-W", "ignore", "-c", code, cwd=folder, **environment)


@pytest.fixture(scope="module")
def clean(tmp_path_factory) -> str:
    done = run(tmp_path_factory.mktemp("clean"), "import fingerpad.startup" + STATE)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_nothing_is_taken_from_the_current_folder(tmp_path, clean):
    for name, text in FOUND.items():
        (tmp_path / name).write_text(text.format(folder=tmp_path))
    done = run(tmp_path, "import fingerpad.runs.full" + STATE)
    assert (done.returncode, done.stdout) == (0, clean), done.stderr
    assert "UCX" not in done.stderr


def test_without_it_they_would_be(tmp_path, clean):
    """What the test above is worth: libraries of this version do read these files."""
    for name in (".petscrc", "ffcx_options.json", "matplotlibrc", "dolfinx_jit_options.json"):
        (tmp_path / name).write_text(FOUND[name].format())
    done = run(tmp_path, STATE)
    assert done.stdout == "True ['found']\n77 77.0\n"


def test_modules_of_the_current_folder_are_not_run(tmp_path):
    """Processes of a sweep are started with python3 -m, which looks there first."""
    (tmp_path / "numpy.py").write_text("raise SystemExit('found')")
    job = "processes.run('fingerpad.runs.solve', ['no.json', '.', '9', 'full'], 9).message"
    code = f"from fingerpad.runs import processes; print({job})"
    assert "No such file or directory: 'no.json'" in run(tmp_path, code).stdout
