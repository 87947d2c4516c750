"""``fingerpad compare-data``: tables of measurements beside a run or a sweep."""

import math
import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fingerpad.cli import ours, tables
from fingerpad.cli.arguments import Parser, echo, path
from fingerpad.cli.curves import Array, Ours, reach
from fingerpad.cli.measured import Measured, read
from fingerpad.io.states import WORDS
from fingerpad.io.titles import plain
from fingerpad.scene.messages import SceneError, clip

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_EXAMPLES = """
    fingerpad compare-data mine.csv --sweep results/sweep --out mine.png --csv compared.csv
    fingerpad compare-data data/measured/ayyildiz2018.csv --run results/mine
"""
_SCALES = {"m": ("mm", 1e3), "m^2": ("mm²", 1e6), "N/m": ("N/m", 1.0), "N": ("N", 1.0), "1": ("", 1.0)}
_ABOUT = ("table", "state", "quantity", "unit", "force_unit")  # of a row in a file, which has rows of every table
_VALUES = ("force", "voltage", "measured", "spread", "ours", "error", "ratio")
_COLUMNS = tuple(tables.Column(key, key) for key in (*_ABOUT, *_VALUES))
_NAMED = 4  # curves in the legend of a picture
_DRAWN = 201  # places of a curve


def main(argv: Sequence[str]) -> int:
    """Compare tables of measurements with ours; return the exit code."""
    parser = Parser(
        "fingerpad compare-data",
        "Print measurements beside a finished run or sweep, and their misfit as a ratio; draw both.",
        _EXAMPLES,
    )
    parser.add_argument("tables", nargs="+", type=path, metavar="TABLE", help="CSV with a header of units and a source")
    which = parser.add_mutually_exclusive_group(required=True)
    which.add_argument("--run", nargs="+", type=path, metavar="DIR", help="folders of runs")
    which.add_argument("--sweep", type=path, metavar="DIR", help="folder of a sweep over f_ext, voltage or both")
    tables.add_files(parser, _COLUMNS, "picture of tables and ours", "--out")
    args = parser.read(argv)
    measured = [read(file) for file in args.tables]
    found = ours.read(args.run or [args.sweep], sweep=args.sweep is not None)
    compared = [_Compared(table, ours.ours(found, table)) for table in measured]
    echo("\n\n".join("\n".join(each.lines()) for each in compared))
    rows = [row for each in compared for row in each.rows()]
    tables.write_files(args, _COLUMNS, rows, lambda file, _: draw(file, compared))
    return 0


class _Compared:
    """A table of measurements with ours at the same conditions."""

    def __init__(self, table: Measured, known: Ours) -> None:
        """Interpolate ours; SceneError where no row of the table is within ours."""
        self.table, self.known = table, known
        self.force, self.voltage = ours.conditions(table, known)
        self.measured, self.spread = np.array(table.values), np.array(table.spread)
        self.ours, self.error = known.at(self.force, self.voltage), known.error(self.force, self.voltage)
        self.ratio = self.ours / self.measured
        if np.isnan(self.ours).all():
            has = reach(known, table.force_unit)
            raise SceneError(f"no row of {clip(str(table.file), 80)} is within ours, which has {has}")
        if not self.within.any():
            none = int(np.isnan(self.ours).sum())
            rows = f"{len(self.ours)} rows of {clip(str(table.file), 80)}"
            beyond = f", and {none} of them are not within ours" if none else ""
            raise SceneError(f"ours has no {table.quantity} above 0 in the {rows}{beyond}")

    @property
    def within(self) -> NDArray[np.bool_]:
        """Return which rows are within ours and have a ratio."""
        return np.isfinite(self.ratio) & (self.ratio > 0)

    def rows(self) -> list[dict[str, str | float | None]]:
        """Return the rows by name, in SI units; None for what is missing."""
        table = self.table
        file = os.path.join(os.curdir, table.file)  # ./=a.csv: a cell =a.csv would be a formula
        about = (file, WORDS[table.state], table.quantity, table.unit, table.force_unit)
        values = (self.force, self.voltage, self.measured, self.spread, self.ours, self.error, self.ratio)
        found = ([float(v) if np.isfinite(v) else None for v in row] for row in zip(*values, strict=True))
        return [dict(zip((*_ABOUT, *_VALUES), (*about, *row), strict=True)) for row in found]

    def lines(self) -> Iterator[str]:
        """Yield the table and the misfit as text."""
        unit, scale = _SCALES[self.table.unit]
        columns = [
            tables.Column("force", "force", self.table.force_unit),
            tables.Column("voltage", "voltage", "V"),
            tables.Column("measured", "measured", unit, scale),
            tables.Column("spread", "spread", unit, scale),
            tables.Column("ours", "ours", unit, scale),
            *([tables.Column("error", "±", unit, scale, ".2g")] if np.isfinite(self.error).any() else []),
            tables.Column("ratio", "ours/measured", digits=".3g"),
        ]
        yield f"{self.table.quantity} at {WORDS[self.table.state]}: {clip(self.table.source, 200)}"
        more = [f"{name} {self.table.about[name]}" for name in ("doi", "url", "people") if name in self.table.about]
        yield from [clip("; ".join(more), 200)] if more else []
        yield tables.text(columns, self.rows())
        if np.isfinite(self.error).any():
            yield "±: estimated discretisation error of ours, of the mesh alone."
        yield from self._misfit()

    def _misfit(self) -> Iterator[str]:
        log, count = np.log(self.ratio[self.within]), int(self.within.sum())
        mean, most = float(np.exp(log.mean())), float(np.exp(np.abs(log).max()))
        yield f"Misfit: ours over measured {mean:.3g} (geometric mean of {count}), at most a factor of {most:.3g}."
        if count > 1:
            shape = float(np.exp(np.abs(log - log.mean()).max()))
            yield f"Shape alone, ours scaled by one factor ({1 / mean:.3g}): at most a factor of {shape:.3g}."
        if (spread := self.within & np.isfinite(self.spread)).any():
            known = np.isfinite(self.error[spread])
            allowed = self.spread[spread] + np.where(known, self.error[spread], 0.0)
            near = np.abs(self.ours - self.measured)[spread] <= allowed
            which = "" if spread.sum() == count else " rows that have a spread"
            plus = " plus the error of ours" if known.any() else ""
            yield f"Within the spread{plus}: {near.sum()} of {spread.sum()}{which}."
        if count < len(self.ratio):
            none, total = int(np.isnan(self.ours).sum()), len(self.ratio)
            yield from [f"Not compared, since ours has no result there: {none} of {total} rows."] if none else []
            zero = total - count - none
            yield from [f"Not compared, since ours is 0 there: {zero} of {total} rows."] if zero else []


