"""What the chart shows: runs of the default scene with a setting of its own each, and three cheaper or finer ways.

A point is an error against what it cost. The error is the distance from the reference of benchmarks/errors.py, the cost
factorisations times unknowns and processor time, both up to the state that the quantity is of. Beside the runs there
are rung 2 of benchmarks/ladder.py, the default scene with an accuracy asked for, of benchmarks/accuracy.py, which costs
all of its solves whatever the state, and states solved again on ever finer meshes, of benchmarks/limits.py, each of
which costs its path and the coarser meshes too. They are taken from what those have kept.
"""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import accuracy, errors, limits
from benchmarks.convergence import Limit
from benchmarks.ladder import name as ladder_name
from benchmarks.runs import Run
from fingerpad.io.states import WORDS
from fingerpad.model.touching import by_rule
from fingerpad.runs.batch import result
from fingerpad.scene import Scene, from_data

DEFAULT = "default"
ASKED, AGAIN, LADDER = "accuracy asked for", "solved again", "ladder"
STATES = {"press": WORDS["uncharged"], "normal": WORDS["charged"], "slip": WORDS["full_slip"]}
KINDS = {"f_t": "f_T and µ_app", "contact_length": "contact length", "sed_0": "SED at the central Merkel site"}
MEASURES = {"work": "factorisations × unknowns", "seconds": "processor time"}
QUANTITIES = [f"{state}_{kind}" for kind in KINDS for state in STATES if kind != "f_t" or state == "slip"]
ALL = "slip_all"  # the largest error of all of these, at full slip since the other states come before
RUNG_1 = "rung 1"  # factorises nothing, so that its cost is at no place of a logarithmic axis
_NOT_STEADY = "no steady full slip by the end of the slide"
Reference = Mapping[str, Limit]


def _mesh(contact: float = errors.AT, **sizes: float) -> dict[str, Any]:
    return {"mesh": {"contact": contact} | sizes}


# A family is what is varied; all but the first are around a contact size of 10 um.
FAMILIES: Mapping[str, Mapping[str, Mapping[str, Any]]] = {
    "contact size": {f"{size * 1e6:g} µm": _mesh(size) for size in errors.CONTACT if size != Scene().mesh.contact},
    "growth": {f"growth {growth:g}": _mesh(growth=growth) for growth in errors.GROWTH if growth != Scene().mesh.growth},
    "size at the sites": {
        f"{size * 1e6:g} µm at the sites": _mesh(receptor=size)
        for size in errors.RECEPTOR
        if size != Scene().mesh.receptor
    },
    "all sizes": {
        "40 µm, growth 0.5, 40 µm at the sites": _mesh(40e-6, growth=0.5, receptor=40e-6),
        "20 µm, growth 0.5, 20 µm at the sites": _mesh(20e-6, growth=0.5, receptor=20e-6),
        "10 µm, growth 0.5, 10 µm at the sites": _mesh(growth=0.5, receptor=10e-6),
        "5 µm, growth 0.125, 10 µm at the sites": _mesh(5e-6, growth=0.125, receptor=10e-6),
    },
    "element": {name: _mesh() | {"numerics": {"element": name}} for name in ("P1", "P2 reduced", "P2-P1", "P3")}
    | {"P1, 5 µm": _mesh(5e-6) | {"numerics": {"element": "P1"}}},
    "formulation": {
        f"Nitsche, γ_0 = {gamma_0:g}": _mesh() | {"contact": {"formulation": "nitsche", "gamma_0": gamma_0}}
        for gamma_0 in (1.0, 10.0)
    }
    | {"augmented Lagrangian": _mesh() | {"contact": {"formulation": "augmented"}}}
    | {
        f"penalty {eps_n / 1e9:g} MPa/mm": _mesh() | {"contact": {"eps_n": eps_n}}
        for eps_n in errors.PENALTY
        if eps_n != Scene().contact.eps_n
    },
    "solver": {f"{points} points a facet": _mesh() | {"numerics": {"quadrature_points": points}} for points in (3, 6)}
    | {
        "tolerance 1e-7": _mesh() | {"numerics": {"tolerance": 1e-7}},
        "coupling tolerance 1e-3": _mesh() | {"numerics": {"coupling_tolerance": 1e-3}},
    },
    "steps": {f"steps × {scale:g}": _mesh() | {"numerics": {"step_scale": scale}} for scale in (0.5, 2.0)},
}


