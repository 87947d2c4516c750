"""The printed numbers of the paper and its central claim, beside what this model computes.

environment/run python3 -m benchmarks.paper [--jobs 2] [--draw]

The limit of µ_app is that of docs/errors.json (make chart). Runs are kept in results/traces by a hash of their
parameters and shared with the other studies: started again, only what is missing or changed is run. Writes
docs/paper.json and docs/paper_figures.json, and from them docs/paper.md and its pictures.
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import newtons
from benchmarks.errors import known
from benchmarks.harness import cells, keep, kept, made, main, page, run
from benchmarks.paper import fields, friction, scenes, states
from benchmarks.paper.figures import FIGURES
from benchmarks.paper.figures import draw as drawn
from benchmarks.paper.statement import BUILT, HOLDS, IN_PART, NOT, Statement
from benchmarks.runs import FORCES, VOLTAGES, Run

_LIMIT = 3600.0  # s of processor time for one run; the sine takes longest


def collect(out: Path) -> dict[str, Any]:
    """Return the numbers of the page from its runs; FileNotFoundError where one is missing."""
    runs = {pair: Run(scene, out) for pair, scene in scenes.grid().items()}
    gathered, high = friction.gather(runs), runs[scenes.MAP, 200.0]
    statements = [
        *fields.microscale(),
        *friction.statements(gathered, known()["full_slip_mu_app"]),
        fields.sine(Run(scenes.sine(), out)),
        fields.claim(high, Run(scenes.rougher(friction.mu_app(high)), out)),
    ]
    seconds = [float(run.summary["processor_seconds"]) for run in runs.values()]
    grid = {name: values.tolist() for name, values in gathered.items()}
    return {"statements": [asdict(each) for each in statements], "seconds": seconds, "grid": grid}


def compute(args: argparse.Namespace) -> None:
    """Run what is missing and keep its numbers."""
    named = {f"{f:g} N/m, {u:g} V": scene for (f, u), scene in scenes.grid().items()}
    summaries = run(named | {"sine": scenes.sine()}, args, _LIMIT)
    high = Run(scenes.grid()[scenes.MAP, 200.0], args.out)
    summaries |= run({"friction": scenes.rougher(friction.mu_app(high))}, args, _LIMIT)
    by = made(summaries.values())
    keep("paper", collect(args.out), by, args.docs)
    shown = {name: figure.numbers(args.out, args.jobs) for name, figure in FIGURES.items() if not figure.of_loads}
    keep("paper_figures", shown, by, args.docs)


# -- page ----------------------------------------------------------------------------------------------------
def _sites(statements: Sequence[Statement]) -> list[tuple[str, int, float, float, float]]:
    """Return the sites of Fig. 9B: their words, the paper's number, and place, ridge and ratio of SED here."""
    named = [(*name.rpartition(" ")[::2], ratio) for s in statements for name, ratio in s.numbers.items()]
    there = [(kind, float(ridge), ratio) for kind, ridge, ratio in named if kind in scenes.NAMED]
    start = next((ridge for kind, ridge, _ in there if kind == "highest"), 0.0)
    return [
        (kind + " at 0 V" * (kind == "highest"), scenes.NAMED[kind], ridge - start, ridge, ratio)
        for kind, ridge, ratio in there
    ]


def off(grid: friction.Grid) -> dict[str, float]:
    """Return by how much the grid's run at the load of the known limits differs from them (%)."""
    at = int(np.flatnonzero(grid["f_ext"] == scenes.MAP)[0]), int(np.flatnonzero(grid["voltage"] == scenes.PEAK)[0])
    names = [f"{state}_{name}" for state in friction.STATES for name in ("f_t", "contact_length")][1:]
    return {name: float(100 * (grid[name][at] / known()[name].value - 1)) for name in names}


def _of_figure(name: str, statements: Sequence[Statement]) -> list[Statement]:
    """Return the statements about a figure; those about the whole of one in two parts are with the second part."""
    own = [(s, s.figure.partition(",")[0]) for s in statements]
    return [s for s, of in own if of == name or (of.rstrip("ABC") == name and of not in FIGURES) or f"{of}B" == name]


def lines(name: str, statements: Sequence[Statement]) -> list[str]:
    """Return the rows of a figure's table, or of section 5: the paper, this model and the verdict."""
    mine = [s for s in statements if s.figure.startswith(name)] if name == "section" else _of_figure(name, statements)
    because = [f": {s.why}" if s.verdict != HOLDS and s.why else "" for s in mine]
    return [cells(s.paper, s.ours, f"**{s.verdict}**{why}") for s, why in zip(mine, because, strict=True)]


def pictures(loads: dict[str, Any], docs: Path) -> None:
    """Draw the figures whose numbers are kept."""
    there = kept("paper_figures", docs).numbers
    for name, figure in FIGURES.items():
        drawn(figure, loads if figure.of_loads else there[name], docs / f"paper_{name}.png")


def draw(docs: Path) -> Path:
    """Draw the page and its pictures from docs/paper.json, paper_figures.json and, in newtons, newtons.json."""
    numbers, sums = kept("paper", docs).numbers, kept("newtons", docs).numbers
    statements = [Statement(**s) for s in numbers["statements"]]
    pictures(numbers["grid"], docs)
    newtons.picture(sums, docs)
    names = newtons.compared(sums) | {
        "statements": statements,
        "count": [[s.verdict for s in statements].count(verdict) for verdict in (HOLDS, BUILT, IN_PART, NOT)],
        "runs": len(FORCES) * len(VOLTAGES),
        "limit": next(s.numbers["mu_app"] for s in statements if "mu_app" in s.numbers),
        "lines": lambda name: lines(name, statements),
        "sites": _sites(statements),
        "grid": (grid := {key: np.array(values) for key, values in numbers["grid"].items()}),
        "off": off(grid),
        "states": states.shown(docs),
    }
    return page(docs, "paper", "make paper", globals() | names, "paper_figures", "newtons", "paper_states")


if __name__ == "__main__":
    sys.exit(main(__doc__, compute, draw))
