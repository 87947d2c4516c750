"""What was asked of speed and accuracy, beside what the kept numbers of the pages have reached.

python3 -m benchmarks.targets     prints the table; make performance and docs/errors.md have it too

Each figure comes from the numbers that a command of this repository keeps in docs/; one that no command has computed
yet is a dash. A figure is of the program of its date, the oldest one where two pages have a part in it.
"""

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import errors, harness, two_meshes
from benchmarks.paper import states
from benchmarks.peers import compared as peers

Numbers = Callable[[str], Any]
"""Returns the kept numbers of a page by its name."""
PATHS = 40  # of the paper's grid
SCENES = 20  # random ones of the stability page
_AT_A_TIME, _MINUTE = 2, 60.0  # runs, on two cores; s


@dataclass(frozen=True)
class Target:
    """A figure, its bound, and how it is found."""

    words: str
    asked: float
    unit: str
    command: str
    found: Callable[[Numbers], float]
    at_least: bool = False


@dataclass(frozen=True)
class Row:
    """A line of the table: figure, what was asked and reached, whether that is met, and by which command when."""

    words: str
    asked: str
    reached: str
    met: str
    of: str
    """Oldest date of the numbers."""
    command: str


# -- figures -------------------------------------------------------------------------------------------------
def _error(kind: str) -> Callable[[Numbers], float]:
    """Return what finds the largest error (%) of the default scene's quantities of a kind."""

    def found(of: Numbers) -> float:
        ends, default = of("errors")["reference"], of("errors")["default"]
        return max(100 * abs(default[name] / end["value"] - 1) for name, end in ends.items() if kind in name)

    return found


def _indented(of: Numbers) -> float:
    """Return the error (%) of the force at a given indentation."""
    value, end = errors.indented(of("errors")["pressed"])
    return 100 * abs(value / end.value - 1)


def _covered(of: Numbers) -> float:
    """Return the least share (%) of the kinds' known errors that the estimated ones cover."""
    known = two_meshes.cases(of("two_meshes"))
    return 100 * min(covered / n for n, covered in (two_meshes.coverage(known, kind) for kind in two_meshes.KINDS))


def _minutes(name: str, seconds: str, loads: str) -> Callable[[Numbers], float]:
    """Return what finds the minutes of the paper's grid, two loads at a time, by kept processor seconds."""

    def found(of: Numbers) -> float:
        numbers = of(name)
        if len(numbers[loads]) < PATHS:
            raise ValueError(f"{len(numbers[loads])} loads are kept of {PATHS}")
        return float(np.sum(numbers[seconds])) / _AT_A_TIME / _MINUTE

    return found


def _further(key: str) -> Callable[[Numbers], float]:
    """Return what finds the mean of a cost of the states of the sweep that no path leads to."""
    return lambda of: float(np.mean([row[key] for row in of("paper_states")["default"] if row["reached"] != "path"]))


def _processor(of: Numbers) -> float:
    """Return the processor time (s) of a whole run."""
    return float(of("performance")["run"]["found"]["processor"])


def _slips(of: Numbers) -> float:
    runs = of("stability")["random"]["runs"]
    return float(sum(row["full_slip"] for row in runs if row["formulation"] == "penalty"))


_CHART, _STATES, _RANDOM = "make chart", "python3 -m benchmarks.paper.states", "python3 -m benchmarks.stability"
_PEERS = "python3 -m benchmarks.peers equal"
_OF_STATES = "paper_states"
TARGETS = (
    Target("whole run with errors and pictures, processor s", 18, "", "make performance", _processor),
    Target("µ_app at full slip, known error", 0.05, "%", _CHART, _error("mu_app")),
    Target("force at a given indentation, known error", 0.1, "%", _CHART, _indented),
    Target("contact lengths, largest known error", 0.25, "%", _CHART, _error("contact_length")),
    Target("highest pressure at full slip, known error", 0.5, "%", _CHART, _error("p_max")),
    Target("saw of the pressure at full slip, rms over the peak", 0.5, "%", _CHART,
           lambda of: 100 * of("errors")["saw"]),
    Target("energy densities at the sites, largest known error", 1, "%", _CHART, _error("sed_")),
    Target("unknowns of the path", 40_000, "", _CHART, lambda of: of("errors")["unknowns_path"]),
    Target("printed errors that cover the known ones, least kind", 95, "%", "make calibration", _covered, True),
    Target("one ridge beside plain dolfinx at equal error, times as fast", 4, "", _PEERS,
           lambda of: min(peers.words(of("peers")["equal"]["rows"])["reached"]), True),
    Target("40 paths of the paper's grid, two at a time, min", 5, "", "make paper",
           _minutes("paper", "seconds", "seconds")),
    Target("the same on elements twice as large", 5, "", _STATES,
           _minutes(_OF_STATES, "seconds_of_paths", "seconds_of_paths")),
    Target("40 states of the paper's grid, two at a time, min", 3, "", _STATES,
           _minutes(_OF_STATES, "seconds_of_sweep", "default")),
    Target("factorisations of a further state of a sweep, mean", 5, "", _STATES, _further("factorisations")),
    Target("processor time of a further state over that of a run", 1 / 15, "", _STATES,
           lambda of: _further("processor_seconds")(of) / _processor(of)),
    Target("states equal to the path's or listed with both values", PATHS, "", _STATES,
           lambda of: sum(each.alike for each in states.compared(of(_OF_STATES))), True),
    Target("random scenes that reach full slip", SCENES, "", _RANDOM, _slips, True),
)  # fmt: skip


# -- page ----------------------------------------------------------------------------------------------------
def rows(docs: Path = harness.DOCS) -> list[Row]:
    """Return the table from the kept numbers of a folder."""
    return [_row(target, docs) for target in TARGETS]


def _row(target: Target, docs: Path) -> Row:
    bound = f"{'≥' if target.at_least else '≤'} {_text(target.asked, target.unit)}"
    dates = list[str]()

    def of(name: str) -> Any:
        kept = harness.kept(name, docs)
        dates.append(kept.made.date)
        return kept.numbers

    try:
        value = float(target.found(of))
    except (FileNotFoundError, KeyError, ValueError, ZeroDivisionError):
        return Row(target.words, bound, "–", "–", "–", target.command)
    met = value >= target.asked if target.at_least else value <= target.asked
    return Row(target.words, bound, _text(value, target.unit), "yes" if met else "no", min(dates), target.command)


def _text(value: float, unit: str) -> str:
    """Return a value with its unit; whole numbers whole."""
    return f"{value:.0f}" if value >= 100 else f"{value:.2g} {unit}".rstrip()


def text(docs: Path = harness.DOCS) -> str:
    """Return the table as Markdown."""
    head = ["figure", "asked", "reached", "met", "of", "command"]
    return harness.table(head, [list(vars(row).values()) for row in rows(docs)])


def main() -> int:
    """Print the table."""
    print(text())
    return 0


if __name__ == "__main__":
    sys.exit(main())
