"""Error over work: one numerical setting after the other, around the default scene.

environment/run python3 -m benchmarks.chart [--jobs 2] [--draw]     after benchmarks.errors, accuracy and models; hours

A point is a run of the default scene (press, charge, slide to full slip) with a setting of its own, or an answer
without a path. Its error is the distance from the limit of benchmarks/errors.py; its cost is factorisations times
unknowns, or processor time, up to the state of the quantity. Writes docs/chart.json, docs/chart.md and docs/chart.png.
"""

import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks import errors, harness
from benchmarks.errors import STATES
from benchmarks.limits import Limit
from benchmarks.runs import finished
from fingerpad.model.touching import by_rule
from fingerpad.scene import Scene, load

_LIMIT = 10800.0  # s of processor time for one run
MEASURES = {"work": "factorisations × unknowns", "seconds": "processor time"}
TARGETS = (5e-2, 1e-2, 2e-3)  # errors whose cost is in the tables
DEFAULT = "default"
REQUESTED, AGAIN, REDUCED = NO_PATH = ("accuracy asked for", "solved again", "reduced model")
OTHER_MODEL = "formulation"
KINDS = {"f_t": "f_T and µ_app", "contact_length": "contact length", "sed_0": "SED at the central Merkel site"}
QUANTITIES = [f"{state}_{kind}" for kind in KINDS for state in STATES if kind != "f_t" or state == "slip"]
ALL = "slip_all"  # the largest error of all quantities; its cost is that of full slip, the last state
Reference = Mapping[str, Limit]


# -- scenes --------------------------------------------------------------------------------------------------
_ALL_SIZES = ((40e-6, 0.5, 40e-6), (20e-6, 0.5, 20e-6), (10e-6, 0.5, 10e-6), (5e-6, 0.125, 10e-6))
# A family is a setting; all but the first are varied around a contact size of 10 um.
FAMILIES: Mapping[str, Mapping[str, Mapping[str, Any]]] = {
    "contact size": {f"{h * 1e6:g} µm": {"mesh.contact": h} for h in (20e-6, 10e-6, 2.5e-6)},
    "growth": {f"growth {growth:g}": {"mesh.growth": growth} for growth in (0.5, 0.125)},
    "size at the sites": {f"{h * 1e6:g} µm at the sites": {"mesh.receptor": h} for h in (40e-6, 20e-6, 10e-6, 2.5e-6)},
    "all sizes": {
        f"{h * 1e6:g} µm, growth {growth:g}, {sites * 1e6:g} µm at the sites": {
            "mesh.contact": h,
            "mesh.growth": growth,
            "mesh.receptor": sites,
        }
        for h, growth, sites in _ALL_SIZES
    },
    "element": {name: {"numerics.element": name} for name in ("P1", "P2 reduced", "P2-P1", "P3")}
    | {"P1, 5 µm": {"mesh.contact": 5e-6, "numerics.element": "P1"}},
    OTHER_MODEL: {
        f"Nitsche, γ_0 = {gamma:g}": {"contact.formulation": "nitsche", "contact.gamma_0": gamma}
        for gamma in (1.0, 10.0)
    }
    | {"augmented Lagrangian": {"contact.formulation": "augmented"}}
    | {f"penalty {eps_n / 1e9:g} MPa/mm": {"contact.eps_n": eps_n} for eps_n in (0.5e12, 5e12)},
    "solver": {f"{points} points a facet": {"numerics.quadrature_points": points} for points in (3, 6)}
    | {
        "tolerance 1e-7": {"numerics.tolerance": 1e-7},
        "coupling tolerance 1e-3": {"numerics.coupling_tolerance": 1e-3},
    },
    "steps": {f"steps × {scale:g}": {"numerics.step_scale": scale} for scale in (0.5, 2.0)},
}


def scenes() -> dict[tuple[str, str], Scene]:
    """Return the scenes to run by family and label, the default one first."""
    found = {("contact size", DEFAULT): errors.DEFAULT}
    for family, settings in FAMILIES.items():
        for label, changes in settings.items():
            found[family, label] = by_rule(load(None, {"mesh.contact": errors.AT, **changes}))
    return found


# -- points --------------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Point:
    """An answer in the chart: its costs up to a state, by state, and relative distances from the limit, by quantity."""

    label: str
    family: str
    work: Mapping[str, float]
    seconds: Mapping[str, float]
    """Processor time, set-up included; empty where it was not kept."""
    errors: Mapping[str, float]

    def error(self, quantity: str) -> float | None:
        """Return the error of a quantity, or the largest of all for :data:`ALL`; None if it is not in the answer."""
        if quantity == ALL:
            return max(self.errors.values()) if set(QUANTITIES) <= set(self.errors) else None
        return self.errors.get(quantity)

    def cost(self, quantity: str, measure: str) -> float | None:
        """Return the cost up to the state of a quantity; None if it is not known or not in the answer."""
        spent = getattr(self, measure)
        return float(spent[quantity.split("_", 1)[0]]) if spent and self.error(quantity) is not None else None


