"""Every way of installing names the packages of environment/packages.txt, and the same versions of dolfinx."""

import os
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest

from tests.commands import python

ROOT = Path(__file__).parent.parent
LIBRARY = ("geometry", "variational", "fingerpad")


def _column(number: int, *uses: str) -> set[str]:
    """Return a column of the list for rows of the given uses, without dashes."""
    lines = (ROOT / "environment/packages.txt").read_text().splitlines()
    rows = [line.split() for line in lines if line and not line.startswith("#")]
    assert all(len(row) == 5 for row in rows)
    return {row[number] for row in rows if row[0] in uses} - {"-"}


def _split(requirements: list[str]) -> dict[str, str]:
    """Return version ranges by name."""
    pairs = [re.fullmatch(r"([A-Za-z0-9_.-]+)\s*(.*)", text).groups() for text in requirements]
    assert len(dict(pairs)) == len(pairs), "a package is listed twice"
    return dict(pairs)


@pytest.fixture
def project() -> dict:
    return tomllib.loads((ROOT / "pyproject.toml").read_text())


@pytest.fixture
def conda() -> dict[str, str]:
    text = (ROOT / "environment.yml").read_text().split("dependencies:\n")[1]
    return _split(re.findall(r"^  - (.+)$", text, flags=re.MULTILINE))


def test_conda(conda, project):
    assert conda.pop("python") == project["project"]["requires-python"]
    assert set(conda) == _column(2, "run", "fem", "test", "system")


def test_pypi(project):
    assert set(_split(project["project"]["dependencies"])) == _column(3, "run")
    extras = project["project"]["optional-dependencies"]
    found = {name: set(_split(listed)) for name, listed in extras.items()}
    # gmsh is on PyPI under its own name; the other finite elements are in the wheel or come with it.
    assert found.pop("pip") == _column(3, "pip") | {"gmsh"}
    assert found == {name: _column(3, name) for name in ("fem", "test", "docs", "topography", "pyvista", "uncertainty")}


def test_wheel_of_dolfinx_is_pinned(project):
    """The version of the extra is the one whose content environment/wheel.txt fixes, and a dolfinx of ours."""
    lines = (ROOT / "environment/wheel.txt").read_text().splitlines()
    pinned = [line for line in lines if not line.startswith("#")]
    assert len(pinned) == 1
    requirement, sum_ = pinned[0].split(" --hash=sha256:")
    assert requirement in project["project"]["optional-dependencies"]["pip"]
    assert re.fullmatch(r"[0-9a-f]{64}", sum_)
    assert requirement.partition("==")[2].startswith("0.11.")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> zipfile.ZipFile:
    """The wheel of this checkout, built with what is installed: no network."""
    folder = tmp_path_factory.mktemp("wheel")
    for name in ("pyproject.toml", "README.md", "LICENSE", "COPYING"):
        shutil.copy(ROOT / name, folder)
    for name in LIBRARY:
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    options = ["--no-build-isolation", "--no-deps", "--no-index", "--quiet", "--disable-pip-version-check"]
    command = [sys.executable, "-m", "pip", "wheel", *options, "--wheel-dir", str(folder), str(folder)]
    subprocess.run(command, check=True, capture_output=True, cwd=folder)
    return zipfile.ZipFile(next(folder.glob("fingerpad-*.whl")))


@pytest.mark.slow
def test_wheel_holds_the_library(wheel):
    """Each module of it, the marks of its types and the parts of its pages; nothing of tests, benchmarks and demos."""
    files = [file for top in LIBRARY for file in (ROOT / top).rglob("*") if file.is_file()]
    whole = {file.relative_to(ROOT) for file in files if "__pycache__" not in file.parts}
    marks = {Path(top) / "py.typed" for top in LIBRARY}
    listed = {Path(name) for name in wheel.namelist() if ".dist-info/" not in name}
    assert listed == whole and marks < listed


@pytest.mark.slow
def test_wheel_runs(wheel, tmp_path):
    """By itself, away from the checkout: nothing that it needs is left out of it."""
    wheel.extractall(tmp_path)
    code = 'import fingerpad as fp; print(fp.__file__, fp.run(fp.Scene(f_ext=50), model="cylinders").full_slip.mu_app)'
    done = python("-c", code, PYTHONPATH=str(tmp_path), PYTHONSAFEPATH="1")
    assert done.stdout.startswith(str(tmp_path / "fingerpad/__init__.py 0.")), done.stderr


# -- environment/lint, docs, wheels and venv -------------------------------------------------------------------------
# A Python that lacks something for the wheel, or nothing; it makes an empty venv, and writes what it is to install.
PYTHON = f"""#!/bin/bash
case "$*" in
    *ensurepip*) echo "$LACKS" ;;
    *"-m venv"*) mkdir -p "$4/bin" && cp "$0" "$4/bin/python3" ;;
    *"-m pip"*) [ -z "$OFFLINE" ] || {{ echo "ERROR: no network" >&2; exit 1; }}; echo "$@" >>"$TOLD" ;;
    *) exec {sys.executable} "$@" ;;
esac
"""


def script(file: Path, text: str) -> None:
    file.parent.mkdir(exist_ok=True)
    file.write_text(text)
    file.chmod(0o755)


# -- the venv ------------------------------------------------------------------------------------------
@pytest.fixture
def variables(tmp_path) -> dict[str, str]:
    """Variables under which the stand-in, in a folder with a space in its name, is the Python to take."""
    script(tmp_path / "my bin" / "python", PYTHON)
    more = {"PYTHON": str(tmp_path / "my bin" / "python"), "TOLD": str(tmp_path / "told"), "SUITE": "pip"}
    return {**os.environ, "XDG_CACHE_HOME": str(tmp_path / "cache"), **more}


def call(name: str, *words: str, **variables: str) -> subprocess.CompletedProcess[str]:
    command = [ROOT / "environment" / name, *words]
    return subprocess.run(command, env=variables, capture_output=True, text=True, check=False)


def test_venv_is_made_once(tmp_path, variables):
    """The wheel first, by its hash and alone; then the rest. Without a network nothing is left."""
    failed = call("venv", **variables, OFFLINE="yes")
    assert (failed.returncode, failed.stdout) == (1, "")
    assert "could not be made: " in failed.stderr and "is there a network?" in failed.stderr
    assert not list((tmp_path / "cache" / "fingerpad").glob("pip-*/whole"))
    done = call("venv", **variables)
    place = Path(done.stdout.strip())
    assert done.returncode == 0 and (place / "whole").exists() and place.parent == tmp_path / "cache" / "fingerpad"
    wheel, rest = (tmp_path / "told").read_text().splitlines()
    assert f"--no-deps --require-hashes -r {ROOT}/environment/wheel.txt" in wheel
    assert rest.endswith(f"-r {place}/packages.txt")
    assert "dolfinx-solver-real==" in (place / "packages.txt").read_text()
    again = call("venv", **variables)
    assert (again.stdout, again.stderr) == (done.stdout, "")


@pytest.mark.parametrize("name", ["venv", "run"])
def test_what_a_venv_lacks_is_one_sentence(variables, name):
    lacks = "python3 is Python 3.11.2, and dolfinx from PyPI needs 3.12 or newer"
    done = call(name, "true", **variables, LACKS=lacks)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (1, "", 1)
    assert done.stderr.startswith(f"fingerpad: {lacks}; or name another Python")
