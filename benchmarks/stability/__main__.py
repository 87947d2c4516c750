"""The stability map and random scenes: where the solver converges, at what cost and with what error.

environment/run python3 -m benchmarks.stability [--part map | random] [--jobs 2] [--hours 6] [--draw]
environment/run python3 -m benchmarks.stability --row "ε_n × 10"      one row of a table, with its reference

Cases are run in processes of their own. Outcomes of the map are kept in results/stability/map after each run, random
scenes (benchmarks/stability/scenes.py) in folders beside it; started again, only what is missing is run. After a
change of the solver delete that folder. Writes docs/stability.json, and from it docs/stability.md and its picture.
"""

import argparse
import json
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, to_hex, to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from benchmarks.harness import keep, kept, made, page, parser, picture, solve, table
from benchmarks.stability import plan, scenes
from benchmarks.stability.plan import DEFAULT, Axis, Case, Named, Outcome, Panel
from fingerpad.results.style import MAGNITUDE, ORANGE, SKY, VERMILION

# Of an outcome, what the page shows.
_SHOWN = "status reason load newton factorisations cutbacks inverted penetration f_t contact_length f_ext".split()


def outcomes(cases: Iterable[Case], args: argparse.Namespace) -> dict[Case, Outcome]:
    """Run the cases whose outcomes are not kept yet; return those there are within the hours given."""
    named = {json.dumps(case.changed, ensure_ascii=False): case for case in cases}
    data = {name: case.changed for name, case in named.items()}
    found = solve("benchmarks.stability.solve", data, args.out / "map", args.jobs, args.limit, args.hours)
    return {case: _outcome(found[name], args.limit) for name, case in named.items() if name in found}


def _outcome(found: dict[str, Any], limit: float) -> Outcome:
    if "failure" not in found:
        return Outcome(**found)
    seconds = 0.0 if found["failure"].startswith("CRASH") else limit
    return Outcome("failed", found["failure"], found["message"], seconds=seconds)


def numbers(found: Mapping[Case, Outcome]) -> dict[str, Any]:
    """Return what the page shows of the cases that have been run, ready for JSON."""
    rows = []
    for case, outcome in found.items():
        compared = {"f_t": case.slide, "contact_length": True, "f_ext": case.indentation}
        errors = {f"error_{name}": _error(found, case, name) for name, told in compared.items() if told}
        rows.append({"case": case.changed} | {name: getattr(outcome, name) for name in _SHOWN} | errors)
    return {"solves": len(found), "seconds": sum(outcome.seconds for outcome in found.values()), "runs": rows}


def _error(found: Mapping[Case, Outcome], case: Case, name: str) -> float | None:
    """Return the relative error of a quantity, with its sign; None without a reference or where one of both failed."""
    here, finest = found[case], found.get(case.reference)
    if finest is None or "failed" in (here.status, finest.status):
        return None
    exact = getattr(finest, name)
    return float((getattr(here, name) - exact) / abs(exact)) if exact else None


# -- page ----------------------------------------------------------------------------------------------------
Row = Mapping[str, Any]
Rows = Mapping[Case, Row]
COLOURS = {"converged": SKY, "continuation": ORANGE, "failed": VERMILION}
SYMBOLS = {"converged": "●", "continuation": "▲", "failed": "✕"}
NAMES = {"converged": "converged", "continuation": "through continuation", "failed": "failed"}


def percent(value: float | None) -> str | None:
    """Return a relative number as per cent; below a millionth it is zero."""
    if value is None:
        return None
    return "0" if abs(value) < 1e-6 else f"{100 * value:.2g}" if abs(value) < 1 else f"{100 * value:.0f}"


# -- tables --------------------------------------------------------------------------------------------------
_COLUMNS = ["run", "outcome", "load", "iterations", "factorisations", "cut steps", "failed solves that met J ≤ 0"]
_COLUMNS += ["penetration (nm)", "f_T (N/m)", "contact length (µm)"]
_ERRORS = ["error in f_T (%)", "error in contact length (%)", "normal force (N/m)", "error in it (%)"]


def _line(words: str, o: Row, referenced: bool) -> list[Any]:
    reason = f": {o['reason']}" if o["status"] == "failed" else ""
    inverted = ", ".join(f"{count} in {layer}" for layer, count in o["inverted"].items()) or "0"
    line = [words, f"{SYMBOLS[o['status']]} {NAMES[o['status']]}{reason}", o["load"], o["newton"], o["factorisations"]]
    line += [o["cutbacks"], inverted, f"{o['penetration'] * 1e9:.3g}", o["f_t"], f"{o['contact_length'] * 1e6:.2f}"]
    errors = [percent(o.get(f"error_{name}")) for name in ("f_t", "contact_length", "f_ext")]
    return [*line, *errors[:2], o.get("f_ext"), errors[2]] if referenced else line


