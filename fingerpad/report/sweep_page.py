"""The table of a sweep and its report: friction and contact over what was varied, every point, and what failed."""

import csv
import io
import itertools
import math
import shlex
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from fingerpad.report import page as html
from fingerpad.report.page import BAD, CARE, GOOD
from fingerpad.results.files import read_object, refuse_other_format
from fingerpad.results.headline import SECTION, WHOLE
from fingerpad.results.quantities import FINGER, PER_LENGTH, Output, in_table
from fingerpad.results.states import WORDS
from fingerpad.runs.sweep_columns import (
    FORCE,
    LOAD,
    described,
    description,
    head_of,
    in_time,
    loads,
    of_finger,
    printed,
    shown,
    tables,
)
from fingerpad.scene import SceneError, changed_keys
from fingerpad.scene.messages import clip
from fingerpad.scene.reading import DEFAULT_MODEL, model_name
from fingerpad.slices.errors import remarks
from variational.files import read

_CHARTS = dict.fromkeys((*in_table("short"), *in_table("first", FINGER)))
_MAX_CAUTIONS = 3  # in the headline
_MAX_VALUES = 6  # of a key in the headline
_MAX_TITLE = 30  # characters beside an axis, beyond which they take two lines
_RUBS = 1e-6  # µ_app that is no roundoff
_IN_TIME = ("mu_app_max", "mu_app_mean", "f_t_amplitude")  # columns with a chart of a load over time, behind its name

_RESULTS = ("uncharged_", "charged_", "full_slip_", "load_")


@dataclass(frozen=True)
class Table:
    """The table of a sweep."""

    folder: Path
    axes: tuple[str, ...]
    """Keys that are varied."""
    rows: tuple[dict[str, Any], ...]
    """By column: numbers, switches and texts; None where a cell is empty."""
    parameters: dict[str, Any]
    """Every parameter of the scene that it varies."""
    model: str = DEFAULT_MODEL
    version: str = ""
    """Of the program that made the table; empty where it is not known."""
    cautions: tuple[str, ...] = ()
    """Limits of validity that points reach."""
    notes: tuple[str, ...] = ()
    """Remarks on the points."""
    outputs: tuple[Output, ...] = ()
    """Of the points, computed from a state."""

    @property
    def whole(self) -> bool:
        """Whether forces are those on the whole finger."""
        return "force" in self.axes or "force" in self.parameters

    def forces(self) -> list[float]:
        """Return the forces on the whole finger (N)."""
        if "force" in self.axes:
            return [float(row["force"]) for row in self.rows]
        if self.whole:
            return [float(self.parameters["force"])]
        return [force for row in self.rows if (force := row.get(FORCE)) is not None]

    @property
    def heads(self) -> dict[str, str]:
        """Words and units of the keys that are varied."""
        return {key: head_of(key, "title") for key in self.axes}

    @cached_property
    def shown(self) -> tuple[str, dict[str, Output]]:
        """The named state in words and the columns of it that the report shows."""
        state, columns = shown(self.rows[0], self.whole, self.outputs)
        return WORDS[state], columns

    def reached(self, row: Mapping[str, Any]) -> bool:
        """Return whether a point reached that state; not all that did have a coefficient of friction."""
        return any(row.get(column) is not None for column in self.shown[1])

    def values(self) -> dict[str, list[Any]]:
        """Return the values of each key that is varied, once each."""
        return {key: list(dict.fromkeys(row[key] for row in self.rows)) for key in self.axes}


