"""Error over work: one numerical setting after the other, around the default scene.

environment/run python3 -m benchmarks.chart [--jobs 2] [--draw]     after benchmarks.errors, accuracy and models; hours

Each run is the default scene (press, charge, slide to full slip) with a setting of its own (benchmarks/points.py).
Writes docs/chart.json, docs/chart.md and docs/chart.png.
"""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks import errors, harness
from benchmarks import points as all_points
from benchmarks.convergence import Limit
from benchmarks.points import ALL, DEFAULT, KINDS, NO_PATH, OTHER_MODEL, QUANTITIES, REDUCED, Point, Reference

_LIMIT = 10800.0  # s of processor time for one run
MEASURES = {"work": "factorisations × unknowns", "seconds": "processor time"}
TARGETS = (5e-2, 1e-2, 2e-3)  # errors whose cost is in the tables


# -- numbers -------------------------------------------------------------------------------------------------
def compute(args: Any) -> None:
    """Run what is missing and keep the numbers."""
    wanted = {label: scene for (_, label), scene in all_points.scenes().items()}
    summaries, reference = harness.run(wanted, args, _LIMIT), errors.known(args.docs)
    found = [*all_points.runs(args.out, reference), *all_points.without_path(args.docs, reference)]
    numbers = {
        "reference": {name: vars(reference[name]) for name in QUANTITIES},
        "points": [asdict(point) for point in found],
        "lost": lost(summaries),
    }
    harness.keep("chart", numbers, harness.made(summaries.values()), args.docs)


