"""Picture of loads over time: voltage, friction and contact length, from the start of the first of them."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from fingerpad.io import style
from variational.state import ContactState

_MM, _MS = 1e3, 1e3
_SHORT = 1.0  # s, below which the axis is in ms


def over_time(path: Path | str | None, states: Sequence[ContactState], title: str) -> Figure:
    """Draw voltage, friction force and contact length over time.

    Args:
        path: of the PNG file; None for the figure alone.
        states: accepted states in order, with their times.
        title: what run it is, see :mod:`fingerpad.io.titles`.
    """
    time = np.array([state.time for state in states])
    short = time[-1] - time[0] < _SHORT
    t = (_MS if short else 1.0) * time
    rows = (
        ("voltage $U$ (V)", [state.voltage for state in states], style.VERMILION),
        ("friction force\n$f_T$ (N/m)", [state.f_t for state in states], style.BLACK),
        ("contact length\n$L_R$ (mm)", [_MM * state.contact_length for state in states], style.BLUE),
    )
    jumps = t[[state.record is not None and state.record.jump for state in states]]
    with style.look():
        figure = style.figure(7.5)
        figure.suptitle(title)
        axes = figure.subplots(3, 1, sharex=True)
        for ax, (label, values, colour) in zip(axes, rows, strict=True):
            ax.plot(t, values, "o-", ms=3, color=colour)
            ax.set_ylabel(label)
            for jump in jumps:
                ax.axvline(jump, color="0.4", lw=1, ls=":", zorder=0)
        words = "; dotted lines: part of the skin jumps" if len(jumps) else ""
        axes[-1].set_xlabel(f"time ({'ms' if short else 's'}){words}")
        return style.save(figure, path)
