"""Measured fingers beside this model's numbers, row by row.

environment/run python3 -m benchmarks.measured [--jobs 2] [--draw]

Most numbers are those of docs/paper.json and docs/models.json (make paper, benchmarks.models). Six runs of an uncharged
press are made here, some ten seconds each. Writes docs/measured.json, and from it docs/measured.md and its picture.
"""

import argparse
import sys
from pathlib import Path
from typing import Any

from benchmarks.harness import keep, made, main, run
from benchmarks.measured import page, scenes
from benchmarks.runs import Run
from fingerpad.scene import Scene

_LIMIT = 600.0  # s of processor time for one run


def numbers(scene: Scene, out: Path) -> dict[str, Any]:
    """Return what the page has of a pressed finger: its contact length (m), touching ridges and their pressures (Pa).

    Places (m) and pressures are of each touching ridge; a pressure is the contact force over the ridge's wavelength.
    """
    found, wavelength = Run(scene, out), scene.geometry.ridge_wavelength
    ridges, force = found.on_ridges(found.pressed, "f_contact")
    length = float(found.steps["contact_length"][found.pressed])
    along = {"place": (ridges * wavelength).tolist(), "pressure": (force / wavelength).tolist()}
    return {"length": length, "ridges": len(ridges)} | along


def compute(args: argparse.Namespace) -> None:
    """Run what is missing and keep the numbers."""
    wanted = scenes.scenes()
    summaries = run(wanted, args, _LIMIT)
    keep(
        "measured",
        {"runs": {name: numbers(s, args.out) for name, s in wanted.items()}},
        made(summaries.values()),
        args.docs,
    )


if __name__ == "__main__":
    sys.exit(main(__doc__, compute, page.draw))
