"""environment/docs, with a stand-in for the private root: what is got from PyPI, once, and what is said."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.test_lint import ROOT, script

# Installs as pip does, from nowhere; other commands are told and not run.
ENTER = """#!/bin/bash
[ "$2" != -c ] || { echo "3.13.5 x86_64"; exit; }
for word in "$@"; do [ "$word" = pip ] && installs=yes; done
[ -n "$installs" ] || { echo "run $*"; exit; }
[ -z "$OFFLINE" ] || { echo "no network"; exit 1; }
while [ "$1" != --target ]; do shift; done
mkdir -p "$2" && echo "${@:3}" >"$2/wanted"
"""


@pytest.fixture
def docs(tmp_path):
    """Return a function that runs the script in a checkout whose root is a stand-in."""
    checkout = tmp_path / "checkout"
    (checkout / "environment").mkdir(parents=True)
    for name in ("docs", "pip"):
        shutil.copy(ROOT / "environment" / name, checkout / "environment")
    shutil.copy(ROOT / "pyproject.toml", checkout)
    script(checkout / "environment/run", ENTER)

    def run(*words: str, **more: str) -> subprocess.CompletedProcess[str]:
        variables = {name: value for name, value in os.environ.items() if name != "FINGERPAD_ROOT"}
        variables |= {"XDG_CACHE_HOME": str(tmp_path / "cache")} | more
        command = [checkout / "environment/docs", *words]
        return subprocess.run(command, env=variables, capture_output=True, text=True, check=False)

    return run


def test_sphinx_is_got_once(docs):
    """In the versions of pyproject.toml; then a build starts at once."""
    first, second = docs("--get"), docs("out", "-v")
    assert (first.returncode, first.stdout) == (0, "")
    assert first.stderr.startswith("fingerpad: getting Sphinx from PyPI") and first.stderr.count("\n") == 1
    place = Path(docs("--place").stdout.strip())
    wanted = (place / "wanted").read_text().split()
    assert [name.partition("==")[0] for name in wanted] == ["sphinx", "myst-parser", "furo", "math-core"]
    assert all("==" in name for name in wanted)
    assert (second.returncode, second.stderr) == (0, "")
    command = second.stdout.split()
    assert command[:4] == ["run", "python3", "-m", "sphinx"] and command[-3:] == ["-v", ".", "out"]
    assert {path.name for path in place.parent.iterdir()} == {place.name, "docs.lock", "docs.log"}


def test_without_a_network(docs):
    """One sentence, and nothing is left that looks whole."""
    done = docs("--get", OFFLINE="yes")
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1].startswith("fingerpad: Sphinx cannot be had from PyPI; is there a network?")
    assert not Path(docs("--place").stdout.strip()).exists()
