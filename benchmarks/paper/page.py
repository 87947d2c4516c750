"""The page: the paper's statements beside this model's numbers, with a verdict each, and three pictures."""

import csv
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.harness import kept, page, picture, table
from benchmarks.paper import friction, section, sed
from benchmarks.paper.scenes import CENTRE, MAP, SECTION, SITES
from benchmarks.paper.statement import HOLDS, IN_PART, NOT, Statement

_PUBLISHED = Path(__file__).parent / "experiment" / "published.csv"
_HOW = """The paper is [Forsbach, Heß and Papangelo 2023](https://doi.org/10.3389/fmech.2022.1074393). Its statements
are text; the data of its figures are not published, so nothing here was fitted to them. The finger has the default
parameters and options with two exceptions: elements of {contact:g} µm in the contact (default 5 µm) and of {sites:g}
µm at the receptor sites (default 5 µm). The coarse sites make energy densities there 13 % too low.

*Normal contact* is the charged state before sliding. Ridges are numbered from 0 at the centre, positive towards the
leading edge. The paper numbers its Merkel sites along the arc: ridge k is its M(k + {centre}). *SED* is the strain
energy density. [scene.md](scene.md) has all parameters and marks those that the paper leaves open. What the mesh
leaves of error in such numbers is in [errors.md](errors.md); the error is largest in the energy densities at the
Merkel sites."""
_CAPTIONS = {
    "friction": "The attraction raises friction most at small forces (A). Sliding shortens the contact about in "
    "proportion to the mean shear stress, with scatter where ridges come and go (B).",
    "section": f"Tractions along the skin at {SECTION[0]:g} N/m and {SECTION[1]:g} V. The sliding finger loses contact "
    "at its trailing edge (left) and gains it at the leading one.",
    "energy": f"Energy density at the Merkel sites at {MAP:g} N/m, sliding. Voltage at µ0 = 0.25, and friction alone "
    "at µ0 = 0.523, agree within 5 % but for the trailing ridges.",
}


def verdicts(statements: list[Statement]) -> str:
    """Return the table of statements; a reason stands with every verdict that is not a plain yes."""
    rows = []
    for s in statements:
        because = f": {s.why}" if s.verdict != HOLDS and s.why else ""
        rows.append([s.figure, s.paper, s.ours, f"**{s.verdict}**{because}"])
    return table(["figure", "the paper", "this model", "verdict"], rows)


def _picture(docs: Path, name: str, numbers: dict[str, Any], measured: friction.Measured | None) -> str:
    """Draw a picture, or keep the one that is there where its numbers are older than their record."""
    path, caption = docs / f"paper_{name}.png", _CAPTIONS[name]
    if name == "friction" and "grid" in numbers:
        grid = {key: np.array(values) for key, values in numbers["grid"].items()}
        return picture(path, (10, 4), lambda figure: friction.paint(figure, grid, measured), caption)
    if name == "section" and "section" in numbers:
        return picture(path, (9, 7), lambda figure: section.paint(figure, numbers["section"]), caption)
    if name == "energy" and "sites" in numbers:
        return picture(path, (8, 5), lambda figure: sed.paint(figure, numbers["sites"]), caption)
    caption += " Drawn with the runs, whose data are not kept."
    return f"![{caption}]({path.name})\n\n*{caption}*" if path.exists() else ""


def draw(docs: Path, measured: friction.Measured | None = None) -> Path:
    """Write docs/paper.md and its pictures from docs/paper.json."""
    found = kept("paper", docs)
    numbers = found.numbers
    statements = [Statement(**s) for s in numbers["statements"]]
    count = Counter(s.verdict for s in statements)
    finding = (
        f"Of {len(statements)} statements of the paper, {count[HOLDS]} hold in this model, {count[IN_PART]} hold in "
        f"part and {count[NOT]} do not hold."
    )
    for mu_app in (s.numbers["mu_app"] for s in statements if "mu_app" in s.numbers):
        finding += f" The apparent friction coefficient at 75 N/m and 200 V is {mu_app:.3f}; the paper has 0.55."
    with _PUBLISHED.open(encoding="utf-8", newline="") as file:
        _, *published = csv.reader(file)
    missing = ", ".join(numbers.get("missing", []))
    how = _HOW.format(contact=1e6 * numbers["contact_size"], sites=1e6 * SITES, centre=CENTRE)
    body = [
        f"**Not run yet:** {missing}." if missing else "",
        f"## Statements\n\n{verdicts(statements)}",
        "## Pictures",
        *(_picture(docs, name, numbers, measured) for name in _CAPTIONS),
        f"## Published measurements\n\n{table(['quantity', 'from', 'to', 'unit (SI)', 'source'], published)}",
    ]
    return page(docs / "paper.md", "The paper, reproduced", finding, how, body, "make paper", found.made, ["paper"])
