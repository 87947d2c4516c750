"""How every picture looks: one palette, one set of fonts and sizes, told apart with any colour vision, and titles.

Categories have Okabe and Ito's colours, magnitudes viridis, voltages a ramp of their own. Importing changes nothing.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path

import matplotlib
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from fingerpad.results.files import replace
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
_LOOK = {
    "font.size": 10.5,
    "axes.titlesize": 10.5,
    "legend.fontsize": 9.5,
    "legend.frameon": False,
    "figure.titlesize": 12,
    "lines.linewidth": 1.5,
    "savefig.dpi": 150,
}


@contextmanager
def look() -> Iterator[None]:
    """Give the figures of the block the common fonts, sizes and resolution, whatever a matplotlibrc of the user has."""
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(_LOOK)
        yield


def figure(height: float, width: float = WIDTH) -> Figure:
    """Return an empty figure of a size (in); its parts keep clear of each other."""
    return Figure(figsize=(width, height), layout="constrained")


def voltage(value: float, highest: float = 200.0) -> tuple[float, float, float, float]:
    """Return the colour of a voltage (V): dark blue at 0 V, over red to orange at ``highest`` or its negative."""
    return matplotlib.colormaps["plasma"](0.82 * min(abs(value) / abs(highest), 1.0) if highest else 0.0)


def count(axis: Axis) -> None:
    """Give an axis that counts whole numbers whole numbers alone."""
    axis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1))


def save(drawn: Figure, path: Path | str | None) -> Figure:
    """Write a figure where a path is given, as PNG unless its name ends otherwise; and return it."""
    if path is not None:
        file, data = Path(path), BytesIO()
        file = file if file.suffix else file.with_name(f"{file.name}.png")
        drawn.savefig(data, format=file.suffix[1:])
        replace(file, data.getvalue())
    return drawn


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
    words = [f"$f_{{ext}}$ = {_range([state.f_ext for state in states])} N/m"]
    words += [f"$U$ = {_range([state.voltage for state in states])} V"]
    words += [f"bone at $x$ = {_range([_MM * state.bone_x for state in states])} mm"] if place else []
    return ", ".join([*words, *([] if mu_0 is None else [f"$\\mu_0$ = {mu_0:.3g}"])])


def _range(values: Sequence[float]) -> str:
    """Return a value to four digits, or the least and the largest of several, roundoff about zero left out."""
    first, last = (f"{0.0 if abs(v) < _NOTHING else v:.4g}" for v in (min(values), max(values)))
    return first if first == last else f"{first} to {last}"
