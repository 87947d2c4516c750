"""A calibration (:class:`fingerpad.measurements.calibrate.Calibration`) as text, and as a page with the fit."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fingerpad import notebook
from fingerpad.launcher import version
from fingerpad.report import page as html
from fingerpad.report.charts import COLOURS, DASHES, Panel, Series, chart
from fingerpad.results.files import replace
from fingerpad.results.quantities import Output
from fingerpad.scene import Scene
from fingerpad.scene.keys import by_name

if TYPE_CHECKING:
    import pandas as pd

_UNITS = {"friction force": "N", "gross area": "mm²", "contact area": "mm²", "depth": "mm", "air gap": "µm"}
_WIDE = 1.3  # rms of deviations, in spreads, from which on it is mentioned


def tables(found: Any) -> Iterator[tuple[str, list[str], list[list[str]]]]:
    """Yield title, heads and rows of each table of a calibration."""
    people, keys = bool(found.values.spread.any()), by_name(Scene)
    heads = ["key", "value", "unit", "95 % region", *["between people"] * people]
    rows = [
        [key, f"{v.value:.4g}", keys[key].unit, f"{v.low:.4g} to {v.high:.4g}", *[f"{100 * v.spread:.0f} %"] * people]
        for key, v in found.values.iterrows()
    ]
    yield "Values", heads, rows
    if len(found.values) > 1:
        numbers = found.correlation.map("{:.2f}".format)
        yield "Correlations", ["", *numbers], [[key, *row] for key, *row in numbers.itertuples()]
    for words, rows_of in (("Residuals, in σ", ~found.rows.held_out), ("Held out, in σ", found.rows.held_out)):
        if rows_of.any():
            heads = ["quantity", "values", "within the band", "mean", "rms", "largest"]
            yield words, heads, [[of, *_residuals(each)] for of, each in found.rows[rows_of].groupby("quantity")]
    for kind, each in found.evidence.groupby("kind"):
        rows = [[r.name, *map(_number, (r.AICc, r.difference, r.weight)), r.values] for r in each.itertuples()]
        yield f"Evidence: {kind}", ["", "AICc", "above the least", "weight", "fitted values"], rows
    if not found.full.empty:
        rows = [
            [f"{r.force:g} N, {r.voltage:g} V", r.quantity, *(_shown(r.quantity, x) for x in (r.closed, r.full)),
             f"{100 * (r.closed / r.full - 1):+.1f} %"] for r in found.full.itertuples()
        ]  # fmt: skip
        yield "Full runs", ["at", "quantity", "closed form", "full model", "difference"], rows


def _residuals(rows: "pd.DataFrame") -> list[str]:
    off = rows.deviation
    worst = rows.loc[off.abs().idxmax()]
    inside = rows.measured.between(rows.low, rows.high).sum()
    return [f"{len(rows)}", f"{inside}", f"{off.mean():+.2f}", f"{np.sqrt((off**2).mean()):.2f}",
            f"{worst.deviation:+.1f}, line {worst.line}"]  # fmt: skip


def _number(x: float) -> str:
    return "–" if np.isnan(x) else f"{x:.2f}"


def _shown(quantity: str, value: float) -> str:
    unit = _UNITS.get(quantity, "")
    return f"{value * Output('', unit).scale:.4g} {unit}".rstrip()


def remarks(found: Any) -> list[str]:
    """Return what a reader must know beside the tables."""
    fitted, held = found.rows[~found.rows.held_out], found.rows[found.rows.held_out]
    people = fitted.participant.nunique()
    lines = [f"Fitted to {len(fitted)} values{f' of {people} participants' if people > 1 else ''}."]
    lines += [] if found.evidence.empty else ["AICc compares closures and friction laws, the least is the best."]
    if people > 1 and not found.values.spread.any():
        lines.append("There are too few participants for a spread between them: they are taken as one.")
    rms = float(np.sqrt((fitted.deviation**2).mean()))
    lines += [f"Rows scatter by {100 * found.noise:.2g} %, estimated."] if found.noise == found.noise else []
    lines += [f"Rows deviate by {rms:.2g} times their spreads."] if found.noise != found.noise and rms > _WIDE else []
    lines += found.ties or ["The table tells all keys apart."]
    if len(held):
        inside = held.measured.between(held.low, held.high).sum()
        off = np.exp(np.log(held.measured / held.fitted).mean()) - 1
        lines.append(f"Held out: {inside} of {len(held)} values in their 95 % band, {100 * off:+.0f} % off on average.")
    return [*lines, *(f"Full run failed at {each}." for each in found.failures)]


def lines(found: Any) -> list[str]:
    """Return a calibration as lines of text."""
    out = remarks(found)
    for title, heads, rows in tables(found):
        out += ["", title, *notebook.side_by_side([heads, *rows])]
    return out


def _chart(rows: "pd.DataFrame", quantity: str) -> Any:
    """Return the chart of a quantity over the force: measured points, and a fitted line for each voltage."""
    scale, series = Output("", _UNITS.get(quantity, "")).scale, []
    for k, (voltage, mine) in enumerate(rows.groupby(rows.voltage.fillna(-1.0))):
        name, look = f"{voltage:g} V" if voltage >= 0 else "", (COLOURS[k % len(COLOURS)], DASHES[k % len(DASHES)])
        line = np.exp(np.log(mine.fitted).groupby(mine.force).mean())
        series.append(Series(f"{name} fitted".strip(), line.index.to_numpy(), scale * line.to_numpy(), "line", *look))
        for words, each in (("measured", mine[~mine.held_out]), ("held out", mine[mine.held_out])):
            if len(each):
                y, error = (scale * each[c].to_numpy() for c in ("measured", "error"))
                labels = [f"line {line}" for line in each.line]
                series.append(Series(f"{name} {words}".strip(), each.force.to_numpy(), y, "points", look[0], "",
                                     error if words == "measured" else (), labels))  # fmt: skip
    title = f"{quantity} ({_UNITS[quantity]})" if quantity in _UNITS else quantity
    return chart([Panel(title, series, 220.0, zero=True)], "force (N)", f"{title} over the force")


def write(found: Any, folder: Path) -> None:
    """Write ``scene.toml``, ``rows.csv`` and ``report.html`` of a calibration into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    scene = "\n".join(html.scene_file(found.scene.parameters()))
    replace(folder / "scene.toml", f"{scene}\n")
    replace(folder / "rows.csv", found.rows.to_csv(index=False))
    rows = found.rows.assign(error=found.rows.measured * found.rows.spread.fillna(found.noise))
    values = ", ".join(f"{key} = {v.value:.3g}" for key, v in found.values.iterrows())
    body = html.page(
        "calibration.html", f"fingerpad: calibration, {folder.resolve().name}", name=folder.resolve().name,
        sentence=f"The table gives {values}.", remarks=remarks(found), tables=list(tables(found)), scene=scene,
        charts=[_chart(each, str(quantity)) for quantity, each in rows.groupby("quantity")], version=version(),
    )  # fmt: skip
    replace(folder / "report.html", body)