def _errors(values: Mapping[str, Any], reference: Reference) -> dict[str, float]:
    there = (name for name in QUANTITIES if values.get(name) is not None)
    return {name: abs(values[name] / reference[name].value - 1) for name in there}


def runs(out: Path, reference: Reference) -> Iterator[Point]:
    """Yield the points of runs that reached full slip."""
    for (family, label), scene in scenes().items():
        if run := finished(scene, out):
            spent = np.cumsum(run.steps["factorisations"]) * run.summary["unknowns"], run.steps["processor_seconds"]
            work, seconds = ({s: float(each[run.row(s)]) for s in STATES} for each in spent)
            yield Point(label, family, work, seconds, _errors(errors.values(run), reference))


def without_path(docs: Path, reference: Reference) -> Iterator[Point]:
    """Yield the points of answers without a path, from the kept numbers of other studies."""

    def point(label: str, family: str, work: float, seconds: float, values: Mapping[str, Any]) -> Point:
        costs = [dict.fromkeys(STATES, cost) for cost in (work, seconds)]
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


def compute(args: Any) -> None:
    """Run what is missing and keep the numbers."""
    wanted = {label: scene for (_, label), scene in scenes().items()}
    summaries, reference = harness.run(wanted, args, _LIMIT), errors.known(args.docs)
    found = [*runs(args.out, reference), *without_path(args.docs, reference)]
    ends = {name: vars(reference[name]) for name in QUANTITIES}
    numbers = {"reference": ends, "points": [asdict(point) for point in found], "lost": lost(summaries)}
    harness.keep("chart", numbers, harness.made(summaries.values()), args.docs)


def lost(summaries: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """Return the runs that did not reach full slip, with the reason."""
    no_slip = "no steady full slip by the end of the slide"
    return [f"{label}: {s.get('failure', no_slip)}" for label, s in summaries.items() if not s.get("full_slip")]


# -- comparison ----------------------------------------------------------------------------------------------
def known(points: Sequence[Point], quantity: str, measure: str = "work") -> list[tuple[float, float, Point]]:
    """Return the points that answer for a quantity, with cost and error, from cheap to expensive."""
    found = [(cost, p.error(quantity) or 0.0, p) for p in points if (cost := p.cost(quantity, measure)) is not None]
    return sorted(found, key=lambda each: each[:2])


def judged(points: Sequence[Point]) -> list[Point]:
    """Return the runs along the whole path with the default's contact model: another may hide the mesh's error."""
    return [p for p in points if p.family not in (*NO_PATH, OTHER_MODEL)]


def front(points: Sequence[Point], quantity: str, measure: str = "work") -> list[Point]:
    """Return Pareto's front from cheap to expensive: no other judged run is both cheaper and more accurate."""
    some = known(judged(points), quantity, measure)
    return [p for k, (_, error, p) in enumerate(some) if all(error < other for _, other, _ in some[:k])]


def _default(points: Sequence[Point]) -> Point:
    return next(p for p in points if p.label == DEFAULT)


def base(points: Sequence[Point], quantity: str, measure: str = "work") -> float:
    """Return the cost of the default scene.

    Raises:
        ValueError: it was not kept.
    """
    cost = _default(points).cost(quantity, measure)
    if cost is None:
        raise ValueError(f"the {MEASURES[measure]} of the default scene is not known; delete its run, run it again")
    return cost


def cheapest(points: Sequence[Point], some: Sequence[Point], quantity: str, target: float, measure: str) -> str:
    """Return the cheapest of some points within an error, with its cost over the default's."""
    own = base(points, quantity, measure)
    good = (f"{p.label}: {cost / own:.2g}" for cost, error, p in known(some, quantity, measure) if error <= target)
    return next(good, "none")


# -- page ----------------------------------------------------------------------------------------------------
_MARKS = {  # kind of setting: its families, colour, marker
    "mesh sizes": (("contact size", "growth", "size at the sites", "all sizes"), harness.BLUE, "o"),
    "element": (("element",), harness.PURPLE, "D"),
    "solver or steps": (("solver", "steps"), harness.GREY, "X"),
    "without the path": ((REQUESTED, AGAIN), harness.GREEN, "^"),
    "smooth finger": ((REDUCED,), harness.ORANGE, "s"),
}
_PANELS = ("slip_f_t", "normal_contact_length", "slip_sed_0", ALL)


def _words(quantity: str) -> str:
    state, kind = quantity.split("_", 1)
    return "largest error of all quantities" if quantity == ALL else f"{KINDS[kind]}, {STATES[state]}"


def _costs(points: Sequence[Point], some: Sequence[Point], reference: Reference, measure: str) -> str:
    """Return the table of the cheapest of some points for each error; beside runs with a path the default's error."""
    rows, default = list[list[str]](), _default(points)
    path = default in some
    for quantity in (*QUANTITIES, ALL):
        rows.append([_words(quantity), *(cheapest(points, some, quantity, t, measure) for t in TARGETS)])
        if path:
            error = f"{100 * (default.error(quantity) or 0):.2g} ± {100 * reference[quantity].relative:.1g} %"
            rows[-1] += [error, "yes" if default in front(points, quantity, measure) else "no"]
    head = ["quantity", *(f"{100 * t:g} %" for t in TARGETS)]
    return harness.table(head + ["error of the default", "on the front"] * path, rows)


def _panel(ax: Axes, points: Sequence[Point], quantity: str, bar: float) -> None:
    def at(some: Sequence[Point]) -> tuple[list[float], list[float]]:
        pairs = [(cost / own, error) for cost, error, _ in known(some, quantity) if cost]
        return [x for x, _ in pairs], [y for _, y in pairs]

    own = base(points, quantity)
    ax.axhspan(1e-9, bar, color="0.9", lw=0)
    ax.step(*at(front(points, quantity)), "k-", where="post", lw=0.9, label="front")
    for words, (families, colour, marker) in _MARKS.items():
        some = [p for p in points if p.family in families and p.label != DEFAULT]
        ax.plot(*at(some), marker, color=colour, ms=6, label=words)
    ax.plot(*at([_default(points)]), "*", color=harness.VERMILION, mec="black", mew=0.5, ms=14, label="default")
    shown = at([p for p in points if p.family != OTHER_MODEL])[1]
    ax.set(yscale="log", title=_words(quantity), ylim=(max(0.5 * min(shown), bar / 5), 2 * max(shown)))
    harness.ticks(ax, (0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0))
    ax.set_xlim(0.04, 9)


def _paint(figure: Figure, points: Sequence[Point], reference: Reference) -> None:
    """Draw error over work for friction, a contact length, an energy density and the largest of all errors."""
    axes = figure.subplots(2, 2)
    for ax, quantity in zip(axes.flat, _PANELS, strict=True):
        _panel(ax, points, quantity, reference[quantity].relative)
    for k in range(2):
        axes[1, k].set_xlabel("work / work of the default scene")
        axes[k, 0].set_ylabel("relative error")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4)


