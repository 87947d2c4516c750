"""Results side by side: ``fingerpad compare`` of several models, ``fingerpad compare-data`` with measured tables."""

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fingerpad.cli import output
from fingerpad.cli.arguments import Parser, echo, path, positive, quantity, scene_of
from fingerpad.launcher import raising_at_ctrl_c
from fingerpad.reduced import cylinders
from fingerpad.reduced.cylinders import Cylinders
from fingerpad.reduced.model import STATES, Model
from fingerpad.reduced.registry import MODELS
from fingerpad.results.files import below, check_folder
from fingerpad.results.quantities import QUANTITIES, Output, cell, plus_minus_of
from fingerpad.results.result import Result
from fingerpad.results.states import WORDS, called
from fingerpad.runs.context import RunContext
from fingerpad.runs.solve import solved
from fingerpad.scene import Scene
from fingerpad.scene.messages import SceneError, clip, counted, ends
from variational.state import RESULTS

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from fingerpad.measurements.computed import Computed
    from fingerpad.measurements.fit import Fit

_MODELS = """
    fingerpad compare --set voltage=100
    fingerpad compare scene.toml --model cylinders full --out results/compare
"""
_DATA = """
    fingerpad compare-data mine.csv --sweep results/sweep --out mine.png --csv compared.csv
    fingerpad compare-data data/measured/ayyildiz2018.csv --run results/mine
    fingerpad compare-data lab.csv --column "Fn=force (N)" --column "CoF=friction (1)" --run results/mine
"""
_UNITS = {"m": "mm", "m^2": "mm²", "1": ""}  # of the screen, where they are not those of files
_ABOUT = ("table", "state", "quantity", "unit", "force_unit")  # of a row in a file, which has rows of every table
_VALUES = (
    *("participant", "force", "voltage", "measured", "spread", "mu_0"),
    *("computed", "error", "difference", "relative_difference"),
)
_COLUMNS = tuple(Output(key, "") for key in (*_ABOUT, *_VALUES))
_FITTED = {
    "rows": "rows",
    "mu_0": "µ_0",
    "spread": "spread",
    "charged": "charged",
    "ratio": "computed/measured",
    "factor": "factor",
}
_NAMED = 4  # curves in the legend of a picture
_DRAWN = 201  # places of a curve
_NEAR = 0.02  # relative distance of conditions in a picture, below which they are repeats of one


# -- models --------------------------------------------------------------------------------------------
def main(argv: Sequence[str]) -> int:
    """Compare models; return the exit code."""
    parser = Parser("compare", _MODELS)
    parser.add_scene()
    parser.add_out("results", "folder of the full run", quiet="table")
    parser.add_argument(
        "--model",
        nargs="+",
        choices=MODELS,
        default=list(MODELS),
        help="models to compare (default: all; full takes minutes)",
    )
    parser.add_argument("--contact-length", type=quantity, metavar="M", help="cylinders: the length in contact, 1.6 mm")
    parser.add_argument("--ridges", type=positive, metavar="N", help="cylinders: on so many ridges")
    parser.add_argument("--run", type=path, metavar="DIR", help="cylinders: contact lengths of this full run")
    args = parser.read(argv, petsc=True)
    given = [name for name in ("contact_length", "ridges", "run") if getattr(args, name) is not None]
    if given and Cylinders.name not in args.model:
        raise SceneError(f"--{given[0].replace('_', '-')} is given without the model cylinders, which reads it; add it")
    scene = scene_of(args)
    check_folder(args.out)
    models = MODELS | {Cylinders.name: Cylinders(_footprint(scene, args.contact_length, args.ridges, args.run))}
    from fingerpad.startup import start

    start(args.petsc)
    import fingerpad.runs.full  # noqa: F401  # before Ctrl-C raises

    def answer_or_refusal(model: Model) -> Result:
        try:
            folder = below(args.out, model.name) if model.path else None
            return solved(scene, model, RunContext(folder, lines=not args.quiet, bar=not args.quiet))
        except SceneError as error:
            return Result(scene, model.name, None, None, None, failure=str(error))

    with raising_at_ctrl_c():
        results = [answer_or_refusal(model) for name, model in models.items() if name in args.model]
    echo(table(results))
    return max(1 if result.failure else 0 for result in results)


