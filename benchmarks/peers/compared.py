"""What the page has of other programs: their quantities beside fingerpad's, and one ridge at equal error."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.polynomial import Polynomial

from benchmarks.harness import ticks
from benchmarks.peers.exchange import Answer, Array, Ridge, State, cases
from fingerpad.results.pictures.style import BLUE, ORANGE, VERMILION

OURS, CURVED, STRAIGHT = "fingerpad", "plain dolfinx, curved facets", "plain dolfinx, straight facets"
PEER = "NGSolve"
QUANTITIES = ("F_n", "half-width", "peak pressure")
ASKED = (1e-3, 2.5e-3, 5e-3)  # relative errors of the three within which a finger's run is to be
_ROUNDED = 5e-7  # a difference that is zero in all printed digits
_TO_POWERS = np.linalg.inv(np.vander([0.0, 1.0, 0.5], increasing=True))  # of the coordinate along an edge
Row = dict[str, Any]


# -- quantities ------------------------------------------------------------------------------------------------
def values(state: State, ridge: Ridge) -> list[float]:
    """Return normal force, friction (N/mm), half-width (mm) and peak pressure (MPa) of a state."""
    return [state.f_n, state.f_t, half_width(ridge, state), state.p_n]


def half_width(ridge: Ridge, state: State) -> float:
    """Return half the current length (mm) of the skin below the plane, its ends located inside edges."""
    places = ridge.points[ridge.skin] + np.array(state.displacement).reshape(-1, 3, 2)
    return sum(_length_below(edge) for edge in places) / 2


def _length_below(edge: Array) -> float:
    """Return the length over which the parabola through an edge's nodes, shape (3, 2), has y < 0."""
    x, y = (Polynomial(_TO_POWERS @ z) for z in edge.T)
    roots = y.roots()
    real = roots[np.abs(np.imag(roots)) < 1e-12].real
    cuts = [0.0, *np.sort(real[(real > 0) & (real < 1)]), 1.0]
    gauss, weights = np.polynomial.legendre.leggauss(6)
    length = 0.0
    for a, b in zip(cuts, cuts[1:], strict=False):
        if y((a + b) / 2) < 0:
            xi = (a + b) / 2 + (b - a) / 2 * gauss
            length += (b - a) / 2 * float(weights @ np.hypot(x.deriv()(xi), y.deriv()(xi)))
    return length


def numbers(folder: Path) -> dict[str, Any]:
    """Return the states of all programs whose answers are in a folder, with differences from fingerpad's."""
    meshes = []
    for path in sorted(folder.glob("*.npz"), key=lambda path: -float(path.stem)):
        ridge, states = Ridge.read(path), []
        for name in cases():
            both = [Answer.read(folder / f"{program}_{name}_{path.stem}.json") for program in ("ours", "ngsolve")]
            for ours, theirs in zip(*(answer.states for answer in both), strict=True):
                own, other = values(ours, ridge), values(theirs, ridge)
                judged = (True, abs(own[1]) > 1e-2 * own[0], True, True)  # friction may vanish by symmetry
                off = [a / b - 1 if judge else None for a, b, judge in zip(other, own, judged, strict=True)]
                rows = [{"program": OURS, "values": own}, {"program": PEER, "values": other, "differences": off}]
                states.append({"name": ours.name, "rows": rows})
        meshes.append({"size": float(path.stem), "triangles": len(ridge.triangles), "states": states})
    return {"meshes": meshes}


def summary(found: Mapping[str, Any]) -> dict[str, Array]:
    """Return the largest differences of other programs from fingerpad, of all states and meshes."""
    rows = [row for mesh in found["meshes"] for state in mesh["states"] for row in state["rows"]]
    sizes = np.array([[abs(d or 0.0) for d in row["differences"]] for row in rows if row["program"] == PEER])
    return {PEER: np.where(sizes > _ROUNDED, sizes, 0.0).max(axis=0)}


# -- one ridge at equal error ----------------------------------------------------------------------------------
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
        "pairs": pairs, "reached": [one for one in reached if one], "lucky": [one for one in luck if one],
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
