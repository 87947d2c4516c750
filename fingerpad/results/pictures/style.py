"""How every picture looks: one palette, one set of fonts and sizes, told apart with any colour vision, and titles.

Categories have Okabe and Ito's colours, magnitudes viridis, voltages a ramp of their own. Importing changes nothing.
"""

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure, FigureBase
from matplotlib.text import Text
from matplotlib.ticker import MaxNLocator
from PIL import Image

from fingerpad.results.files import replace
from fingerpad.results.quantities import SYMBOL
from variational.state import ContactState

BLACK, ORANGE, SKY, GREEN, YELLOW = "#000000", "#E69F00", "#56B4E9", "#009E73", "#F0E442"
BLUE, VERMILION, PURPLE, GREY = "#0072B2", "#D55E00", "#CC79A7", "#999999"
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
_LOOK = {
    "font.size": 10.5,
    "axes.titlesize": 10.5,
    "legend.fontsize": 9.5,
    "legend.frameon": False,
    "figure.titlesize": 12,
    "lines.linewidth": 1.5,
    "savefig.dpi": DPI,
}


class _Picture(Figure):
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


def figure(height: float, title: str = "", width: float = WIDTH) -> Figure:
    """Return an empty figure of a size (in) with a title; its parts keep clear of each other."""
    drawn = _Picture(figsize=(width, height), layout="constrained")
    if title:
        drawn.suptitle(title)
    return drawn


def column(on: FigureBase, ratios: Sequence[float]) -> list[Axes]:
    """Return axes below each other, of heights in a ratio, with one scale along x and light lines at its ticks."""
    panels = list(on.subplots(len(ratios), 1, sharex=True, squeeze=False, height_ratios=ratios)[:, 0])
    for axes in panels:
        axes.grid(axis="x", color="0.9", linewidth=0.8)
        axes.set_axisbelow(True)
    return panels


def second_scale(axes: Axes, unit: float, label: str) -> None:
    """Draw the scale of a quantity over ``unit`` on the right of axes."""
    functions: Any = (lambda value: value / unit, lambda ratio: ratio * unit)
    axes.secondary_yaxis("right", functions=functions).set_ylabel(label)


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
    """Write a figure as PNG of 256 colours: a third of the bytes of all colours."""
    drawn.set_dpi(DPI)
    canvas = FigureCanvasAgg(drawn)
    canvas.draw()
    image = Image.fromarray(np.asarray(canvas.buffer_rgba())[:, :, :3].copy())
    image.quantize(_COLOURS, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE).save(data, "PNG", dpi=(DPI, DPI))


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
