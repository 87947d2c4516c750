"""Fingers by name beside each other: friction by the closed form and by the full model, and where their keys are from.

environment/run python3 -m benchmarks.fingers [--draw]     a run for each finger on coarse elements, some three
minutes of processor time

Each finger bears about the same force. Writes docs/fingers.json, docs/fingers.md and its picture.
"""

import argparse
import re
import sys
from collections.abc import Mapping
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
from fingerpad.scene.fingers import FINGERS, Trait

FORCE = 0.5  # N, about, on each finger
VOLTAGE = 200.0  # V
_COARSE = {"contact": 20e-6, "receptor": 40e-6, "interface": 120e-6, "growth": 0.5}  # m, but for the growth
_LIMIT = 1800.0  # s of processor time of a run


def scenes() -> dict[str, Scene]:
    """Return the scene of each finger, under the force per length at its centre that makes up about :data:`FORCE`."""
    found, quick = {}, {"receptors": False, "errors": False, "each_load": False}
    for name in FINGERS:
        f_ext = float(f"{Scene(finger=name, force=FORCE).centre_force:.4g}")
        found[name] = Scene(finger=name, f_ext=f_ext, voltage=VOLTAGE, mesh=_COARSE, output=quick)
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
    for key in ("mu_app", "contact_length", "ridges_in_contact"):
        found[key] = summary.get(f"full_slip_{key}")
    found["force"] = whole["f_ext"] if whole else None
    found["whole"] = whole["states"]["full_slip"]["mu_app"] if whole and slip else None
    try:
        closed = solved(scene, find("cylinders"), RunContext()).full_slip
        found["closed"] = closed.mu_app if closed is not None else None
    except SceneError:  # of a finger whose contact the closed form does not have
        found["closed"] = None
    return found


# -- page ----------------------------------------------------------------------------------------------------
def draw(docs: Path) -> Path:
    """Write docs/fingers.md and its picture from docs/fingers.json."""
    numbers = harness.kept("fingers", docs).numbers
    harness.picture(docs / "fingers.png", (8, 3.8), lambda figure: _paint(figure, numbers))
    return harness.page(docs, "fingers", "python3 -m benchmarks.fingers", globals())


def _paint(figure: Figure, numbers: Mapping[str, Any]) -> None:
    ax = figure.subplots()
    places = {name: -k for k, name in enumerate(numbers)}
    for name, found in numbers.items():
        ax.plot([found.mu_0, found.whole], [places[name]] * 2, color=style.BLUE, lw=2, zorder=1)
    looks: list[tuple[str, str, dict[str, Any]]] = [
        ("mu_0", "without voltage, µ_0", {"marker": "o", "mfc": "white", "color": style.BLUE, "ms": 8}),
        ("whole", f"{VOLTAGE:g} V, whole finger, full", {"marker": "o", "color": style.BLUE, "ms": 8}),
        ("mu_app", f"{VOLTAGE:g} V, section at its centre, full", {"marker": "|", "color": style.BLACK, "ms": 12}),
        ("closed", f"{VOLTAGE:g} V, section at its centre, closed form", {"marker": "x", "color": style.VERMILION}),
    ]
    for key, label, look in looks:
        known = {name: found[key] for name, found in numbers.items() if found[key] is not None}
        ax.plot(list(known.values()), [places[name] for name in known], ls="none", label=label, **look)
    ax.set_yticks(list(places.values()), list(places))
    ax.set(xlabel="friction coefficient µ_app at full slip (–)", xlim=(0, None))
    ax.grid(axis="x", alpha=0.3)
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)


def value(key: str, number: Any) -> str:
    """Return a value of a finger as a scene file has it."""
    return f'`{key} = "{number}"`' if isinstance(number, str) else f"`{key} = {number:g}`"


def source(trait: Trait) -> str:
    """Return where a trait's values are from, with links and the assumptions marked."""
    text = re.sub(r"doi (10\.[^\s,;)]+)", r"[doi \1](https://doi.org/\1)", trait.source)
    return text.replace("Assumption", "*Assumption*").replace("docs/drive.md", "[drive.md](drive.md)")


if __name__ == "__main__":
    sys.exit(harness.main(__doc__, compute, draw))
