"""Measured fingers beside this model's numbers, row by row.

environment/run python3 -m benchmarks.measured [--jobs 2] [--draw]

Most numbers are those of docs/paper.json and docs/models.json (make paper, benchmarks.models), to be made again after
them. Eight runs of an uncharged press are made here, some ten seconds each. Writes docs/measured.json, and from it
docs/measured.md and its picture.
"""

import argparse
import sys
from pathlib import Path
from typing import Any

from benchmarks.harness import keep, kept, made, main, run
from benchmarks.measured import page, rows, scenes
from benchmarks.runs import Run
from fingerpad.scene import Scene

_LIMIT = 600.0  # s of processor time for one run


def pressed(scene: Scene, out: Path) -> dict[str, Any]:
    """Return what the page has of a pressed finger: its contact length (m), touching ridges and their pressures (Pa).

    Places (m) and pressures are of each touching ridge; a pressure is the contact force over the ridge's wavelength.
    """
    found, wavelength = Run(scene, out), scene.geometry.ridge_wavelength
    ridges, force = found.on_ridges(found.pressed, "f_contact")
    length = float(found.steps["contact_length"][found.pressed])
    along = {"place": (ridges * wavelength).tolist(), "pressure": (force / wavelength).tolist()}
    return {"length": length, "ridges": len(ridges)} | along


def numbers(runs: dict[str, Any], docs: Path) -> dict[str, Any]:
    """Return the numbers of the page from runs of :func:`pressed` and the kept numbers of the other pages."""
    grid = rows.grid(kept("paper", docs).numbers, kept("models", docs).numbers)
    judged = {
        key: {"numbers": {name: float(value) for name, value in found.items()}, "verdict": verdict}
        for key, (found, verdict) in rows.numbers(grid, runs).items()
    }
    return {"runs": runs, "rows": judged, "curves": rows.curves(grid)}


def compute(args: argparse.Namespace) -> None:
    """Run what is missing and keep the numbers."""
    wanted = scenes.scenes()
    summaries = run(wanted, args, _LIMIT)
    runs = {name: pressed(scene, args.out) for name, scene in wanted.items()}
    keep("measured", numbers(runs, args.docs), made(summaries.values()), args.docs)


if __name__ == "__main__":
    sys.exit(main(__doc__, compute, page.draw))
