"""The pictures of the README: finger, one ridge with gap and attraction, friction force; and the moving run.

Finger and ridge are those of a default run, at whose middle 75 N/m press. Friction forces are of the whole finger, sums
of slices over the traces of docs/models.json, under the force of the README and under two others. The README has the
headline of the run under that force.

environment/run python3 -m benchmarks.hero PATH FORCE    keep the numbers of the folders of two default runs, then draw:
                                                         fingerpad run, and fingerpad run --force "0.5 N" (make demo)
environment/run python3 -m benchmarks.pages hero         draw from docs/hero.json, without a run
"""

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import ConnectionPatch, Polygon
from numpy.typing import NDArray

from benchmarks import newtons
from benchmarks.harness import DOCS, keep, kept, made, picture
from fingerpad.results import fields
from fingerpad.results.pictures import style
from fingerpad.results.pictures.finger import LAYER_COLOURS
from fingerpad.results.result import Result
from fingerpad.scene.parameters import Slices
from fingerpad.slices.total import at_force
from geometry import tags
from variational.snapshot import loops

Array = NDArray[np.float64]
FORCES = (0.2, 0.75)  # N, of the curves of friction beside that of the run
RIDGE = 8  # the enlarged one
_MM, _UM, _KPA = 1e3, 1e6, 1e-3
_FINE = 0.02  # mm, between the points of a drawn outline


def main(folder: str, newtons_folder: str) -> None:
    """Keep the numbers of two default runs with those of docs/models.json, and draw."""
    summary = json.loads((Path(newtons_folder) / "summary.json").read_text(encoding="utf-8"))
    result = Result.load(folder)
    view = fields.views_of(Path(folder), result.steps, result.named)[1]["full_slip"]
    body: Any = view.snapshot
    xy, outlines = _MM * (body.x + body.u), []
    for tag in tags.LAYERS.values():
        for loop in loops(body.lines, body.beside, body.tag, tag):
            points = xy[loop[:, :2]].reshape(-1, 2)  # the begin and the middle of each line
            outlines.append({"layer": int(tag), "points": _rows(_thinned(points))})
    skin: Any = view.skin
    ridge = {name: skin[name][skin["ridge"] == RIDGE] for name in ("x", "y", "p", "p_el", "d_eq")}
    scenes, force = kept("models").numbers["scenes"], round(summary["full_slip_finger_f_ext"], 4)
    friction = {f"{each:g}": _forces(scenes, each) for each in (FORCES[0], force, FORCES[1])}
    along = {name: _rows([float(f"{v:.6g}") for v in values]) for name, values in ridge.items()}
    default = {name: summary[name] for name in ("full_slip_mu_app", "full_slip_mu_app_error", "headline")}
    default |= {"force": f"{force:g}"}
    numbers = {"default": default, "finger": outlines, "ridge": along, "friction": friction}
    keep("hero", numbers, made([summary]))
    draw(DOCS)
    Result.load(folder).animate(DOCS / "animation.webp")


def _forces(scenes: Mapping[str, Any], force: float) -> list[list[float]]:
    """Return voltages (V) and friction forces at full slip (N) under an external force (N) on the whole finger."""
    traces = {voltage: newtons.kept(scenes, "full", voltage) for voltage in newtons.VOLTAGES}
    finger, count = newtons.finger(), Slices().count
    return [[voltage, at_force(finger, each, force, count).totals["f_t"]] for voltage, each in traces.items()]


def _rows(values: list[Any]) -> list[list[Any]]:
    return [values[k : k + 20] for k in range(0, len(values), 20)]  # each a line of the file


def _thinned(points: Array) -> list[list[float]]:
    """Return the points of an outline (mm) that are not too close to the one before."""
    last, thinned = np.full(2, np.inf), []
    for point in points:
        if not np.hypot(*(point - last)) <= _FINE:
            last = point
            thinned.append([round(float(c), 3) for c in point])
    return thinned


# -- page ----------------------------------------------------------------------------------------------------
def draw(docs: Path) -> Path:
    """Draw docs/hero.png from docs/hero.json; return its path."""
    numbers = kept("hero", docs).numbers
    ridge = {name: np.concatenate(values) for name, values in numbers["ridge"].items()}
    centre = float(ridge["x"][ridge["p"] > 0].mean())

    def paint(figure: Figure) -> None:
        whole, near, friction = figure.subplots(1, 3, width_ratios=[1.55, 1, 1.05])
        _draw_finger(whole, numbers["finger"], float(numbers["default"]["force"]))
        _draw_ridge(near, ridge, centre)
        _draw_friction(friction, numbers["friction"], numbers["default"]["force"])
        whole.plot(_MM * centre, 0.1, "o", ms=13, mfc="none", mec="black", mew=1.5, zorder=5)
        look: dict[str, Any] = {"axesA": whole, "axesB": near, "color": "0.4", "ls": "--"}
        for corner in (0, 1):
            figure.add_artist(ConnectionPatch((_MM * centre, 0.1), (0, corner), "data", "axes fraction", **look))

    picture(docs / "hero.png", (style.WIDTH, 3.5), paint)
    return docs / "hero.png"


