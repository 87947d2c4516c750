"""What a verification case is and what it reports, and the page: a table of each area."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from benchmarks.harness import cells, kept, page

ELSEWHERE, CURVE, CONVERGENCE, IDENTITY = "elsewhere", "curve", "convergence", "identity"
KINDS = {
    ELSEWHERE: "answers from elsewhere",
    CURVE: "errors of a curve, whose answer is 0",
    CONVERGENCE: "orders of convergence, and finer meshes",
    IDENTITY: "identities of the model's own equations",
}
"""Kinds of numbers, in words."""


@dataclass(frozen=True)
class Row:
    """One computed number beside the known answer."""

    quantity: str
    """With its unit in parentheses where it has one."""
    computed: float
    reference: float
    tolerance: float
    """Largest error that passes; ``why`` says in one sentence where it comes from."""
    why: str
    mesh: str = "–"
    order: float | None = None
    """Observed order of convergence, where several meshes were run."""
    absolute: bool = False
    """Whether error and tolerance are in the quantity's unit; relative otherwise."""
    kind: str = ELSEWHERE
    """Of :data:`KINDS`; :data:`CURVE` by itself where the answer is 0."""

    def __post_init__(self) -> None:
        """Take an answer of 0 for that of a curve."""
        if self.reference == 0 and self.kind == ELSEWHERE:
            object.__setattr__(self, "kind", CURVE)

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
    """A problem with a known answer; ``run(small)`` computes its rows, small on the coarse meshes of the tests."""

    name: str
    reference: str
    """Where the answer comes from, with its DOI or equation number."""
    run: Callable[[bool], Sequence[Row]]
    kind: str = ELSEWHERE
    """Of its numbers that have no other kind."""

    def rows(self, small: bool) -> list[Row]:
        """Return the rows, each with its kind."""
        return [replace(row, kind=self.kind) if row.kind == ELSEWHERE else row for row in self.run(small)]


def worst(rows: Sequence[Row]) -> Row:
    """Return the row that comes nearest to its tolerance or exceeds it most, named as the worst of all."""
    most = max(rows, key=lambda row: row.error / row.tolerance if row.error == row.error else float("inf"))
    return replace(most, quantity=f"{most.quantity}, worst of {len(rows)}")


def order(errors: ArrayLike, parts: ArrayLike) -> float:
    """Return the order of convergence, fitted to errors of either sign over the numbers of parts, shape (n,)."""
    return -float(np.polyfit(np.log(parts), np.log(np.abs(errors)), 1)[0])


def order_row(quantity: str, observed: float, expected: float, tolerance: float, why: str, mesh: str) -> Row:
    """Return the row of an observed order of convergence."""
    return Row(quantity, observed, expected, tolerance, why, mesh, observed, absolute=True, kind=CONVERGENCE)


# -- page ----------------------------------------------------------------------------------------------------
Results = Mapping[str, Sequence[tuple[Case, Sequence[Row]]]]


def numbers(results: Results) -> dict[str, Any]:
    """Return the rows of all cases, ready for JSON."""

    def record(case: Case, rows: Sequence[Row]) -> dict[str, Any]:
        return {"name": case.name, "reference": case.reference, "rows": [asdict(row) for row in rows]}

    return {area: [record(*found) for found in cases] for area, cases in results.items()}


def _line(case: Mapping[str, Any], rows: Sequence[Row]) -> str:
    """Return the row of a case: its source, its numbers, and the one that comes nearest to its tolerance."""
    near = max(rows, key=lambda row: (not row.holds, row.error / row.tolerance if row.tolerance else 0.0))
    error = f"{near.error:.2g}{'' if near.absolute else ' (rel.)'}"
    holds = f"{sum(row.holds for row in rows)} of {len(rows)}"
    found = (f"{near.reference:.6g}", f"{near.computed:.6g}", error, f"{near.tolerance:.2g}")
    return cells(case["name"], case["reference"], holds, near.quantity, *found)


def draw(docs: Path) -> Path:
    """Put the numbers of docs/verification.json in place in the pages."""
    rows, areas = list[Row](), dict[str, list[str]]()
    for area, cases in kept("verification", docs).numbers.items():
        some = [[Row(**row) for row in case["rows"]] for case in cases]
        areas[area] = [*map(_line, cases, some)]
        rows += [row for each in some for row in each]
    count = {kind: sum(row.kind == kind for row in rows) for kind in KINDS}
    return page(docs, "verification", "make verify", {"rows": rows, "areas": areas, "count": count, "KINDS": KINDS})
