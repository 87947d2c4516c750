"""Where the time of the default scene goes, how it grows with the mesh, and what a second rank brings.

environment/run python3 -m benchmarks.performance [--part NAME ...] [--draw]     also: make performance; half an hour

Each part is measured in processes of its own and kept with the version and the load average of its start. Counts and
ratios are the same on a busy machine; the part "ranks" is refused on one. Writes docs/performance.json and the page.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import harness
from benchmarks.harness import keep, kept, made

FACTORS = (2.0, 1.4, 1.0, 0.7, 0.5, 0.31)  # on the element sizes of the default scene
ON_RANKS, REPEATS = (1.0, 0.5), 3
IDLE = 0.5  # load average above which a ratio of wall times is not measured
OPERATIONS = ("tangent", "factorisation", "solution", "residual")
LAYER = "layer at the screen"
Numbers = dict[str, Any]


# -- measurements --------------------------------------------------------------------------------------------
def child(*words: str, ranks: int = 1, cache: str = "") -> Numbers:
    """Return what :mod:`benchmarks.measure` prints, started with these words."""
    launcher = ["mpirun", "-n", str(ranks)] if ranks > 1 else []
    env = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    env |= {"XDG_CACHE_HOME": cache} if cache else {}
    command = [*launcher, sys.executable, "-m", "benchmarks.measure", *words]
    print("measured:", *words, f"on {ranks} rank" + "s" * (ranks > 1), flush=True)
    done = subprocess.run(command, env=env, cwd=harness.ROOT, stdout=subprocess.PIPE, text=True, check=True)
    return dict(json.loads(done.stdout.strip().splitlines()[-1]))


def _operations() -> list[Numbers]:
    return [child("operations", str(factor)) for factor in FACTORS]


def _ranks() -> list[Numbers]:
    if os.getloadavg()[0] > IDLE:
        raise BlockingIOError(f"the load average is {os.getloadavg()[0]:.2f}, above {IDLE}: two ranks are not timed")
    return [_middle([_pair(factor) for _ in range(REPEATS)]) for factor in ON_RANKS]


def _pair(factor: float) -> Numbers:
    """Return the costs of single operations on one rank and on two."""
    return {n: child("operations", str(factor), ranks=int(n)) for n in "12"}


def _middle(pairs: Sequence[Numbers]) -> Numbers:
    """Return the pair whose ratio of a Newton step is the median, with the ratios of all: the partition differs."""
    ordered = sorted(pairs, key=faster)
    return ordered[len(ordered) // 2] | {"ratios": [faster(pair) for pair in ordered]}


def faster(pair: Mapping[str, Any]) -> float:
    """Return how many times as fast a step of Newton's method is on two ranks."""
    one, two = (sum(pair[ranks]["wall"].values()) for ranks in "12")
    return float(one / two)


def _compile() -> Numbers:
    with tempfile.TemporaryDirectory() as cache:
        found = {state: child("compile", cache=cache) for state in ("cold", "warm")}
        return found | {"files": len(list(Path(cache).rglob("*.so")))}


# The ranks first: the load average is not yet this command's own.
PARTS = {
    "ranks": _ranks,
    "compile": _compile,
    "operations": _operations,
    "run": lambda: child("run"),
}


def measure(args: argparse.Namespace) -> None:
    """Measure the parts asked for, or all, and keep them, the others staying as they are."""
    docs = args.docs
    for name in args.part or PARTS:
        load, by = os.getloadavg()[0], made()
        try:
            part = {"load": load, "made": asdict(by), "found": PARTS[name]()}
        except BlockingIOError as refused:
            print(f"{name}: {refused}", file=sys.stderr)
            continue
        others = kept("performance", docs).numbers if (docs / "performance.json").exists() else {}
        keep("performance", others | {name: part}, by, docs)


# -- page ----------------------------------------------------------------------------------------------------
def exponent(x: Sequence[float], y: Sequence[float]) -> float:
    """Return the power with which y grows with x, by least squares of the logarithms."""
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])


def unit(run: Mapping[str, Any]) -> float:
    """Return the processor seconds of one factorisation with its tangent on the path of a run.

    It is one of the whole finger: those of the half that leads it until the bone moves sideways count half.
    """
    seconds, calls = run["path"], run["calls"]
    return float(sum(seconds[name] / (calls[name] - run["led"] / 2) for name in ("tangent", "factorisation")))


def _times(size: Mapping[str, Any]) -> list[float]:
    """Return the processor seconds of each operation, of one step of Newton's method and of the first factorisation."""
    each = [float(size["processor"][name]) for name in OPERATIONS]
    return [*each, sum(each), size["first"]]


def draw(docs: Path) -> Path:
    """Write docs/performance.md from docs/performance.json."""
    of = harness.Record({name: part["found"] for name, part in kept("performance", docs).numbers.items()})
    run, sizes = of["run"], of["operations"]
    unknowns = [size["unknowns"] for size in sizes]
    names = {
        "of": of, "run": run, "path": sum(run["path"].values()), "unit": unit(run), "times": _times,
        "powers": [exponent(unknowns, seconds) for seconds in zip(*map(_times, sizes), strict=True)],
        "memory": exponent(unknowns, [size["memory"] - size["before"] for size in sizes]),
    }  # fmt: skip
    return harness.page(docs, "performance", "make performance", globals() | names)


if __name__ == "__main__":
    alone = {"action": "append", "choices": PARTS, "help": "measure this part alone; may be repeated"}
    sys.exit(harness.main(__doc__, measure, draw, part=alone))
