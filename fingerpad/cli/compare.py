"""Tables of measurements beside results: ``fingerpad compare``."""

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fingerpad.cli import output
from fingerpad.cli.arguments import Parser, echo, heads_of, path
from fingerpad.results.quantities import Output
from fingerpad.results.states import WORDS
from fingerpad.scene.messages import clip, ends

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from fingerpad.measurements.compare import Computed

_EXAMPLES = """
    fingerpad compare mine.csv --sweep results/sweep --out mine.png --csv compared.csv
    fingerpad compare data/measured/ayyildiz2018.csv --run results/mine
    fingerpad compare lab.csv --column "Fn=force (N)" --column "CoF=friction (1)" --run results/mine
"""
_ABOUT = ("table", "state", "quantity", "unit", "force_unit")  # of a row in a file, which has rows of every table
_VALUES = ("force", "voltage", "measured", "spread", "mu_0", "computed", "error", "difference", "relative_difference")
_COLUMNS = tuple(Output(key, "") for key in (*_ABOUT, *_VALUES))
_UNITS = {"m": "mm", "m^2": "mm²", "1": ""}  # of the screen, where they are not those of files
_IN_LEGEND = 4  # curves in the legend of a picture


def main(argv: Sequence[str]) -> int:
    """Compare tables of measurements with results; return the exit code."""
    parser = Parser("compare", _EXAMPLES)
    parser.add_argument("tables", nargs="+", type=path, metavar="TABLE", help="CSV with names and units in its header")
    parser.add_heads()
    parser.add_argument("--state", metavar="STATE", help="uncharged, charged or full slip, if the tables name none")
    words = "folders of runs, or the folder of a sweep over force, voltage or both"
    where = {"dest": "results", "metavar": "DIR", "help": words}
    parser.add_argument("--run", "--sweep", nargs="+", type=path, required=True, **where)
    output.add_files(parser, _COLUMNS, "picture of measured and computed values", "--out")
    args = parser.read(argv)
    from fingerpad.measurements import compare, table  # pandas

    columns = heads_of(args)
    measured = [table.read(file, columns, args.state) for file in args.tables]
    known = [compare.computed(args.results, each) for each in measured]
    compared = [compare.comparison(*pair) for pair in zip(measured, known, strict=True)]
    echo("\n\n".join("\n".join(_lines(each)) for each in compared))
    rows = [row for each in compared for row in _rows(each)]
    output.write_files(args, _COLUMNS, rows, lambda file, _: _draw(file, compared, known))
    return 0


def _rows(compared: "pd.DataFrame") -> list[dict[str, Any]]:
    """Return the rows by name, in SI units; None for what is missing."""
    about = {key: compared.attrs[key] for key in _ABOUT} | {"state": WORDS[compared.attrs["state"]]}
    return [about | row for row in compared.astype(object).where(compared.notna(), None).to_dict("records")]


