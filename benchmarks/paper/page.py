"""The page: the paper's statements beside this model's numbers, with a verdict each, and a picture."""

import csv
from collections import Counter
from pathlib import Path

import numpy as np

from benchmarks import newtons
from benchmarks.harness import kept, page, picture, prose, table
from benchmarks.paper import friction, scenes
from benchmarks.paper.statement import BUILT, HOLDS, IN_PART, NOT, Statement
from benchmarks.runs import FORCES, VOLTAGES
from fingerpad.slices import errors

_PUBLISHED = Path(__file__).parent / "published.csv"


def verdicts(statements: list[Statement]) -> str:
    """Return the table of statements; a reason stands with every verdict that is not a plain yes."""
    rows = []
    for s in statements:
        because = f": {s.why}" if s.verdict != HOLDS and s.why else ""
        rows.append([s.figure, s.paper, s.ours, f"**{s.verdict}**{because}"])
    return table(["figure", "the paper", "this model", "verdict"], rows)


def sites(statements: list[Statement]) -> str:
    """Return the table of the sites that the paper names, empty without a run of Fig. 9B."""
    named = [n for s in statements for name in s.numbers.items() if (n := _site(*name))]
    start = next((ridge for kind, ridge, _ in named if kind == "highest"), 0.0)
    rows = []
    for kind, ridge, ratio in named:
        theirs, site = scenes.NAMED[kind], f"{kind} at 0 V" if kind == "highest" else kind
        places = f"{theirs - scenes.NAMED['highest']:+d}", f"{ridge - start:+g}"
        rows.append([site, f"M{theirs}", places[0], f"{ridge:g}", places[1], f"{ratio:.2g}"])
    return table(["site", "the paper", "its place", "ridge here", "its place", "ratio of SED"], rows) if rows else ""


def _site(name: str, ratio: float) -> tuple[str, float, float] | None:
    """Return kind, ridge and ratio of one of the numbers of Fig. 9B's sites, None for other numbers."""
    kind, _, ridge = name.rpartition(" ")
    return (kind, float(ridge), ratio) if kind in scenes.NAMED else None


def in_newtons(docs: Path) -> str:
    """Return the verdict on the paper's conversion by 20 mm, and Fig. 6 in newtons; empty without docs/newtons.json."""
    if not (docs / "newtons.json").exists():
        return ""
    numbers = kept("newtons", docs).numbers
    widths, lower = newtons.widths(numbers), newtons.lower(numbers)
    middle = next(each for each in newtons.at(numbers, newtons.RADII[1], newtons.HIGH) if each["f_ext"] > 0.499)
    values = {"narrow": 1e3 * widths[0], "wide": 1e3 * widths[1], "low": 100 * lower[0], "high": 100 * lower[1]}
    values |= {"mu_app": middle["mu_app"], "by_20_mm": middle["by_20_mm"], "factor": newtons.PAPER / widths[1]}
    values |= {"most": newtons.PAPER / widths[0]}
    slices = errors.percent(errors.known_at(newtons.COMPARED)["f_t"])
    text = prose("paper")["newtons"].format(slices=slices, **values)
    return f"## Fig. 6 in newtons\n\n{text}\n\n{newtons.picture(numbers, docs)}"


def draw(docs: Path) -> Path:
    """Write docs/paper.md and its picture from docs/paper.json, and Fig. 6 in newtons from docs/newtons.json."""
    found = kept("paper", docs)
    numbers = found.numbers
    statements = [Statement(**s) for s in numbers["statements"]]
    count = Counter(s.verdict for s in statements)
    text, verdict = (
        prose("paper"),
        {"holds": count[HOLDS], "built": count[BUILT], "part": count[IN_PART], "none": count[NOT]},
    )
    finding = text["finding"].format(n=len(statements), **verdict)
    for values in (s.numbers for s in statements if "mu_app" in s.numbers):
        finding += " " + text["mu_app"].format(**values)
    with _PUBLISHED.open(encoding="utf-8", newline="") as file:
        _, *published = csv.reader(file)
    missing = ", ".join(numbers.get("missing", []))
    how = text["how"].format(runs=len(FORCES) * len(VOLTAGES))
    grid = {key: np.array(values) for key, values in numbers.get("grid", {}).items()}
    path, caption = docs / "paper_friction.png", " ".join(text["caption"].split())
    gaps = text["gaps"].format(*(1e6 * grid["gaps_range"])) if grid else ""
    body = [
        f"**Not run yet:** {missing}." if missing else "",
        f"## Statements\n\n{verdicts(statements)}",
        f"## Sites of Fig. 9B\n\n{text['sites']}\n\n{named}" if (named := sites(statements)) else "",
        picture(path, (10, 4), lambda figure: friction.paint(figure, grid), caption) if grid else "",
        in_newtons(docs),
        f"## Published measurements\n\n{table(['quantity', 'from', 'to', 'unit (SI)', 'source'], published)}",
        gaps,
    ]
    names = ["paper", *(["newtons"] if body[4] else [])]
    return page(docs / "paper.md", "The paper, reproduced", finding, how, body, "make paper", found.made, names)
