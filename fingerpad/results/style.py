"""How every picture looks: one palette, one set of fonts and sizes, told apart with any colour vision, and titles.

Categories have Okabe and Ito's colours, magnitudes viridis, voltages a ramp of their own. Importing changes nothing.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.ticker import MaxNLocator
from PIL import Image

from fingerpad.results.files import replace
from fingerpad.results.palette import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION, YELLOW  # noqa: F401
from fingerpad.results.quantities import SYMBOL
from variational.state import ContactState

CATEGORIES = (BLUE, VERMILION, GREEN, PURPLE, SKY, ORANGE, BLACK)
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
STATE = {"uncharged": SKY, "charged": BLUE, "full_slip": VERMILION}
PRESSURE, ATTRACTION, SHEAR, GAP = BLACK, BLUE, ORANGE, GREEN
MAGNITUDE = "viridis"
WIDTH = 9.0  # in, of a page
_MM = 1e3
_NOTHING = 1e-9  # N/m, V or mm: what a title calls zero
DPI = 150
_PAGE = 96  # pixels of an inch of a page
_COLOURS = 256  # of a PNG file
_LEVEL = 3  # of compression: the next one takes twice as long and saves a tenth
_ROWS = 4  # of pixels, one of which is counted for the colours of a PNG file
_LINE = 0.2  # in, of a title
_ABOVE_TITLE, _BELOW, _BESIDE = 0.1, 0.27, 0.55  # in: above a figure's title, from axes to labels of x and y
_LOOK = {
    "font.size": 10.5,
    "axes.titlesize": 10.5,
    "axes.titley": 1.0,
    "legend.fontsize": 9.5,
    "legend.frameon": False,
    "figure.titlesize": 12,
    "lines.linewidth": 1.5,
    "savefig.dpi": DPI,
}


class Picture(Figure):
    """A figure that a notebook shows as the last value of a cell, without pyplot."""

    def _repr_png_(self) -> tuple[bytes, dict[str, float]]:
        """Return the picture as PNG and its width and height on the page (pixels)."""
        data = BytesIO()
        with look():
            _write_png(self, data)
        width, height = self.get_size_inches()
        return data.getvalue(), {"width": _PAGE * width, "height": _PAGE * height}


@contextmanager
def look() -> Iterator[None]:
    """Give the figures of the block the common fonts, sizes and resolution, whatever a matplotlibrc of the user has."""
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(_LOOK)
        yield


def figure(height: float, width: float = WIDTH) -> Figure:
    """Return an empty figure of a size (in); its parts keep clear of each other."""
    return Picture(figsize=(width, height), layout="constrained")


def sheet(height: float, title: str) -> Figure:
    """Return a figure of the width of a page with a title, whose parts :func:`panel` places.

    To find places takes as long as to draw: a picture whose parts have known sizes is drawn in half the time.

    Args:
        height: of a figure whose title has one line (in).
        title: of one line or several.
    """
    drawn = Picture(figsize=(WIDTH, height + _LINE * title.count("\n")))
    head(drawn, title)
    return drawn


def head(on: Figure, title: str) -> None:
    """Write the title of a figure whose parts :func:`panel` places, or another one instead."""
    on.suptitle(title, y=1 - _ABOVE_TITLE / on.get_size_inches()[1], va="top")


def panel(on: Figure, left: float, right: float, bottom: float, top: float, **options: Any) -> Axes:
    """Return axes at a place of a figure (in, from its lower left corner); its title and labels keep their places."""
    wide, high = on.get_size_inches()
    axes = on.add_axes((left / wide, bottom / high, (right - left) / wide, (top - bottom) / high), **options)
    axes.set_title("")  # else a draw would look for the places of titles and of labels
    axes.xaxis.set_label_coords(0.5, -_BELOW / (top - bottom))
    axes.yaxis.set_label_coords(-_BESIDE / (right - left), 0.5)
    return axes


def column(on: Figure, left: float, right: float, heights: Sequence[tuple[float, float]]) -> list[Axes]:
    """Return axes below each other, between heights (in), with one scale along x below the last."""
    panels: list[Axes] = []
    for bottom, top in heights:
        panels.append(panel(on, left, right, bottom, top, sharex=panels[0] if panels else None))
    for axes in panels[:-1]:
        axes.xaxis.set_visible(False)
    return panels


def align(panels: Sequence[Axes]) -> None:
    """Draw light lines through axes below each other at the ticks of their scale along x, which stays as it is now."""
    panels[-1].set_xlim(panels[-1].get_xlim())
    lines = [[(x, 0), (x, 1)] for x in panels[-1].get_xticks()]
    for axes in panels:
        across = axes.get_xaxis_transform()
        axes.add_artist(LineCollection(lines, colors="0.9", linewidths=0.8, zorder=0, transform=across))


def second_scale(axes: Axes, unit: float, label: str) -> None:
    """Draw the scale of a quantity over ``unit`` on the right of axes, or change the one that is there."""
    functions: Any = (lambda value: value / unit, lambda ratio: ratio * unit)
    there: list[Any] = axes.child_axes
    if there:
        there[0].set_functions(functions)
        return
    right = axes.secondary_yaxis("right", functions=functions)
    right.set_ylabel(label)
    right.yaxis.label.set_verticalalignment("top")
    right.yaxis.set_label_coords(1 + _BESIDE / (WIDTH * axes.get_position().width), 0.5, axes.transAxes)


def clear(axes: Iterable[Axes]) -> None:
    """Take away what is drawn in axes, for another state: scales, labels, titles and legends stay."""
    for each in axes:
        for artist in (*each.lines, *each.collections, *each.patches, *each.images, *each.texts):
            artist.remove()


def decades(low: float, high: float) -> list[float]:
    """Return 1, 2 and 5 times the powers of ten from one number to another, for ticks."""
    powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    return [value for k in powers for value in (10.0**k, 2 * 10.0**k, 5 * 10.0**k) if low <= value <= high]


def voltage(value: float, highest: float = 200.0) -> tuple[float, float, float, float]:
    """Return the colour of a voltage (V): dark blue at 0 V, over red to orange at ``highest`` or its negative."""
    return matplotlib.colormaps["plasma"](0.82 * min(abs(value) / abs(highest), 1.0) if highest else 0.0)


def count(axis: Axis) -> None:
    """Give an axis that counts whole numbers whole numbers alone."""
    axis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1))


def save(drawn: Figure, path: Path | str | None) -> Figure:
    """Write a figure where a path is given, as PNG unless its name ends otherwise; and return it.

    Symbols such as d_eq are typeset, in each text that has no formula of its own.
    """
    for words in drawn.findobj(Text):
        assert isinstance(words, Text)
        if "_" in words.get_text() and "$" not in words.get_text():
            words.set_text(SYMBOL.sub(r"\1$_\\mathrm{\2}$", words.get_text()))
    if path is not None:
        file, data = Path(path), BytesIO()
        file = file if file.suffix else file.with_name(f"{file.name}.png")
        if file.suffix == ".png":
            _write_png(drawn, data)
        else:
            drawn.savefig(data, format=file.suffix[1:])
        replace(file, data.getvalue())
    return drawn


def _write_png(drawn: Figure, data: BytesIO) -> None:
    """Write a figure as PNG of 256 colours: a third of the bytes of all colours, in less time."""
    drawn.set_dpi(DPI)
    canvas = FigureCanvasAgg(drawn)
    canvas.draw()
    pixels = np.ascontiguousarray(canvas.buffer_rgba())
    packed = pixels.view("<u4")[:, :, 0]  # red in the lowest byte
    kind = ((packed >> 3 & 0x1F) | (packed >> 5 & 0x7E0) | (packed >> 8 & 0xF800)).astype(np.uint16)
    colour = np.zeros(1 << 16, dtype="<u4")
    colour[kind] = packed  # the last of each kind: it was drawn, as white was
    found = np.flatnonzero(colour)
    known = colour[found].view(np.uint8).reshape(-1, 4)[:, :3].astype(np.float32)
    count = np.bincount(kind[::_ROWS].ravel(), minlength=1 << 16)[found]
    palette = known[np.argsort(-count, kind="stable")[:_COLOURS]]
    nearest = np.zeros(1 << 16, dtype=np.uint8)
    nearest[found] = ((palette**2).sum(axis=1) - 2 * known @ palette.T).argmin(axis=1)
    image = Image.fromarray(nearest[kind])
    image.putpalette(palette.astype(np.uint8).tobytes())
    image.save(data, "PNG", dpi=(DPI, DPI), compress_level=_LEVEL)


def plain(words: str) -> str:
    """Return words that a user chose, as of a load or a file, so that a picture shows each character as it is."""
    return words.replace("$", r"\$")


def conditions(states: Sequence[ContactState], mu_0: float | None = None, place: bool = False) -> str:
    """Return the ranges of f_ext (N/m) and U (V) over states as the words of a title.

    Args:
        states: one or several.
        mu_0: friction coefficient, where it is known.
        place: whether to add where the bone is sideways.
    """
    words = [f"f_ext = {_range([state.f_ext for state in states])} N/m"]
    words += [f"U = {_range([state.voltage for state in states])} V"]
    words += [f"bone at x = {_range([_MM * state.bone_x for state in states])} mm"] if place else []
    return ", ".join([*words, *([] if mu_0 is None else [f"µ_0 = {mu_0:.3g}"])])


def _range(values: Sequence[float]) -> str:
    """Return a value to four digits, or the least and the largest of several, roundoff about zero left out."""
    first, last = (f"{0.0 if abs(v) < _NOTHING else v:.4g}" for v in (min(values), max(values)))
    return first if first == last else f"{first} to {last}"
