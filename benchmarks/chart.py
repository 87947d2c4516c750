"""Error against work: one setting after the other, around the default scene.

environment/run python3 benchmarks/chart.py [--jobs 2] [--draw]     also: make chart

Each run is the default scene (press, charge, slide to full slip) with a setting of its own. Its error is the distance
from the reference of benchmarks/errors.py; its work the factorisations up to a state times the unknowns, or processor
time. Writes docs/chart.md, docs/chart.png, docs/chart_time.png and docs/chart.json; runs are kept in results/traces, so
that drawing anew takes seconds.
"""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks import arguments, errors
from benchmarks.convergence import Limit
from benchmarks.paper.style import BLUE, GREEN, GREY, PURPLE, VERMILION, draw
from benchmarks.runs import Run
from fingerpad.files import replace, replace_json
from fingerpad.reach import by_rule
from fingerpad.scene import Scene, from_data
from fingerpad.sweep import result, sweep

_LIMIT = 10800.0  # s of processor time for one run
DEFAULT = "default"
_TICKS = (0.2, 0.5, 1.0, 2.0)
TARGETS = (5e-2, 1e-2, 2e-3)  # errors that the table tells the cost of
STATES = {"press": "normal contact", "normal": "charged contact", "slip": "full slip"}
KINDS = {"f_t": "f_T and µ_app", "contact_length": "contact length", "sed_0": "SED at the central Merkel site"}
MEASURES = {"work": "factorisations × unknowns", "seconds": "processor time"}
PICTURES = {"work": "chart.png", "seconds": "chart_time.png"}
QUANTITIES = [f"{state}_{kind}" for kind in KINDS for state in STATES if kind != "f_t" or state == "slip"]


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
        "Nitsche": _mesh() | {"contact": {"formulation": "nitsche"}},
        "augmented Lagrangian": _mesh() | {"contact": {"formulation": "augmented"}},
    }
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


@dataclass(frozen=True)
class Point:
    """A run in the chart."""

    label: str
    family: str
    work: Mapping[str, float]
    """Factorisations up to a state times unknowns, by state."""
    seconds: Mapping[str, float]
    """Processor time up to a state, set-up included, by state; empty for runs of versions that did not keep it."""
    errors: Mapping[str, float]
    """Relative distance from the reference, by quantity."""


def scenes() -> dict[tuple[str, str], Scene]:
    """Return all scenes by family and label, the default one first."""
    found = {("contact size", DEFAULT): errors.DEFAULT}
    for family, settings in FAMILIES.items():
        found |= {(family, label): by_rule(from_data(data)) for label, data in settings.items()}
    return found


def collect(out: Path, reference: Mapping[str, Limit]) -> list[Point]:
    """Return what has been run to full slip."""
    points = []
    for (family, label), scene in scenes().items():
        values = errors.values(scene, out)
        if values is None:
            continue
        run = Run(scene, out)
        spent = np.cumsum(run.steps["factorisations"]) * run.summary["unknowns"]
        seconds = run.steps.get("processor_seconds")
        rows = {"press": run.pressed, "normal": run.normal, "slip": run.slip}
        points.append(
            Point(
                label,
                family,
                {state: float(spent[row]) for state, row in rows.items()},
                {} if seconds is None else {state: float(seconds[row]) for state, row in rows.items()},
                {name: abs(values[name] / reference[name].value - 1) for name in QUANTITIES},
            )
        )
    return points


def lost(out: Path) -> list[str]:
    """Return the runs that did not reach full slip, and why."""
    found = {label: result(scene, out) or {} for (_, label), scene in scenes().items()}
    return [f"{label}: {summary['failure']}" for label, summary in found.items() if "failure" in summary]


def state_of(quantity: str) -> str:
    """Return the state that a quantity is of."""
    return quantity.split("_", 1)[0]


def cost(point: Point, quantity: str, measure: str) -> float:
    """Return what a run cost up to the state of a quantity; ``measure`` is ``work`` or ``seconds``."""
    return float(getattr(point, measure)[state_of(quantity)])


def known(points: Sequence[Point], measure: str) -> list[Point]:
    """Return the runs whose cost is known."""
    return [p for p in points if getattr(p, measure)]


def front(points: Sequence[Point], quantity: str, measure: str = "work") -> list[Point]:
    """Return Pareto's front from cheap to dear: no other run is both cheaper and nearer to the reference."""
    found = list[Point]()
    for point in sorted(known(points, measure), key=lambda p: (cost(p, quantity, measure), p.errors[quantity])):
        if not found or point.errors[quantity] < found[-1].errors[quantity]:
            found.append(point)
    return found


def _panel(ax: Axes, points: Sequence[Point], quantity: str, reference: Limit, measure: str) -> None:
    points = known(points, measure)
    base = cost(_default(points), quantity, measure)

    def at(some: Sequence[Point]) -> tuple[list[float], list[float]]:
        return [cost(p, quantity, measure) / base for p in some], [p.errors[quantity] for p in some]

    ax.axhspan(1e-6, reference.bar / abs(reference.value), color="0.9", lw=0)
    ax.step(*at(front(points, quantity, measure)), "k-", where="post", lw=0.8)
    for family, (colour, marker) in _LOOKS.items():
        ax.plot(*at([p for p in points if p.family == family and p.label != DEFAULT]), marker, color=colour, ms=5)
    ax.plot(*at([_default(points)]), "*", color=BLUE, mec="black", mew=0.5, ms=13)
    ax.set(xscale="log", yscale="log")
    ax.set_xticks(_TICKS, [f"{tick:g}" for tick in _TICKS])
    ax.minorticks_off()
    ax.set(title=f"{KINDS[quantity.split('_', 1)[1]]}, {STATES[state_of(quantity)]}")


