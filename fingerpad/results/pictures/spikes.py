"""Raster of spikes: a panel a class, a row a unit, ridges in their order; energy densities and the loads above."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fingerpad.results.pictures import style

COLOURS = (style.BLUE, style.VERMILION, style.BLACK, style.GREEN, style.PURPLE)
_HIGH, _ROW, _LEAST = 1.3, 0.09, 0.6  # in: of all but the panels; of a unit; of a panel at the least
_TICKS = 0.35  # in, of a panel, between the numbers of two ridges
_CURVES, _MARKED = 1.8, 4  # in, panel of energy densities; curves that are told apart
_NAMED = 0.06  # of the length of the run, from which a load has its name
Load = tuple[str, float, float]
"""Name, begin and end (ms)."""


class Panel(NamedTuple):
    """A class of afferents."""

    law: str
    places: list[float]
    """Of the units, in ridges."""
    trains: list[NDArray[Any]]
    """Times (ms) of each unit's spikes."""
    population: bool
    length: float
    """Of a spike, in ridges."""


class Curves(NamedTuple):
    """Strain energy densities at Merkel sites over time."""

    ridges: Sequence[int]
    time: NDArray[Any]
    """ms, shape (states,)."""
    values: NDArray[Any]
    """kPa, shape (ridges, states)."""


def raster(
    panels: Sequence[Panel], curves: Curves | None, loads: Sequence[Load], end: float, path: Path | None
) -> Figure:
    """Draw the spikes of a run; write the picture where a path is given.

    Args:
        panels: of the classes.
        curves: drawn above them; None for none.
        loads: of the run.
        end: of the run (ms).
        path: PNG file.
    """
    few = max(len(panel.places) for panel in panels) / 2  # of ridges with two sites
    heights = [_LEAST if each.population else _LEAST + _ROW * max(len(each.places), few) for each in panels]
    first = 0 if curves is None else 1
    heights = [_CURVES] * first + heights
    with style.look():
        figure = style.figure(_HIGH + sum(heights))
        drawn = figure.subplots(len(heights), 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
        if curves is not None:
            _paint_curves(drawn[0], curves)
        for k, (ax, panel) in enumerate(zip(drawn[first:], panels, strict=True)):
            paint(ax, panel, COLOURS[k % len(COLOURS)], max(int(heights[first + k] / _TICKS), 1))
        for ax in drawn:
            for _, begin, _ in loads:
                ax.axvline(begin, color=style.GREY, lw=0.8, ls=":")
        for name, begin, last in loads:
            if last - begin > _NAMED * end:
                where = {"transform": drawn[0].get_xaxis_transform(), "ha": "center", "va": "bottom", "fontsize": 9}
                drawn[0].text((begin + last) / 2, 1.0, style.plain(name), **where)
        drawn[-1].set_xlabel("time (ms)")
        drawn[-1].set_xlim(0, end)
        figure.suptitle("Spikes of afferents below the ridges that can touch; thresholds are relative")
        return style.save(figure, path)


def _paint_curves(ax: Axes, curves: Curves) -> None:
    """Draw all densities, those that change most in colours with the numbers of their ridges."""
    marked = np.sort(np.argsort(-np.ptp(curves.values, axis=1))[:_MARKED])
    for values in curves.values:
        ax.plot(curves.time, values, color=style.GREY, lw=0.7, alpha=0.6)
    for colour, k in zip(style.CATEGORIES, marked, strict=False):
        ax.plot(curves.time, curves.values[k], color=colour, label=f"ridge {curves.ridges[int(k)]}")
    ax.set_ylabel("SED at Merkel\nsites (kPa)")
    ax.set_ylim(bottom=0)
    ax.spines[["top", "right"]].set_visible(False)
    ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))


def paint(ax: Axes, panel: Panel, colour: str, ticks: int) -> None:
    """Draw the spikes of a class into axes with at most so many numbers of ridges."""
    ax.eventplot(panel.trains, colors=colour, lineoffsets=panel.places, linelengths=panel.length, linewidths=1.1)
    ax.set_ylabel(f"{panel.law}\n" + ("" if panel.population else "ridge"), color=colour)
    ax.spines[["top", "right"]].set_visible(False)
    low, high = min(panel.places), max(panel.places)
    ax.set_ylim(low - 0.7, high + 0.7)
    step = max(1, int(np.ceil((high - low) / ticks)))
    ax.set_yticks([] if panel.population else [k for k in range(int(low), int(high) + 1) if k % step == 0])
