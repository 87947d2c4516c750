"""Which model when: the charged cylinders beside full runs, over forces and voltages.

environment/run python3 -m benchmarks.models [--jobs 2] [--draw]     twenty minutes, mostly full runs

The full runs have a contact size of 10 um. Four more are at loads that no number of a model comes from, and a few
beyond these forces and voltages; both have tables of their own on the page. Writes docs/models.json, from which the
cylinders have their known error, and docs/models.md.
"""

import argparse
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import harness
from benchmarks.runs import FORCES, VOLTAGES, trace
from fingerpad.reduced import cylinders
from fingerpad.results.states import WORDS
from fingerpad.runs.batch import Summary
from fingerpad.scene import Scene, load
from fingerpad.scene.reading import override
from variational.state import RESULTS

_SOFT = ("subcutis", "dermis", "viable_epidermis")
_LIMIT = 3600.0  # s of processor time for one run
SIZE = 10e-6  # m, contact size
MODELS = {"cylinders": "charged cylinders"}
QUANTITIES = {
    "full_slip_mu_app": f"µ_app, {WORDS['full_slip']}",
    "full_slip_contact_length": f"contact length, {WORDS['full_slip']}",
    "charged_contact_length": f"contact length, {WORDS['charged']}",
    "charged_f_electrostatic": f"attraction, {WORDS['charged']}",
}
_COST = ("seconds", "factorisations", "unknowns")
HELD_OUT = ((8.2, 153.0), (20.8, 124.0), (34.2, 136.0), (38.7, 153.0))  # N/m, V; no model has a number from these loads
_MESH = ("mesh.contact=10e-6", "mesh.receptor=20e-6")  # as the scenes over forces and voltages have it
HALF_STEPS = "half the steps"
BEYOND = {  # words: changes of the default scene, beside the mesh's
    "little force": ("f_ext=2",),
    "much friction": ("friction=1",),
    "hardly compressible": tuple(f"materials.{layer}.poisson=0.499" for layer in _SOFT),
    "twice the voltage": ("f_ext=10", "voltage=400", "mesh.touching_half_arc=3.9e-3"),
    HALF_STEPS: ("f_ext=120", "voltage=150", "numerics.step_scale=0.5"),
}
_ROUNDOFF = 1e-6  # of a tenth of a per cent
_KEPT = ("full_slip_mu_app", "full_slip_ridges_in_contact", "factorisations", "newton_iterations")


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


def beyond() -> dict[str, Scene]:
    """Return the scenes beyond these forces and voltages by their words."""
    return {words: load(None, dict(map(override, (*changes, *_MESH)))) for words, changes in BEYOND.items()}


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
    wanted, others = scenes() | held_out(), harness.run(beyond(), args, _LIMIT)
    full = harness.run(wanted, args, _LIMIT)
    keys = (*_KEPT, "full_slip", "failure")
    kept = {
        "scenes": {key: answers(scene, full[key]) for key, scene in scenes().items()},
        "held_out": {key: answers(scene, full[key]) for key, scene in held_out().items()},
        "beyond": {words: {key: summary.get(key) for key in keys} for words, summary in others.items()},
    }
    harness.keep("models", kept, harness.made([*full.values(), *others.values()]), args.docs)


def answers(scene: Scene, full: Summary) -> dict[str, Any]:
    """Return the numbers of every model in one scene that docs/models.json has."""
    summaries = {"cylinders": cylinders.solve(scene).to_dict(), "full": full}
    return {model: answer(summary) for model, summary in summaries.items()}


def value(found: Mapping[str, Any], model: str, key: str) -> float | None:
    """Return a model's value in one scene, None where it is not known."""
    return found.get(model, {}).get("summary", {}).get(key)


def error(found: Mapping[str, Any], model: str, key: str) -> float | None:
    """Return a model's relative error against the full run, None where either is not known."""
    own, full = value(found, model, key), value(found, "full", key)
    return None if own is None or not full else own / full - 1


# -- page ----------------------------------------------------------------------------------------------------
_WHICH = {  # model: finger it is for, its answers
    "cylinders": (
        "the default finger, or one whose uncharged contact length is known",
        "forces, friction and contact length",
    ),
    "full": ("any finger", "everything, receptors too"),
}


def _largest(scenes: Mapping[str, Any], model: str, key: str) -> str:
    """Return the largest error of a model, rounded up to 0.1 % as the program prints it."""
    found = [abs(e) for each in scenes.values() if (e := error(each, model, key)) is not None]
    return f"{np.ceil(1e3 * max(found) - _ROUNDOFF) / 10:.1f} %" if found and model != "full" else "–"


