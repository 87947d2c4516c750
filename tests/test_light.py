"""What needs no finite elements imports none: scenes, the microscale and the closed form run with NumPy and SciPy."""

import subprocess
import sys

import pytest

HEAVY = ("dolfinx", "ufl", "basix", "ffcx", "petsc4py", "mpi4py", "gmsh")
LIGHT = (
    "fingerpad.scene",
    "fingerpad.closed_form",
    "fingerpad.rungs",
    "fingerpad.needs",
    "fingerpad.budget",
    "fingerpad.place",
    "fingerpad.cli",
    "fingerpad.cli.arguments",
    "fingerpad.cli.estimate",
    "fingerpad.cli.microscale",
    "fingerpad.cli.params",
    "fingerpad.cli.topography",
    "fingerpad.terminal",
    "variational.cylinder",
    "variational.roughness.bam",
    "variational.roughness.heightfile",
    "variational.roughness.selfaffine",
    "variational.roughness.spectrum",
    "geometry.profiles",
    "geometry.sizing",
)
WORK = """
from fingerpad import budget, closed_form, scene
found = scene.load(None, {"voltage": 100.0})
scene.check(found)
assert 0.3 < closed_form.solve(found).summary["slip_mu_app"] < 0.5
assert found.roughness.bearing_area(found.h_0)(1e4).d_eq > 0
assert budget.estimate(found).memory > 1e8
"""


def without(code: str, *blocked: str) -> subprocess.CompletedProcess[str]:
    """Run code where modules cannot be imported; None in ``sys.modules`` is Python's own way of saying so."""
    block = f"import sys; sys.modules.update(dict.fromkeys({blocked!r}))\n"
    return subprocess.run([sys.executable, "-c", block + code], capture_output=True, text=True, check=False)


@pytest.mark.parametrize("module", LIGHT)
def test_module_imports_no_finite_elements(module):
    done = without(f"import {module}", *HEAVY, "pint", "rich")
    assert done.returncode == 0, done.stderr


def test_scene_and_closed_form_work_without_finite_elements():
    """Read, check, estimate and answer: all that a newcomer does before the first run."""
    done = without(WORK, *HEAVY, "pint", "rich")
    assert done.returncode == 0, done.stderr


def test_what_is_blocked_is_blocked():
    """Without this the tests above would hold of any module."""
    assert "ModuleNotFoundError" in without("import variational.ogden", *HEAVY).stderr
