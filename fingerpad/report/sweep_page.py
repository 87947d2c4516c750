"""The table of a sweep and its report: friction and contact over what was varied, every point, and what failed."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from fingerpad.report import page as html
from fingerpad.report.charts import COLOURS, DASHES, Panel, Series, chart
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
from fingerpad.scene import SceneError
from fingerpad.scene.messages import clip
from fingerpad.scene.reading import DEFAULT_MODEL, model_name
from fingerpad.slices.errors import remarks

_CHARTS = dict.fromkeys(key for key in (*in_table("short"), *in_table("first", FINGER)) if key != "f_ext")
_MAX_CAUTIONS = 3  # in the headline
_MAX_VALUES = 6  # of a key in the headline
_RUBS = 1e-6  # µ_app that is no roundoff
_IN_TIME = ("mu_app_max", "mu_app_mean", "f_t_amplitude")  # columns with a chart of a load over time, behind its name
FILE = "sweep.json"


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
    """Return the table of the sweep in a folder, from ``sweep.json``.

    Raises:
        SceneError: it cannot be read.
    """
    name = clip(str(folder), 80)
    try:
        found = read_object(folder / FILE)
        refuse_other_format(found, f"the sweep in {name}")
        axes, rows = tuple(found["axes"]), tuple(found["rows"])
        if not (axes and rows and all({*axes, "failure"} <= row.keys() == rows[0].keys() for row in rows)):
            raise ValueError("its rows have no value of a varied key")
        return Table(
            folder,
            axes,
            rows,
            dict(found["parameters"]),
            model_name(found["model"]),
            str(found.get("version", "")),
            tuple(map(str, found["cautions"])),
            tuple(map(str, found["notes"])),
            tuple(Output(**each) for each in found["outputs"]),
        )
    except KeyError as missing:
        raise SceneError(f"{FILE} in {name} has no {missing}; give the command of the sweep again") from None
    except SceneError:
        raise
    except (OSError, ValueError, TypeError, AttributeError) as error:
        raise SceneError(f"{FILE} in {name} cannot be read: {error}; give the command of the sweep again") from None


def page(table: Table) -> str:
    """Return the page of a sweep."""
    state, columns = table.shown
    sentence, said = _finding(table)
    charts = _charts(table)
    over_time = [(name, [charts[c] for c in charts if c.startswith(f"{LOAD}_{name}_")], heads, rows)
                 for name, (heads, *rows) in tables(table.rows, table.heads)]  # fmt: skip
    failed = [(", ".join(f"{key} = {printed(row[key])}" for key in table.axes), row["failure"]) for row in table.rows
              if row["failure"]]  # fmt: skip
    alone = "--states full_slip" if "full_slip_reached" in table.rows[0] else ""
    return html.page(
        "sweep.html", f"fingerpad: sweep over {', '.join(table.axes)}", name=table.folder.resolve().name,
        sentence=sentence, said=said, verdict=_verdict(table), state=state, of=description(columns),
        over_time=over_time, charts=[charts[column] for column in columns if column in charts],
        heads=[*table.heads.values(), *(quantity.title for quantity in columns.values()), ""], points=_points(table),
        remarks=[*remarks(dict.fromkeys(table.forces())), *([] if table.whole else [PER_LENGTH])],
        notes=[*table.notes, *table.cautions], failed=failed, parameters=html.parameters(table.parameters, table.axes),
        again=html.recipe(table.parameters, table.model, table.values(), alone), version=table.version,
    )  # fmt: skip


def _finding(table: Table) -> tuple[str, str]:
    """Return the finding, a sentence, and what it is over."""
    state, columns = table.shown
    sentence, said = f"No point reached {state}.", f"Over {_varied(table)}."
    slid = [row for row in table.rows if table.reached(row)]
    for column, quantity in _drawn(columns).items():  # the coefficient of friction first
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
    return sentence, said


def _verdict(table: Table) -> tuple[str, str]:
    """Return whether the points can be used, and why not."""
    failed = [row for row in table.rows if row["failure"]]
    missing = sum(not table.reached(row) and not row["failure"] for row in table.rows)
    if failed:
        return BAD, f"{len(failed)} of {len(table.rows)} points failed; the table of failures says why."
    if not (missing or table.cautions):
        return GOOD, "Every point was computed."
    slips = f"{missing} of {len(table.rows)} points have no {table.shown[0]}." if missing else ""
    more = len(table.cautions) - _MAX_CAUTIONS
    limits = [*table.cautions[:_MAX_CAUTIONS], *([f"and {more} more"] if more > 0 else [])]
    limit = f"Limits of validity are reached: {'; '.join(limits)}." if limits else ""
    return CARE, " ".join(filter(None, (slips, limit)))


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


def _drawn(columns: Mapping[str, Output]) -> dict[str, Output]:
    """Return the columns with a chart, one of each quantity; of the whole finger before the section's."""
    found = [next((each for each in columns.items() if each[0].endswith(f"_{key}")), None) for key in _CHARTS]
    return dict(each for each in found if each is not None)