def _takes(scenes: Mapping[str, Any], model: str) -> str:
    costs = [each[model]["cost"] for each in scenes.values() if "cost" in each.get(model, {})]
    seconds, factorisations, unknowns = (float(np.median([c[key] for c in costs])) for key in _COST)
    words = f"{seconds:.2g} s" if seconds < 10 else f"{seconds:.0f} s"
    return f"{words}, {factorisations:.0f} factorisations, {unknowns:.0f} unknowns" if unknowns else words


def _which(scenes: Mapping[str, Any]) -> str:
    rows = []
    for model, words in _WHICH.items():
        largest = (_largest(scenes, model, key) for key in QUANTITIES)
        rows.append([f"`{model}`", *words, *largest, _takes(scenes, model)])
    errors = (f"largest error of {words}" for words in QUANTITIES.values())
    return harness.table(["model", "for", "answers", *errors, "takes"], rows)


def _held_out(scenes: Mapping[str, Any]) -> str:
    """Return the errors (%) of the reduced models at the loads that no number of theirs comes from."""
    rows = []
    for model in MODELS:
        for at, found in scenes.items():
            errors = (error(found, model, key) for key in QUANTITIES)
            rows.append([f"`{model}`", at, *(None if e is None else f"{100 * e:+.1f}" for e in errors)])
    return harness.table(["model", "load", *QUANTITIES.values()], rows)


def _matrix(scenes: Mapping[str, Any], model: str, key: str) -> str:
    """Return a table over force and voltage: errors (%) of a reduced model, or the value of the full one."""

    def cell(found: Mapping[str, Any]) -> Any:
        if model == "full":
            return value(found, model, key)
        return None if (e := error(found, model, key)) is None else f"{1e2 * e:+.1f}"

    rows = [[f"{f:g}", *(cell(scenes.get(name(f, u), {})) for u in VOLTAGES)] for f in FORCES]
    return harness.table(["f_ext (N/m)", *(f"{u:g} V" for u in VOLTAGES)], rows)


def _section(scenes: Mapping[str, Any], model: str) -> list[str]:
    failed = [key for key, each in scenes.items() if "failure" in each.get(model, {})]
    parts = [f"## Errors of the {MODELS[model]} (`{model}`), in per cent of the full model"]
    parts += [f"No answer at {'; '.join(failed)}."] * bool(failed)
    first, *others = ((words, _matrix(scenes, model, key)) for key, words in QUANTITIES.items())
    return [*parts, f"**{first[0]}**\n\n{first[1]}", *(harness.folded(words, matrix) for words, matrix in others)]


def _beyond(found: Mapping[str, Any]) -> str:
    """Return the table of the scenes beyond, those that failed by their words."""
    rows = []
    for words, each in found.items():
        cells = (" ".join(f"`{change}`" for change in BEYOND[words]), *map(each.get, _KEPT))
        rows.append([*cells, each["failure"] or ("yes" if each["full_slip"] else "no")])
    head = ["options `--set`", "µ_app", "ridges in contact", "factorisations", "Newton iterations", "full slip"]
    return harness.table(head, rows)


def draw(docs: Path) -> Path:
    """Draw the page from the kept numbers."""
    kept, text = harness.kept("models", docs), harness.prose("models")
    scenes, held = kept.numbers["scenes"], kept.numbers["held_out"]
    every = scenes | held
    largest = {model: _largest(every, model, "full_slip_mu_app") for model in MODELS}
    largest |= {f"{model}_pull": _largest(every, model, "charged_f_electrostatic") for model in MODELS}
    largest |= {f"{model}_length": _largest(every, model, "charged_contact_length") for model in MODELS}
    full = [each["full"] for each in every.values() if "full" in each]
    slips = sum(bool(each.get("summary", {}).get("full_slip")) for each in full)
    finding = text["finding"].format(**largest, slips=slips, n=len(full), which=_which(every))
    forces, voltages = (", ".join(f"{value:g}" for value in each) for each in (FORCES, VOLTAGES))
    body = [text["held_out"].format(table=_held_out(held))]
    body += [part for model in MODELS for part in _section(scenes, model)]
    body += [
        "## Full runs",
        f"**{QUANTITIES['full_slip_mu_app']}**\n\n{_matrix(scenes, 'full', 'full_slip_mu_app')}",
        text["beyond"].format(half=kept.numbers["beyond"][HALF_STEPS], table=_beyond(kept.numbers["beyond"])),
    ]
    path, command = docs / "models.md", "python3 -m benchmarks.models"
    how = text["how"].format(forces=forces, voltages=voltages)
    return harness.page(path, "Which model when", finding, how, body, command, kept.made, ["models"])


if __name__ == "__main__":
    sys.exit(harness.main(__doc__, compute, draw))
