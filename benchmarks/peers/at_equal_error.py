"""The ridge at equal error: which rows of the kept numbers are compared, and their picture."""

from collections.abc import Sequence
from typing import Any

from matplotlib.figure import Figure

from benchmarks.harness import ticks
from fingerpad.results.style import BLUE, ORANGE, VERMILION

QUANTITIES = ("F_n", "half-width", "peak pressure")
ASKED = (1e-3, 2.5e-3, 5e-3)  # relative errors of the three within which a finger's run is to be
OURS, CURVED, STRAIGHT = "fingerpad", "plain dolfinx, curved facets", "plain dolfinx, straight facets"
Row = dict[str, Any]


# -- page ----------------------------------------------------------------------------------------------------
def cheapest(rows: Sequence[Row], ours: bool, errors: Sequence[float], lucky: bool = False) -> Row | None:
    """Return the row of least time of this package, or of the script, whose errors are within given ones; or None.

    The error of one mesh may be small by chance, by where in a facet the contact ends. So all finer meshes of the same
    program must be within them too, unless ``lucky``.
    """
    found: list[Row] = []
    for program in {row["program"] for row in rows if (row["program"] == OURS) == ours}:
        for row in sorted((row for row in rows if row["program"] == program), key=lambda row: float(row["size"])):
            if all(a <= b for a, b in zip(row["errors"], errors, strict=True)):
                found.append(row)
            elif not lucky:
                break
    return min(found, key=lambda row: float(row["seconds"])) if found else None


def words(rows: Sequence[Row]) -> dict[str, Any]:
    """Return what the page says of the rows: this package's, each with the script's that is nowhere less accurate."""
    mine = [row for row in rows if row["program"] == OURS]
    pairs = [(row, cheapest(rows, False, row["errors"])) for row in mine]
    reached = [ratio(*pair) for pair in pairs]
    luck = [ratio(row, cheapest(rows, False, row["errors"], lucky=True)) for row in mine]
    return {
        "QUANTITIES": QUANTITIES, "ASKED": ASKED, "ratio": ratio, "errors_of": errors_of, "pairs": pairs,
        "reached": [one for one in reached if one], "lucky": [one for one in luck if one],
        "asked": [cheapest(rows, ours, ASKED) for ours in (True, False)],
    }  # fmt: skip


def errors_of(row: Row) -> str:
    """Return the three errors of a row in words."""
    return ", ".join(f"{100 * error:.2g} %" for error in row["errors"])


def ratio(row: Row | None, other: Row | None) -> float | None:
    """Return how many times as long the other row takes; None without one of them."""
    return float(other["seconds"] / row["seconds"]) if row and other else None


def paint(figure: Figure, rows: Sequence[Row]) -> None:
    """Draw the errors of each program over its processor seconds; a panel a quantity."""
    axes = figure.subplots(1, 3, sharex=True)
    for k, (ax, name) in enumerate(zip(axes, QUANTITIES, strict=True)):
        for program, colour, marker in ((OURS, BLUE, "o"), (CURVED, ORANGE, "s"), (STRAIGHT, VERMILION, "^")):
            mine = [row for row in rows if row["program"] == program]
            seconds, errors = [row["seconds"] for row in mine], [100 * row["errors"][k] for row in mine]
            ax.loglog(seconds, errors, marker, ls="-", color=colour, label=program)
        ticks(ax, (0.5, 1, 2, 5, 10))
        ax.set(title=name, xlabel="processor time (s)")
    axes[0].set_ylabel("error (%)")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
