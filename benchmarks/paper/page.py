"""The page: our figures beside the paper's statements, with a verdict each."""

import csv
import json
import math
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from benchmarks.paper.statement import HOLDS, Statement
from fingerpad.io.files import replace, replace_json

_PUBLISHED = Path(__file__).parent / "experiment" / "published.csv"
_NUMBERS = Path("paper", "paper.json")
_HEADER = """# The paper, reproduced

Made by `make paper`; do not edit. [Forsbach, Heß and Papangelo 2023](https://doi.org/10.3389/fmech.2022.1074393) by
our model with default options, contact size {size:g} µm. What the paper says is text; its figures' data are not
published, so nothing here was fitted to them. The numbers unrounded: [paper.json](paper/paper.json). What the mesh
leaves of error in such numbers is in [errors.md](errors.md); it is largest in the energy densities at the Merkel sites.
"""


def _table(statements: Sequence[Statement]) -> str:
    lines = ["| figure | the paper | ours | verdict |", "|---|---|---|---|"]
    for s in statements:
        because = f": {s.why}" if s.verdict != HOLDS and s.why else ""
        lines.append(f"| {s.figure} | {s.paper} | {s.ours} | **{s.verdict}**{because} |")
    return "\n".join(lines)


def published() -> str:
    """Return the values measured by others as Markdown."""
    lines = ["| quantity | from | to | unit (SI) | source |", "|---|---|---|---|---|"]
    with _PUBLISHED.open(encoding="utf-8", newline="") as file:
        lines += [f"| {' | '.join(row.values())} |" for row in csv.DictReader(file)]
    return "\n".join(lines)


def write(
    docs: Path,
    size: float,
    statements: Sequence[Statement],
    figures: Sequence[tuple[str, str]],
    tables: str,
    missing: str,
) -> None:
    """Write the page and its numbers.

    Args:
        docs: folder of the page; pictures are in ``paper`` below it.
        size: contact size of the runs (m).
        statements: in the order of the page.
        figures: file names and captions, likewise.
        tables: Tables 1 to 3 in Markdown.
        missing: what has not been run, empty if nothing.
    """
    held = sum(s.verdict == HOLDS for s in statements)
    parts = [_HEADER.format(size=size * 1e6), missing, f"{held} of {len(statements)} statements hold as they stand."]
    parts += ["## Statements", _table(statements), "## Figures"]
    parts += [f"![{caption}](paper/{name})\n\n*{caption}*" for name, caption in figures]
    parts += ["## Published measurements", published()]
    parts += ["## Parameters", tables]
    replace(docs / "paper.md", "\n\n".join(filter(None, parts)) + "\n")
    data = {"contact_size": size, "statements": [asdict(s) for s in statements]}
    replace_json(docs / _NUMBERS, data)


def moved(docs: Path, size: float, statements: Sequence[Statement]) -> list[str]:
    """Return what of the page's numbers is not what it was when the page was last written, at the same contact size.

    Runs of one scene differ by the solver's tolerance, and by which steps were cut: a thousandth is neither.
    """
    try:
        page = json.loads((docs / _NUMBERS).read_text(encoding="utf-8"))
    except OSError:
        return []
    if page["contact_size"] != size:
        return []
    before = {s["paper"]: s["numbers"] for s in page["statements"]}
    return [
        f"{s.paper}: {name} was {before[s.paper][name]:.6g}, is {value:.6g}"
        for s in statements
        for name, value in s.numbers.items()
        if not math.isclose(before.get(s.paper, {}).get(name, value), value, rel_tol=1e-3, abs_tol=1e-12)
    ]
