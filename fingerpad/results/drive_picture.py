"""Picture of a drive: voltage, attraction and friction over a period, and the spectrum of friction."""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fingerpad.results import style

Array = NDArray[Any]
_LEAST = 1e-3  # of the largest amplitude, from which components are drawn
_MOST = 60  # components


class Period(NamedTuple):
    """What is drawn of a drive, arrays over one period of shape (samples,), and of a spectrum (components,)."""

    time: Array
    """(s)."""
    voltage: Array
    """(V)."""
    sigma_el: Array
    """(Pa)."""
    f_t: Array
    """Friction force, in its unit."""
    unit: str
    frequency: Array
    """(Hz)."""
    amplitude: Array
    """Of the friction force, in its unit."""


def over_period(found: Period, title: str, path: Path | None) -> Figure:
    """Draw a drive over a period; write it as a file where a path is given."""
    with style.look():
        figure = style.figure(6.0)
        grid = figure.add_gridspec(3, 2, width_ratios=(3, 2))
        panels = [figure.add_subplot(grid[k, 0]) for k in range(3)]
        parts = (
            (found.voltage, "U (V)", style.BLACK),
            (found.sigma_el / 1e3, r"$\sigma_{el}$ (kPa)", style.ATTRACTION),
            (found.f_t, f"{_symbol(found)} ({found.unit})", style.VERMILION),
        )
        for ax, (values, label, colour) in zip(panels, parts, strict=True):
            ax.plot(1e3 * found.time, values, color=colour)
            ax.set_ylabel(label)
            ax.grid(alpha=0.3)
        panels[-1].axhline(
            found.f_t.mean(), color=style.GREY, ls="--", label=f"mean {found.f_t.mean():.4g} {found.unit}"
        )
        panels[-1].legend(frameon=True)
        panels[-1].set_xlabel("time (ms)")
        _spectrum(figure.add_subplot(grid[:, 1]), found)
        figure.suptitle(style.plain(title))
        return style.save(figure, path)


def _symbol(found: Period) -> str:
    """Return the symbol of the friction force: of the whole finger in N, and of a section in N/m."""
    return "$F_T$" if found.unit == "N" else "$f_T$"


def _spectrum(ax: Axes, found: Period) -> None:
    shown = np.flatnonzero(found.amplitude > _LEAST * found.amplitude.max(initial=0.0))[:_MOST]
    ax.vlines(found.frequency[shown], 0, found.amplitude[shown], color=style.VERMILION)
    ax.plot(found.frequency[shown], found.amplitude[shown], "o", color=style.VERMILION, ms=4)
    ax.set(xlabel="frequency (Hz)", ylabel=f"amplitude of {_symbol(found)} ({found.unit})")
    ax.set_xlim(left=0)
    ax.set_ylim(bottom=0)
    ax.grid(alpha=0.3)