def named_table(named: Named, rows: Rows) -> str:
    """Return a group of runs, one a row."""
    columns = _COLUMNS + (_ERRORS if named.referenced else [])
    not_run = ["not run", *[None] * (len(columns) - 2)]
    lines = [
        _line(words, rows[case], named.referenced) if case in rows else [words, *not_run]
        for words, case in named.cases.items()
    ]
    return table(columns, lines)


def full_slips(runs: Iterable[Row], formulation: str) -> str:
    """Return how many of the random scenes that were run a formulation leads to full slip, on whatever elements."""
    ends = [row["full_slip"] for row in runs if row["formulation"] == formulation]
    missing = scenes.COUNT - len(ends)
    return f"{sum(ends)} of {len(ends)}" + (f" ({missing} not run)" if missing else "")


def dearer(runs: Iterable[Row], formulation: str) -> float:
    """Return a formulation's factorisations over the penalty's, in the random scenes that both lead to full slip."""
    work = {(row["formulation"], row["number"]): row["factorisations"] for row in runs if row["full_slip"]}
    both = [number for name, number in work if name == formulation and ("penalty", number) in work]
    return sum(work[formulation, k] for k in both) / max(sum(work["penalty", k] for k in both), 1)


def _scene_cell(row: Row | None) -> str:
    if row is None:
        return "not run"
    work = row["factorisations"] or "–"
    if not row["full_slip"]:
        return f"{SYMBOLS['failed']} {row['failure']}, {work}"
    if row["contact"] < scenes.MESH["contact"]:
        return f"{SYMBOLS['continuation']} {1e6 * row['contact']:g} µm, {work}; {row['failure']}"
    return f"{SYMBOLS['converged']} {work}"


# -- picture -------------------------------------------------------------------------------------------------
def _tick(axis: Axis, value: float) -> str:
    return f"{value / axis.unit:.6g}".replace("e+", "e")


def _cell(ax: Axes, place: tuple[int, int], colour: str, text: str, default: bool) -> None:
    ax.add_patch(Rectangle(place, 1, 1, facecolor=colour, edgecolor="white", lw=1.5))
    if default:
        inner = (place[0] + 0.06, place[1] + 0.06)
        ax.add_patch(Rectangle(inner, 0.88, 0.88, fill=False, ec="black", lw=1.8, zorder=3))
    red, green, blue = to_rgb(colour)
    ink = "black" if 0.3 * red + 0.59 * green + 0.11 * blue > 0.45 else "white"
    ax.text(place[0] + 0.5, place[1] + 0.5, text, ha="center", va="center", color=ink, fontsize=8, linespacing=1.1)


def _map(ax: Axes, panel: Panel, rows: Rows, title: str, cell: Callable[[Row], tuple[str, str]]) -> None:
    for i, y in enumerate(panel.y.values):
        for k, x in enumerate(panel.x.values):
            case = panel.case(x, y)
            colour, text = cell(rows[case]) if case in rows else ("#EEEEEE", "not run")
            _cell(ax, (k, i), colour, text, case == panel.base and case.element == DEFAULT.element)
    ax.set(title=title, xlim=(0, len(panel.x.values)), ylim=(0, len(panel.y.values)))
    ax.set(xlabel=panel.x.label, ylabel=panel.y.label)
    for axis, which in ((panel.x, ax.xaxis), (panel.y, ax.yaxis)):
        which.set_ticks([k + 0.5 for k in range(len(axis.values))], [_tick(axis, v) for v in axis.values])
        which.set_tick_params(length=0)
    for spine in ax.spines.values():
        spine.set_visible(False)


def outcome_cell(o: Row) -> tuple[str, str]:
    """Return colour and text of a cell: how a run ended, its iterations, and the load of one that failed."""
    text = f"{SYMBOLS[o['status']]}\n{o['newton']}" + (f"\n{o['load']}" if o["status"] == "failed" else "")
    return COLOURS[o["status"]], text


def value_cell(name: str, low: float, high: float, scale: float) -> Callable[[Row], tuple[str, str]]:
    """Return what gives colour and text of a cell: a number, its size on a logarithmic ramp."""
    norm, colours = LogNorm(low, high, clip=True), matplotlib.colormaps[MAGNITUDE]

    def cell(o: Row) -> tuple[str, str]:
        if o["status"] == "failed" or o.get(name) is None:
            return "#EEEEEE", SYMBOLS["failed"]
        number = scale * o[name]
        return to_hex(colours(norm(max(abs(number), low)))), f"{number:.0f}" if abs(number) >= 10 else f"{number:.2g}"

    return cell


