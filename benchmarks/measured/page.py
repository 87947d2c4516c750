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
from benchmarks.measured import rows, scenes
from benchmarks.measured.verdict import BUILT, HIT, MISS, PART
from benchmarks.runs import VOLTAGES
from fingerpad.io import style

_HERE = Path(__file__).parent
_KINDS = {"shape": "Shapes, exponents and trends", "ratio": "Ratios", "value": "Absolute values"}
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
    text, found = prose("measured"), judged(docs)
    count = Counter(row.verdict for row in found)
    words = {"n": len(found), "hit": count[HIT], "part": count[PART], "miss": count[MISS], "built": count[BUILT]}
    own = kept("measured", docs)
    path, caption = docs / "measured.png", " ".join(text["caption"].split())
    body = [picture(path, (10, 3.6), lambda figure: _paint(figure, own.numbers), caption)]
    body += [f"## {head}\n\n{_table([row for row in found if row.kind == kind])}" for kind, head in _KINDS.items()]
    body += [text["meaning"], text["missing"], text["tables"]]
    how = text["how"].format(softer=scenes.SOFTER)
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
    b, _ = rows.exponential(depth, force)
    power, factor = np.polyfit(np.log(depth), np.log(force), 1)
    fine = np.linspace(depth.min(), depth.max(), 200)
    a = np.exp(np.mean(np.log(force) - np.log(np.expm1(b * depth))))
    ax.plot(1e3 * depth, force, "o", color=style.BLUE, label="this model, 0 V")
    ax.plot(1e3 * fine, a * np.expm1(b * fine), "--", color="black", label="exponential, measured")
    curve = np.exp(factor) * fine**power
    ax.plot(1e3 * fine, curve, ":", color=style.VERMILION, label=f"power law, {power:.2f}")
    ax.set(xlabel="depth (mm)", ylabel="force of the whole finger (N)", title="B  pressed")
    ax.legend(fontsize=8)


def _over_width(ax: Axes, run: Mapping[str, Any]) -> None:
    place, pressure = np.array(run["place"]), np.array(run["pressure"])
    top, a, r2 = rows.paraboloid(place, pressure)
    fine = np.linspace(-a, a, 200)
    ax.plot(1e3 * place, pressure / 1e3, "o", color=style.BLUE, label="ridges of this model")
    curve = top * (1 - (fine / a) ** 2) / 1e3
    ax.plot(1e3 * fine, curve, "--", color="black", label=f"paraboloid, measured; R² {r2:.2f}")
    ax.set(xlabel="x (mm)", ylabel="force over area of a ridge (kPa)", title="C  75 N/m, 0 V")
    ax.set_ylim(0, 1.45 * pressure.max() / 1e3)
    ax.legend(fontsize=8, loc="upper center")
