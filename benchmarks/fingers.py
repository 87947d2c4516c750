"""Fingers by name beside each other: their friction, and where their keys are from.

environment/run python3 -m benchmarks.fingers [--draw]     also: make fingers; two minutes of processor time

The closed form has all of them, by a press of each. Those with a press of their own are run by the full model, too, on
coarse elements, and so is the default finger. Writes docs/fingers.json, numbers of docs/assumptions.md
and a picture.
"""

import argparse
import re
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

import fingerpad as fp
from benchmarks import harness
from fingerpad.reduced import press
from fingerpad.results.pictures import style
from fingerpad.runs.batch import Summary
from fingerpad.runs.context import RunContext
from fingerpad.runs.solve import find, solved
from fingerpad.scene import Scene
from fingerpad.scene.fingers import FINGERS, PAPER, Trait

FORCE = 0.5  # N, about, on each finger
VOLTAGE = 200.0  # V
FREQUENCY = 100.0  # Hz, of the one drive of all fingers, a sine with VOLTAGE as rms
CONTRAST = 50  # %, rise of µ_app by the voltage
_UP_TO = 600.0  # V
_COARSE = {"contact": 20e-6, "receptor": 40e-6, "interface": 120e-6, "growth": 0.5}  # m, but for the growth
_LIMIT = 1800.0  # s of processor time of a run


def runs() -> dict[str, Scene]:
    """Return the scenes of the full model, under the force per length at the centre that makes up about 0.5 N."""
    found, quick = {}, {"receptors": False, "errors": False, "each_load": False}
    for name in (PAPER, *(each for each in FINGERS if press.name(Scene(finger=each)) != press.name(Scene()))):
        f_ext = float(f"{Scene(finger=name, force=FORCE).centre_force:.4g}")
        found[name] = Scene(finger=name, f_ext=f_ext, voltage=VOLTAGE, mesh=_COARSE, output=quick)
    return found


def compute(args: argparse.Namespace) -> None:
    """Compute and keep the numbers."""
    import fingerpad.startup  # noqa: F401

    summaries = harness.run(runs(), args, _LIMIT)
    numbers = {name: _closed(name) | {"full": _full(summaries.get(name))} for name in FINGERS}
    harness.keep("fingers", numbers, harness.made(summaries.values()), args.docs)


def _closed(name: str) -> dict[str, Any]:
    """Return the friction of a finger by the closed form."""
    scene = Scene(finger=name, force=FORCE, voltage=VOLTAGE)
    found: dict[str, Any] = {"mu_0": scene.friction, "h_0": scene.h_0, "leak": str(scene.electric.leak)}
    drive = scene.replace(voltage={"waveform": "sine", "rms": VOLTAGE, "frequency": FREQUENCY})
    found |= {"closed": _friction(scene), "driven": _friction(drive)}
    for key, over, each in (("needs", "voltage", scene), ("needs_driven", "voltage.rms", drive)):
        (found[key],) = fp.solve(each, over, mu_app=1 + CONTRAST / 100, relative=True, between=[1.0, _UP_TO]).values
    return found


def _friction(scene: Scene) -> float:
    """Return µ_app of the whole finger by the closed form."""
    whole = solved(scene, find("cylinders"), RunContext()).finger
    assert whole is not None
    return whole.states["full_slip"].mu_app


def _full(summary: Summary | None) -> dict[str, Any] | None:
    """Return the friction of a whole finger by a run, and its force (N)."""
    if summary is None or summary.get("full_slip") is None:
        return None
    whole = {key: summary[f"full_slip_finger_{name}"] for key, name in (("mu_app", "mu_app"), ("force", "f_ext"))}
    return whole | {"f_ext": summary["f_ext"]}


# -- page ----------------------------------------------------------------------------------------------------
def draw(docs: Path) -> Path:
    """Write docs/assumptions.md and its picture from docs/fingers.json."""
    numbers = harness.kept("fingers", docs).numbers
    harness.picture(docs / "fingers.png", (8, 3.6), lambda figure: _paint(figure, numbers))
    return harness.page(docs, "fingers", "make fingers", globals())


def best(found: Mapping[str, Any]) -> float:
    """Return µ_app of a finger: by the closed form, or by its run."""
    return float(found["full"]["mu_app"] if found["closed"] is None else found["closed"])


def _paint(figure: Figure, numbers: Mapping[str, Any]) -> None:
    ax = figure.subplots()
    places = {name: -k for k, name in enumerate(numbers)}
    for name, found in numbers.items():
        ax.plot([found.mu_0, best(found)], [places[name]] * 2, color=style.BLUE, lw=2, zorder=1)
    full = {name: found.full["mu_app"] for name, found in numbers.items() if found.full}
    closed = {name: found.closed for name, found in numbers.items() if found.closed is not None}
    alone = {name: found.mu_0 for name, found in numbers.items()}
    looks: list[tuple[dict[str, float], str, dict[str, Any]]] = [
        (alone, "without voltage: µ_0", {"marker": "o", "mfc": "white"}),
        (closed, f"{VOLTAGE:g} V, closed form", {"marker": "o"}),
        (full, f"{VOLTAGE:g} V, full model", {"marker": "D", "color": style.VERMILION}),
    ]
    for values, label, look in looks:
        own: dict[str, Any] = {"ls": "none", "color": style.BLUE, "ms": 8, "label": label} | look
        ax.plot(list(values.values()), [places[name] for name in values], **own)
    ax.set_yticks(list(places.values()), list(places))
    ax.set(xlabel="friction coefficient µ_app of the whole finger at full slip (–)", xlim=(0, None))
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
