"""What the tests of the command fingerpad have in common."""

import json
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


def kept(file: str) -> dict:
    """Return the numbers of a file in docs."""
    return json.loads((ROOT / "docs" / file).read_text(encoding="utf-8"))["numbers"]