def table_of(folder: Path) -> Table:
    """Return the table of the sweep in a folder.

    Raises:
        SceneError: it cannot be read.
    """
    name = clip(str(folder), 80)
    try:
        reader = csv.DictReader(io.StringIO(read(folder / "table.csv").decode(), newline=""))
        texts, columns = list(reader), list(reader.fieldnames or ())
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise SceneError(f"the table of {name} cannot be read: {error}") from None
    axes = tuple(key for key in columns if not key.startswith(_RESULTS) and key != "failure")
    if "failure" not in columns or not axes or not texts:
        raise SceneError(f"table.csv in {name} is not the table of a sweep of fingerpad, or is cut short")
    if any(None in row or None in row.values() for row in texts):
        raise SceneError(f"table.csv in {name} is cut short; give the command of the sweep again to write it anew")
    rows = tuple({key: text if key == "failure" else _value(text) for key, text in row.items()} for row in texts)
    try:
        asked = read_object(folder / "sweep.json")
        refuse_other_format(asked, f"the sweep in {name}")
        more = model_name(asked["model"]), str(asked.get("version", ""))
        cautions, notes = (tuple(map(str, asked.get(name, ()))) for name in ("cautions", "notes"))
        outputs = tuple(Output(**each) for each in asked.get("outputs", ()))
        return Table(folder, axes, rows, dict(asked["parameters"]), *more, cautions, notes, outputs)
    except KeyError as missing:
        raise SceneError(f"sweep.json in {name} has no {missing}; give the command of the sweep again") from None
    except SceneError:
        raise
    except (OSError, ValueError, TypeError) as error:
        raise SceneError(f"sweep.json in {name} cannot be read: {error}") from None


def _value(text: str) -> Any:
    """Return what a cell of a table holds: a number, a switch or a text; None where it is empty or not finite."""
    for kind in (int, float):
        with suppress(ValueError):
            return number if math.isfinite(number := kind(text)) else None
    return {"": None, "True": True, "False": False}.get(text, text)


def page(table: Table) -> str:
    """Return the page of a sweep."""
    title = f"fingerpad: sweep over {', '.join(table.axes)}"
    made = (_head, _over_time, _study, _points, _failed, _parameters, _cite)
    parts = [section(table) for section in made]
    return html.page(title, "\n".join(filter(None, parts)), {"sweep": _curves(table)})


def _head(table: Table) -> str:
    state, columns = table.shown
    slid = [row for row in table.rows if table.reached(row)]
    sentence, said = f"No point reached {state}.", f"Over {_varied(table)}."
    for column, quantity in _drawn(columns).values():  # the coefficient of friction first
        values = [quantity.scale * value for row in slid if (value := row.get(column)) is not None]
        if values:
            words = quantity.words if quantity.symbol == quantity.words else quantity.words.rpartition(" ")[0]
            what = "friction coefficient" if column.endswith("_mu_app") else words
            of = WHOLE if of_finger(column) else SECTION
            ends = f"from {min(values):.3f} to {max(values):.3f} {quantity.unit}".rstrip()
            sentence = f"At {state} the {what} of the {of} goes {ends}."
            break
    if (wave := _wave(table)) is not None:  # which a sweep of a waveform is about
        name, least, most = wave
        said += f" {sentence}" if slid else ""
        sentence = f"In the load {name} the friction coefficient of the {SECTION} goes "
        sentence += f"from {least:z.3f} to {most:z.3f}."
    failed = [row for row in table.rows if row["failure"]]
    missing = len(table.rows) - len(slid) - sum(1 for row in failed if not table.reached(row))
    kind, words = GOOD, "Every point was computed."
    if failed:
        kind, words = BAD, f"{len(failed)} of {len(table.rows)} points failed; the table of failures says why."
    elif missing or table.cautions:
        slips = f"{missing} of {len(table.rows)} points have no {state}." if missing else ""
        more = len(table.cautions) - _MAX_CAUTIONS
        limits = [*table.cautions[:_MAX_CAUTIONS], *([f"and {more} more"] if more > 0 else [])]
        limit = f"Limits of validity are reached: {'; '.join(limits)}." if limits else ""
        kind, words = CARE, " ".join(filter(None, (slips, limit)))
    return html.banner("report of a sweep", table.folder, sentence, "", said, kind, html.text(words))


