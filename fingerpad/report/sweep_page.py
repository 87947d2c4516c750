"""The report of a sweep: friction and contact length over what was varied, every point, and what failed and why."""

import itertools
import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from fingerpad.report import page as html
from fingerpad.results.quantities import PER_LENGTH, QUANTITIES, Output
from fingerpad.results.states import WORDS
from fingerpad.runs.sweep_columns import LOAD, described, in_time, loads, shown, text
from fingerpad.scene.reading import DEFAULT_MODEL
from fingerpad.slices import errors

if TYPE_CHECKING:
    from fingerpad.report.write import Table

_CHARTS = ("mu_app", "f_t", "contact_length", "contact_area")
_TOLD = 3  # cautions in the headline
_RUBS = 1e-6  # µ_app that is no roundoff
_IN_TIME = {  # column of a load over time, behind its name
    "mu_app_max": "largest µ_app",
    "mu_app_mean": "mean µ_app",
    "f_t_amplitude": "amplitude of f_T (N/m)",
}


def page(table: "Table") -> str:
    """Return the page of a sweep."""
    title = f"fingerpad: sweep over {', '.join(table.axes)}"
    made = (_head, _over_time, _study, _points, _failed, _parameters, _cite)
    parts = [section(table) for section in made]
    return html.page(title, "\n".join(filter(None, parts)), {"sweep": _curves(table)})


def _shown(table: "Table") -> tuple[str, dict[str, Output]]:
    """Return the state in words and the columns of it that the page shows."""
    state, columns = shown(table.rows[0], table.whole, table.outputs)
    return WORDS[state], columns


def _head(table: "Table") -> str:
    state, columns = _shown(table)
    slid = [row for row in table.rows if _reached(row, columns)]
    number = f"No point reached {state}"
    for column, quantity in _drawn(columns).values():  # the coefficient of friction first
        values = [value for row in slid if (value := _read(row.get(column))) is not None]
        if values:
            low, high = (f"{value * quantity.scale:.3f}" for value in (min(values), max(values)))
            number = f"{_symbol(quantity)} from {low} to {high} {quantity.unit}".rstrip()
            break
    said = f"{'whole finger at' if table.whole else 'at'} {state}, over {_varied(table)}"
    if (wave := _wave(table)) is not None:  # which a sweep of a waveform is about
        name, least, most = wave
        said = f"in the load {name}, over {_varied(table)}"
        said += f"; {number.replace('<sub>app</sub>', '_app')} at full slip" if slid else ""
        number = f"µ<sub>app</sub> from {least:z.3f} to {most:z.3f}"
    failed = [row for row in table.rows if row["failure"]]
    missing = len(table.rows) - len(slid) - sum(1 for row in failed if not _reached(row, columns))
    kind, mark, words = "holds", "✓ holds", "Every point was computed."
    if failed:
        kind, mark = "fails", "✗ fails"
        words = f"{len(failed)} of {len(table.rows)} points failed; the table of failures says why."
    elif missing or table.cautions:
        kind, mark = "care", "! care"
        slips = f"{missing} of {len(table.rows)} points have no {state}." if missing else ""
        limits = f"Limits of validity are reached: {'; '.join(table.cautions[:_TOLD])}" if table.cautions else ""
        limits += f"; and {len(table.cautions) - _TOLD} more" if len(table.cautions) > _TOLD else ""
        words = " ".join(filter(None, (slips, f"{limits}." if limits else "")))
    return (
        f'<header><p class="kind">fingerpad · report of a sweep · {html.text(table.folder.resolve().name)}</p>'
        f'<h1>{number}</h1><p class="said">{html.text(said)}</p>'
        f'<p class="verdict {kind}"><b>{mark}</b> {html.text(words)}</p></header>'
    )


def _wave(table: "Table") -> tuple[str, float, float] | None:
    """Return the last load with a spectrum in which the finger rubs, and the least and the largest µ_app there."""
    for name in reversed(loads(table.rows[0])):
        column = f"{LOAD}_{name}"
        spectrum = [_read(row.get(f"{column}_f_t_amplitude")) for row in table.rows]
        read = ([_read(row.get(f"{column}_mu_app_{end}")) for row in table.rows] for end in ("min", "max"))
        least, most = ([value for value in values if value is not None] for values in read)
        if any(value is not None for value in spectrum) and least and max(map(abs, least + most)) > _RUBS:
            return name, min(least), max(most)
    return None


