"""Pictures of commands: panels side by side, curves with a colour, a dash and a marker each."""

from collections.abc import Iterator
from contextlib import chdir, contextmanager
from pathlib import Path
from typing import Any

with chdir("/"):  # a matplotlibrc of the current folder is not obeyed, see fingerpad.startup
    import matplotlib  # noqa: F401

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy import size
from numpy.typing import ArrayLike

from fingerpad.results import style

_DASHES = ("-", "--", "-.", ":", (0, (6, 1, 1, 1, 1, 1)), (0, (8, 3)), (0, (1, 3)))
_MAX_MARKERS = 15  # points up to which each has a marker


@contextmanager
def panels(file: Path, title: str, count: int = 1) -> Iterator[tuple[Figure, list[Axes]]]:
    """Give a figure and its panels side by side; write it at the end of the block."""
    with style.look():
        figure = style.figure(4.0, width=2.5 + 3.0 * count)
        figure.suptitle(title)
        yield figure, list(figure.subplots(1, count, squeeze=False)[0])
        style.save(figure, file)


def curve(ax: Axes, k: int, x: ArrayLike, y: ArrayLike, label: str, colour: Any = None) -> None:
    """Draw curve number k, with markers where its points are few; ``colour`` takes the place of the palette's."""
    marked = size(x) <= _MAX_MARKERS
    marker: dict[str, Any] = {"marker": style.MARKERS[k % len(style.MARKERS)], "ms": 5} if marked else {}
    colour = style.CATEGORIES[k % len(style.CATEGORIES)] if colour is None else colour
    ax.plot(x, y, color=colour, ls=_DASHES[k % len(_DASHES)], label=label, **marker)


def patch(colour: str, label: str) -> Patch:
    """Return an entry of a legend for an area."""
    return Patch(facecolor=colour, edgecolor="k", lw=0.5, label=label)
