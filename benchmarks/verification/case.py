"""What a verification case is and what it reports."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from fingerpad.io.style import CATEGORIES, MARKERS

_FEW = 40  # known points that are drawn one by one
Lines = Mapping[str, tuple[ArrayLike, ArrayLike]]


@dataclass(frozen=True)
class Row:
    """One computed number beside the known answer.

    Attributes:
        quantity: with its unit in parentheses where it has one.
        computed: by the program.
        reference: the known answer.
        tolerance: largest error that passes.
        why: where the tolerance comes from, in one sentence.
        mesh: elements and their size, or what else the number was computed with.
        order: observed order of convergence, where several meshes were run.
        absolute: whether error and tolerance are in the quantity's unit; relative otherwise.
    """

    quantity: str
    computed: float
    reference: float
    tolerance: float
    why: str
    mesh: str = "–"
    order: float | None = None
    absolute: bool = False

    @property
    def error(self) -> float:
        """Return the difference from the reference, relative to it unless ``absolute``."""
        difference = abs(self.computed - self.reference)
        return difference if self.absolute else difference / abs(self.reference)

    @property
    def holds(self) -> bool:
        """Whether the error is within the tolerance; a NaN is not."""
        return bool(self.error <= self.tolerance)


@dataclass(frozen=True)
class Curves:
    """The picture of a case: known answers in black, computed numbers as coloured markers.

    Attributes:
        x: label of the abscissa, with its unit.
        y: label of the ordinate, likewise.
        known: abscissae and ordinates by name.
        computed: likewise.
        logarithmic: whether both axes are.
        limits: of the abscissa; None for all there is.
    """

    x: str
    y: str
    known: Lines
    computed: Lines
    logarithmic: bool = False
    limits: tuple[float, float] | None = None

    def draw(self, figure: Figure) -> None:
        """Draw into an empty figure."""
        ax = figure.subplots()
        for k, (name, (x, y)) in enumerate(self.known.items()):
            marker = "+" if np.size(x) < _FEW else ""
            line = ("-", "--", ":", "-.")[k % 4] if np.size(x) > 2 else "none"
            ax.plot(x, y, ls=line, marker=marker, color="black", lw=0.8, label=name)
        for k, (name, (x, y)) in enumerate(self.computed.items()):
            ax.plot(x, y, MARKERS[k % 7], color=CATEGORIES[k % 7], ms=4, mfc="none", label=f"{name}, computed")
        scale = "log" if self.logarithmic else "linear"
        ax.set(xlabel=self.x, ylabel=self.y, xscale=scale, yscale=scale, xlim=self.limits)
        figure.legend(fontsize="small", loc="outside right upper")


@dataclass(frozen=True)
class Outcome:
    """What a case found, and its picture if it has one."""

    rows: tuple[Row, ...]
    curves: Curves | None = None


@dataclass(frozen=True)
class Case:
    """A problem with a known answer.

    Attributes:
        name: of the case.
        reference: where the answer comes from, with its DOI or equation number.
        run: solves it; the argument asks for the small form, of seconds and coarse meshes, that the tests run.
    """

    name: str
    reference: str
    run: Callable[[bool], Outcome]

    @property
    def slug(self) -> str:
        """Return the name as a file's."""
        return re.sub(r"[^a-z0-9]+", "_", self.name.lower()).strip("_")


def worst(rows: Sequence[Row]) -> Row:
    """Return the row that comes nearest to its tolerance or exceeds it most, named as the worst of all."""
    most = max(rows, key=lambda row: row.error / row.tolerance if row.error == row.error else float("inf"))
    return replace(most, quantity=f"{most.quantity}, worst of {len(rows)}")