def _draw_finger(ax: Axes, outlines: list[dict[str, Any]], force: float) -> None:
    ax.set_title("A fingertip slides on a touchscreen", weight="bold")
    for outline in outlines:
        ax.add_patch(Polygon(np.concatenate(outline["points"]), fc=LAYER_COLOURS[outline["layer"]], ec="black", lw=0.4))
    ax.axhspan(-1.6, 0, color="0.35", lw=0)
    ax.text(-3.6, -0.85, "touchscreen", color="white", ha="center", va="center", fontsize=9)
    ax.text(1.5, 7.5, "bone", ha="center", va="center")
    for start, end, colour in (((12, 2.8), (16.6, 2.8), style.VERMILION), ((1.5, 17.3), (1.5, 13.4), style.BLACK)):
        ax.annotate("", end, start, arrowprops={"arrowstyle": "-|>", "lw": 3.5, "color": colour})
    ax.text(14.2, 3.6, "sliding", ha="center", color=style.VERMILION)
    ax.text(2.4, 15.6, f"{force:.2g} N", va="center")
    ax.set(xlim=(-9.5, 17), ylim=(-1.6, 17.5), aspect="equal", xlabel="x (mm)", ylabel="height (mm)")


def _draw_ridge(ax: Axes, ridge: dict[str, Array], centre: float) -> None:
    x, gap, pull = _UM * (ridge["x"] - centre), _UM * np.maximum(ridge["y"], ridge["d_eq"]), _KPA * ridge["p_el"]
    ax.set_title("Voltage attracts a ridge", weight="bold")
    ax.fill_between(x, gap, 20, color=LAYER_COLOURS[tags.STRATUM_CORNEUM], alpha=0.45, lw=0)
    ax.plot(x, gap, color="black", lw=1)
    ax.axhspan(-2.5, 0, color="0.35", lw=0)
    ax.text(0, -1.3, "touchscreen, 200 V", color="white", ha="center", va="center", fontsize=9)
    for place in np.arange(-60.0, 61.0, 12.0).tolist():
        at = float(np.interp(place, x, gap))
        arrow = {"arrowstyle": "-|>", "lw": 1.8, "color": style.ATTRACTION, "shrinkA": 0, "shrinkB": 0}
        ax.annotate("", (place, at), (place, at + 0.1 * float(np.interp(place, x, pull))), arrowprops=arrow)
    ax.text(0, 6.4, f"attraction\n{pull.max():.0f} kPa", ha="center", color=style.ATTRACTION)
    ax.text(0, 9.9, "skin", ha="center")
    ax.text(0, 0.75, f"air gap {_UM * np.median(ridge['d_eq']):.1f} µm", ha="center", va="center")
    ax.set(xlim=(-100, 100), ylim=(-2.5, 11.5), xlabel="x (µm)", ylabel="height (µm)")


def _draw_friction(ax: Axes, friction: dict[str, list[list[float]]], own: str) -> None:
    ax.set_title("Friction doubles", weight="bold")
    for force, points in friction.items():
        u, f_t = np.array(points).T
        shown = force == own
        ax.plot(u, f_t, color="black" if shown else "0.65", lw=2 if shown else 1.2, zorder=2)
        if shown:
            ax.text(215, f_t[-1], f"{f_t[-1]:.2f} N at\n{float(force):.2g} N", va="center", weight="bold", fontsize=9)
            ax.scatter(u, f_t, c=[style.voltage(each) for each in u], s=42, zorder=3)
            ax.text(0, f_t[0] - 0.035, f"{f_t[0]:.2f} N", weight="bold", fontsize=9)
        else:
            ax.text(215, f_t[-1], f"at {force} N", va="center", color="0.4", fontsize=9)
    ax.set(xlim=(-10, 345), ylim=(0, 0.47), xlabel="voltage (V)", ylabel="friction force of the whole finger (N)")
    ax.set_xticks([0, 100, 200])


if __name__ == "__main__":
    main(*sys.argv[1:])
