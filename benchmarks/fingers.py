"""Fingers by name beside each other: friction by the closed form and by the full model, and where their keys are from.

environment/run python3 -m benchmarks.fingers [--draw]     a run for each finger, some five minutes of processor time

Each finger bears about the same force. Writes docs/fingers.json, docs/fingers.md and its picture.
"""

import argparse
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from benchmarks import harness
from fingerpad.reduced.registry import find
from fingerpad.results import style
from fingerpad.runs.batch import Summary
from fingerpad.runs.context import RunContext
from fingerpad.runs.solve import solved
from fingerpad.scene import Scene, SceneError
from fingerpad.scene.fingers import ADULT, FINGERS
from fingerpad.scene.keys import every
from fingerpad.slices.estimate import with_newtons

FORCE = 0.5  # N, about, on each finger
VOLTAGE = 200.0  # V
_LIMIT = 1800.0  # s of processor time of a run


def scenes() -> dict[str, Scene]:
    """Return the scene of each finger, under the force per length at its centre that makes up about :data:`FORCE`."""
    found = {}
    for name in FINGERS:
        f_ext = Scene(finger=name, force=FORCE).centre_force
        found[name] = Scene(finger=name, f_ext=float(f"{f_ext:.4g}"), voltage=VOLTAGE, output={"receptors": False})
    return found


def compute(args: argparse.Namespace) -> None:
    """Compute and keep the numbers."""
    import fingerpad.startup  # noqa: F401

    summaries = harness.run(scenes(), args, _LIMIT)
    numbers = {name: _numbers(name, scene, summaries[name]) for name, scene in scenes().items()}
    harness.keep("fingers", numbers, harness.made(summaries.values()), args.docs)


def _numbers(name: str, scene: Scene, summary: Summary) -> dict[str, Any]:
    """Return the numbers of a finger: of its run, and of the closed form where that has its contact."""
    slip, whole = summary.get("full_slip"), summary.get("finger")
    found: dict[str, Any] = {"f_ext": scene.f_ext, "mu_0": scene.friction, "h_0": scene.h_0}
    found["failure"] = summary.get("failure")
    for key in ("mu_app", "mu_app_error", "contact_length", "ridges_in_contact"):
        found[key] = summary.get(f"full_slip_{key}")
    found["force"] = whole["f_ext"] if whole else None
    found["whole"] = whole["states"]["full_slip"]["mu_app"] if whole and slip else None
    try:
        closed = with_newtons(solved(scene, find("cylinders"), RunContext()))
        found["closed"] = {"mu_app": closed.full_slip.mu_app}
    except SceneError as error:
        found["closed"] = {"refused": str(error)}
    return found