def _lines(compared: "pd.DataFrame") -> Iterator[str]:
    """Yield table and misfit as text."""
    about, errors, fit, found = (
        compared.attrs,
        compared.error.notna().any(),
        compared.attrs["fit"],
        compared.attrs["misfit"],
    )
    unit = _UNITS.get(about["unit"], about["unit"])
    named = ("measured", "spread", "computed", *(["error"] if errors else []), "difference")
    columns = [
        Output("force", about["force_unit"]),
        Output("voltage", "V rms", digits=1),
        *(Output(key, unit, words="±" if key == "error" else key, digits=4) for key in named),
        Output("relative_difference", "%", words="relative", digits=1),
    ]
    yield f"{about['quantity']} at {WORDS[about['state']]}: {ends(about['source'], 200)}"
    if more := [f"{name} {about[name]}" for name in ("doi", "url", "people") if name in about]:
        yield clip("; ".join(more), 200)
    yield output.text(columns, _rows(compared))
    if about["ignored"]:
        yield f"Columns not read: {clip(', '.join(about['ignored']), 200)}."
    if errors:
        yield "±: whole known error of the computed value."
    if about["turned"]:
        yield f"Rows with a friction below 0, of the other direction: {about['turned']}. Magnitudes are compared."
    if fit:
        spread = "" if math.isnan(fit["spread"]) else f", standard deviation {fit['spread']:.3g}"
        yield (
            f"µ_0 of the rows at 0 V ({fit['rows']}): {fit['mu_0']:.4g}{spread}. Computed friction is scaled to it "
            f"from {about['mu_0']:g} in the results, with their attraction. Rows at 0 V are not in the misfit."
        )
    elif not compared.voltage[compared.difference.notna()].any():
        yield "All compared rows are at 0 V: attraction is not compared."
    if found:
        yield (
            f"Misfit: computed over measured {found['ratio']:.3g} (geometric mean of {found['rows']}), at most a "
            f"factor of {found['factor']:.3g}. Scaled by one factor ({1 / found['ratio']:.3g}): at most a factor of "
            f"{found['shape_factor']:.3g}."
        )
        if found["spreads"]:
            yield f"Within the spread plus the error of the computed value: {found['within']} of {found['spreads']}."
    used = compared[compared.voltage > 0] if fit else compared
    if left := len(used) - found.get("rows", 0):
        yield f"Not compared, since a value is 0 or is not computed there: {left} of {len(used)} rows."


def _draw(file: Path, compared: Sequence["pd.DataFrame"], known: Sequence["Computed"]) -> None:
    """Draw each table over the computed values, in a panel of its own."""
    with output.panels(file, "Measured points and computed lines", len(compared)) as (_, panels):
        for each in zip(panels, compared, known, strict=True):
            _panel(*each)


def _panel(ax: "Axes", rows: "pd.DataFrame", known: "Computed") -> None:
    from fingerpad.results.pictures import style

    about, points = rows.attrs, known.points
    unit = _UNITS.get(about["unit"], about["unit"])
    scale = Output("", unit).scale
    factor = scale * (about["fit"]["mu_0"] / about["mu_0"] if about["fit"] else 1.0)
    over_voltage = rows.voltage.nunique() > rows.force.nunique()
    x, other, name = ("voltage", "force", about["force_unit"]) if over_voltage else ("force", "voltage", "V")
    across = np.union1d(points[x], np.linspace(points[x].min(), points[x].max(), 201))
    for k, (held, mine) in enumerate(rows.groupby(rows[other].map(lambda value: float(f"{value:.2g}")))):
        level = np.full(len(across), mine[other].mean())
        curve, error = (factor * values for values in known.at(*((level, across) if over_voltage else (across, level))))
        words = f"{held:.3g} {name}"
        output.curve(ax, k, across, curve, f"computed, {words}" if k < _IN_LEGEND else "_", error=np.nan_to_num(error))
        look: dict[str, Any] = {"fmt": style.MARKERS[k % len(style.MARKERS)], "mfc": "white", "ms": 6, "capsize": 3}
        look |= {
            "color": style.CATEGORIES[k % len(style.CATEGORIES)],
            "label": f"measured, {words}" if k < _IN_LEGEND else "_",
        }
        ax.errorbar(mine[x], scale * mine.measured, None if mine.spread.isna().all() else scale * mine.spread, **look)
    force = "force (N)" if about["force_unit"] == "N" else "force per length (N/m)"
    ax.set(xlabel="voltage (V rms)" if over_voltage else force)
    ax.set(ylabel=f"{about['quantity']} ({unit or '–'})", title=style.plain(clip(about["source"], 40)))
    ax.set_ylim(bottom=0)
    if math.isclose(*ax.get_xlim(), rel_tol=0.05):  # a single force, but for roundoff
        ax.set_xlim(0, 2 * rows[x].mean())
    ax.legend(title=f"µ_0 = {about['fit']['mu_0']:.3g}, fitted at 0 V" if about["fit"] else None)
