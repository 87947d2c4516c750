"""What the tests of the command fingerpad and of processes have in common."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from fingerpad.cli import main

ROOT = Path(__file__).parent.parent
COARSE = ("mesh.contact=30e-6", "mesh.receptor=80e-6", "mesh.interface=120e-6", "mesh.growth=0.5")


def refused(capsys: pytest.CaptureFixture[str], *argv: str) -> str:
    """Return the sentence by which the command refuses its arguments."""
    assert main(argv) == 2
    out, err = capsys.readouterr()
    assert out == "" and err.startswith("fingerpad: ") and err.count("\n") == 1
    return err.removeprefix("fingerpad: ")


def python(
    *words: object, ranks: int = 1, cwd: Path | None = None, **variables: str
) -> subprocess.CompletedProcess[str]:
    """Run Python in a process of its own, or in more, where the modules of the checkout are found."""
    launcher = ["mpirun", "-n", str(ranks)] if ranks > 1 else []
    environment = {**os.environ, "PYTHONPATH": str(ROOT), **variables}
    command = [*launcher, sys.executable, *map(str, words)]
    return subprocess.run(command, cwd=cwd, env=environment, capture_output=True, text=True, check=False, timeout=600)


def kept(file: str) -> dict:
    """Return the numbers of a file in docs."""
    return json.loads((ROOT / "docs" / file).read_text(encoding="utf-8"))["numbers"]