def _finding(points: Sequence[Point]) -> str:
    text, error, everything = harness.prose("chart"), 100 * (_default(points).error(ALL) or 0), [*QUANTITIES, ALL]
    on = sum(_default(points) in front(points, quantity) for quantity in everything)
    aims = ((ALL, 0.05), ("slip_f_t", 0.01), ("slip_f_t", 0.002))
    best = [cheapest(points, judged(points), quantity, target, "work") for quantity, target in aims]
    parts = [text["finding"].format(*best, error=error, on=on, n=len(everything))]
    for p in points:
        if p.label == "P1":
            wrong = (100 * p.errors[name] for name in ("normal_contact_length", "slip_sed_0"))
            parts.append(text["linear"].format(*wrong))
    return "\n\n".join(parts)


def _other_models(points: Sequence[Point]) -> str:
    names = ("slip_f_t", "normal_contact_length", "slip_contact_length")
    own, others = base(points, ALL), [p for p in points if p.family == OTHER_MODEL]
    rows = [[p.label, f"{p.work['slip'] / own:.2g}"] + [f"{100 * p.errors[q]:.2g} %" for q in names] for p in others]
    return harness.table(["formulation or penalty", "work", *map(_words, names)], rows)


def draw(docs: Path) -> Path:
    """Draw page and picture from the kept numbers."""
    kept, text = harness.kept("chart", docs), harness.prose("chart")
    points = [Point(**each) for each in kept.numbers["points"]]
    reference = {name: Limit(**each) for name, each in kept.numbers["reference"].items()}
    reference[ALL] = Limit(1.0, max(end.relative for end in reference.values()), None)
    states, lost_ones = [p for p in points if p.family in NO_PATH], kept.numbers["lost"]
    ran = len(points) - len(states)
    fronts = {quantity: "; ".join(p.label for p in front(points, quantity)) for quantity in (*QUANTITIES, ALL)}
    lists = "\n".join(f"- {_words(quantity)}: {labels}" for quantity, labels in fronts.items())

    def tables(some: Sequence[Point]) -> str:
        work, time = (_costs(points, some, reference, measure) for measure in MEASURES)
        return f"{work}\n\n{harness.folded('The same by processor time', time)}"

    body = [
        harness.picture(docs / "chart.png", (9, 7), lambda figure: _paint(figure, points, reference), text["caption"]),
        "## Cheapest run for an error\n\nA number is the work over that of the default scene.",
        tables(judged(points)),
        text["without"],
        tables(states),
        "## Other formulations and penalties\n\nDifferences from the limit over the default's penalty.",
        _other_models(points),
        harness.folded("Fronts over work, from cheap to expensive", lists),
        f"## Runs\n\n{ran} of {ran + len(lost_ones)} runs reached full slip.",
        *(f"Not reached: {words}" for words in lost_ones),
    ]
    path, names = docs / "chart.md", ["chart", "errors"]
    return harness.page(path, "Error over work", _finding(points), text["how"], body, "make chart", kept.made, names)


if __name__ == "__main__":
    sys.exit(harness.main(__doc__, compute, draw))
