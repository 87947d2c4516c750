"""Measured fingers beside this model's numbers, row by row.

environment/run python3 -m benchmarks.measured [--jobs 2] [--draw]

Most numbers are those of docs/paper.json, docs/models.json and docs/viscosity.json (make paper, benchmarks.models, make
viscosity), to be made again after them. Ten presses are run here, some ten seconds each, and one that is held for 20 s.
Writes docs/measured.json, and from it docs/measured.md and its picture. A finding of the kind ``simulated`` was
computed by its source and does not count.
"""

import argparse
import csv
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks.harness import cells, keep, kept, made, main, page, picture, run
from benchmarks.measured import drives, fingers, keys, rows, rules
from benchmarks.measured.rules import BUILT, HIT
from benchmarks.runs import VOLTAGES, Run
from fingerpad.results.pictures import style
from fingerpad.scene import Scene

_LEFT_OUT = (
    "time", "relaxation", "speed", "real_sliding", "adhesion", "gap_sliding",
    "friction_acrylic", "friction_power", "friction_occluded",
)  # fmt: skip
"""Rows of what the default finger leaves out."""
_LIMIT = 600.0  # s of processor time for one run


def pressed(scene: Scene, out: Path) -> dict[str, Any]:
    """Return what the page has of a pressed finger: its contact length (m), touching ridges and their pressures (Pa).

    Places (m) and pressures are of each touching ridge; a pressure is the contact force over the ridge's wavelength.
    """
    found, wavelength = Run(scene, out), scene.geometry.ridge_wavelength
    touching = found.final("uncharged", "ridges")
    ridges, force = touching["ridge"], touching["f_contact"]
    length = float(found.summary["uncharged_contact_length"])
    along = {"place": (ridges * wavelength).tolist(), "pressure": (force / wavelength).tolist()}
    return {"length": length, "ridges": len(ridges)} | along


def numbers(runs: dict[str, Any], held: Mapping[str, list[float]], docs: Path) -> dict[str, Any]:
    """Return the numbers of the page from runs of :func:`pressed`, a held finger and the kept ones of other pages."""
    grid = rows.grid(kept("paper", docs).numbers, kept("models", docs).numbers)
    # Where no scene has a key for a finding, the verdict is in the table of texts.
    typed: dict[str, rows.Row] = {text["key"]: ({}, text["verdict"]) for text in _read("rows") if text["verdict"]}
    of_time = keys.of_time(kept("viscosity", docs).numbers, held)
    every = {"rows": rows.numbers(grid, runs) | drives.numbers() | of_time | typed, "others": keys.others(runs)}
    judged = {
        name: {
            key: {"numbers": {each: float(value) for each, value in found.items()}, "verdict": verdict}
            for key, (found, verdict) in table.items()
        }
        for name, table in every.items()
    }
    return {"runs": runs, "held": held, "curves": rows.curves(grid)} | judged


def compute(args: argparse.Namespace) -> None:
    """Run what is missing and keep the numbers."""
    wanted = fingers.scenes()
    summaries = run(wanted | {"held": keys.scene()}, args, _LIMIT)
    runs = {name: pressed(scene, args.out) for name, scene in wanted.items()}
    keep("measured", numbers(runs, keys.held(args.out), args.docs), made(summaries.values()), args.docs)


# -- page ------------------------------------------------------------------------------------------------------
class Row(NamedTuple):
    """A measured finding with its verdict, and its row on the page."""

    key: str
    kind: str
    numbers: Mapping[str, float]
    verdict: str
    line: str


def judged(docs: Path) -> list[Row]:
    """Return the rows of the page from the kept numbers of a folder."""
    found, judged = kept("measured", docs).numbers["rows"], []
    sources = {source["key"]: f"[{k}]({source['link']})" for k, source in enumerate(_read("sources"), start=1)}
    for text in _read("rows"):
        numbers, verdict = found[text["key"]].values()
        verdict = BUILT if text["built"] and verdict == HIT else verdict
        because = f": {text['why']}" if verdict != HIT and text["why"] else ""
        ours = text["ours"].format(**numbers).replace("%", " %")
        measured, fitted = f"{text['measured']} {sources[text['source']]}", _number(text["fitted"])
        line = cells(measured, ours, fitted, f"**{verdict}**{because}")
        judged.append(Row(text["key"], text["kind"], numbers, verdict, line))
    return judged


