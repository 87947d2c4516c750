"""Fingers by name beside each other by the closed form: their contact, their friction, and where their keys are from.

environment/run python3 -m benchmarks.fingers [--draw]     also: make fingers; some minutes, mostly for presses

Each finger has one press (:mod:`fingerpad.reduced.press`). Voltages are compared under one drive in the circuit of each
finger, with its leak. Writes docs/fingers.json, numbers of docs/fingers.md and a picture.
"""

import argparse
import re
import sys
from collections.abc import Mapping
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

import fingerpad as fp
from benchmarks import harness
from fingerpad.results.pictures import style
from fingerpad.scene import Scene, SceneError
from fingerpad.scene.fingers import FINGERS, Trait

FORCE = 1.0  # N, on each finger
VOLTAGE = 150.0  # V, rms
FREQUENCY = 100.0  # Hz, of the one drive of all fingers, a sine with VOLTAGE as rms
CONTRAST = 20  # %, rise of µ_app by the voltage
_BETWEEN = [1.0, 1000.0]  # V
_DRIVE = {"waveform": "sine", "rms": VOLTAGE, "frequency": FREQUENCY}


def compute(args: argparse.Namespace) -> None:
    """Compute and keep the numbers."""
    import fingerpad.startup  # noqa: F401

    harness.keep("fingers", {name: _finger(name) for name in FINGERS}, harness.made(), args.docs)


def _finger(name: str) -> dict[str, Any]:
    """Return a finger's contact and friction at full slip, without voltage and under the drive."""
    still = fp.run(Scene(finger=name, force=FORCE, voltage=0.0), model="cylinders").finger
    driven = Scene(finger=name, force=FORCE, voltage=_DRIVE)
    moved = fp.run(driven, model="cylinders").finger
    assert still is not None and moved is not None
    press, slip = still.values("uncharged"), still.values("full_slip")
    needs = None
    with suppress(SceneError):  # a shear stress on the ridges hardly grows with the voltage
        (needs,) = fp.solve(driven, "voltage.rms", mu_app=1 + CONTRAST / 100, relative=True, between=_BETWEEN).values
    found: dict[str, Any] = {key: press[key] for key in ("indentation", "gross_area", "contact_area")}
    found |= {"mu_0": slip["mu_app"], "driven": moved.values("full_slip")["mu_app"], "needs": needs}
    return found | {"leak": str(driven.electric.leak), "words": FINGERS[name].words}


# -- page ----------------------------------------------------------------------------------------------------
def draw(docs: Path) -> Path:
    """Put the numbers of docs/fingers.json into docs/fingers.md and draw its picture."""
    numbers = harness.kept("fingers", docs).numbers
    harness.picture(docs / "fingers.png", (8, 3.8), lambda figure: _paint(figure, numbers))
    names = {"share": partial(_share, numbers), "rise": partial(_rise, numbers)}
    return harness.page(docs, "fingers", "make fingers", globals() | names)


def _paint(figure: Figure, numbers: Mapping[str, Any]) -> None:
    ax = figure.subplots()
    places = {name: -k for k, name in enumerate(numbers)}
    for name, found in numbers.items():
        ax.plot([found.mu_0, found.driven], [places[name]] * 2, color=style.BLUE, lw=2, zorder=1)
    looks = [("mu_0", "without voltage", "white"), ("driven", f"{VOLTAGE:g} V rms, {FREQUENCY:g} Hz", style.BLUE)]
    for key, label, face in looks:
        values = [found[key] for found in numbers.values()]
        ax.plot(values, list(places.values()), "o", color=style.BLUE, mfc=face, ms=8, label=label)
    ax.set_yticks(list(places.values()), list(places))
    ax.set(xlabel="friction coefficient µ_app of the whole finger at full slip, 1 N (–)", xlim=(0, None))
    ax.grid(axis="x", alpha=0.3)
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)


def _share(numbers: Mapping[str, Any], name: str) -> float:
    """Return the area of the ridges in contact over the gross area."""
    return float(numbers[name]["contact_area"] / numbers[name]["gross_area"])


def _rise(numbers: Mapping[str, Any], name: str) -> float:
    """Return the rise of friction by the drive (%)."""
    return float(100 * (numbers[name]["driven"] / numbers[name]["mu_0"] - 1))


def source(trait: Trait) -> str:
    """Return where a trait's values are from, with links and the assumptions marked."""
    text = re.sub(r"doi (10\.[^\s,;)]+)", r"[doi \1](https://doi.org/\1)", trait.source)
    return text.replace("Assumption", "*Assumption*").replace("docs/drive.md", "[drive.md](drive.md)")


def traits() -> list[tuple[Trait, list[str]]]:
    """Return each trait with the names of its fingers."""
    found = dict[int, tuple[Trait, list[str]]]()
    for name, finger in FINGERS.items():
        for trait in finger.traits:
            found.setdefault(id(trait), (trait, []))[1].append(name)
    return [*found.values()]


if __name__ == "__main__":
    sys.exit(harness.main(__doc__, compute, draw))