def paint(figure: Figure, rows: Rows) -> None:
    """Draw the eight maps that the choice of the default rests on."""
    charts = plan.charts()
    by_parameter, elements = charts[plan.BY_PARAMETER], {panel.title: panel for panel in charts[plan.BY_ELEMENT]}
    depth = value_cell("penetration", 0.1, 1e4, 1e9)
    error = value_cell("error_contact_length", 0.01, 100, 100)
    maps = [
        (charts["Voltage and force"][0], "A  penalty: outcome", outcome_cell),
        (by_parameter[0], "B  penalty: outcome", outcome_cell),
        (by_parameter[1], "C  augmented Lagrangian: outcome", outcome_cell),
        (by_parameter[2], "D  Nitsche, θ = 0: outcome", outcome_cell),
        (charts["Step size and voltage"][0], "E  penalty: outcome", outcome_cell),
        (by_parameter[0], "F  penalty: penetration (nm)", depth),
        (by_parameter[0], "G  penalty: error in contact length (%)", error),
        (elements["P2"], "H  P2 elements: error in contact length (%)", error),
    ]
    for ax, (panel, title, cell) in zip(figure.subplots(2, 4).flat, maps, strict=True):
        _map(ax, panel, rows, title, cell)
    keys = [Patch(color=COLOURS[s], label=f"{SYMBOLS[s]} {NAMES[s]}, with Newton iterations") for s in COLOURS]
    keys.append(Patch(fill=False, ec="black", lw=1.8, label="default"))
    figure.legend(handles=keys, loc="outside lower center", ncols=4, frameon=False)


def draw(docs: Path) -> Path:
    """Write docs/stability.md and docs/stability.png from docs/stability.json."""
    numbers, charts = kept("stability", docs).numbers, plan.charts()
    rows, random = {Case(**row["case"]): row for row in numbers["runs"]}, numbers["random"]["runs"]
    picture(docs / "stability.png", (17, 9), lambda figure: paint(figure, rows))
    counts = [
        (title, panel.title, Counter(rows[case]["status"] if case in rows else "not run" for case in panel.cases()))
        for title, panels in charts.items()
        for panel in panels
    ]
    ends = {(row["number"], row["formulation"]): row for row in random}
    names = {
        "counts": counts,
        "ends": counts[0][2],
        "named": {n: named_table(each, rows) for n, each in plan.named().items()},
        "near": {words: rows[case] for words, case in plan.named()["neighbours"].cases.items() if case in rows},
        "slips": {name: full_slips(random, name) for name in scenes.FORMULATIONS},
        "drawn": [
            (k, scenes.drawn(k), [_scene_cell(ends.get((k, name))) for name in scenes.FORMULATIONS])
            for k in range(scenes.COUNT)
        ],
    }
    return page(docs, "stability", "environment/run python3 -m benchmarks.stability", globals() | names)


def main(given: Sequence[str] | None = None) -> int:
    """Run what is missing, keep its numbers and draw the page; or make one row."""
    names = [name for group in plan.named().values() for name in group.cases]
    asked = parser(__doc__, "stability")
    asked.add_argument("--limit", type=float, default=120.0, help="seconds of processor time for one run")
    asked.add_argument("--hours", type=float, default=6.0, help="after which no run of the map is started")
    asked.add_argument("--part", choices=("map", "random"), help="run this part alone, and keep the other's numbers")
    asked.add_argument("--row", choices=names, metavar="NAME", help=f"this row alone, printed: {', '.join(names)}")
    args = asked.parse_args(given)
    if args.row:
        group = next(group for group in plan.named().values() if args.row in group.cases)
        case = group.cases[args.row]
        runs = numbers(outcomes([case, case.reference] if group.referenced else [case], args))["runs"]
        rows = {Case(**each["case"]): each for each in runs}
        print(named_table(plan.Named({args.row: case}, group.referenced), rows))
        return 0 if case in rows else 1
    left = 0
    if not args.draw and args.part != "random":
        found = outcomes(cases := plan.cases(), args)
        left = len(cases) - len(found)
        keep("stability", kept("stability", args.docs).numbers | numbers(found), made(), args.docs)
    if not args.draw and args.part != "map":
        old = kept("stability", args.docs)
        keep("stability", old.numbers | {"random": scenes.numbers(args)}, old.made, args.docs)
    print(f"{draw(args.docs)}" + (f"; {left} runs are missing" if left else ""))
    return 1 if left else 0


if __name__ == "__main__":
    sys.exit(main())
