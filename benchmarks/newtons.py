"""Newtons of a whole finger: sums of slices over force, voltage and shape, and what they rest on.

environment/run python3 -m benchmarks.newtons [--draw]     seconds

The traces are those of docs/models.json: the full and the cylinders' finger at eight forces and five voltages, with a
contact size of 10 um. Writes docs/newtons.json, docs/newtons.md and its picture; docs/paper.md has its friction.
"""

import argparse
import itertools
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from benchmarks import harness
from benchmarks.models import name
from benchmarks.runs import FORCES, VOLTAGES
from fingerpad.reduced import press
from fingerpad.results.pictures import style
from fingerpad.results.quantities import RESULTS
from fingerpad.scene import Scene
from fingerpad.scene.parameters import Slices
from fingerpad.slices import errors, estimate
from fingerpad.slices.total import Profile, Total, at_force, profile
from fingerpad.slices.trace import Trace
from fingerpad.slices.trace import trace as trace_of
from variational.state import ContactState

RADII = (15e-3, 28e-3, 40e-3)  # m, R_z
NEWTONS = (0.05, 0.1, 0.2, 0.3, 0.5, 0.75)  # N
COMPARED = 0.5  # N
OF_CLOSED_FORM = (0.05, 0.075, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.75, 1.0, 1.2)  # N, of the error of the closed form
PAPER = 20e-3  # m of finger, by which the paper multiplies
CENTRE = 75.0  # N/m, of the run and of the estimates in the table
CENTRES = (25.0, 50.0, 75.0, 100.0, 120.0)  # N/m, of the runs whose estimates are judged
ESTIMATED = ("f_t", "f_electrostatic", "contact_area", "gross_area", "indentation")
HIGH = 200.0  # V
COMPARISONS = {"ridged, 200 V": errors.ONCE, "smooth, earlier": errors.EARLIER, "smooth, below": errors.SMOOTH}
COARSE = 0.3  # N: below it a few elements of a solid finger are in contact
Found = Mapping[str, Any]


# -- traces --------------------------------------------------------------------------------------------------
def states(scenes: Found, model: str, voltage: float, state: str) -> list[ContactState]:
    """Return the kept states of a model over force, at a voltage (V)."""
    found = []
    for f_ext in FORCES:
        summary = scenes[name(f_ext, voltage)][model]["summary"]
        values = {key: summary[f"{state}_{key}"] for key in RESULTS if f"{state}_{key}" in summary}
        if model == "cylinders":
            values["bone_height"] = -float(press.of(Scene()).indentation(f_ext, state))
        found.append(ContactState(f_ext=f_ext, voltage=voltage, **values))
    return found


def kept(scenes: Found, model: str, voltage: float, state: str = "full_slip") -> Trace:
    """Return a kept trace; arguments as of :func:`states`."""
    return trace_of(states(scenes, model, voltage, state), Scene().geometry.ridge_wavelength)


def finger(radius: float = RADII[1]) -> Profile:
    """Return the finger with a radius R_z (m)."""
    return profile(Slices(radius=radius))


# -- numbers -------------------------------------------------------------------------------------------------
def row(total: Total, voltage: float, radius: float) -> dict[str, float]:
    """Return the numbers of a sum."""
    more = {"radius": radius, "voltage": voltage, "mu_app": total.mu_app, "centre": total.centre}
    return more | total.totals | {"indentation": total.delta}


def friction(scenes: Found) -> list[dict[str, float]]:
    """Return the sums at full slip by radius, voltage and force, with the paper's conversion beside them."""
    found = []
    for voltage in VOLTAGES:
        of = kept(scenes, "full", voltage)
        for radius in RADII:
            for force in NEWTONS:
                total = at_force(finger(radius), of, force, Slices().count)
                more = {"by_20_mm": _by_20_mm(of, force), "continued": _continued(total)}
                found.append(row(total, voltage, radius) | more)
    return found


