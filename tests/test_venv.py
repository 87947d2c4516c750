"""environment/venv, and what environment/run makes of it, with stand-ins for Python: no package is fetched."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from fingerpad.installed import COMPILER, need_compiler
from tests.test_environment import script
from tests.test_lint import ROOT

# A Python that lacks something for the wheel, or nothing; it makes an empty venv, and writes what it is to install.
PYTHON = f"""#!/bin/bash
case "$*" in
    *ensurepip*) echo "$LACKS" ;;
    *"-m venv"*) mkdir -p "$4/bin" && cp "$0" "$4/bin/python3" ;;
    *"-m pip"*) [ -z "$OFFLINE" ] || {{ echo "ERROR: no network" >&2; exit 1; }}; echo "$@" >>"$TOLD" ;;
    *) exec {sys.executable} "$@" ;;
esac
"""


@pytest.fixture
def variables(tmp_path) -> dict[str, str]:
    """Variables under which the stand-in, in a folder with a space in its name, is the Python to take."""
    script(tmp_path / "my bin" / "python", PYTHON)
    more = {"PYTHON": str(tmp_path / "my bin" / "python"), "TOLD": str(tmp_path / "told"), "SUITE": "pip"}
    return {**os.environ, "XDG_CACHE_HOME": str(tmp_path / "cache"), **more}


def call(name: str, *words: str, **variables: str) -> subprocess.CompletedProcess[str]:
    command = [ROOT / "environment" / name, *words]
    return subprocess.run(command, env=variables, capture_output=True, text=True, check=False)


def test_made_once(tmp_path, variables):
    """The wheel first, by its hash and alone; then the rest. Nothing is printed but the path when it is there."""
    done = call("venv", **variables)
    place = Path(done.stdout.strip())
    assert done.returncode == 0 and (place / "whole").exists() and place.parent == tmp_path / "cache" / "fingerpad"
    wheel, rest = (tmp_path / "told").read_text().splitlines()
    assert f"--no-deps --require-hashes -r {ROOT}/environment/wheel.txt" in wheel
    assert rest.endswith(f"-r {place}/packages.txt")
    assert "dolfinx-solver-real==" in (place / "packages.txt").read_text()
    again = call("venv", **variables)
    assert (again.stdout, again.stderr) == (done.stdout, "")


def test_not_made_without_a_network(tmp_path, variables):
    done = call("venv", **variables, OFFLINE="yes")
    assert (done.returncode, done.stdout) == (1, "")
    assert "could not be made: ERROR: no network; is there a network?" in done.stderr
    assert not list((tmp_path / "cache" / "fingerpad").glob("pip-*/whole"))


@pytest.mark.parametrize("name", ["venv", "run"])
def test_what_is_missing_is_one_sentence(variables, name):
    lacks = "python3 is Python 3.11.2, and dolfinx from PyPI needs 3.12 or newer"
    done = call(name, "true", **variables, LACKS=lacks)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (1, "", 1)
    assert done.stderr.startswith(f"fingerpad: {lacks}; or name another Python")


def test_no_compiler(monkeypatch):
    monkeypatch.setenv("CC", "nosuchcompiler -O2")
    with pytest.raises(ImportError, match="nosuchcompiler is not on the path; .* gcc") as found:
        need_compiler()
    assert found.value.name == COMPILER
