"""environment/lint, with stand-ins for ruff and the private root: which ruff is used, and what is said without one."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
VERSION = "0.17.6"
RUFF = """#!/bin/sh
[ "$1" = --version ] && echo "ruff {version}" && exit
echo "ruff {version} $*"
"""
# Installs ruff as pip does, from nowhere; other commands are told and not run.
ENTER = """#!/bin/bash
while [ $# -gt 0 ] && [ "$1" != --target ]; do words+=("$1"); shift; done
[ "$1" = --target ] || { echo "run ${words[*]}"; exit; }
[ -z "$OFFLINE" ] || { echo "no network"; exit 1; }
mkdir -p "$2/bin" && cp "$STAND_IN" "$2/bin/ruff"
"""


@pytest.fixture
def lint(tmp_path):
    """Return a function that runs lint in a checkout with a ruff of some version on the path."""
    checkout, tools = tmp_path / "checkout", tmp_path / "bin"
    (checkout / "environment").mkdir(parents=True)
    tools.mkdir()
    for name in ("lint", "pip"):
        shutil.copy(ROOT / "environment" / name, checkout / "environment")
    (checkout / "pyproject.toml").write_text(f'test = ["pytest", "ruff=={VERSION}"]\n')
    script(checkout / "environment/run", ENTER)
    script(tmp_path / "ruff", RUFF.format(version=VERSION))

    def run(on_path: str, **more: str) -> subprocess.CompletedProcess[str]:
        script(tools / "ruff", RUFF.format(version=on_path))
        variables = {"PATH": f"{tools}:{os.environ['PATH']}", "XDG_CACHE_HOME": str(tmp_path / "cache")}
        variables |= {"STAND_IN": str(tmp_path / "ruff")} | more
        command = [checkout / "environment/lint"]
        return subprocess.run(command, env=os.environ | variables, capture_output=True, text=True, check=False)

    return run


def script(file: Path, text: str) -> None:
    file.write_text(text)
    file.chmod(0o755)


CHECKS = [f"ruff {VERSION} check .", f"ruff {VERSION} format --check .", "run mypy"]


def test_ruff_of_another_version(lint):
    """The one named is fetched once."""
    first, second = lint("0.0.1"), lint("0.0.1")
    assert first.stderr.startswith(f"fingerpad: getting ruff {VERSION} from PyPI") and first.stderr.count("\n") == 1
    assert (first.stdout.splitlines()[-3:], first.returncode) == (CHECKS, 0)
    assert (second.stderr, second.stdout.splitlines()) == ("", CHECKS)


def test_ruff_that_cannot_be_had(lint):
    done = lint("0.0.1", OFFLINE="yes")
    assert done.returncode == 1
    last = done.stderr.splitlines()[-1]
    assert last.startswith(f"fingerpad: ruff {VERSION} cannot be had from PyPI; is there a network?")