def _continued(total: Total) -> float:
    """Return the share of the friction force on slices below the least force of the traces."""
    light = total.columns["f_ext"] < FORCES[0]
    return float((total.thickness * total.columns["f_t"])[light].sum() / total.totals["f_t"])


def _by_20_mm(of: Trace, force: float) -> float:
    """Return µ_app of the cross-section under a force per 20 mm."""
    line = force / PAPER
    depth = np.exp(np.interp(np.log(line), np.log(of.columns["f_ext"]), np.log(of.depth)))
    if not of.columns["f_ext"][0] <= line <= of.columns["f_ext"][-1]:
        return float("nan")
    values = of.at(np.array([depth]))
    return float(values["f_t"][0] / values["f_ext"][0])


def by_model(scenes: Found) -> list[dict[str, Any]]:
    """Return the sums of each model at :data:`COMPARED`, and the estimate of a run at :data:`CENTRE`."""
    found = []
    for voltage in VOLTAGES:
        for model in ("full", "cylinders"):
            total = at_force(finger(), kept(scenes, model, voltage), COMPARED, Slices().count)
            found.append({"model": model} | row(total, voltage, RADII[1]))
    return found


def closed_form(scenes: Found) -> dict[str, float]:
    """Return the largest error of the cylinders' sums at full slip by quantity, of their value, rounded up to 0.1 %."""
    worst = dict.fromkeys(("f_electrostatic", "contact_area", "gross_area"), 0.0)
    for voltage, force in itertools.product(VOLTAGES[1:], OF_CLOSED_FORM):
        made = (kept(scenes, model, voltage) for model in ("cylinders", "full"))
        own, full = (at_force(finger(), each, force, Slices().count).totals for each in made)
        worst = {key: max(value, abs(full[key] / own[key] - 1)) for key, value in worst.items()}
    return {key: float(np.ceil(1e3 * value - 1e-6) / 1e3) for key, value in worst.items()}


def estimates(scenes: Found) -> list[dict[str, Any]]:
    """Return relative errors of what runs at :data:`CENTRES` estimate, beside traces of the full model."""
    found = []
    for centre, voltage in itertools.product(CENTRES, VOLTAGES):
        k, scene = FORCES.index(centre), Scene(f_ext=centre, voltage=voltage)
        press = states(scenes, "full", 0.0, "charged")[: k + 1]
        named = {state: states(scenes, "full", voltage, state)[k] for state in ("charged", "full_slip")}
        made = estimate.estimate(scene, press, {"uncharged": press[-1]} | named).states
        for state in named:
            one = made[state].values
            full = at_force(finger(), kept(scenes, "full", voltage, state), one["f_ext"], Slices().count).values
            errors = {key: one[key] / full[key] - 1 if full[key] else 0.0 for key in ESTIMATED}
            sums = {f"{key}_full": full[key] for key in ("f_ext", "f_t", "f_electrostatic")}
            found.append({"centre": centre, "voltage": voltage, "state": state} | sums | errors)
    return found


def compute(args: argparse.Namespace) -> None:
    """Keep the numbers."""
    scenes = harness.kept("models", args.docs).numbers["scenes"]
    numbers = {
        "friction": friction(scenes), "models": by_model(scenes), "estimates": estimates(scenes),
    }  # fmt: skip
    harness.keep("newtons", numbers, harness.made(), args.docs)


# -- page ----------------------------------------------------------------------------------------------------
def at(numbers: Found, radius: float, voltage: float) -> list[harness.Record]:
    """Return the sums at full slip over force, of a radius (m) and a voltage (V)."""
    return [each for each in numbers["friction"] if each["radius"] == radius and each["voltage"] == voltage]


def compared(numbers: Found) -> dict[str, Any]:
    """Return what docs/newtons.md and docs/paper.md have of the sums.

    ``middle``: that at :data:`COMPARED` and :data:`HIGH`; ``widths``: the least and largest ratio of a force to that of
    the centre (m); ``lower``: the least and largest share by which µ_app is below that of the 20 mm, at :data:`HIGH`.
    """
    rows, ratios = at(numbers, RADII[1], HIGH), [each["f_ext"] / each["centre"] for each in numbers["friction"]]
    shares = [1 - each.mu_app / each.by_20_mm for each in rows if each.by_20_mm is not None]
    middle = next(each for each in rows if abs(each.f_ext / COMPARED - 1) < 1e-6)
    return {"middle": middle, "widths": (min(ratios), max(ratios)), "lower": (min(shares), max(shares))}


