"""How all figures look."""

from collections.abc import Callable
from pathlib import Path

import matplotlib
from matplotlib.figure import Figure

# Okabe and Ito's colours in the order of the voltages; markers and dashes tell them apart in grey.
VOLTAGE = {
    0.0: ("#000000", "o", "-"),
    50.0: ("#56B4E9", "s", "--"),
    100.0: ("#009E73", "^", "-."),
    150.0: ("#E69F00", "D", ":"),
    200.0: ("#D55E00", "v", "-"),
}
BLUE, VERMILION, GREEN, PURPLE, GREY = "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#999999"


def draw(path: Path, size: tuple[float, float], paint: Callable[[Figure], None]) -> None:
    """Have a figure painted and keep it as a PNG."""
    with matplotlib.rc_context({"font.size": 10, "axes.titlesize": 10, "legend.fontsize": 8, "lines.linewidth": 1.4}):
        figure = Figure(figsize=size, layout="constrained")
        paint(figure)
        figure.savefig(path, dpi=130)