def _wave(table: Table) -> tuple[str, float, float] | None:
    """Return the last load with a spectrum in which the finger rubs, and the least and the largest µ_app there."""
    for name in reversed(loads(table.rows[0])):
        spectrum, least, most = (
            [value for row in table.rows if (value := row.get(f"{LOAD}_{name}_{key}")) is not None]
            for key in ("f_t_amplitude", "mu_app_min", "mu_app_max")
        )
        if spectrum and least and max(map(abs, least + most)) > _RUBS:
            return name, min(least), max(most)
    return None


def _drawn(columns: Mapping[str, Output]) -> dict[str, tuple[str, Output]]:
    """Return the columns with a chart by the names of their quantities; of the whole finger before the section's."""
    found = {key: [each for each in columns.items() if each[0].endswith(f"_{key}")] for key in _CHARTS}
    return {key: each[0] for key, each in found.items() if each}


def _varied(table: Table) -> str:
    words = []
    for key, values in table.values().items():
        shown = ", ".join(map(printed, values[:_MAX_VALUES]))
        words.append(f"{head_of(key, 'title')}: {shown}{', …' if len(values) > _MAX_VALUES else ''}")
    return "; ".join(words)


def _over_time(table: Table) -> str:
    """Return friction and contact in loads over time, which no state at full slip has; nothing without such a load."""
    parts = list[str]()
    for name, (heads, *lines) in tables(table.rows, table.heads):
        drawn = _charts(table).items()
        charts = [html.chart(key, title) for key, (column, title) in drawn if column.startswith(f"{LOAD}_{name}_")]
        parts += [html.paragraph(f"In the load {name}:"), *charts, html.table(heads, lines, "numbers")]
    return html.section("time", "Loads over time", *parts)


def _charts(table: Table) -> dict[str, tuple[str, str]]:
    """Return the column and the title of each chart by the name of its place on the page."""
    found = {f"sweep_{key}": (column, _titled(column, each)) for key, (column, each) in _drawn(table.shown[1]).items()}
    for k, name in enumerate(loads(table.rows[0])):
        words = in_time(name, table.rows[0])
        columns = {key: f"{LOAD}_{name}_{key}" for key in _IN_TIME}
        found |= {f"sweep_load_{k}_{key}": (each, words[each]) for key, each in columns.items() if each in words}
    return found


def _titled(column: str, quantity: Output) -> str:
    """Return the title of a chart's axis, with what the quantity is of."""
    unit = f" ({quantity.unit})" if quantity.unit else ""
    return f"{quantity.symbol.removesuffix(' of section')} of the {WHOLE if of_finger(column) else SECTION}{unit}"


def _study(table: Table) -> str:
    state, columns = table.shown
    drawn = [(place, words) for place, (column, words) in _charts(table).items() if column in columns]
    note = "Bars are the whole known errors, where a point has them."
    without = (
        '<noscript><p class="note">The charts need JavaScript; the table below has the same numbers.</p></noscript>'
    )
    charts = (html.chart(place, f"{words} at {state} over the sweep") for place, words in drawn)
    title = f"Friction and contact of the {description(columns)} at {state}"
    return html.section("study", title, without, *charts, html.paragraph(note, "note"))


def _points(table: Table) -> str:
    state, columns = table.shown
    rows = []
    for row in table.rows:
        cells = (each.shown(row.get(column), row.get(f"{column}_error")) for column, each in columns.items())
        said = "failed" if row["failure"] else "" if table.reached(row) else f"no {state}"
        rows.append([*(printed(row[key]) for key in table.axes), *cells, said])
    heads = [*table.heads.values(), *(quantity.title for quantity in columns.values()), ""]
    notes = [*remarks(dict.fromkeys(table.forces())), *([] if table.whole else [PER_LENGTH])]
    return html.section(
        "points",
        "Every point",
        html.table(heads, rows, "numbers"),
        *(html.paragraph(note, "note") for note in notes),
        html.items((*table.notes, *table.cautions)),
    )


