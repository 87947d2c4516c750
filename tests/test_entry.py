"""Libraries take no configuration from the folder that a run is started in, and none from the home folder."""

import subprocess
from pathlib import Path

import pytest

from tests.commands import python

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