def paint(figure: Figure, numbers: Found) -> None:
    """Draw apparent friction over newtons, with the band of the radius and the paper's conversion, and areas."""
    left, right = figure.subplots(1, 2)
    for voltage in VOLTAGES:
        colour = style.voltage(voltage)
        low, middle, high = (at(numbers, radius, voltage) for radius in RADII)
        force = [each["f_ext"] for each in middle]
        for axis, key, scale in ((left, "mu_app", 1.0), (right, "contact_area", 1e6)):
            ends = ([scale * each[key] for each in rows] for rows in (low, high))
            axis.fill_between(force, *ends, color=colour, alpha=0.25, lw=0)
            values = [scale * each[key] for each in middle]
            axis.plot(force, values, color=colour, marker="o", ms=4, label=f"{voltage:g} V")
        other = [(each["f_ext"], each["by_20_mm"]) for each in middle if each["by_20_mm"] is not None]
        left.plot(*zip(*other, strict=True), color=colour, ls="--", lw=1)
    left.plot([], [], color=style.GREY, ls="--", lw=1, label="centre × 20 mm")
    left.set(xlabel="external force $F_{ext}$ (N)", ylabel="apparent friction coefficient µ_app (–)", ylim=(0, None))
    right.set(xlabel="external force $F_{ext}$ (N)", ylabel="ridge contact area (mm²)", ylim=(0, None))
    left.set_title("A  Friction at full slip")
    right.set_title("B  Ridges in contact")
    left.legend()


def picture(numbers: Found, docs: Path) -> None:
    """Draw docs/newtons.png, which docs/paper.md shows too."""
    harness.picture(docs / "newtons.png", (10, 4), lambda figure: paint(figure, numbers))


def _largest(estimates: Iterable[Mapping[str, Any]], key: str, centre: float | None = None) -> float:
    return 100 * max(abs(each[key]) for each in estimates if centre in (None, each["centre"]))


def draw(docs: Path) -> Path:
    """Draw the page from the kept numbers."""
    numbers, pairs = harness.kept("newtons", docs).numbers, (("f_ext_slices", "f_ext"), ("area_slices", "area"))
    picture(numbers, docs)
    solids = [
        (s["f_ext"], [100 * (s[a] / s[b] - 1) for a, b in (*pairs, ("area_slices_at_force", "area"))])
        for s in harness.kept("solid", docs).numbers
    ]
    above = [errors for f_ext, errors in solids if f_ext > COARSE]
    friction = [
        (
            each,
            [r["mu_app"] for r in numbers["friction"] if r["voltage"] == u and abs(r["f_ext"] / each.f_ext - 1) < 1e-6],
        )
        for u in (0.0, HIGH)
        for each in at(numbers, RADII[1], u)
    ]
    names = compared(numbers) | {
        "default": harness.kept("hero", docs).numbers["default"]["headline"],
        "friction": friction, "largest": _largest,
        "comparisons": [
            (words, of, points) for key, words in errors.COMPARED.items() for of, known in COMPARISONS.items()
            if (points := known.get(key, ()))
        ],
        "shares": [[errors[0] for _, errors in solids], *([errors[k] for errors in above] for k in (1, 2))],
        "slips": [each for each in numbers["estimates"] if each["state"] == "full_slip"],
        "presses": [each for each in numbers["estimates"] if each["state"] == "charged"],
    }  # fmt: skip
    return harness.page(docs, "newtons", "python3 -m benchmarks.newtons", globals() | names, "models", "solid", "hero")


if __name__ == "__main__":
    sys.exit(harness.main(__doc__, compute, draw))
