"""The verification page: a table of known answers and computed numbers for each area."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from benchmarks.harness import kept, page, prose, table
from benchmarks.verification.case import Case, Row

Results = Mapping[str, Sequence[tuple[Case, Sequence[Row]]]]
_HEAD = ["case and source of the answer", "quantity", "known answer", "computed", "error", "tolerance", "mesh", "order"]


def numbers(results: Results) -> dict[str, Any]:
    """Return the rows of all cases, ready for JSON."""

    def record(case: Case, rows: Sequence[Row]) -> dict[str, Any]:
        return {"name": case.name, "reference": case.reference, "rows": [asdict(row) for row in rows]}

    return {area: [record(*found) for found in cases] for area, cases in results.items()}


def _lines(name: str, reference: str, rows: Sequence[Row]) -> list[list[str]]:
    return [
        [
            f"{name}; {reference}" if k == 0 else "",
            row.quantity,
            f"{row.reference:.6g}",
            f"{row.computed:.6g}",
            f"{'' if row.holds else '**!** '}{row.error:.2g}{'' if row.absolute else ' (rel.)'}",
            f"{row.tolerance:.2g}: {row.why}",
            row.mesh,
            "–" if row.order is None else f"{row.order:.2f}",
        ]
        for k, row in enumerate(rows)
    ]


def draw(docs: Path) -> Path:
    """Write docs/verification.md from docs/verification.json."""
    found = kept("verification", docs)
    areas = {
        area: [(case["name"], case["reference"], [Row(**row) for row in case["rows"]]) for case in cases]
        for area, cases in found.numbers.items()
    }
    rows = [row for cases in areas.values() for *_, some in cases for row in some]
    held, count = sum(row.holds for row in rows), sum(map(len, areas.values()))
    text = prose("verification")
    finding = text["finding"].format(held=held, n=len(rows), count=count)
    body = [
        f"## {area}\n\n{table(_HEAD, [line for case in cases for line in _lines(*case)])}"
        for area, cases in areas.items()
    ]
    path, names = docs / "verification.md", ["verification"]
    return page(path, "Verification", finding, text["how"], body, "make verify", found.made, names)