def _footprint(scene: Scene, length: float | None, ridges: int | None, run: Path | None) -> cylinders.Footprint | None:
    if run is not None:
        if length is not None or ridges is not None:
            raise SceneError("--run is given and a contact length too; give one of the two")
        return cylinders.from_run(scene, run)
    if (length is None) != (ridges is None):
        raise SceneError("one of --contact-length and --ridges is given without the other; give both or none")
    if length is None or ridges is None:
        return None
    finger = scene.geometry
    if ridges > finger.ridge_count:
        raise SceneError(f"--ridges is {ridges}, and the finger has {finger.ridge_count}; count those that touch")
    if length > ridges * finger.ridge_wavelength:
        whole = 1e3 * ridges * finger.ridge_wavelength
        raise SceneError(
            f"--contact-length is {1e3 * length:g} mm, longer than {counted(ridges, 'ridge')}, {whole:.3g} mm"
        )
    return cylinders.given(length, ridges)


def table(results: Sequence[Result]) -> str:
    """Return results of one scene side by side, with their errors and their notes."""
    rows = [["", *(result.model for result in results)]]
    for name in STATES:
        for key in RESULTS:
            quantity = QUANTITIES[key]
            unit = f" ({quantity.unit})" if quantity.unit else ""
            states = [getattr(result, name) for result in results]
            cells = ["–" if s is None else cell(key, getattr(s, key), getattr(s.error, key, math.nan)) for s in states]
            words = called(name, next((s.voltage for s in states if s is not None), results[0].scene.volts))
            rows.append([f"{words}: {quantity.words}{unit}", *cells])
    rows.append(["processor time (s)", *(f"{result.cost.processor_seconds:.2f}" for result in results)])
    rows.append(["factorisations", *(str(result.cost.factorisations) for result in results)])
    rows.append(["unknowns", *(str(result.cost.unknowns) for result in results)])
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ["  ".join([row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])]).rstrip() for row in rows]
    said = [(result.model, (*result.notes, *result.cautions, _failure(result))) for result in results]
    shared = [note for note in said[0][1] if note and len(said) > 1 and all(note in each for _, each in said)]
    notes = [f"{model}: {note}" for model, each in said for note in each if note and note not in shared]
    known = [result for result in results if any(state.error.known() for state in result.named.values())]
    if known:
        notes.insert(0, plus_minus_of(f"{part} ({each.model})" for each in known for part in each.parts()))
    return "\n".join(lines + notes + shared)


def _failure(result: Result) -> str:
    """Return why a column ends early, or has no values; empty of a result that is whole."""
    return result.failure if result.named or not result.failure else f"no values, since {result.failure}"


# -- measurements --------------------------------------------------------------------------------------
def compare_data(argv: Sequence[str]) -> int:
    """Compare tables of measurements with results; return the exit code."""
    parser = Parser("compare-data", _DATA)
    parser.add_argument("tables", nargs="+", type=path, metavar="TABLE", help="CSV with names and units in its header")
    parser.add_argument(
        "--column",
        action="append",
        default=[],
        metavar="HEAD=NAME",
        help="a column of the tables by the name and unit it has here, as 'Fn=force (N)'; 'Fn=' leaves it out",
    )
    parser.add_argument("--state", metavar="STATE", help="uncharged, charged or full slip, if the tables name none")
    words = "folders of runs, or the folder of a sweep over force, voltage or both"
    where = {"dest": "results", "metavar": "DIR", "help": words}
    parser.add_argument("--run", "--sweep", nargs="+", type=path, required=True, **where)
    output.add_files(parser, _COLUMNS, "picture of measured and computed values", "--out")
    args = parser.read(argv)
    from fingerpad.measurements import compare, table  # pandas
    from fingerpad.measurements.computed import computed

    measured = [table.read(file, _mapping(args.column), args.state) for file in args.tables]
    known = [computed(args.results, each) for each in measured]
    compared = [compare.beside(*pair) for pair in zip(measured, known, strict=True)]
    echo("\n\n".join("\n".join(_lines(each)) for each in compared))
    rows = [row for each in compared for row in _rows(each)]
    output.write_files(args, _COLUMNS, rows, lambda file, _: _draw(file, compared, known))
    return 0


