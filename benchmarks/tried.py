"""Other constants of the solver on the default scene: the part "tried" of benchmarks/performance.py.

Counts and answers do not depend on the machine's load, so that two runs go at a time.
"""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from benchmarks.harness import table

Numbers = dict[str, Any]
NOW = "as it is"
VARIANTS: dict[str, Sequence[str]] = {
    NOW: [],
    "end the first solve of a load at 1e-5 of the force scale out of balance, not 1e-3": ["coupling._FIRST.most=1e-5"],
    "at 1e-2": ["coupling._FIRST.most=1e-2"],
    "end the later ones at 0.1 of what the air gaps' change brought, not 0.03": ["coupling._LATER.part=0.1"],
    "at 0.25": ["coupling._LATER.part=0.25"],
    "give up after 1 iteration without progress where a ridge lets go, not 2": ["coupling._HASTE=1"],
    "after 4": ["coupling._HASTE=4"],
    "keep a factorisation while the residual falls to 0.3 an iteration, not 0.4": ["iteration._CONTRACTS=0.3"],
    "to 0.6": ["iteration._CONTRACTS=0.6"],
    "balance the layer to 0.05 of the last residual, not 0.005": ["iteration._REST=0.05"],
    "to 0.0005": ["iteration._REST=0.0005"],
    "skin within half a facet of the screen in the layer, not one": ["skin_layer._NEAR=0.5", "skin_layer._MARGIN=1"],
    "within two facets": ["skin_layer._NEAR=2", "skin_layer._MARGIN=4"],
    "drive open skin 10 µm deep in a first step, not 1 µm": ["iteration._DEEPEST=1e-5"],
    "accelerate by the last 3 differences, not 6": ["anderson._DEPTH=3"],
    "by the last 12": ["anderson._DEPTH=12"],
    "close the air gap of a ridge that comes down by half at a time, not a third": ["secant._DOWN=0.5"],
    "steps of the force half as long again": ["continuation._FORCE=0.2"],
    "three times as long": ["continuation._FORCE=0.402"],
    "the voltage in one step, not two": ["continuation._VOLTAGE=1"],
    "steps of the slide of 60 µm, not 120 µm": ["continuation._SLIDE=60e-6"],
    "of 180 µm": ["continuation._SLIDE=180e-6"],
    "of 240 µm": ["continuation._SLIDE=240e-6"],
}
_AT_A_TIME = 2
_COUNTS = ("factorisations", "newton", "rounds", "steps")
_SAME = 5e-9  # relative difference of an answer that is shown as none


def measure(child: Callable[..., Numbers]) -> dict[str, Numbers]:
    """Return counts and answers of each variant; ``child`` starts :mod:`benchmarks.measure` with words."""
    with ThreadPoolExecutor(_AT_A_TIME) as pool:
        found = pool.map(lambda constants: child("tried", *constants), VARIANTS.values())
        return dict(zip(VARIANTS, found, strict=True))


def rows(found: Mapping[str, Mapping[str, Any]]) -> str:
    """Return the table of what was tried."""
    now, lines = found[NOW]["answers"], list[list[Any]]()
    for words, each in found.items():
        differences = [each["answers"][name] / now[name] - 1 for name in now]
        shown = ["0" if abs(d) < _SAME else f"{100 * d:+.1g} %" for d in differences]
        lines.append([words, *(each[name] for name in _COUNTS), *(shown if words != NOW else ["–"] * len(shown))])
    head = ["change", "factorisations", "Newton iterations", "rounds over the air gaps", "steps"]
    return table([*head, *(f"change of the {name}" for name in now)], lines)
