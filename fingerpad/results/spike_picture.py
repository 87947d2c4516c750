"""Raster of spikes: a panel a class, a row a unit, ridges in their order, and the loads above."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fingerpad.results import style

if TYPE_CHECKING:
    from fingerpad.results.spikes import Spikes

COLOURS = (style.BLUE, style.VERMILION, style.BLACK, style.GREEN, style.PURPLE)
_HIGH, _ROW, _LEAST = 1.3, 0.09, 0.6  # in: of all but the panels; of a unit; of a panel at the least
_TICKS = 0.35  # in, of a panel, between the numbers of two ridges


def raster(spikes: "Spikes", path: Path | None) -> Figure:
    """Draw the spikes of a run; write the picture where a path is given."""
    rows = {law: len(spikes.of(law)) for law in spikes.laws}
    few = max(rows.values(), default=1) / 2  # of ridges with two sites
    heights = [_LEAST if count == 1 else _LEAST + _ROW * max(count, few) for count in rows.values()]
    with style.look():
        figure = style.figure(_HIGH + sum(heights))
        panels = figure.subplots(len(heights), 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
        for k, (ax, law) in enumerate(zip(panels, spikes.laws, strict=True)):
            paint(ax, spikes, law, COLOURS[k % len(COLOURS)], int(heights[k] / _TICKS))
            for span in spikes.loads:
                ax.axvline(1e3 * span.begin, color=style.GREY, lw=0.8, ls=":")
        _names(panels[0], spikes)
        panels[-1].set_xlabel("time (ms)")
        panels[-1].set_xlim(0, 1e3 * spikes.seconds)
        figure.suptitle("Spikes of afferents below the ridges that can touch; thresholds are relative")
        return style.save(figure, path)


def paint(ax: Axes, spikes: "Spikes", law: str, colour: str, ticks: int) -> None:
    """Draw the spikes of a class into axes with at most so many numbers of ridges."""
    units = [unit for unit in spikes.units if unit.law == law]
    trains = [1e3 * train for train in spikes.of(law)]
    if units[0].ridge is None:
        ax.eventplot(trains, colors=colour, lineoffsets=[0], linelengths=0.8, linewidths=0.9)
        ax.set_yticks([])
        ax.set_ylabel(f"{law}\n", color=colour)
    else:
        beside = {"": 0.0, "left": -0.25, "right": 0.25}
        place = [unit.ridge + beside[unit.side] for unit in units if unit.ridge is not None]
        length = 0.8 if not units[0].side else 0.4
        ax.eventplot(trains, colors=colour, lineoffsets=place, linelengths=length, linewidths=0.9)
        ax.set_ylim(min(place) - 0.7, max(place) + 0.7)
        ax.set_ylabel(f"{law}\nridge", color=colour)
        step = max(1, int(np.ceil(np.ptp(place) / max(ticks, 1))))
        ax.set_yticks([k for k in range(int(min(place)), int(max(place)) + 1) if k % step == 0])
    ax.spines[["top", "right"]].set_visible(False)


def _names(ax: Axes, spikes: "Spikes") -> None:
    """Write the names of the loads above the first panel."""
    for span in spikes.loads:
        if span.end - span.begin > 0.06 * spikes.seconds:
            middle = 500 * (span.begin + span.end)
            ax.text(middle, 1.0, span.name, transform=ax.get_xaxis_transform(), ha="center", va="bottom", fontsize=9)
