"""One picture a chart: what became of each run and, beside it, penetration and errors. Okabe and Ito's colours."""

from collections.abc import Callable
from pathlib import Path

import matplotlib
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, Normalize, to_hex, to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from benchmarks.stability import results
from benchmarks.stability.cache import Cache
from benchmarks.stability.case import Case, Status
from benchmarks.stability.plan import DEFAULT, Axis, Chart, Panel

COLOURS: dict[Status, str] = {"converged": "#56B4E9", "continuation": "#E69F00", "failed": "#D55E00"}
SYMBOLS: dict[Status, str] = {"converged": "●", "continuation": "▲", "failed": "✕"}
NAMES: dict[Status, str] = {"converged": "converged", "continuation": "through continuation", "failed": "failed"}
_STYLE = {"font.size": 10, "axes.titlesize": 10, "figure.titlesize": 13, "axes.grid": False}
Value = Callable[[Case, Cache], float | None]


def _cell(ax: Axes, k: int, i: int, colour: str, text: str, default: bool) -> None:
    ax.add_patch(Rectangle((k, i), 1, 1, facecolor=colour, edgecolor="white", lw=1.5))
    if default:
        ax.add_patch(Rectangle((k + 0.06, i + 0.06), 0.88, 0.88, fill=False, ec="black", lw=1.8, zorder=3))
    red, green, blue = to_rgb(colour)
    ink = "black" if 0.3 * red + 0.59 * green + 0.11 * blue > 0.45 else "white"
    ax.text(k + 0.5, i + 0.5, text, ha="center", va="center", color=ink, fontsize=8, linespacing=1.1)


def _frame(ax: Axes, panel: Panel, title: str) -> None:
    ax.set_title(title)
    ax.set_xlim(0, len(panel.x.values))
    ax.set_ylim(0, len(panel.y.values))
    for axis, which, label in ((panel.x, ax.xaxis, ax.set_xlabel), (panel.y, ax.yaxis, ax.set_ylabel)):
        which.set_ticks([k + 0.5 for k in range(len(axis.values))], [tick(axis, v) for v in axis.values])
        which.set_tick_params(length=0)
        label(axis.label)
    for spine in ax.spines.values():
        spine.set_visible(False)


def tick(axis: Axis, value: float) -> str:
    """Return a value in its axis's unit, short."""
    return f"{value / axis.unit:.6g}".replace("e+", "e")


def _is_default(case: Case, panel: Panel) -> bool:
    """Return whether both axes are at the base's values: the default of its formulation and element."""
    return case == panel.base and panel.base.element == DEFAULT.element


def _outcomes(ax: Axes, panel: Panel, cache: Cache) -> None:
    for i, y in enumerate(panel.y.values):
        for k, x in enumerate(panel.x.values):
            case = panel.case(x, y)
            outcome = cache.get(case)
            if outcome is None:
                _cell(ax, k, i, "#EEEEEE", "not run", False)
                continue
            text = f"{SYMBOLS[outcome.status]}\n{outcome.newton}"
            if outcome.status == "failed":
                text += f"\n{outcome.load}"
            _cell(ax, k, i, COLOURS[outcome.status], text, _is_default(case, panel))
    _frame(ax, panel, f"{panel.title}: outcome, Newton iterations")


def _values(ax: Axes, panel: Panel, cache: Cache, value: Value, norm: Normalize, words: str, scale: float) -> None:
    colours = matplotlib.colormaps["viridis"]
    for i, y in enumerate(panel.y.values):
        for k, x in enumerate(panel.x.values):
            case = panel.case(x, y)
            number, outcome = value(case, cache), cache.get(case)
            if number is None:
                failed = outcome is not None and outcome.status == "failed"
                _cell(ax, k, i, "#EEEEEE", SYMBOLS["failed"] if failed else "–", False)
                continue
            number *= scale
            colour = to_hex(colours(norm(max(abs(number), norm.vmin or 0.0))))
            _cell(ax, k, i, colour, _short(number), _is_default(case, panel))
    _frame(ax, panel, f"{panel.title}: {words}")


def _short(number: float) -> str:
    size = abs(number)
    if size >= 100:
        return f"{number:.0f}"
    return f"{number:.1f}" if size >= 1 else f"{number:.2g}" if size >= 1e-3 else f"{number:.0e}"


def draw(chart: Chart, cache: Cache, path: Path) -> Figure:
    """Draw a chart from what the cache holds.

    Args:
        chart: its panels are the rows.
        cache: outcomes; cells that have not been run say so.
        path: of the PNG file.
    """
    percent = LogNorm(0.01, 100, clip=True)
    maps: list[tuple[str, Value, Normalize, float]] = [
        ("penetration (nm)", results.penetration, LogNorm(0.1, 1e4, clip=True), 1e9),
        ("error in $f_T$ (%)", results.friction_error, percent, 100),
        ("error in contact length (%)", results.length_error, percent, 100),
    ]
    with matplotlib.rc_context(_STYLE):
        across = max(len(panel.x.values) for panel in chart.panels)
        heights = [len(panel.y.values) * 0.5 + 1.0 for panel in chart.panels]
        figure = Figure(figsize=(4 * (across * 0.56 + 1.0), sum(heights) + 0.8), layout="constrained")
        figure.suptitle(chart.title)
        rows = figure.subplots(len(chart.panels), 4, squeeze=False, gridspec_kw={"height_ratios": heights})
        for axes, panel in zip(rows, chart.panels, strict=True):
            _outcomes(axes[0], panel, cache)
            for ax, (words, value, norm, scale) in zip(axes[1:], maps, strict=True):
                _values(ax, panel, cache, value, norm, words, scale)
        keys = [Patch(color=COLOURS[s], label=f"{SYMBOLS[s]} {NAMES[s]}") for s in COLOURS]
        keys.append(Patch(fill=False, ec="black", lw=1.8, label="default"))
        figure.legend(handles=keys, loc="outside lower center", ncols=4, frameon=False)
        path.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(path, dpi=130)
    return figure
