"""Error against work: one setting after the other, around the default scene.

environment/run python3 benchmarks/chart.py [--jobs 2] [--draw]     also: make chart

Each run is the default scene (press, charge, slide to full slip) with a setting of its own; what else there is, and
what error and work are, says benchmarks/points.py. Writes docs/chart.md, docs/chart.png, docs/chart_time.png and
docs/chart.json; runs are kept in results/traces, so that drawing anew takes seconds.
"""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks import arguments, errors
from benchmarks.convergence import Limit
from benchmarks.paper.style import BLUE, GREEN, GREY, PURPLE, VERMILION, draw
from benchmarks.points import (
    AGAIN,
    ALL,
    ASKED,
    DEFAULT,
    KINDS,
    LADDER,
    MEASURES,
    QUANTITIES,
    RUNG_1,
    STATES,
    Point,
    collect,
    missing,
    scenes,
)
from fingerpad.io.files import replace, replace_json
from fingerpad.runs.batch import sweep

_LIMIT = 10800.0  # s of processor time for one run
_TICKS = (0.05, 0.1, 0.2, 0.5, 1.0, 2.0)
TARGETS = (5e-2, 1e-2, 2e-3)  # errors that the table tells the cost of
PICTURES = {"work": "chart.png", "seconds": "chart_time.png"}
_LOOKS = {
    "contact size": (BLUE, "o"),
    "growth": (VERMILION, "^"),
    "size at the sites": (GREEN, "s"),
    "all sizes": ("black", "P"),
    "element": (PURPLE, "D"),
    "formulation": ("#E69F00", "v"),
    "solver": (GREY, "X"),
    "steps": ("#56B4E9", "<"),
}
_ALL_AT = (0, 1)  # row and column of the panel
OTHER_MODEL = "formulation"
_STATES_ONLY = {ASKED: ("black", "1"), AGAIN: ("black", "2"), LADDER: ("black", "x")}  # no whole path


def known(points: Sequence[Point], quantity: str, measure: str) -> list[tuple[float, Point]]:
    """Return the points that say something of a quantity, with what they cost, from cheap to dear."""
    found = [(cost, p) for p in points if (cost := p.cost(quantity, measure)) is not None]
    return sorted(found, key=lambda each: (each[0], each[1].errors[quantity]))


def whole(points: Sequence[Point]) -> list[Point]:
    """Return the runs that have followed the whole path to their states."""
    return [p for p in points if p.family not in _STATES_ONLY]


def front(points: Sequence[Point], quantity: str, measure: str = "work") -> list[Point]:
    """Return Pareto's front from cheap to dear: no other run of the model is both cheaper and nearer to the reference.

    Runs with another formulation or penalty are of another model, whose difference may hide the mesh's error.
    """
    found = list[Point]()
    for _, point in known([p for p in whole(points) if p.family != OTHER_MODEL], quantity, measure):
        if not found or point.errors[quantity] < found[-1].errors[quantity]:
            found.append(point)
    return found


def _default(points: Sequence[Point]) -> Point:
    return next(p for p in points if p.label == DEFAULT)


def _base(points: Sequence[Point], quantity: str, measure: str) -> float:
    cost = _default(points).cost(quantity, measure)
    if cost is None:
        raise ValueError(
            f"what the default scene took in {MEASURES[measure]} is not known; delete its run, run it again"
        )
    return cost


def _panel(ax: Axes, points: Sequence[Point], quantity: str, reference: Limit, measure: str) -> None:
    base = _base(points, quantity, measure)

    def at(some: Sequence[Point]) -> tuple[list[float], list[float]]:
        pairs = [(cost / base, p.errors[quantity]) for cost, p in known(some, quantity, measure)]
        return [x for x, _ in pairs], [y for _, y in pairs]

    ax.axhspan(1e-6, reference.bar / abs(reference.value), color="0.9", lw=0)
    for point in points:
        if point.label == RUNG_1 and quantity in point.errors:
            ax.axhline(point.errors[quantity], color="black", ls=":", lw=0.8)
    points = [p for p in points if p.label != RUNG_1]
    ax.step(*at(front(points, quantity, measure)), "k-", where="post", lw=0.8)
    for family, (colour, marker) in (_LOOKS | _STATES_ONLY).items():
        size = 8 if family in _STATES_ONLY else 5
        ax.plot(*at([p for p in points if p.family == family and p.label != DEFAULT]), marker, color=colour, ms=size)
    ax.plot(*at([_default(points)]), "*", color=BLUE, mec="black", mew=0.5, ms=13)
    ax.set(xscale="log", yscale="log")
    ax.set_xticks(_TICKS, [f"{tick:g}" for tick in _TICKS])
    ax.minorticks_off()
    shown = [p.errors[quantity] for _, p in known(points, quantity, measure)]
    ax.set_ylim(max(0.5 * min(shown), 1e-5), 2 * max(shown))
    ax.set(title=_words(quantity).replace(", ", "\n", 1))