def _drawn(columns: Mapping[str, Output]) -> dict[str, tuple[str, Output]]:
    """Return the columns with a chart by the names of their quantities."""
    return {key: each for key in _CHARTS for each in columns.items() if each[0].endswith(f"_{key}")}


def _symbol(quantity: Output) -> str:
    """Return the symbol of a quantity for the headline, its index below the line; its words where it has none."""
    name, _, index = quantity.symbol.partition("_")
    return html.text(name) + (f"<sub>{html.text(index)}</sub>" if index else "")


def _reached(row: Mapping[str, Any], columns: Iterable[str]) -> bool:
    """Return whether a point reached the state of columns; not all that did have a coefficient of friction."""
    return any(_read(row.get(column)) is not None for column in columns)


def _varied(table: "Table") -> str:
    words = []
    for key in table.axes:
        values = list(dict.fromkeys(row[key] for row in table.rows))
        shown = ", ".join(_plain(value) for value in values[:6])
        words.append(f"{_head_of(key)}: {shown}{', …' if len(values) > 6 else ''}")
    return "; ".join(words)


def _over_time(table: "Table") -> str:
    """Return friction and contact in loads over time, which no state at full slip has; nothing without such a load."""
    parts = list[str]()
    for name in loads(table.rows[0]):
        shown = in_time(name, table.rows[0])
        heads = [*(_head_of(key) for key in table.axes), *shown.values()]
        rows = [
            [*(_plain(row[key]) for key in table.axes), *(text(column, _read(row[column])) for column in shown)]
            for row in table.rows
        ]
        charts = [html.chart(key, title) for key, (column, title) in _charts(table).items() if column in shown]
        parts += [html.paragraph(f"In the load {name}:"), *charts, html.table(heads, map(tuple, rows), "numbers")]
    return html.section("time", "Loads over time", *parts) if parts else ""


def _charts(table: "Table") -> dict[str, tuple[str, str]]:
    """Return the column and the title of each chart by the name of its place on the page."""
    drawn = _drawn(_shown(table)[1])
    found = {f"sweep_{key}": (column, quantity.title) for key, (column, quantity) in drawn.items()}
    for k, name in enumerate(loads(table.rows[0])):
        for key, words in _IN_TIME.items():
            column = f"{LOAD}_{name}_{key}"
            if column in table.rows[0]:
                found[f"sweep_load_{k}_{key}"] = column, words
    return found


def _study(table: "Table") -> str:
    state, columns = _shown(table)
    over = f"at {state} over the sweep"
    charts = [
        html.chart(place, f"{words} {over}") for place, (column, words) in _charts(table).items() if column in columns
    ]
    note = "Bars are estimated discretisation errors, where a run has them."
    without = (
        '<noscript><p class="note">The charts need JavaScript; the table below has the same numbers.</p></noscript>'
    )
    title = f"Friction and contact at {state}"
    return html.section("study", title, without, *charts, html.paragraph(note, "note"))


def _points(table: "Table") -> str:
    state, columns = _shown(table)
    rows = []
    for row in table.rows:
        cells = []
        for column, quantity in columns.items():
            cells.append(quantity.shown(_read(row.get(column)), _read(row.get(f"{column}_error"))))
        said = "failed" if row["failure"] else "" if _reached(row, columns) else f"no {state}"
        first, *rest = (_plain(row[key]) for key in table.axes)
        rows.append((first, *rest, *cells, said))
    forces = dict.fromkeys(table.forces())
    notes = errors.remarks(forces) or [PER_LENGTH]
    heads = [*(_head_of(key) for key in table.axes), *(quantity.title for quantity in columns.values())]
    return html.section(
        "points",
        "Every point",
        html.table((*heads, ""), rows, "numbers"),
        *(html.paragraph(note, "note") for note in notes),
        html.items((*table.notes, *table.cautions)),
    )