def _varied(table: Table) -> str:
    words = []
    for key, values in table.values().items():
        some = ", ".join(map(printed, values[:_MAX_VALUES]))
        words.append(f"{head_of(key, 'title')}: {some}{', …' if len(values) > _MAX_VALUES else ''}")
    return "; ".join(words)


def _charts(table: Table) -> dict[str, Any]:
    """Return the charts by column: those of full slip, and those of loads over time."""
    titles = {column: (_titled(column, each), each.scale) for column, each in _drawn(table.shown[1]).items()}
    for name in loads(table.rows[0]):
        words = in_time(name, table.rows[0])
        columns = [f"{LOAD}_{name}_{key}" for key in _IN_TIME]
        titles |= {column: (words[column].title, 1.0) for column in columns if column in words}
    return {column: _chart(table, column, *title) for column, title in titles.items()}


def _titled(column: str, quantity: Output) -> str:
    """Return the title of a chart's axis, with what the quantity is of."""
    unit = f" ({quantity.unit})" if quantity.unit else ""
    return f"{quantity.symbol.removesuffix(' of section')} of the {WHOLE if of_finger(column) else SECTION}{unit}"


def _chart(table: Table, column: str, title: str, scale: float) -> Any:
    """Return the chart of a column: a curve for each value of all axes but the one along x, which has most numbers."""
    along, curves = _curves_of(table, column)
    numbers = [value for value in table.values()[along] if type(value) in (int, float)]
    names = [] if numbers else [printed(value) for value in table.values()[along]]
    series = []
    for k, (name, rows) in enumerate(curves.items()):
        x = [table.values()[along].index(row[along]) if names else row[along] for row in rows]
        y, error = ([_scaled(row.get(f"{column}{end}"), scale) for row in rows] for end in ("", "_error"))
        series.append(Series(name, x, y, "both", COLOURS[k % len(COLOURS)], DASHES[k % len(DASHES)], error))
    return chart(
        [Panel(title, series, 200.0, zero=True)], head_of(along, "title"), f"{title} over the sweep", names=names
    )


def _curves_of(table: Table, column: str) -> tuple[str, dict[str, Sequence[Mapping[str, Any]]]]:
    """Return the key along x, and the rows of each curve of a column by the values of the other keys, in words."""
    numbers = {key: [each for each in values if type(each) in (int, float)] for key, values in table.values().items()}
    along = max(table.axes, key=lambda key: len(numbers[key]))
    curves = dict[str, Any]()
    for row in table.rows:
        name = ", ".join(f"{key} = {printed(row[key])}{_unit(key)}" for key in table.axes if key != along)
        curves.setdefault(name, []).append(row)
    return along, curves


def _scaled(value: float | None, scale: float) -> float:
    return math.nan if value is None else scale * value


def _unit(key: str) -> str:
    meant = described(key)
    return f" {meant.unit}" if meant is not None and meant.unit else ""


def _points(table: Table) -> list[list[str]]:
    """Return a row for each point."""
    state, columns = table.shown
    rows = []
    for row in table.rows:
        cells = (each.shown(row.get(column), row.get(f"{column}_error")) for column, each in columns.items())
        said = "failed" if row["failure"] else "" if table.reached(row) else f"no {state}"
        rows.append([*(printed(row[key]) for key in table.axes), *cells, said])
    return rows
