"""The page: measured fingers beside this model, with a verdict each, and a picture."""

import csv
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks.harness import kept, page, picture, prose, table
from benchmarks.measured import forms, rows, scenes
from benchmarks.measured.verdict import BUILT, HIT, MISS, PART
from benchmarks.runs import VOLTAGES
from fingerpad.results import style

_HERE = Path(__file__).parent
_KINDS = {"shape": "Shapes, exponents and trends", "ratio": "Ratios", "value": "Absolute values"}
_SIMULATED = "simulated"
"""Kind of a finding that the source computed: it is no measurement, and does not count."""
_HEAD = ("measured", "by whom, on how many people, read in", "this model", "fitted parameters", "verdict")


class Row(NamedTuple):
    """A measured finding, our number, and the verdict."""

    key: str
    kind: str
    measured: str
    source: Mapping[str, str]
    ours: str
    numbers: Mapping[str, float]
    fitted: str
    verdict: str
    why: str


def judged(docs: Path) -> list[Row]:
    """Return the rows of the page from the kept numbers of a folder."""
    found = dict(kept("measured", docs).numbers["rows"])
    sources = {source.pop("key"): source for source in _read("sources")}
    judged = []
    for text in _read("rows"):
        numbers, verdict = (found[text["key"]][part] for part in ("numbers", "verdict"))
        if text["built"] and verdict == HIT:
            verdict = BUILT
        because = text["why"] if verdict != HIT else ""
        words = (
            text["key"],
            text["kind"],
            text["measured"],
            sources[text["source"]],
            text["ours"].format(**numbers).replace("%", " %"),
        )
        judged.append(Row(*words, numbers, text["fitted"], verdict, because))
    return judged


def _read(name: str) -> list[dict[str, str]]:
    with (_HERE / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def _table(judged: list[Row]) -> str:
    lines = []
    for row in judged:
        by = f"[{row.source['words']}]({row.source['link']}); people: {row.source['people']}; {row.source['read']}"
        because = f": {row.why}" if row.why else ""
        lines.append([row.measured, by, row.ours, row.fitted, f"**{row.verdict}**{because}"])
    return table(_HEAD, lines)


def draw(docs: Path) -> Path:
    """Write docs/measured.md and its picture from docs/measured.json."""
    text, every = prose("measured"), judged(docs)
    found = [row for row in every if row.kind != _SIMULATED]
    count = Counter(row.verdict for row in found)
    words = {"n": len(found), "hit": count[HIT], "part": count[PART], "miss": count[MISS], "built": count[BUILT]}
    own = kept("measured", docs)
    path, caption = docs / "measured.png", " ".join(text["caption"].split())
    body = [picture(path, (10, 3.6), lambda figure: _paint(figure, own.numbers), caption)]
    body += [f"## {head}\n\n{_table([row for row in found if row.kind == kind])}" for kind, head in _KINDS.items()]
    simulated = _table([row for row in every if row.kind == _SIMULATED])
    body += [f"{text['simulated']}\n\n{simulated}", text["meaning"], text["missing"], text["tables"]]
    least, most = scenes.SOFTER
    how = text["how"].format(least=least, most=most)
    title, finding = "Beside measured fingers", text["finding"].format(**words)
    return page(docs / "measured.md", title, finding, how, body, "make measured", own.made, ["measured"])


# -- picture -------------------------------------------------------------------------------------------------
def _paint(figure: Figure, numbers: Mapping[str, Any]) -> None:
    voltage, force, pressure = figure.subplots(1, 3)
    _over_voltage(voltage, numbers["curves"])
    _over_depth(force, *(np.array(numbers["curves"][name]) for name in ("depth", "force")))
    _over_width(pressure, numbers["runs"]["dry 20"])


def _over_voltage(ax: Axes, curves: Mapping[str, list[float]]) -> None:
    u, words = np.array(VOLTAGES[1:]), dict(zip(rows.DRAWN, ("friction", "contact length"), strict=True))
    for k, (force, name) in enumerate((f, name) for f in rows.DRAWN_FORCES for name in rows.DRAWN):
        values = np.array(curves[f"{name} {force:g}"])
        rise = (values[1:] - values[0]) / (values[VOLTAGES.index(100.0)] - values[0])
        look = {"color": style.CATEGORIES[k], "marker": style.MARKERS[k], "ms": 5}
        ax.loglog(u, rise, **look, label=f"{words[name]}, {force:g} N/m")
    ax.loglog(u, (u / 100) ** 2, color="black", ls="--", zorder=0, label="U², measured")
    ax.set(xlabel="voltage (V)", ylabel="rise over 0 V / rise at 100 V (–)", title="A  full slip")
    ax.set_xticks(u, [f"{each:g}" for each in u])
    ax.minorticks_off()
    ax.legend(fontsize=8)


def _over_depth(ax: Axes, depth: rows.Array, force: rows.Array) -> None:
    ax.plot(1e3 * depth, force, "o", color=style.BLUE, label="this model, 0 V")
    exponent = forms.of_largest(forms.power, depth, force).parameter
    _fitted(ax, forms.exponential, (depth, force), 1.0, ("--", "black", "exponential, measured"))
    _fitted(ax, forms.power, (depth, force), 1.0, (":", style.VERMILION, f"power law, {exponent:.2f}"))
    ax.set(xlabel="depth (mm)", ylabel="force of the whole finger (N)", title="B  pressed")
    ax.legend(fontsize=8)


def _over_width(ax: Axes, run: Mapping[str, Any]) -> None:
    points = np.array(run["place"]), np.array(run["pressure"])
    ax.plot(1e3 * points[0], points[1] / 1e3, "o", color=style.BLUE, label="ridges of this model")
    _fitted(ax, forms.paraboloid, points, 1e-3, ("--", "black", "paraboloid, measured"))
    _fitted(ax, forms.ellipse, points, 1e-3, (":", style.VERMILION, "half an ellipse"))
    ax.set(xlabel="x (mm)", ylabel="force over area of a ridge (kPa)", title="C  75 N/m, 0 V")
    ax.set_ylim(0, 1.55e-3 * points[1].max())
    ax.legend(fontsize=8, loc="upper center")


def _fitted(
    ax: Axes, form: forms.Form, points: tuple[rows.Array, rows.Array], unit: float, look: tuple[str, str, str]
) -> None:
    """Draw a form that is fitted by the largest value; ``look`` is line, colour and label."""
    x, y = points
    parameter = forms.of_largest(form, x, y).parameter
    fine, factor = np.linspace(x.min(), x.max(), 201), forms.scale(form(x, parameter), y)
    ax.plot(1e3 * fine, unit * factor * form(fine, parameter), look[0], color=look[1], label=look[2])
