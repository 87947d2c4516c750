"""What a verification case is and what it reports."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike


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
class Case:
    """A problem with a known answer.

    Attributes:
        name: of the case.
        reference: where the answer comes from, with its DOI or equation number.
        run: computes its rows; the argument selects the small form, of seconds and coarse meshes, that the tests run.
    """

    name: str
    reference: str
    run: Callable[[bool], Sequence[Row]]


def worst(rows: Sequence[Row]) -> Row:
    """Return the row that comes nearest to its tolerance or exceeds it most, named as the worst of all."""
    most = max(rows, key=lambda row: row.error / row.tolerance if row.error == row.error else float("inf"))
    return replace(most, quantity=f"{most.quantity}, worst of {len(rows)}")


def order(errors: ArrayLike, parts: ArrayLike) -> float:
    """Return the order of convergence, fitted to errors of either sign over the numbers of parts, shape (n,)."""
    return -float(np.polyfit(np.log(parts), np.log(np.abs(errors)), 1)[0])


def order_row(quantity: str, observed: float, expected: float, tolerance: float, why: str, mesh: str) -> Row:
    """Return the row of an observed order of convergence."""
    return Row(quantity, observed, expected, tolerance, why, mesh, observed, absolute=True)