def _failed(table: Table) -> str:
    rows = [
        (", ".join(f"{key} = {printed(row[key])}" for key in table.axes), row["failure"])
        for row in table.rows
        if row["failure"]
    ]
    if not rows:
        return html.section("failed", "Failures", html.paragraph("No run failed."))
    note = "A run that crashed, was stopped or had too little memory is started again by the same command."
    return html.section(
        "failed", "Which runs failed, and why", html.table(("point", "reason"), rows), html.paragraph(note)
    )


def _parameters(table: Table) -> str:
    return html.section("parameters", "Parameters", html.all_parameters(table.parameters, table.axes))


def _cite(table: Table) -> str:
    given = {key: value for key, (value, _) in changed_keys(table.parameters).items()}
    kept = {key: value for key, value in given.items() if not (key in table.axes or "[" in key or value is None)}
    options = [html.option_of(key, value) for key, value in kept.items()]
    options += [f"--model {shlex.quote(table.model)}"] if table.model != DEFAULT_MODEL else []
    options += ["--states full_slip"] if any("full_slip_reached" in row for row in table.rows) else []
    values = table.values()
    if all(type(value) in (int, float) for each in values.values() for value in each):
        over = [html.option_of(key, ",".join(map(repr, each)), "--over") for key, each in values.items()]
        code = " ".join(["fingerpad sweep", *options, *over, "--out results/again"])
    else:  # --over reads numbers alone
        lines = [f"{html.toml(key)} = {html.toml(each)}" for key, each in values.items()]
        command = " ".join(["fingerpad sweep study.toml", *options, "--out results/again"])
        code = "\n".join(["# study.toml", "[sweep]", *lines, "", "# the command", command])
    lists = any("[" in key and key not in table.axes for key in given)
    note = "Loads of its own, and other lists of the scene, are not in this line." if lists else ""
    return html.section(
        "reproduce", "How to reproduce and cite", f"<pre><code>{html.text(code)}</code></pre>",
        html.paragraph(note, "note") if note else "", html.cite(table.version),
    )  # fmt: skip


def _unit(key: str) -> str:
    meant = described(key)
    return f" {meant.unit}" if meant is not None and meant.unit else ""


def _curves(table: Table) -> dict[str, Any]:
    """Return one curve for each value of all axes but the one along x, which is that with most numbers."""
    charts, scales = _charts(table), {column: quantity.scale for column, quantity in table.shown[1].items()}
    numbers = {key: [each for each in values if type(each) in (int, float)] for key, values in table.values().items()}
    along = max(table.axes, key=lambda key: len(numbers[key]))
    others = [key for key in table.axes if key != along]
    groups: dict[tuple[Any, ...], list[dict[str, Any]]] = {}
    for row in table.rows:
        groups.setdefault(tuple(row[key] for key in others), []).append(row)
    curves = []
    for values, rows in groups.items():
        name = ", ".join(f"{key} = {printed(value)}{_unit(key)}" for key, value in zip(others, values, strict=True))
        x = [row[along] if numbers[along] else printed(row[along]) for row in rows]
        curve: dict[str, Any] = {"name": name, "x": x}
        for (place, (column, _)), end in itertools.product(charts.items(), ("", "_error")):
            found = [row.get(f"{column}{end}") for row in rows]
            curve[f"{place}{end}"] = [None if value is None else value * scales.get(column, 1.0) for value in found]
        curves.append(curve)
    breaks = {place: "<br>of the " if len(title) > _MAX_TITLE else " of the " for place, (_, title) in charts.items()}
    titles = {place: html.typeset(title).replace(" of the ", breaks[place]) for place, (_, title) in charts.items()}
    return {"along": html.typeset(head_of(along, "title")), "curves": curves, "charts": titles}
