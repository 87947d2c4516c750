"""Which model when: the charged cylinders beside full runs, over forces and voltages.

environment/run python3 -m benchmarks.models [--jobs 2] [--draw]     twenty minutes, mostly full runs

The full runs have a contact size of 10 um. Four more are at loads that no number of a model comes from.
Writes docs/models.json and numbers of docs/closed_form.md,
and prints what fingerpad/reduced has of them: the lengths that the cylinders interpolate, and their known error. Where
the lengths differ they are put there, and the command is given again, which runs the cylinders alone.
"""

import argparse
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import harness
from benchmarks.runs import FORCES, VOLTAGES, trace
from fingerpad.reduced import cylinder_errors, cylinders, press
from fingerpad.results.quantities import RESULTS
from fingerpad.runs.batch import Summary
from fingerpad.scene import Scene

_LIMIT = 3600.0  # s of processor time for one run
SIZE = 10e-6  # m, contact size
QUANTITIES = ("full_slip_mu_app", "full_slip_contact_length", "charged_contact_length", "charged_f_electrostatic")
_COST = ("seconds", "factorisations", "unknowns")
HELD_OUT = ((8.2, 153.0), (20.8, 124.0), (34.2, 136.0), (38.7, 153.0))  # N/m, V; no model has a number from these loads
_ROUNDOFF = 1e-6  # of a tenth of a per cent


# -- numbers -------------------------------------------------------------------------------------------------
def name(f_ext: float, voltage: float) -> str:
    """Return the name of a scene in docs/models.json."""
    return f"{f_ext:g} N/m, {voltage:g} V"


def scenes() -> dict[str, Scene]:
    """Return the scenes by name."""
    return {name(f, u): trace(f, u, SIZE) for f in FORCES for u in VOLTAGES}


def held_out() -> dict[str, Scene]:
    """Return the scenes at loads that no model was fitted to, by name."""
    return {name(f, u): trace(f, u, SIZE) for f, u in HELD_OUT}


def answer(summary: Summary) -> dict[str, Any]:
    """Return the numbers of a run or of a reduced model that docs/models.json has."""
    if "failure" in summary:
        return {"failure": summary["failure"]}
    keys = (f"{state}_{key}" for state in ("charged", "full_slip") for key in RESULTS)
    found = {"full_slip": summary["full_slip"]} | {key: summary[key] for key in keys if summary[key] is not None}
    cost = {key: summary["processor_seconds" if key == "seconds" else key] for key in _COST}
    return {"summary": found, "cost": cost}


def compute(args: argparse.Namespace) -> None:
    """Run what is missing and keep the numbers."""
    full = harness.run(scenes() | held_out(), args, _LIMIT)
    kept = {
        "scenes": {key: answers(scene, full[key]) for key, scene in scenes().items()},
        "held_out": {key: answers(scene, full[key]) for key, scene in held_out().items()},
    }
    harness.keep("models", kept, harness.made(full.values()), args.docs)
    print(in_the_program(kept))


def answers(scene: Scene, full: Summary) -> dict[str, Any]:
    """Return the numbers of every model in one scene that docs/models.json has."""
    summaries = {"cylinders": cylinders.solve(scene).to_dict(), "full": full}
    return {model: answer(summary) for model, summary in summaries.items()}


def value(found: Mapping[str, Any], model: str, key: str) -> float | None:
    """Return a model's value in one scene, None where it is not known."""
    return found.get(model, {}).get("summary", {}).get(key)


def in_the_program(kept: Mapping[str, Any]) -> str:
    """Return the tables of :mod:`fingerpad.reduced.cylinders` and the known errors as kept numbers have them."""
    runs = [kept["scenes"][name(f, 0.0)]["full"]["summary"] for f in FORCES]
    lines = []
    for state in press.of(Scene()).lengths:
        lengths, ridges, heights = (
            [run[f"{state}_{key}"] for run in runs] for key in ("contact_length", "ridges_in_contact", "bone_height")
        )
        lines += [f"LENGTHS {state}: {', '.join(f'{1e3 * each:.4f}e-3' for each in lengths)}"]
        lines += [f"RIDGES {state}: {', '.join(map(str, ridges))}"]
        lines += [f"INDENTATIONS {state}: {', '.join(f'{-1e3 * each:.4f}e-3' for each in heights)}"]
    every = [*kept["scenes"].values(), *kept["held_out"].values()]
    known = cylinder_errors.REGIONS[0].errors
    for key in (f"{state}_{quantity}" for state in press.of(Scene()).lengths for quantity in known[state]):
        errors = [_error(found, key) for found in every if value(found, "cylinders", key)]
        off = [abs(1 / (1 + each / 100) - 1) for each in errors if each is not None]  # over the printed value
        lines += [f"KNOWN_ERROR {key}: {np.ceil(1e3 * max(off) - _ROUNDOFF) / 1e3:.3f}"]
    return "\n".join(lines)


def _error(found: Mapping[str, Any], key: str) -> float | None:
    """Return the cylinders' error against the full run (%), None where either is not known."""
    own, full = value(found, "cylinders", key), value(found, "full", key)
    return None if own is None or not full else 100 * (own / full - 1)


# -- page ----------------------------------------------------------------------------------------------------
def draw(docs: Path) -> Path:
    """Draw the page from the kept numbers."""
    numbers = harness.kept("models", docs).numbers
    every = [*numbers["scenes"].values(), *numbers["held_out"].values()]

    def medians(model: str) -> list[float]:
        costs = [each[model]["cost"] for each in every if "cost" in each[model]]
        return [float(np.median([cost[key] for cost in costs])) for key in _COST]

    def at(f_ext: float, voltage: float) -> Mapping[str, Any]:
        return dict(numbers["scenes"].get(name(f_ext, voltage), {}))

    names = {
        "every": every, "medians": medians, "at": at,
        "errors": lambda key, f: [_error(at(f, u), key) for u in VOLTAGES],
        "slips": sum(bool(each["full"].get("summary", {}).get("full_slip")) for each in every),
    }  # fmt: skip
    return harness.page(docs, "models", "python3 -m benchmarks.models", globals() | names)


if __name__ == "__main__":
    sys.exit(harness.main(__doc__, compute, draw))