def _failed(table: "Table") -> str:
    rows = [
        (", ".join(f"{key} = {_plain(row[key])}" for key in table.axes), row["failure"])
        for row in table.rows
        if row["failure"]
    ]
    if not rows:
        return html.section("failed", "Failures", html.paragraph("No run failed."))
    note = "A run that crashed, was stopped or had too little memory is started again by the same command."
    return html.section(
        "failed", "Which runs failed, and why", html.table(("point", "reason"), rows), html.paragraph(note)
    )


def _parameters(table: "Table") -> str:
    return html.section("parameters", "Parameters", html.all_parameters(table.parameters, table.axes))


def _cite(table: "Table") -> str:
    given = html.changed(table.parameters)
    kept = {key: value for key, value in given.items() if not (key in table.axes or "[" in key or value is None)}
    options = [html.option_of(key, value) for key, value in kept.items()]
    options += [f"--model {table.model}"] if table.model != DEFAULT_MODEL else []
    values = {key: list(dict.fromkeys(row[key] for row in table.rows)) for key in table.axes}
    if all(_read(value) is not None for each in values.values() for value in each):
        over = [html.option_of(key, ",".join(each), "--over") for key, each in values.items()]
        code = " ".join(["fingerpad sweep", *options, *over, "--out results/again"])
    else:  # --over reads numbers alone
        lines = [f"{html.toml(key)} = [{', '.join(map(_toml, each))}]" for key, each in values.items()]
        command = " ".join(["fingerpad sweep study.toml", *options, "--out results/again"])
        code = "\n".join(["# study.toml", "[sweep]", *lines, "", "# the command", command])
    lists = any("[" in key and key not in table.axes for key in given)
    note = "Loads of its own, and other lists of the scene, are not in this line." if lists else ""
    return html.section(
        "reproduce", "How to reproduce and cite", f"<pre><code>{html.text(code)}</code></pre>",
        html.paragraph(note, "note") if note else "", html.cite(table.version),
    )  # fmt: skip


def _toml(cell: str) -> str:
    """Return a value of the table as TOML: a number as it stands, a switch, or a text."""
    if _read(cell) is not None:
        return cell
    return cell.lower() if cell in ("True", "False") else html.toml(cell)


def _curves(table: "Table") -> dict[str, Any]:
    """Return one curve for each value of all axes but the one along x, which is that with most numbers."""
    charts, scales = _charts(table), {column: quantity.scale for column, quantity in _shown(table)[1].items()}
    numbers = {key: {row[key] for row in table.rows if _read(row[key]) is not None} for key in table.axes}
    along = max(table.axes, key=lambda key: len(numbers[key]))
    others = [key for key in table.axes if key != along]
    curves = []

    def of(row: dict[str, str]) -> tuple[str, ...]:
        return tuple(row[key] for key in others)

    rows = sorted(table.rows, key=lambda row: list(dict.fromkeys(map(of, table.rows))).index(of(row)))
    for values, group in itertools.groupby(rows, key=of):
        mine = list(group)
        curve: dict[str, Any] = {
            "name": ", ".join(f"{key} = {_plain(value)}" for key, value in zip(others, values, strict=True)),
            "x": [_read(row[along]) if numbers[along] else _plain(row[along]) for row in mine],
        }
        for place, (column, _) in charts.items():
            scale = scales.get(column, 1.0)
            for end in ("", "_error"):
                found = [_read(row.get(f"{column}{end}")) for row in mine]
                curve[f"{place}{end}"] = [None if value is None else value * scale for value in found]
        curves.append(curve)
    titles = {place: title for place, (_, title) in charts.items()}
    return {"along": _head_of(along), "curves": curves, "charts": titles}


def _head_of(key: str) -> str:
    quantity = QUANTITIES.get(key)
    if quantity:
        return quantity.title
    meant = described(key)
    return f"{key} ({meant.unit})" if meant is not None and meant.unit else key


def _read(text: str | None) -> float | None:
    try:
        value = float(text or "nan")
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def _plain(text: str) -> str:
    value = _read(text)
    return text if value is None else f"{value:.6g}"
