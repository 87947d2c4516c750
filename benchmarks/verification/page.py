"""The verification page: a table for each area, its pictures below."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path

from matplotlib.figure import Figure

from benchmarks.verification.case import Case, Outcome, Row
from fingerpad.io.files import replace, replace_json

Results = Mapping[str, Sequence[tuple[Case, Outcome]]]
_HEADER = """# Verification

Made by `make verify`; do not edit. Each row is a number of ours beside its reference; **!** marks an error above its
tolerance, with which `make verify` fails. The same cases on coarser meshes are part of `make test`. The numbers
themselves, unrounded: [results.json](verification/results.json).
"""


def draw(outcome: Outcome, path: Path) -> None:
    """Draw an outcome's picture, if it has one, as a PNG."""
    if outcome.draw is None:
        return
    figure = Figure(figsize=(7.0, 3.6), layout="constrained")
    outcome.draw(figure)
    figure.savefig(path, dpi=110)


def _number(value: float) -> str:
    return f"{value:.6g}"


def _line(case: Case, row: Row, first: bool) -> str:
    flag = "" if row.holds else "**!** "
    unit = "" if row.absolute else " (rel.)"
    cells = [
        f"{case.name}; {case.reference}" if first else "",
        row.quantity,
        _number(row.reference),
        _number(row.ours),
        f"{flag}{row.error:.2g}{unit}",
        f"{row.tolerance:.2g}: {row.why}",
        row.mesh,
        "–" if row.order is None else f"{row.order:.2f}",
    ]
    return "| " + " | ".join(cells) + " |"


def page(results: Results, folder: str) -> str:
    """Return the page; pictures are in ``folder``, relative to it."""
    rows = [row for cases in results.values() for _, outcome in cases for row in outcome.rows]
    held = sum(row.holds for row in rows)
    parts = [_HEADER, f"{held} of {len(rows)} numbers are within their tolerance."]
    for area, cases in results.items():
        head = ["case and reference", "quantity", "reference", "ours", "error", "tolerance", "mesh", "order"]
        lines = ["| " + " | ".join(head) + " |", "|---" * len(head) + "|"]
        for case, outcome in cases:
            lines += [_line(case, row, k == 0) for k, row in enumerate(outcome.rows)]
        parts += [f"## {area}", "\n".join(lines)]
        parts += [f"![{case.name}]({folder}/{case.slug}.png)" for case, outcome in cases if outcome.draw]
    return "\n\n".join(parts) + "\n"


def write(results: Results, docs: Path) -> None:
    """Write page, numbers and pictures into the docs."""
    folder = docs / "verification"
    folder.mkdir(parents=True, exist_ok=True)
    for cases in results.values():
        for case, outcome in cases:
            draw(outcome, folder / f"{case.slug}.png")
    data = {
        area: {case.name: [asdict(row) | {"error": row.error} for row in outcome.rows] for case, outcome in cases}
        for area, cases in results.items()
    }
    replace_json(folder / "results.json", data)
    replace(docs / "verification.md", page(results, folder.name))