def _default(points: Sequence[Point]) -> Point:
    return next(p for p in points if p.label == DEFAULT)


def paint(figure: Figure, points: Sequence[Point], reference: Mapping[str, Limit], measure: str) -> None:
    """Draw a panel for each quantity in each state; f_T is that of full slip, the free places hold the legend."""
    axes = figure.subplots(len(KINDS), len(STATES))
    for row, kind in enumerate(KINDS):
        for column, state in enumerate(STATES):
            ax, quantity = axes[row, column], f"{state}_{kind}"
            if quantity not in QUANTITIES:
                ax.axis("off")
                continue
            _panel(ax, points, quantity, reference[quantity], measure)
            smallest = min(p.errors[quantity] for p in points)
            ax.set_ylim(max(0.5 * smallest, 1e-5), 2 * max(p.errors[quantity] for p in points))
    for ax in axes[-1]:
        ax.set_xlabel(f"{MEASURES[measure]} / the default's")
    for ax in (axes[0, 2], axes[1, 0], axes[2, 0]):
        ax.set_ylabel("relative error")
    handles = [
        axes[0, 0].plot([], [], marker, color=colour, label=family)[0] for family, (colour, marker) in _LOOKS.items()
    ]
    handles += axes[0, 0].plot([], [], "*", color=BLUE, mec="black", ms=12, label="default scene")
    handles += axes[0, 0].plot([], [], "k-", lw=0.8, label="Pareto's front")
    handles.append(axes[0, 0].fill_between([], [], color="0.9", label="below the reference's error bar"))
    axes[0, 0].legend(handles=handles, loc="upper left", ncols=2, bbox_to_anchor=(0.0, 1.0))


def costs(points: Sequence[Point], reference: Mapping[str, Limit], measure: str) -> str:
    """Return a table of what errors cost: the cheapest run for each, and its cost over the default's."""
    base = _default(points)
    lines = [
        "| | reference's bar | " + " | ".join(f"{100 * t:g} %" for t in TARGETS) + " | default's error | on the front |"
    ]
    lines.append("|---" * (len(TARGETS) + 4) + "|")
    for quantity in QUANTITIES:
        state, kind = quantity.split("_", 1)
        cells = [f"{100 * reference[quantity].bar / abs(reference[quantity].value):.2g} %"]
        for target in TARGETS:
            good = [p for p in known(points, measure) if p.errors[quantity] <= target]
            best = min(good, key=lambda p: cost(p, quantity, measure), default=None)
            ratio = 0.0 if best is None else cost(best, quantity, measure) / cost(base, quantity, measure)
            cells.append("none" if best is None else f"{best.label}: {ratio:.2g}")
        blurred = base.errors[quantity] < reference[quantity].bar / abs(reference[quantity].value)
        on = "yes" if base in front(points, quantity, measure) else "not resolved" if blurred else "no"
        cells += [f"{100 * base.errors[quantity]:.2g} %", on]
        lines.append(f"| {KINDS[kind]}, {STATES[state]} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


_HEADER = """# What accuracy costs

Made by `make chart`; do not edit. The default scene with one setting after the other changed, around a contact size of
10 µm unless said otherwise. An error is the relative distance from the limit of [errors.md](errors.md), whose error bar
is grey: what lies in the grey is not resolved. Work is the number of factorisations up to the state times the number of
unknowns; processor time has the set-up in it, and shared its machine with other runs. The reference has the default's
penalty, so that what a formulation or another penalty changes of the contact length counts as error here. *Not
resolved*: cheaper runs come out nearer, but the default's error is below the bar. The data: [chart.json](chart.json).
"""
_TABLES = {
    "work": "The cheapest run for an error, and its factorisations × unknowns over those of the default scene:",
    "seconds": "The same by processor time:",
}


def write(
    points: Sequence[Point], total: int, reference: Mapping[str, Limit], docs: Path, failures: Sequence[str] = ()
) -> None:
    """Write page, pictures and data."""
    for measure, name in PICTURES.items():
        draw(docs / name, (12, 10), partial(paint, points=points, reference=reference, measure=measure))
    names = {quantity: ", ".join(p.label for p in front(points, quantity)) for quantity in QUANTITIES}
    fronts = "\n".join(f"- {KINDS[q.split('_', 1)[1]]}, {STATES[state_of(q)]}: {labels}" for q, labels in names.items())
    parts = [_HEADER, f"{len(points)} of {total} runs.", *(f"Not reached: {words}." for words in failures)]
    for measure, words in _TABLES.items():
        parts += [f"![Relative error over {MEASURES[measure]}]({PICTURES[measure]})"]
        parts += [words, costs(points, reference, measure)]
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
    points = collect(args.out, reference)
    write(points, len(wanted), reference, args.docs, lost(args.out))
    print(f"{len(points)} of {len(wanted)} runs; {args.docs / 'chart.md'}")
    return 0 if len(points) == len(wanted) else 1


if __name__ == "__main__":
    sys.exit(main())