def paint(figure: Figure, points: Sequence[Point], reference: Mapping[str, Limit], measure: str) -> None:
    """Draw a panel for each quantity in each state; f_T is that of full slip, beside it are all and the legend."""
    axes = figure.subplots(len(KINDS), len(STATES))
    for row, kind in enumerate(KINDS):
        for column, state in enumerate(STATES):
            ax, quantity = axes[row, column], ALL if (row, column) == _ALL_AT else f"{state}_{kind}"
            if quantity not in reference:
                ax.axis("off")
                continue
            _panel(ax, points, quantity, reference[quantity], measure)
    for ax in axes[-1]:
        ax.set_xlabel(f"{MEASURES[measure]} / the default's")
    for ax in (axes[0, 1], axes[1, 0], axes[2, 0]):
        ax.set_ylabel("relative error")
    legend, words = axes[0, 0], {ASKED: ASKED, AGAIN: "states solved again, finer and finer", LADDER: "rung 2"}
    handles = [legend.plot([], [], m, color=c, label=family)[0] for family, (c, m) in _LOOKS.items()]
    handles += legend.plot([], [], "*", color=BLUE, mec="black", ms=12, label="default scene")
    handles += legend.plot([], [], "k-", lw=0.8, label="Pareto's front")
    for family, (colour, marker) in _STATES_ONLY.items():
        handles += legend.plot([], [], marker, color=colour, ms=8, label=words[family])
    handles += legend.plot([], [], "k:", lw=0.8, label="rung 1, at once")
    handles.append(legend.fill_between([], [], color="0.9", label="below the reference's error bar"))
    legend.legend(handles=handles, loc="upper left", ncols=2, bbox_to_anchor=(0.0, 1.0))


def _cheapest(points: Sequence[Point], quantity: str, measure: str, base: float) -> list[str]:
    cells = []
    for target in TARGETS:
        good = [(cost, p) for cost, p in known(points, quantity, measure) if p.errors[quantity] <= target]
        cells.append(f"{good[0][1].label}: {good[0][0] / base:.2g}" if good else "none")
    return cells


def costs(points: Sequence[Point], reference: Mapping[str, Limit], measure: str) -> str:
    """Return a table of what errors cost: the cheapest run for each, and its cost over the default's."""
    base = _default(points)
    targets = " | ".join(f"{100 * t:g} %" for t in TARGETS)
    lines = [f"| | reference's bar | {targets} | default's error | on the front |", "|---" * (len(TARGETS) + 4) + "|"]
    for quantity in (*QUANTITIES, ALL):
        end = reference[quantity]
        bar = end.bar / abs(end.value)
        runs = [p for p in whole(points) if p.family != OTHER_MODEL]
        cells = _cheapest(runs, quantity, measure, _base(points, quantity, measure))
        off = "not resolved" if base.errors[quantity] < bar else "no"
        on = "yes" if base in front(points, quantity, measure) else off
        cells = [_words(quantity), f"{100 * bar:.2g} %", *cells, f"{100 * base.errors[quantity]:.2g} %", on]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def costs_of_states(points: Sequence[Point], measure: str) -> str:
    """Return the same of the points that have a state or two and no path."""
    some = [p for p in points if p.family in _STATES_ONLY]
    lines = ["| | " + " | ".join(f"{100 * t:g} %" for t in TARGETS) + " |", "|---" * (len(TARGETS) + 1) + "|"]
    for quantity in (*QUANTITIES, ALL):
        cells = _cheapest(some, quantity, measure, _base(points, quantity, measure))
        lines.append("| " + " | ".join([_words(quantity), *cells]) + " |")
    return "\n".join(lines)


