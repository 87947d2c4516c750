"""What a verification case is and what it says."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from matplotlib.figure import Figure


@dataclass(frozen=True)
class Row:
    """One number beside its reference."""

    quantity: str
    """What it is, with its unit in parentheses where it has one."""
    ours: float
    reference: float
    tolerance: float
    """Largest error that passes."""
    why: str
    """Where the tolerance comes from, in one sentence."""
    mesh: str = "–"
    """Elements and their size, or what else the number was computed with."""
    order: float | None = None
    """Observed order of convergence, where several meshes were run."""
    absolute: bool = False
    """Whether error and tolerance are in the quantity's unit; relative otherwise."""

    @property
    def error(self) -> float:
        """Return the difference from the reference, relative to it unless ``absolute``."""
        difference = abs(self.ours - self.reference)
        return difference if self.absolute else difference / abs(self.reference)

    @property
    def holds(self) -> bool:
        """Whether the error is within the tolerance; a NaN is not."""
        return bool(self.error <= self.tolerance)


@dataclass(frozen=True)
class Outcome:
    """What a case found."""

    rows: tuple[Row, ...]
    draw: Callable[[Figure], None] | None = None
    """Draws the picture into an empty figure."""


@dataclass(frozen=True)
class Case:
    """A problem with a known answer."""

    name: str
    reference: str
    """Where the answer comes from, with its DOI or equation number."""
    run: Callable[[bool], Outcome]
    """Solves it; the argument asks for the small form, of seconds and coarse meshes, that the tests run."""

    @property
    def slug(self) -> str:
        """Return the name as a file's."""
        return re.sub(r"[^a-z0-9]+", "_", self.name.lower()).strip("_")


def worst(rows: Sequence[Row]) -> Row:
    """Return the row that comes nearest to its tolerance or exceeds it most, said to be the worst of all."""
    most = max(rows, key=lambda row: row.error / row.tolerance if row.error == row.error else float("inf"))
    return replace(most, quantity=f"{most.quantity}, worst of {len(rows)}")
