"""Curves for people: colours that are told apart with any colour vision, and a style of line for each."""

import contextlib
from pathlib import Path
from typing import Any

with contextlib.chdir("/"):  # matplotlibrc of the current folder is not obeyed, see fingerpad.startup
    import matplotlib

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import ArrayLike

_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000")  # Okabe and Ito's
_LINES = ("-", "--", "-.", ":", (0, (6, 1, 1, 1, 1, 1)), (0, (8, 3)), (0, (1, 3)))
_MARKERS = "osD^vP*"


def figure(title: str, panels: int = 1) -> tuple[Figure, list[Axes]]:
    """Return a figure and its panels side by side."""
    matplotlib.rcParams.update({"font.size": 11, "axes.titlesize": 11, "legend.frameon": False})
    made = Figure(figsize=(1.2 + 5.2 * panels, 4.6), layout="constrained")
    made.suptitle(title, fontsize=12)
    return made, list(made.subplots(1, panels, squeeze=False)[0])


def curve(ax: Axes, k: int, x: ArrayLike, y: ArrayLike, label: str) -> None:
    """Draw curve number k, with markers where its points are few."""
    marker: dict[str, Any] = {"marker": _MARKERS[k % len(_MARKERS)], "ms": 4} if np.size(x) <= 15 else {}
    ax.plot(x, y, color=_COLOURS[k % len(_COLOURS)], ls=_LINES[k % len(_LINES)], lw=1.8, label=label, **marker)


def save(made: Figure, file: Path) -> None:
    """Write a picture, in the format that the name ends with."""
    made.savefig(file, dpi=150)


def patch(colour: str, label: str) -> Patch:
    """Return an entry of a legend for an area."""
    return Patch(facecolor=colour, edgecolor="k", lw=0.5, label=label)