def draw(file: Path, compared: Sequence[_Compared]) -> None:
    """Draw each table over ours, in a panel of its own."""
    from fingerpad.cli import plot  # Matplotlib

    with plot.panels(file, "Measured, and ours as lines", len(compared)) as (_, panels):
        for ax, each in zip(panels, compared, strict=True):
            _panel(ax, each)


class _Curve(NamedTuple):
    """Ours over voltages or forces, as the table has it; shape (places,) each."""

    along: Array
    values: Array
    error: Array
    computed: NDArray[np.bool_]
    """Whether a value is not interpolated."""

    @classmethod
    def of(cls, known: Ours, axis: Array, held: float, over_voltage: bool) -> "_Curve":
        """Return ours along an axis, where the other condition is held."""
        along = np.union1d(axis, np.linspace(axis[0], axis[-1], _DRAWN))
        level = np.full(len(along), held)
        at = (level, along) if over_voltage else (along, level)
        return cls(along, known.at(*at), known.error(*at), known.computed(*at))


def _panel(ax: "Axes", each: _Compared) -> None:
    from fingerpad.cli import plot
    from fingerpad.io import style

    unit, scale = _SCALES[each.table.unit]
    over_voltage = len(np.unique(each.voltage)) > len(np.unique(each.force))
    x, other = (each.voltage, each.force) if over_voltage else (each.force, each.voltage)
    known, name = (each.known.voltage, each.table.force_unit) if over_voltage else (each.known.force, "V")
    for k, held in enumerate(np.unique(other)):
        mine, colour = other == held, style.CATEGORIES[k % len(style.CATEGORIES)]
        found = _Curve.of(each.known, known, held, over_voltage)
        along, curve, error = found.along, scale * found.values, scale * found.error
        plot.curve(ax, k, along, curve, f"ours, {held:g} {name}" if k < _NAMED else "_")
        ax.fill_between(along, curve - error, curve + error, color=colour, alpha=0.2, lw=0)
        at = found.computed
        ax.errorbar(along[at], curve[at], error[at], fmt=".", ms=9, capsize=2, color=colour)
        spread = None if np.isnan(each.spread).all() else scale * each.spread[mine]
        ax.errorbar(
            x[mine],
            scale * each.measured[mine],
            spread,
            fmt=style.MARKERS[k % len(style.MARKERS)],
            color=colour,
            mfc="white",
            ms=7,
            capsize=3,
            label=f"measured, {held:g} {name}" if k < _NAMED else "_",
        )
    force = "force (N)" if each.table.whole else "force per length (N/m)"
    ax.set(xlabel="voltage (V)" if over_voltage else force)
    ax.set(ylabel=f"{each.table.quantity} ({unit or '–'})", title=plain(clip(each.table.source, 40)))
    ax.set_ylim(bottom=0)
    if math.isclose(*ax.get_xlim(), rel_tol=0.05):  # a single force, but for roundoff
        ax.set_xlim(0, 2 * x.mean())
    ax.legend()
