"""Error over work: one numerical setting after the other, around the default scene.

environment/run python3 -m benchmarks.chart [--jobs 2] [--draw]     after benchmarks.errors; twenty minutes of one core

A point is a run of the default scene (press, charge, slide to full slip) with a setting of its own. Its error is the
distance from the limit of benchmarks/errors.py; its cost is factorisations times unknowns of the path
up to the state of the quantity and of all states solved again on the final mesh. Writes docs/chart.json, docs/errors.md
and docs/chart.png.
"""

import sys
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks import errors, harness
from benchmarks.errors import STATES, parted
from benchmarks.limits import Limit
from benchmarks.runs import finished
from fingerpad.model.options import by_rule
from fingerpad.results.pictures import style
from fingerpad.scene import Scene, load

_LIMIT = 10800.0  # s of processor time for one run
TARGETS = (5e-2, 1e-2, 2e-3)  # errors whose cost is in the tables
DEFAULT = "default"
OTHER_MODEL = "formulation"
KINDS = {"f_t": "f_T and µ_app", "contact_length": "contact length", "sed_0": "SED at the central Merkel site"}
QUANTITIES = [f"{state}_{kind}" for kind in KINDS for state in STATES if kind != "f_t" or state == "full_slip"]
ALL = "full_slip_all"  # the largest error of all quantities; its cost is that of full slip, the last state
Reference = Mapping[str, Limit]


# -- scenes --------------------------------------------------------------------------------------------------
FAMILIES: dict[str, Any] = tomllib.loads((harness.ROOT / "benchmarks/chart.toml").read_text(encoding="utf-8"))


def scenes() -> dict[tuple[str, str], Scene]:
    """Return the scenes to run by family and label, the default one first."""
    found = {("contact size", DEFAULT): errors.DEFAULT}
    for family, settings in FAMILIES.items():
        for label, changes in settings.items():
            found[family, label] = by_rule(load(None, changes))
    return found


# -- points --------------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Point:
    """An answer in the chart: the work up to a state, by state, and relative distances from the limit, by quantity."""

    label: str
    family: str
    work: Mapping[str, float]
    errors: Mapping[str, float]

    def error(self, quantity: str) -> float:
        """Return the error of a quantity, or the largest of all for :data:`ALL`."""
        return max(self.errors.values()) if quantity == ALL else self.errors[quantity]

    def cost(self, quantity: str) -> float:
        """Return the work up to the state of a quantity."""
        return self.work[parted(quantity)[0]]


def runs(out: Path, reference: Reference) -> Iterator[Point]:
    """Yield the points of runs that reached full slip."""
    for (family, label), scene in scenes().items():
        if run := finished(scene, out):
            path = np.cumsum(run.steps["factorisations"]) * run.summary["unknowns_path"]
            solves = run.summary.get("accuracy", {}).get("solves", [])[1:]  # on the final mesh
            more = sum(each["unknowns"] * each["factorisations"] for each in solves)
            found = errors.values(run)
            off = {name: abs(found[name] / reference[name].value - 1) for name in QUANTITIES}
            yield Point(label, family, {state: float(path[run.row(state)]) + more for state in STATES}, off)


def compute(args: Any) -> None:
    """Run what is missing and keep the numbers."""
    wanted = {label: scene for (_, label), scene in scenes().items()}
    summaries, reference = harness.run(wanted, args, _LIMIT), errors.known(args.docs)
    ends = {name: vars(reference[name]) for name in QUANTITIES}
    points = [asdict(point) for point in runs(args.out, reference)]
    numbers = {"reference": ends, "points": points, "lost": failed(summaries)}
    harness.keep("chart", numbers, harness.made(summaries.values()), args.docs)


def failed(summaries: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """Return the runs that did not reach full slip, with the reason."""
    no_slip = "no steady full slip by the end of the slide"
    return [f"{label}: {s.get('failure', no_slip)}" for label, s in summaries.items() if not s.get("full_slip")]


# -- comparison ----------------------------------------------------------------------------------------------
def judged(points: Sequence[Point], quantity: str) -> list[Point]:
    """Return the runs with the default's contact model, since another may hide the mesh's error, cheap ones first."""
    some = [p for p in points if p.family != OTHER_MODEL]
    return sorted(some, key=lambda p: (p.cost(quantity), p.error(quantity)))


def front(points: Sequence[Point], quantity: str) -> list[Point]:
    """Return Pareto's front from cheap to expensive: no other judged run is both cheaper and more accurate."""
    some = judged(points, quantity)
    return [p for k, p in enumerate(some) if all(p.error(quantity) < q.error(quantity) for q in some[:k])]


def _default(points: Sequence[Point]) -> Point:
    return next(p for p in points if p.label == DEFAULT)


def cheapest(points: Sequence[Point], quantity: str, target: float) -> str:
    """Return the cheapest judged run within an error, with its cost over the default's."""
    own, some = _default(points).cost(quantity), judged(points, quantity)
    good = (p for p in some if p.error(quantity) <= target)
    return next((f"{p.label}: {p.cost(quantity) / own:.2g}" for p in good), "none")


# -- page ----------------------------------------------------------------------------------------------------
_MARKS = {  # kind of setting: its families, colour, marker
    "mesh sizes": (("contact size", "growth", "size at the sites", "all sizes"), style.BLUE, "o"),
    "element": (("element",), style.PURPLE, "D"),
    "solver or steps": (("solver", "steps"), style.GREY, "X"),
}
_PANELS = ("full_slip_f_t", "charged_contact_length", "full_slip_sed_0", ALL)


def _words(quantity: str) -> str:
    state, kind = parted(quantity)
    return "largest error of all quantities" if quantity == ALL else f"{KINDS[kind]}, {STATES[state]}"


def _panel(ax: Axes, points: Sequence[Point], quantity: str, bar: float) -> None:
    def at(some: Sequence[Point]) -> tuple[list[float], list[float]]:
        return [p.cost(quantity) / own for p in some], [max(p.error(quantity), 1.2 * lowest) for p in some]

    own = _default(points).cost(quantity)
    shown = [p.error(quantity) for p in judged(points, quantity)]
    lowest = max(0.5 * min(shown), bar / 5)
    ax.axhspan(1e-9, bar, color="0.9", lw=0)
    ax.step(*at(front(points, quantity)), "k-", where="post", lw=0.9, label="front")
    for words, (families, colour, marker) in _MARKS.items():
        some = [p for p in points if p.family in families and p.label != DEFAULT]
        ax.plot(*at(some), marker, color=colour, ms=6, label=words)
    ax.plot(*at([_default(points)]), "*", color=style.VERMILION, mec="black", mew=0.5, ms=14, label="default")
    ax.set(yscale="log", title=_words(quantity), ylim=(lowest, 2 * max(shown)))
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


def draw(docs: Path) -> Path:
    """Draw page and picture from the kept numbers."""
    numbers = harness.kept("chart", docs).numbers
    points = [Point(each.label, each.family, each.work, each.errors) for each in numbers["points"]]
    reference = {name: Limit(**each) for name, each in numbers["reference"].items()}
    reference[ALL] = Limit(1.0, max(end.relative for end in reference.values()), None)
    harness.picture(docs / "chart.png", (9, 7), lambda figure: _paint(figure, points, reference))
    names = {"points": points, "reference": reference, "default": _default(points)}
    names |= {"words": _words, "linear": next((p for p in points if p.label == "P1"), None)}
    return harness.page(docs, "chart", "make chart", globals() | names, "errors")


if __name__ == "__main__":
    sys.exit(harness.main(__doc__, compute, draw))