def _mapping(given: Sequence[str]) -> dict[str, str]:
    """Return the names of columns by their heads."""
    found = {}
    for text in given:
        head, equals, name = text.rpartition("=")
        if not equals:
            raise SceneError(f"--column is {clip(repr(text))}; it must be HEAD=NAME, such as 'Fn=force (N)'")
        found[head] = name
    return found


def _rows(compared: "pd.DataFrame") -> list[dict[str, str | float | None]]:
    """Return the rows by name, in SI units; None for what is missing."""
    about = {key: compared.attrs[key] for key in _ABOUT}
    about["state"] = WORDS[about["state"]]
    values = compared.astype(object).where(compared.notna(), None)
    return [about | row for row in values.to_dict("records")]


def _lines(compared: "pd.DataFrame") -> Iterator[str]:
    """Yield table and misfit as text."""
    about, errors = compared.attrs, compared.error.notna().any()
    fits: list[Fit] = about["fits"]
    unit = _UNITS.get(about["unit"], about["unit"])
    named = ("measured", "spread", "computed", *(["error"] if errors else []), "difference")
    columns = [
        *([Output("participant", "")] if "participant" in compared else []),
        Output("force", about["force_unit"]),
        Output("voltage", "V rms", digits=1),
        *(Output(key, unit, words="±" if key == "error" else key, digits=4) for key in named),
        Output("relative_difference", "%", words="relative", digits=1),
    ]
    yield f"{about['quantity']} at {WORDS[about['state']]}: {ends(about['source'], 200)}"
    more = [f"{name} {about[name]}" for name in ("doi", "url", "people") if name in about]
    yield from [clip("; ".join(more), 200)] if more else []
    yield output.text(columns, _rows(compared))
    if about["ignored"]:
        yield f"Columns not read: {clip(', '.join(about['ignored']), 200)}."
    if errors:
        yield "±: whole known error of the computed value."
    if about["turned"]:
        rows = f"{about['turned']} of {len(compared)} rows have a friction below 0"
        yield f"{rows}, of the other direction; its magnitude is compared."
    yield from _fits(fits, about["mu_0"])
    compared_at = compared.voltage[compared.difference.notna()]
    if about["misfit"] and not compared_at.any():
        alone = f"µ_0 alone, {about['mu_0']:g} in the results" if about["mu_0"] else "friction without voltage"
        what = alone if about["quantity"].startswith("friction") else "contact without voltage"
        yield f"All compared rows are at 0 V: the misfit is that of {what}, and not of the attraction."
    yield from _misfit(about["misfit"], errors)
    if not compared.voltage.any():
        yield "No row is under a voltage: attraction is not compared."
    used = compared[compared.voltage > 0] if fits else compared
    beside, none = len(used), int(used.computed.isna().sum())
    if none:
        yield f"Not compared, since no value is computed there: {none} of {beside} rows{' under voltage' * bool(fits)}."
    if zero := beside - none - about["misfit"].get("rows", 0):
        yield f"Not compared, since the computed or the measured value is 0 there: {zero} of {beside} rows."


def _fits(fits: "Sequence[Fit]", known: float) -> Iterator[str]:
    """Yield the friction coefficients of rows at 0 V."""
    if not fits:
        return
    every = fits[-1]
    rows = "one row" if every.rows == 1 else f"{every.rows} rows"
    spread = "" if math.isnan(every.spread) else f", with a standard deviation of {every.spread:.3g}"
    yield f"µ_0 is fitted to {rows} at 0 V: {every.mu_0:.4g}{spread}. The results have {known:g}."
    if len(fits) > 1:
        yield "Computed values above are of each participant's own µ_0. Charged: rows under voltage, of the ratios."
        digits = {"mu_0": 4, "spread": 4, "ratio": 3, "factor": 3}
        numbers = (Output(key, "", words=words, digits=digits.get(key, 0)) for key, words in _FITTED.items())
        mine = [each.misfit | vars(each) | {"charged": each.misfit.get("rows", 0)} for each in fits]
        yield output.text([Output("who", ""), *numbers], mine)
    yield "Computed friction is scaled to it, with the attraction of the results. Rows at 0 V are not in the misfit."