def with_keys(docs: Path) -> list[Row]:
    """Return the findings that are computed with other keys too, in the order of ``others.csv``."""
    found, first = kept("measured", docs).numbers["others"], {text["key"]: text for text in _read("rows")}
    made_of = []
    for text in _read("others"):
        numbers, verdict = found[text["key"]].values()
        verdict = BUILT if text["built"] and verdict == HIT else verdict
        ours = text["ours"].format(**numbers).replace("%", " %")
        line = cells(first[text["key"]]["measured"], text["keys"], ours, _number(text["fitted"]), f"**{verdict}**")
        made_of.append(Row(text["key"], "other", numbers, verdict, line))
    return made_of


def _number(fitted: str) -> str:
    """Return how many parameters are fitted, without which ones."""
    return fitted.partition(" (")[0]


def _read(name: str) -> list[dict[str, str]]:
    with (Path(__file__).parent / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def draw(docs: Path) -> Path:
    """Write docs/measured.md and its picture from docs/measured.json."""
    picture(docs / "measured.png", (11, 4), lambda figure: _paint(figure, kept("measured", docs).numbers))
    every = judged(docs)
    names: dict[str, Any] = {"judged": every, "others": with_keys(docs), "sources": _read("sources")}
    names |= {"left_out": sum(row.verdict == rules.MISS for row in every if row.key in _LEFT_OUT)}
    names |= {"found": [row.verdict for row in every if row.kind != "simulated"]}
    return page(docs, "measured", "make measured", globals() | names)


# -- picture -------------------------------------------------------------------------------------------------
def _paint(figure: Figure, numbers: Mapping[str, Any]) -> None:
    figure.suptitle("Shapes, not values: this model beside the form of measured curves, scaled to it")
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
    ax.loglog(u, (u / 100) ** 2, color="black", ls="--", zorder=0, label="U², measured shape")
    ax.set(xlabel="voltage (V)", ylabel="rise over 0 V / rise at 100 V (–)", title="A  full slip")
    ax.set_xticks(u, [f"{each:g}" for each in u])
    ax.minorticks_off()
    ax.legend(fontsize=8)


def _over_depth(ax: Axes, depth: rows.Array, force: rows.Array) -> None:
    ax.plot(1e3 * depth, force, "o", color=style.BLUE, label="this model, 0 V")
    exponent = rules.of_largest(rules.power, depth, force).parameter
    _fitted(ax, rules.exponential, (depth, force), 1.0, ("--", "black", "exponential, measured shape"))
    _fitted(ax, rules.power, (depth, force), 1.0, (":", style.VERMILION, f"power law, {exponent:.2f}"))
    ax.set(xlabel="depth (mm)", ylabel="force of the whole finger (N)", title="B  pressed, 0 V")
    ax.legend(fontsize=8)


def _over_width(ax: Axes, run: Mapping[str, Any]) -> None:
    points = np.array(run["place"]), np.array(run["pressure"])
    ax.plot(1e3 * points[0], points[1] / 1e3, "o", color=style.BLUE, label="ridges of this model")
    _fitted(ax, rules.paraboloid, points, 1e-3, ("--", "black", "paraboloid, measured shape"))
    _fitted(ax, rules.ellipse, points, 1e-3, (":", style.VERMILION, "half an ellipse"))
    ax.set(xlabel="x (mm)", ylabel="force over area of a ridge (kPa)", title="C  75 N/m, 0 V")
    ax.set_ylim(0, 1.55e-3 * points[1].max())
    ax.legend(fontsize=8, loc="upper center")


def _fitted(
    ax: Axes, form: rules.Form, points: tuple[rows.Array, rows.Array], unit: float, look: tuple[str, str, str]
) -> None:
    """Draw a form that is fitted by the largest value; ``look`` is line, colour and label."""
    x, y = points
    parameter = rules.of_largest(form, x, y).parameter
    fine, factor = np.linspace(x.min(), x.max(), 201), rules.scale(form(x, parameter), y)
    ax.plot(1e3 * fine, unit * factor * form(fine, parameter), look[0], color=look[1], label=look[2])


if __name__ == "__main__":
    sys.exit(main(__doc__, compute, draw))
