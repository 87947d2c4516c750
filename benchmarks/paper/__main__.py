"""The paper's statements on friction, contact and energy density, beside what this model computes.

environment/run python3 -m benchmarks.paper [--jobs 2] [--contact-size 10e-6] [--measured FILE.csv] [--draw]

Runs are kept in results/traces by a hash of their parameters and shared with the other studies: started again, only
what is missing or changed is run. Writes docs/paper.json, and from it docs/paper.md and its pictures. Ends with 1 if a
run is missing, or if a number is not the one that the page had.
"""

import sys
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.harness import keep, kept, made, moved, parser, run
from benchmarks.paper import friction, micro, page, scenes, section, sed
from benchmarks.paper.statement import Statement
from benchmarks.runs import Run
from fingerpad.cli.arguments import positive
from fingerpad.model.check import check

_LIMIT = 3600.0  # s of processor time for one run; the sine takes longest


def _rises(run: Run) -> float:
    """Return in how many steps from normal contact to full slip the contact length rises."""
    return float((np.diff(run.steps["contact_length"][run.normal : run.slip + 1]) > 0).sum())


def mu_app(high: Run) -> float:
    """Return the apparent friction coefficient of a run."""
    return float(high.steps["mu_app"][high.slip])


def collect(out: Path, size: float) -> dict[str, Any]:
    """Return the numbers of the page from the runs there are; what is missing is named."""
    numbers: dict[str, Any] = {"contact_size": size, "missing": [], "statements": []}
    grid = scenes.grid(size)

    def at(force: float, voltage: float) -> Run:
        return Run(grid[force, voltage], out)

    def of_grid() -> list[Statement]:
        runs = {pair: at(*pair) for pair in grid}
        gathered = friction.gather(runs)
        numbers["grid"] = {name: values.tolist() for name, values in gathered.items()}
        rises = {f"{u:g}": _rises(runs[scenes.TRANSITION, u]) for u in gathered["voltage"]}
        return friction.statements(gathered, rises)

    def of_section() -> list[Statement]:
        numbers["section"] = section.gather(at(*scenes.SECTION))
        return section.statements(at(*scenes.SECTION))

    def of_claim() -> list[Statement]:
        high = at(scenes.MAP, 200.0)
        numbers["sites"] = sed.gather(high, Run(scenes.rougher(size, mu_app(high)), out))
        return [sed.claim_statement(numbers["sites"])]

    parts: dict[str, Callable[[], list[Statement]]] = {
        "Fig. 2": of_section,
        "Figs. 4 and 5": micro.statements,
        "Figs. 6 to 8": of_grid,
        "Fig. 9A": lambda: sed.statements(at(scenes.MAP, 200.0)),
        "Fig. 9B": lambda: sed.sine_statements(Run(scenes.sine(size), out)),
        "section 5": of_claim,
    }
    for name, part in parts.items():
        try:
            numbers["statements"] += map(asdict, part())
        except FileNotFoundError as missing:
            print(f"missing: {name}, {missing}")
            numbers["missing"].append(name)
    return numbers


def changes(before: dict[str, Any], after: dict[str, Any]) -> list[str]:
    """Return which numbers of statements moved, at the same contact size."""
    if before["contact_size"] != after["contact_size"]:
        return []
    old, new = ({s["paper"]: s["numbers"] for s in numbers["statements"]} for numbers in (before, after))
    return moved(old, new)


def main(given: Sequence[str] | None = None) -> int:
    """Run what is missing, keep its numbers and draw the page."""
    asked = parser(__doc__)
    asked.add_argument("--contact-size", type=positive(float), default=scenes.SIZE, help="m")
    asked.add_argument("--measured", type=Path, help="CSV of measured friction, drawn beside the model's")
    args = asked.parse_args(given)
    size, wrong = args.contact_size, list[str]()
    try:
        check(scenes.grid(size)[scenes.SECTION])
        measured = friction.Measured.read(args.measured) if args.measured else None
    except (OSError, ValueError) as error:
        asked.error(str(error))
    if not args.draw:
        named = {f"{f:g} N/m, {u:g} V": scene for (f, u), scene in scenes.grid(size).items()}
        summaries = run({"sine": scenes.sine(size)} | named, args, _LIMIT)
        try:
            high = Run(scenes.grid(size)[scenes.MAP, 200.0], args.out)
            summaries |= run({"friction": scenes.rougher(size, mu_app(high))}, args, _LIMIT)
        except FileNotFoundError as missing:
            print(f"the run without voltage but with more friction cannot be made: {missing}")
        numbers = collect(args.out, size)
        if (args.docs / "paper.json").exists():
            wrong = [f"moved: {words}" for words in changes(kept("paper", args.docs).numbers, numbers)]
        wrong += numbers["missing"]
        keep("paper", numbers, made(summaries.values()), args.docs)
    print("\n".join([*wrong, str(page.draw(args.docs, measured))]))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
