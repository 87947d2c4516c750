"""What speed was asked for, beside what was measured: the table at the head of docs/performance.md.

Most numbers are of the page itself; those of runs over the paper's loads and of other programs are of their own pages.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from benchmarks.harness import kept, table


class Target(NamedTuple):
    """A number that was asked for."""

    what: str
    sign: str
    """``≤`` or ``≥``."""
    asked: float
    measured: float | None
    """None where it was not measured."""
    why: str = ""
    """Heading of the text in benchmarks/prose/performance.md that says why it is missed, where it is."""

    @property
    def reached(self) -> bool:
        """Whether the number was measured, and is on the right side."""
        if self.measured is None:
            return False
        return self.measured <= self.asked if self.sign == "≤" else self.measured >= self.asked


def targets(of: Mapping[str, Any], path: Mapping[str, float], docs: Path) -> list[Target]:
    """Return all targets.

    Args:
        of: parts of docs/performance.json by name.
        path: of the default scene's path: ``seconds``, ``units``, and the exponents ``time`` and ``memory``.
        docs: folder of the kept numbers.
    """
    run, paper = of["run"], kept("paper", docs).numbers.get("minutes") or {}
    grid = paper.get("grid")
    models = kept("models", docs).numbers["scenes"].values()
    speed = kept("peers", docs).numbers["speed"]["meshes"]
    found = [
        Target("LU factorisations of the default path", "≤", 120, run["factorisations"]),
        Target("Newton iterations of it", "≤", 400, run["newton"]),
        Target("the path, in factorisations with their tangents", "≤", 150, path["units"], "missed-units"),
        Target("the path (processor s)", "≤", 60, path["seconds"]),
        Target("whole run with errors and pictures (processor s)", "≤", 90, run["processor"]),
        Target("compile of all forms (processor s)", "≤", 30, of["compile"]["cold"]["seconds"]),
        Target(f"the paper's 40 runs on facets of 5 µm, {paper.get('at a time', 2)} at a time (min)", "≤", 30, grid),
    ]
    two: Sequence[float | None] = [float(np.median(size["ratios"])) for size in of.get("ranks", ())] or [None, None]
    for asked, words, times in zip((1.5, 1.6), ("the default mesh", "elements of half the size"), two, strict=True):
        found.append(Target(f"a Newton step on two ranks, {words}: times as fast", "≥", asked, times, "missed-ranks"))
    found += [
        Target("exponent of a Newton step's time over the unknowns", "≤", 1.15, path["time"]),
        Target("exponent of its memory", "≤", 1.1, path["memory"]),
    ]
    for words, model in (("with facets of 10 µm", "full"), ("by the smooth finger's model", "smooth")):
        reached = sum(bool(scene[model].get("summary", {}).get("full_slip")) for scene in models)
        found.append(Target(f"runs of the paper's 40 that reach full slip {words}", "≥", 40, reached))
    for mesh in speed:
        seconds = {row["program"]: row["seconds"] for row in mesh["rows"]}
        ratio = seconds["plain dolfinx"] / seconds["fingerpad"]
        what = f"one ridge, {mesh['size']:g} µm: a plain script's time over fingerpad's"
        found.append(Target(what, "≥", 2, ratio, "missed-script"))
    return found


def reasons(found: Sequence[Target]) -> list[str]:
    """Return the headings of the texts that say why targets are missed, each once."""
    return list(dict.fromkeys(target.why for target in found if target.why and not target.reached))


def rows(found: Sequence[Target]) -> str:
    """Return the table."""
    lines = [[t.what, f"{t.sign} {t.asked:g}", _number(t.measured), "yes" if t.reached else "no"] for t in found]
    return table(["what", "asked for", "measured", "reached"], lines)


def _number(value: float | None) -> str:
    return "not measured" if value is None else str(value) if isinstance(value, int) else f"{value:.3g}"