def _words(quantity: str) -> str:
    state, kind = quantity.split("_", 1)
    return "all of these, the largest error" if quantity == ALL else f"{KINDS[kind]}, {STATES[state]}"


_HEADER = """# What accuracy costs

Made by `make chart`; do not edit. The default scene with one setting after the other changed, around a contact size of
10 µm unless said otherwise. An error is the relative distance from the limit of [errors.md](errors.md), whose error bar
is grey: what lies in the grey is not resolved. Work is the number of factorisations up to the state times the number of
unknowns; processor time has the set-up in it, and shared its machine with other runs. *Not resolved*: cheaper runs come
out nearer, but the default's error is below the bar. Energy densities at the sites do not feel the contact size, so
that runs with a coarser one are cheaper than the default there, which is for all quantities at once: the last row is of
the largest of these errors.

The front and the first tables are of the runs that follow the whole path of the loads with the default's penalty, which
the reference has. Another formulation or penalty is another model, drawn but not judged: a softer screen's longer
contact hides the mesh's shorter one. What has two or three states alone is drawn beside the front as well: an accuracy
asked for (all of its solves and the estimate are in its cost), states solved again on finer and finer meshes (each with
its path and the coarser meshes), and the rungs of [the ladder](ladder.md), of which the first knows the uncharged
contact length from full runs.
The data: [chart.json](chart.json).
"""
_TABLES = {
    "work": "The cheapest run for an error, and its factorisations × unknowns over those of the default scene:",
    "seconds": "The same by processor time:",
}


def write(
    points: Sequence[Point],
    total: int,
    reference: Mapping[str, Limit],
    docs: Path,
    absent: Sequence[str] = (),
) -> None:
    """Write page, pictures and data."""
    reference = {
        **reference,
        ALL: Limit(1.0, max(reference[q].bar / abs(reference[q].value) for q in QUANTITIES), None),
    }
    for measure, name in PICTURES.items():
        paint_all = partial(paint, points=points, reference=reference, measure=measure)
        draw(docs / name, (12, 10), paint_all)
    runs = whole(points)
    names = {quantity: "; ".join(p.label for p in front(points, quantity)) for quantity in (*QUANTITIES, ALL)}
    fronts = "\n".join(f"- {_words(quantity)}: {labels}" for quantity, labels in names.items())
    parts = [_HEADER, f"{len(runs)} of {total} runs.", *(f"Not there: {words}." for words in absent)]
    for measure, words in _TABLES.items():
        parts += [f"![Relative error over {MEASURES[measure]}]({PICTURES[measure]})"]
        parts += [words, costs(points, reference, measure)]
        parts += ["The same without the path of the loads:", costs_of_states(points, measure)]
    parts.append(f"Pareto's fronts over factorisations × unknowns, from cheap to dear:\n\n{fronts}")
    replace(docs / "chart.md", "\n\n".join(parts) + "\n")
    data = {"reference": {q: vars(reference[q]) for q in QUANTITIES}, "points": [asdict(p) for p in points]}
    replace_json(docs / "chart.json", data)


def main(given: Sequence[str] | None = None) -> int:
    """Run what is missing and write the page."""
    parser = arguments.parser(__doc__)
    parser.add_argument("--draw", action="store_true", help="run nothing, draw what is there")
    args = parser.parse_args(given)
    wanted = scenes()
    if not args.draw:
        sweep({f"{family}: {label}": scene for (family, label), scene in wanted.items()}, args.out, args.jobs, _LIMIT)
    reference = errors.reference(args.out)
    if not reference:
        parser.error("the reference is missing; run benchmarks/errors.py first")
    points = collect(args.out, args.docs, reference)
    write(points, len(wanted), reference, args.docs, missing(args.out))
    ran = len(whole(points))
    print(f"{ran} of {len(wanted)} runs; {args.docs / 'chart.md'}")
    return 0 if ran == len(wanted) else 1


if __name__ == "__main__":
    sys.exit(main())