def _misfit(found: dict[str, float], errors: bool) -> Iterator[str]:
    """Yield how far computed values are from measured ones."""
    if not found:
        return
    count, mean = found["rows"], found["ratio"]
    rows = f"(geometric mean of {count})"
    yield f"Misfit: computed over measured {mean:.3g} {rows}, at most a factor of {found['factor']:.3g}."
    if count > 1:
        factor = f"at most a factor of {found['shape_factor']:.3g}"
        yield f"Shape alone, computed values scaled by one factor ({1 / mean:.3g}): {factor}."
    if spreads := found["spreads"]:
        which = "" if spreads == count else " rows that have a spread"
        plus = " plus the error of the computed value" if errors else ""
        yield f"Within the spread{plus}: {found['within']} of {spreads}{which}."


def _draw(file: Path, compared: Sequence["pd.DataFrame"], known: Sequence["Computed"]) -> None:
    """Draw each table over the computed values, in a panel of its own."""
    with output.panels(file, "Measured points and computed lines", len(compared)) as (_, panels):
        for each in zip(panels, compared, known, strict=True):
            _panel(*each)


def _panel(ax: "Axes", rows: "pd.DataFrame", known: "Computed") -> None:
    from fingerpad.measurements.computed import CLOSE
    from fingerpad.results import style

    about, points = rows.attrs, known.points
    unit = _UNITS.get(about["unit"], about["unit"])
    scale = Output("", unit).scale
    factor = scale * (about["fits"][-1].mu_0 / about["mu_0"] if about["fits"] else 1.0)
    rows = rows.assign(force=_levels(rows.force), voltage=_levels(rows.voltage))
    over_voltage = rows.voltage.nunique() > rows.force.nunique()
    x, other, name = ("voltage", "force", about["force_unit"]) if over_voltage else ("force", "voltage", "V")
    axis = np.union1d(points[x], np.linspace(points[x].min(), points[x].max(), _DRAWN))
    for k, (held, mine) in enumerate(rows.groupby(other)):
        colour, label = style.CATEGORIES[k % len(style.CATEGORIES)], f"{held:.3g} {name}"
        level = np.full(len(axis), held)
        curve, error = (factor * values for values in known.at(*((level, axis) if over_voltage else (axis, level))))
        output.curve(ax, k, axis, curve, f"computed, {label}" if k < _NAMED else "_")
        ax.fill_between(axis, curve - error, curve + error, color=colour, alpha=0.2, lw=0)
        at = points[np.isclose(points[other], held, rtol=CLOSE if over_voltage else 1e-6, atol=0.0)]
        ax.errorbar(at[x], factor * at.value, factor * at.error, fmt=".", ms=9, capsize=2, color=colour)
        marker = style.MARKERS[k % len(style.MARKERS)]
        repeated = mine.groupby(x).size().max() > 1
        if repeated:
            ax.plot(mine[x], scale * mine.measured, marker, ms=3, color=colour, alpha=0.5)
        repeats = mine.groupby(x).agg({"measured": ["mean", "std"], "spread": "mean"})
        spread = repeats["measured", "std"].fillna(repeats["spread", "mean"])
        look: dict[str, Any] = {"fmt": marker, "color": colour, "mfc": "white"}
        look["label"] = f"measured, {label}{', mean of repeats' * bool(repeated)}" if k < _NAMED else "_"
        bars = None if spread.isna().all() else scale * spread
        ax.errorbar(repeats.index, scale * repeats["measured", "mean"], bars, ms=7, capsize=3, **look)
    force = "force (N)" if about["force_unit"] == "N" else "force per length (N/m)"
    ax.set(xlabel="voltage (V rms)" if over_voltage else force)
    ax.set(ylabel=f"{about['quantity']} ({unit or '–'})", title=style.plain(clip(about["source"], 40)))
    ax.set_ylim(bottom=0)
    if math.isclose(*ax.get_xlim(), rel_tol=0.05):  # a single force, but for roundoff
        ax.set_xlim(0, 2 * rows[x].mean())
    ax.legend(title=f"µ_0 = {about['fits'][-1].mu_0:.3g}, fitted at 0 V" if about["fits"] else None)


def _levels(values: "pd.Series[float]") -> "pd.Series[float]":
    """Return for each value the mean of those near it: neighbours within :data:`_NEAR` are repeats of one condition."""
    order = values.sort_values()
    apart = order.diff() > _NEAR * order
    return order.groupby(apart.cumsum()).transform("mean").reindex(values.index)