def lost(summaries: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """Return the runs that did not reach full slip, with the reason."""
    no_slip = "no steady full slip by the end of the slide"
    return [f"{label}: {s.get('failure', no_slip)}" for label, s in summaries.items() if not s.get("full_slip")]


# -- page ----------------------------------------------------------------------------------------------------
def known(points: Sequence[Point], quantity: str, measure: str) -> list[tuple[float, float, Point]]:
    """Return the points that answer for a quantity, with cost and error, from cheap to expensive."""
    found = [(cost, p.error(quantity) or 0.0, p) for p in points if (cost := p.cost(quantity, measure)) is not None]
    return sorted(found, key=lambda each: each[:2])


def judged(points: Sequence[Point]) -> list[Point]:
    """Return the runs along the whole path with the default's contact model.

    Another formulation or penalty is another model: its difference may hide the mesh's error.
    """
    return [p for p in points if p.family not in (*NO_PATH, OTHER_MODEL)]


def front(points: Sequence[Point], quantity: str, measure: str = "work") -> list[Point]:
    """Return Pareto's front from cheap to expensive: no other judged run is both cheaper and more accurate."""
    found, least = list[Point](), np.inf
    for _, error, point in known(judged(points), quantity, measure):
        if error < least:
            found.append(point)
            least = error
    return found


def _default(points: Sequence[Point]) -> Point:
    return next(p for p in points if p.label == DEFAULT)


def base(points: Sequence[Point], quantity: str, measure: str) -> float:
    """Return the cost of the default scene.

    Raises:
        ValueError: it was not kept.
    """
    cost = _default(points).cost(quantity, measure)
    if cost is None:
        raise ValueError(f"the {MEASURES[measure]} of the default scene is not known; delete its run, run it again")
    return cost


def cheapest(some: Sequence[Point], quantity: str, measure: str, own: float, target: float) -> str:
    """Return the cheapest of some points within an error, with its cost over ``own``."""
    good = [(p.label, cost / own) for cost, error, p in known(some, quantity, measure) if error <= target]
    return f"{good[0][0]}: {good[0][1]:.2g}" if good else "none"


def costs(points: Sequence[Point], some: Sequence[Point], reference: Reference, measure: str) -> str:
    """Return the table of the cheapest of some points for each error; beside runs with a path the default's error."""
    rows, default, path = [], _default(points), DEFAULT in (p.label for p in some)
    for quantity in (*QUANTITIES, ALL):
        own, bar = base(points, quantity, measure), 100 * _bar(reference[quantity])
        rows.append([_words(quantity), *(cheapest(some, quantity, measure, own, target) for target in TARGETS)])
        if path:
            on = "yes" if default in front(points, quantity, measure) else "no"
            rows[-1] += [f"{100 * (default.error(quantity) or 0):.2g} ± {bar:.1g} %", on]
    head = ["quantity", *(f"{100 * t:g} %" for t in TARGETS)]
    return harness.table(head + ["error of the default", "on the front"] * path, rows)


def _bar(end: Limit) -> float:
    return end.bar / abs(end.value)


def _words(quantity: str) -> str:
    state, kind = quantity.split("_", 1)
    return "largest error of all quantities" if quantity == ALL else f"{KINDS[kind]}, {errors.STATES[state]}"


_MARKS = {  # kind of setting: its families, colour, marker
    "mesh sizes": (("contact size", "growth", "size at the sites", "all sizes"), harness.BLUE, "o"),
    "element": (("element",), harness.PURPLE, "D"),
    "solver or steps": (("solver", "steps"), harness.GREY, "X"),
    "without the path": ((all_points.REQUESTED, all_points.AGAIN), harness.GREEN, "^"),
    "smooth finger": ((REDUCED,), harness.ORANGE, "s"),
}
_PANELS = ("slip_f_t", "normal_contact_length", "slip_sed_0", ALL)


def _panel(ax: Axes, points: Sequence[Point], quantity: str, bar: float) -> None:
    own = base(points, quantity, "work")

    def at(some: Sequence[Point]) -> tuple[list[float], list[float]]:
        pairs = [(cost / own, error) for cost, error, _ in known(some, quantity, "work") if cost]
        return [x for x, _ in pairs], [y for _, y in pairs]

    ax.axhspan(1e-9, bar, color="0.9", lw=0)
    best = front(points, quantity)
    ax.step(*at(best), "k-", where="post", lw=0.9, label="front")
    for words, (families, colour, marker) in _MARKS.items():
        some = [p for p in points if p.family in families and p.label != DEFAULT]
        ax.plot(*at(some), marker, color=colour, ms=6, label=words)
    ax.plot(*at([_default(points)]), "*", color=harness.VERMILION, mec="black", mew=0.5, ms=14, label="default")
    ax.set(xscale="log", yscale="log", title=_words(quantity), xlim=(0.04, 9))
    ticks = (0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
    ax.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    ax.minorticks_off()
    shown = at([p for p in points if p.family != OTHER_MODEL])[1]
    ax.set_ylim(max(0.5 * min(shown), bar / 5), 2 * max(shown))
    ax.grid(alpha=0.3)


def paint(figure: Figure, points: Sequence[Point], reference: Reference) -> None:
    """Draw error over work for friction, a contact length, an energy density and the largest of all errors."""
    axes = figure.subplots(2, 2)
    for ax, quantity in zip(axes.flat, _PANELS, strict=True):
        _panel(ax, points, quantity, _bar(reference[quantity]))
    for ax in axes[1]:
        ax.set_xlabel("work / work of the default scene")
    for ax in axes[:, 0]:
        ax.set_ylabel("relative error")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4)


_HOW = """Each run is the default scene (75 N/m, 200 V, slid to full slip) with one setting changed, around a contact
size of 10 µm unless its name gives another one. The *error* is the relative distance from the limit of
[errors.md](errors.md). *Work* is the number of factorisations up to the state of the quantity, times the number of
unknowns. Processor time includes the set-up, on a machine shared with other runs. The *front* has the runs for which no
other run is both cheaper and more accurate. It compares runs along the whole load path with the default's penalty.

Another formulation or penalty is another model and is not judged: the longer contact over a softer screen hides the
shorter one of a coarse mesh. Energy densities at the Merkel sites hardly depend on the contact size, so that runs with
a coarser contact are cheaper than the default there."""
_WITHOUT = """These answers have one to three states and no path. A requested accuracy costs all of its solves. A state
solved again costs its coarse path and the coarser meshes, too. Of the reduced models ([models.md](models.md)),
`cylinders` takes the uncharged contact length from full runs."""


def _finding(points: Sequence[Point]) -> str:
    default, everything = _default(points), [*QUANTITIES, ALL]
    on = sum(default in front(points, quantity) for quantity in everything)
    aims = ((ALL, 0.05), ("slip_f_t", 0.01), ("slip_f_t", 0.002))
    best = [cheapest(judged(points), q, "work", base(points, q, "work"), target) for q, target in aims]
    finding = (
        f"The default settings give all quantities to {100 * (default.error(ALL) or 0):.2g} %. For {on} of "
        f"{len(everything)} quantities no other run is both cheaper and more accurate.\n\nLess accuracy costs less. "
        "The cheapest settings, with their work over the default's, are:\n\n"
        f"- for all quantities within 5 %: {best[0]},\n- for the friction within 1 %: {best[1]},\n"
        f"- for the friction within 0.2 %: {best[2]}."
    )
    linear = next((p.errors for p in points if p.label == "P1"), None)
    if linear is None:
        return finding
    length, sed = linear["normal_contact_length"], linear["slip_sed_0"]
    return finding + (
        f"\n\nLinear elements (P1) are cheaper still, but wrong by {100 * length:.0f} % in the contact length and by "
        f"{100 * sed:.0f} % in the energy density."
    )


def _other_models(points: Sequence[Point]) -> str:
    rows = []
    for p in points:
        if p.family == OTHER_MODEL:
            cells = (f"{100 * p.errors[q]:.2g} %" for q in ("slip_f_t", "normal_contact_length", "slip_contact_length"))
            rows.append([p.label, f"{p.work['slip'] / base(points, ALL, 'work'):.2g}", *cells])
    head = [
        "formulation or penalty",
        "work",
        *map(_words, ("slip_f_t", "normal_contact_length", "slip_contact_length")),
    ]
    return harness.table(head, rows)


def draw(docs: Path) -> Path:
    """Draw page and picture from the kept numbers."""
    kept = harness.kept("chart", docs)
    points = [Point(**each) for each in kept.numbers["points"]]
    reference = {name: Limit(**each) for name, each in kept.numbers["reference"].items()}
    reference[ALL] = Limit(1.0, max(map(_bar, reference.values())), None)
    states = [p for p in points if p.family in NO_PATH]
    fronts = {quantity: "; ".join(p.label for p in front(points, quantity)) for quantity in (*QUANTITIES, ALL)}
    lists = "\n".join(f"- {_words(quantity)}: {labels}" for quantity, labels in fronts.items())
    caption = (
        "The default scene (star) lies on the front of error over work or close to it. Grey: below the uncertainty of "
        "the limit."
    )
    ran, lost_ones = len(points) - len(states), kept.numbers["lost"]
    work, time = ([costs(points, some, reference, m) for some in (judged(points), states)] for m in MEASURES)
    body = [
        harness.picture(docs / "chart.png", (9, 7), lambda figure: paint(figure, points, reference), caption),
        "## Cheapest run for an error",
        "A number is the work over that of the default scene.",
        work[0],
        harness.folded("The same by processor time", time[0]),
        "## Without the path",
        _WITHOUT,
        work[1],
        harness.folded("The same by processor time", time[1]),
        "## Other formulations and penalties",
        "Differences from the limit over the default's penalty.",
        _other_models(points),
        harness.folded("Fronts over work, from cheap to expensive", lists),
        "## Runs",
        f"{ran} of {ran + len(lost_ones)} runs reached full slip.",
        *(f"Not reached: {words}" for words in lost_ones),
    ]
    names = ["chart", "errors"]
    return harness.page(
        docs / "chart.md", "Error over work", _finding(points), _HOW, body, "make chart", kept.made, names
    )


if __name__ == "__main__":
    sys.exit(harness.main(__doc__, compute, draw))
