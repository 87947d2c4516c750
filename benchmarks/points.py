"""Points of the chart of error over work: runs with a setting of their own, and answers without a path.

An error is the distance from the limit of benchmarks/errors.py; a cost is factorisations times unknowns, or processor
time, up to the state of the quantity.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import errors, harness
from benchmarks.convergence import Limit
from benchmarks.runs import Run
from fingerpad.model.touching import by_rule
from fingerpad.scene import Scene, from_data

DEFAULT = "default"
REQUESTED, AGAIN, REDUCED = "accuracy asked for", "solved again", "reduced model"
NO_PATH = (REQUESTED, AGAIN, REDUCED)
OTHER_MODEL = "formulation"
KINDS = {"f_t": "f_T and µ_app", "contact_length": "contact length", "sed_0": "SED at the central Merkel site"}
QUANTITIES = [f"{state}_{kind}" for kind in KINDS for state in errors.STATES if kind != "f_t" or state == "slip"]
ALL = "slip_all"  # the largest error of all quantities; its cost is that of full slip, the last state
Reference = Mapping[str, Limit]


def _mesh(contact: float = errors.AT, **sizes: float) -> dict[str, Any]:
    return {"mesh": {"contact": contact} | sizes}


def _coarse(contact: float, growth: float, sites: float) -> tuple[str, dict[str, Any]]:
    words = f"{contact * 1e6:g} µm, growth {growth:g}, {sites * 1e6:g} µm at the sites"
    return words, _mesh(contact, growth=growth, receptor=sites)


# A family is a setting; all but the first are varied around a contact size of 10 um.
FAMILIES: Mapping[str, Mapping[str, Mapping[str, Any]]] = {
    "contact size": {f"{h * 1e6:g} µm": _mesh(h) for h in (20e-6, 10e-6, 2.5e-6)},
    "growth": {f"growth {growth:g}": _mesh(growth=growth) for growth in (0.5, 0.125)},
    "size at the sites": {
        f"{h * 1e6:g} µm at the sites": _mesh(receptor=h) for h in (40e-6, 20e-6, 10e-6, 2.5e-6)
    },
    "all sizes": dict(
        _coarse(*sizes)
        for sizes in ((40e-6, 0.5, 40e-6), (20e-6, 0.5, 20e-6), (10e-6, 0.5, 10e-6), (5e-6, 0.125, 10e-6))
    ),
    "element": {name: _mesh() | {"numerics": {"element": name}} for name in ("P1", "P2 reduced", "P2-P1", "P3")}
    | {"P1, 5 µm": _mesh(5e-6) | {"numerics": {"element": "P1"}}},
    OTHER_MODEL: {
        f"Nitsche, γ_0 = {gamma_0:g}": _mesh() | {"contact": {"formulation": "nitsche", "gamma_0": gamma_0}}
        for gamma_0 in (1.0, 10.0)
    }
    | {"augmented Lagrangian": _mesh() | {"contact": {"formulation": "augmented"}}}
    | {f"penalty {eps_n / 1e9:g} MPa/mm": _mesh() | {"contact": {"eps_n": eps_n}} for eps_n in (0.5e12, 5e12)},
    "solver": {f"{points} points a facet": _mesh() | {"numerics": {"quadrature_points": points}} for points in (3, 6)}
    | {
        "tolerance 1e-7": _mesh() | {"numerics": {"tolerance": 1e-7}},
        "coupling tolerance 1e-3": _mesh() | {"numerics": {"coupling_tolerance": 1e-3}},
    },
    "steps": {f"steps × {scale:g}": _mesh() | {"numerics": {"step_scale": scale}} for scale in (0.5, 2.0)},
}  # fmt: skip


# -- points --------------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Point:
    """An answer in the chart."""

    label: str
    family: str
    work: Mapping[str, float]
    """Factorisations times unknowns up to a state, by state."""
    seconds: Mapping[str, float]
    """Processor time up to a state, set-up included, by state; empty where it was not kept."""
    errors: Mapping[str, float]
    """Relative distance from the limit, by quantity."""

    def error(self, quantity: str) -> float | None:
        """Return the error of a quantity, or the largest of all for :data:`ALL`; None if it is not in the answer."""
        if quantity == ALL:
            return max(self.errors.values()) if set(QUANTITIES) <= set(self.errors) else None
        return self.errors.get(quantity)

    def cost(self, quantity: str, measure: str) -> float | None:
        """Return the cost up to the state of a quantity; None if it is not known or not in the answer."""
        spent = getattr(self, measure)
        return float(spent[quantity.split("_", 1)[0]]) if spent and self.error(quantity) is not None else None


def scenes() -> dict[tuple[str, str], Scene]:
    """Return the scenes to run by family and label, the default one first."""
    found = {("contact size", DEFAULT): errors.DEFAULT}
    for family, settings in FAMILIES.items():
        found |= {(family, label): by_rule(from_data(data)) for label, data in settings.items()}
    return found


def _errors(values: Mapping[str, Any], reference: Reference) -> dict[str, float]:
    there = (name for name in QUANTITIES if values.get(name) is not None)
    return {name: abs(values[name] / reference[name].value - 1) for name in there}


def runs(out: Path, reference: Reference) -> Iterator[Point]:
    """Yield the points of runs that reached full slip."""
    for (family, label), scene in scenes().items():
        if (values := errors.values(scene, out)) is None:
            continue
        run = Run(scene, out)
        spent = np.cumsum(run.steps["factorisations"]) * run.summary["unknowns"]
        work, seconds = (
            {state: float(each[run.row(state)]) for state in errors.STATES}
            for each in (spent, run.steps["processor_seconds"])
        )
        yield Point(label, family, work, seconds, _errors(values, reference))


def without_path(docs: Path, reference: Reference) -> Iterator[Point]:
    """Yield the points of answers without a path, from the kept numbers of other studies."""

    def point(label: str, family: str, work: float, seconds: float, values: Mapping[str, Any]) -> Point:
        costs = [dict.fromkeys(errors.STATES, cost) for cost in (work, seconds)]
        return Point(label, family, costs[0], costs[1], _errors(values, reference))

    for name, row in harness.kept("accuracy", docs).numbers["runs"].items():
        if name.startswith("default scene; ") and "values" in row:
            yield point(name.split("; ")[1], REQUESTED, row["work"], row["seconds"], row["values"])
    again, work, seconds = harness.kept("errors", docs).numbers["again"], 0.0, 0.0
    for k, solve in enumerate([again["path"], *again["levels"]]):
        work, seconds = work + solve["unknowns"] * solve["factorisations"], seconds + solve["processor_seconds"]
        if k:
            yield point(f"again at {solve['mesh']['contact'] * 1e6:g} µm", AGAIN, work, seconds, solve["values"])
    scene = f"{errors.DEFAULT.f_ext:g} N/m, {errors.DEFAULT.voltage:g} V"
    for model, found in harness.kept("models", docs).numbers["scenes"][scene].items():
        if model != "full" and "summary" in found:
            cost = found["cost"]
            yield point(model, REDUCED, cost["factorisations"] * cost["unknowns"], cost["seconds"], found["summary"])
