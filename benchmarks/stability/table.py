"""The stability map as a page of Markdown."""

from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path

from benchmarks.stability import results
from benchmarks.stability.cache import Cache
from benchmarks.stability.case import Case, Outcome
from benchmarks.stability.loop import Loop, loop
from benchmarks.stability.pictures import NAMES, SYMBOLS, tick
from benchmarks.stability.plan import Chart, Named, Panel
from fingerpad.io.files import replace
from variational.roughness.bam import BearingArea

_INTRODUCTION = """# Where the solver converges

Made by `environment/run python3 benchmarks/stability_map.py`; do not edit. One ridge of the layered finger (three for
the snap-off), pressed by a force, charged and dragged until it slips everywhere. Its lateral faces move sideways with
the bone and freely up and down, as if the neighbours were equal: 4.4 N/m a ridge then give the finger's contact length
and friction. Errors are relative to a run with contact size 1.25 µm, P2 elements, the default penalty and the same
physical parameters. {symbols}. Iterations
are Newton's, over the whole history; *load* is the one in which a run ended.
"""
_LOOP = """
### The fixed point near the fold

The loop over the scales for one uniform ridge, started 1 % off its solution. Keyed on the external pressure, with
pressure and attraction one sweep out of phase, it diverges where its gain exceeds 1/2; keyed on the contact pressure
(the default, here without its secant steps) it converges everywhere in contact.

| p_ext (kPa) | U (V) | gain | sweeps, keyed on p_ext | sweeps, keyed on p_c |
|---|---|---|---|---|
"""
_LOOP_POINTS = [(p, u) for u in (50.0, 100.0, 150.0, 200.0) for p in (500.0, 2e3, 5e3, 20e3)]


def percent(value: float | None) -> str:
    """Return a relative number as per cent, a dash where there is none."""
    return "–" if value is None else f"{100 * value:.2g}" if abs(value) < 1 else f"{100 * value:.0f}"


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "".join("| " + " | ".join(line) + " |\n" for line in lines)


def _outcome(outcome: Outcome | None) -> str:
    if outcome is None:
        return "not run"
    words = f"{SYMBOLS[outcome.status]} {NAMES[outcome.status]}"
    if outcome.status == "failed":
        words += f": {outcome.reason}"
    return words


def _numbers(case: Case, cache: Cache) -> list[str]:
    """Return the columns that all tables share."""
    o = cache.get(case)
    if o is None:
        return ["not run", *["–"] * 8]
    inverted = ", ".join(f"{count} in {layer}" for layer, count in o.inverted.items()) or "0"
    return [
        _outcome(o),
        o.load,
        str(o.newton),
        str(o.factorisations),
        str(o.cutbacks),
        inverted,
        f"{o.penetration * 1e9:.3g}",
        f"{o.f_t:.4g}",
        f"{o.contact_length * 1e6:.2f}",
    ]


_COLUMNS = ["outcome", "load", "iterations", "factorisations", "cut steps", "failed solves that met J ≤ 0"]
_COLUMNS += ["penetration (nm)", "f_T (N/m)", "contact length (µm)"]


def named_section(named: Named, cache: Cache, level: int = 3) -> str:
    """Return what a group of runs shows."""
    head, rows = ["run", *_COLUMNS], []
    if named.referenced:
        head += ["error in f_T (%)", "error in contact length (%)", "normal force (N/m)", "error in it (%)"]
    for words, case in named.cases:
        row, o = [words, *_numbers(case, cache)], cache.get(case)
        if named.referenced:
            row += [percent(results.friction_error(case, cache) if case.slide else None)]
            row += [percent(results.length_error(case, cache))]
            row += [f"{o.f_ext:.4g}" if o else "–"]
            row += [percent(results.force_error(case, cache) if case.indentation else None)]
        rows.append(row)
    return f"\n{'#' * level} {named.name.capitalize()}\n\n{named.says}\n\n" + _table(head, rows)


def loop_section(closure: BearingArea) -> str:
    """Return the table of the scalar fixed points."""

    def words(sweeps: int | None) -> str:
        return "diverges" if sweeps is None else str(sweeps)

    def row(point: Loop) -> str:
        cells = [f"{point.pressure / 1e3:g}", f"{point.voltage:g}", f"{point.gain:.2f}"]
        return "| " + " | ".join([*cells, words(point.by_external), words(point.by_contact)]) + " |\n"

    return _LOOP + "".join(row(loop(closure, p, u)) for p, u in _LOOP_POINTS)


def _panel_table(panel: Panel, cache: Cache) -> str:
    head = [panel.x.label, panel.y.label, *_COLUMNS, "error in f_T (%)", "error in contact length (%)"]
    rows = [
        [
            tick(panel.x, x),
            tick(panel.y, y),
            *_numbers(case := panel.case(x, y), cache),
            percent(results.friction_error(case, cache)),
            percent(results.length_error(case, cache)),
        ]
        for y in panel.y.values
        for x in panel.x.values
    ]
    return f"\n<details><summary>{panel.title}: all runs</summary>\n\n" + _table(head, rows) + "\n</details>\n"


def chart_section(chart: Chart, cache: Cache) -> str:
    """Return a chart's picture, the counts of its outcomes, and its runs."""
    text = f"\n## {chart.title}\n\n![{chart.title}](stability/{chart.name}.png)\n\n"
    for panel in chart.panels:
        cases = list(panel.cases())
        count = Counter(o.status for o in map(cache.get, cases) if o)
        said = ", ".join(f"{count[status]} {NAMES[status]}" for status in NAMES)
        text += f"{panel.title}: of {len(cases)} runs {said}.\n"
    return text + "".join(_panel_table(panel, cache) for panel in chart.panels)


def write(
    path: Path, charts: list[Chart], default: Named, named: list[Named], closure: BearingArea, cache: Cache, left: int
) -> None:
    """Write the page.

    Args:
        path: of the Markdown file; pictures are looked for in a folder ``stability`` beside it.
        charts: pairs of parameters.
        default: the default and its neighbours, with why it is the default.
        named: known failures.
        closure: of the scalar fixed points.
        cache: outcomes.
        left: number of runs that are missing, which the page says.
    """
    symbols = ", ".join(f"{SYMBOLS[s]} {NAMES[s]}" for s in NAMES)
    text = _INTRODUCTION.format(symbols=symbols[0].upper() + symbols[1:])
    seconds = sum(o.seconds for o in cache.outcomes.values())
    text += f"\n{len(cache.outcomes)} solves, {seconds / 60:.0f} minutes of one core"
    text += f"; {left} more have not been run.\n" if left else ".\n"
    text += named_section(default, cache, 2) + "\n## Known failures, reproduced\n"
    text += "".join(named_section(one, cache) for one in named) + loop_section(closure)
    text += "".join(chart_section(chart, cache) for chart in charts)
    path.parent.mkdir(parents=True, exist_ok=True)
    replace(path, text)