@dataclass(frozen=True)
class Point:
    """An answer in the chart."""

    label: str
    family: str
    work: Mapping[str, float]
    """Factorisations up to a state times unknowns, by state."""
    seconds: Mapping[str, float]
    """Processor time up to a state, set-up included, by state; empty for runs of versions that did not keep it."""
    errors: Mapping[str, float]
    """Relative distance from the reference, by quantity, and :data:`ALL` where every quantity is there."""

    def cost(self, quantity: str, measure: str) -> float | None:
        """Return what it cost up to the state of a quantity, None if that is not known or has no such quantity.

        Args:
            quantity: one of :data:`QUANTITIES`, or :data:`ALL`.
            measure: one of :data:`MEASURES`.
        """
        known = getattr(self, measure)
        return float(known[state_of(quantity)]) if known and quantity in self.errors else None


def state_of(quantity: str) -> str:
    """Return the state that a quantity is of."""
    return quantity.split("_", 1)[0]


def scenes() -> dict[tuple[str, str], Scene]:
    """Return the scenes to run by family and label, the default one first."""
    found = {("contact size", DEFAULT): errors.DEFAULT}
    for family, settings in FAMILIES.items():
        found |= {(family, label): by_rule(from_data(data)) for label, data in settings.items()}
    return found


def collect(out: Path, docs: Path, reference: Reference) -> list[Point]:
    """Return all points that there are."""
    return [
        *_runs(out, reference),
        *_asked(out, reference),
        *_solved_again(out, reference),
        *_rungs(docs, reference),
    ]


def _errors(values: Mapping[str, float], reference: Reference) -> dict[str, float]:
    found = {name: abs(values[name] / reference[name].value - 1) for name in QUANTITIES if name in values}
    return found | ({ALL: max(found.values())} if len(found) == len(QUANTITIES) else {})


def _of_states(label: str, family: str, work: float, seconds: float, errors: Mapping[str, float]) -> Point:
    """Return a point whose states cost the same, since they come together."""
    return Point(label, family, dict.fromkeys(STATES, work), dict.fromkeys(STATES, seconds), errors)


def _runs(out: Path, reference: Reference) -> Iterator[Point]:
    for (family, label), scene in scenes().items():
        values = errors.values(scene, out)
        if values is None:
            continue
        run = Run(scene, out)
        spent = np.cumsum(run.steps["factorisations"]) * run.summary["unknowns"]
        seconds = run.steps.get("processor_seconds")
        rows = {"press": run.pressed, "normal": run.normal, "slip": run.slip}
        yield Point(
            label,
            family,
            {state: float(spent[row]) for state, row in rows.items()},
            {} if seconds is None else {state: float(seconds[row]) for state, row in rows.items()},
            _errors(values, reference),
        )


def _asked(out: Path, reference: Reference) -> Iterator[Point]:
    for label, scene in accuracy.of_default().items():
        summary = result(scene, out)
        if summary is None or "accuracy" not in summary or "failure" in summary:
            continue
        values = {name: q["value"] for name, q in summary["accuracy"]["quantities"].items()}
        yield _of_states(label, ASKED, *accuracy.spent(summary), _errors(values, reference))


def _solved_again(out: Path, reference: Reference) -> Iterator[Point]:
    found = limits.kept(errors.DEFAULT, errors.LEVELS, errors.folder_of_limits(out))
    if found is None:
        return
    work = found["path"]["unknowns"] * found["path"]["factorisations"]
    seconds = found["path"]["processor_seconds"]
    for level in found["levels"]:
        work, seconds = work + level["unknowns"] * level["factorisations"], seconds + level["processor_seconds"]
        label = f"again at {level['mesh']['contact'] * 1e6:g} µm"
        yield _of_states(label, AGAIN, work, seconds, _errors(level["values"], reference))


def _rungs(docs: Path, reference: Reference) -> Iterator[Point]:
    file = docs / "ladder.json"
    known = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    found = known.get(ladder_name(errors.DEFAULT.f_ext, errors.DEFAULT.voltage), {})
    for number, label in (("1", RUNG_1), ("2", "rung 2")):
        if "summary" in found.get(number, {}):
            values, cost = found[number]["summary"], found[number]["cost"]
            work = cost["factorisations"] * cost["unknowns"]
            yield _of_states(label, LADDER, work, cost["seconds"], _errors(values, reference))


def missing(out: Path) -> list[str]:
    """Return the runs that are not in the chart, and why."""
    found = {label: result(scene, out) for (_, label), scene in scenes().items()}
    return [
        f"{label}: {'not run' if summary is None else summary.get('failure', _NOT_STEADY)}"
        for label, summary in found.items()
        if summary is None or not summary.get("full_slip")
    ]
