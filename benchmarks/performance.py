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
from benchmarks.harness import Made, keep, kept, made, prose, table

FACTORS = (2.0, 1.4, 1.0, 0.7, 0.5, 0.31)  # on the element sizes of the default scene: 45 k to 1.16 M unknowns
ON_RANKS, REPEATS = (1.0, 0.5), 3
IDLE = 0.5  # load average above which a ratio of wall times is not measured
OPERATIONS = {"tangent": "tangent", "factorisation": "LU", "solution": "back-substitution", "residual": "residual"}
LAYER = "layer at the screen"
_LINK, _LATENCY = 10e9, 2e-6  # bytes/s and s, of a cluster's network
_MASSES = ("explicit, one density", "explicit, scaled mass")
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
    "explicit": lambda: child("explicit"),
    "run": lambda: child("run"),
}


def measure(names: Sequence[str], docs: Path) -> None:
    """Measure the named parts and keep them, the others staying as they are."""
    for name in names:
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


def cluster(one: Mapping[str, Any], ranks: int) -> tuple[float, float, float]:
    """Estimate what a rank sends in a factorisation and its residual (bytes), and the time this takes (s).

    Nested dissection of a plane mesh halves the area and divides the order of a front by the root of two from level
    to level. Half of a front is the contribution that is sent to the next one. A front of order m is shared by columns
    in panels of 64, each of which is sent to the others. The halo is the perimeter of a square of P2 nodes.

    Args:
        one: the costs of single operations with the order of the largest front.
        ranks: of MPI.
    """
    levels = int(np.log2(ranks))
    fronts = [one["front"] * 2 ** (-level / 2) for level in range(levels)]
    contribution = sum(8 * (m / 2) ** 2 for m in fronts) / 2
    panels = sum(8 * (m / 2) ** 2 for m in fronts)
    halo = 2 * 8 * 4 * np.sqrt(one["unknowns"] / 2 / ranks)
    messages = sum(m / 64 * np.log2(max(ranks / 2**level, 2)) for level, m in enumerate(fronts))
    sent = contribution + panels + halo
    return sent, halo, sent / _LINK + messages * _LATENCY


def _work(run: Mapping[str, Any]) -> str:
    path = sum(run["path"].values())
    rows = [
        ["LU factorisations, those of stability checks included", run["factorisations"]],
        ["of these with half of the finger, before the bone moves sideways", run["led"]],
        ["factorisations of the layer at the screen", run["calls"][LAYER]],
        ["Newton iterations", run["newton"]],
        ["accepted steps", run["steps"]],
        ["path, in units of one factorisation with its tangent", path / unit(run)],
        ["whole run with errors and pictures, in the same units", run["processor"] / unit(run)],
        ["path (processor s)", path],
        ["whole run (processor s)", run["processor"]],
        ["one factorisation with its tangent (processor s)", unit(run)],
    ]
    return table(["default scene", "measured"], rows)


def _parts(run: Mapping[str, Any]) -> str:
    whole = sum(run["path"].values())
    rows = [
        [name, run["calls"].get(name), f"{100 * seconds / whole:.1f} %", f"{seconds:.1f}"]
        for name, seconds in sorted(run["path"].items(), key=lambda item: -item[1])
    ]
    rows.append(["path", None, "100 %", f"{whole:.1f}"])
    rows += [[f"{name} (not of the path)", None, f"{100 * s / whole:.1f} %", f"{s:.1f}"]
             for name, s in run["beside"].items()]  # fmt: skip
    return table(["part", "calls", "of the path", "processor s"], rows)


def _growth(sizes: Sequence[Mapping[str, Any]]) -> str:
    n = [size["unknowns"] for size in sizes]
    rows: list[list[Any]] = [
        [size["unknowns"], *(size["processor"][name] for name in OPERATIONS), _step(size), size["first"]]
        for size in sizes
    ]
    powers = [exponent(n, [row[k] for row in rows]) for k in range(1, len(rows[0]))]
    rows = [[*row, size["memory"] / 1e3] for row, size in zip(rows, sizes, strict=True)]
    rows.append(["exponent", *(f"{power:.2f}" for power in powers), f"{_memory(sizes):.2f}"])
    timed = [f"{words} (s)" for words in (*OPERATIONS.values(), "all four", "first LU, with analysis")]
    return table(["unknowns", *timed, "peak (GB)"], rows)


def _step(size: Mapping[str, Any]) -> float:
    """Return the processor seconds of one step of Newton's method with a tangent of its own."""
    return float(sum(size["processor"][name] for name in OPERATIONS))


def _memory(sizes: Sequence[Mapping[str, Any]]) -> float:
    """Return the exponent of the memory that the mesh adds to the program itself."""
    return exponent([size["unknowns"] for size in sizes], [size["memory"] - size["before"] for size in sizes])


def _two(sizes: Sequence[Mapping[str, Any]]) -> str:
    rows = []
    for size in sizes:
        one, two = size["1"], size["2"]
        step = [sum(each["wall"].values()) for each in (one, two)]
        ratios = [one["wall"][name] / two["wall"][name] for name in OPERATIONS]
        span = f"{min(size['ratios']):.2f} to {max(size['ratios']):.2f}"
        rows.append([one["unknowns"], faster(size), span, *ratios, step[0], step[1]])
    head = ["unknowns", "Newton step: times as fast", "in all runs", *OPERATIONS.values(), "1 rank (s)", "2 ranks (s)"]
    return table(head, rows)


def _cluster(sizes: Sequence[Mapping[str, Any]]) -> str:
    rows = []
    for one in (size for size in sizes if size["factor"] in ON_RANKS):
        for ranks in (2, 8, 64):
            sent, halo, seconds = cluster(one, ranks)
            work = sum(one["processor"].values()) / ranks
            rows.append([one["unknowns"], ranks, sent / 1e6, halo / 1e3, 1e3 * seconds, 1e3 * work])
    head = ["unknowns", "ranks", "sent a rank (MB)", "of it by a residual (kB)", "network (ms)", "work a rank (ms)"]
    return table(head, rows)


def worst(found: Mapping[str, Any], reference: Mapping[str, Any]) -> float:
    """Return the largest relative difference of contact forces and lengths, and of friction in the last state."""
    differences = np.abs(np.array(found["answers"]) / reference["answers"] - 1)
    differences[:-1, 1] = 0.0  # friction vanishes by symmetry before the slide
    return float(differences.max())


def _explicit(found: Mapping[str, Any], run: Mapping[str, Any]) -> str:
    rows, costs, finger = list[list[Any]](), list[list[Any]](), found["finger"]
    residuals = sum(run["path"].values()) / run["path"]["residual"] * run["calls"]["residual"]  # as long as the path
    for each in found["ridges"]:
        size, base = f"{1e6 * each['size']:g} µm", each["implicit"]
        rows.append([size, "implicit", base["steps"], base["iterations"], None, None, 1.0, base["seconds"]])
        for name, ran in zip(_MASSES, each["explicit"], strict=True):
            shares = [f"{100 * share:.2g} %" for share in (ran["ratio"], worst(ran, base))]
            times = ran["seconds"] / base["seconds"]
            rows.append([size, name, ran["steps"], ran["steps"], *shares, times, ran["seconds"]])
    for name, (low, high), ran in zip(_MASSES, finger["frequencies"], each["explicit"], strict=True):
        steps = 3 * ran["periods"] * np.pi * high / low / found["safety"]
        hours = steps * finger["residual"] / 3600
        costs.append([name, ran["periods"], high / low, f"{steps:.2g}", steps / residuals, hours])
    head = ["facets", "way", "steps", "iterations or residuals", "kinetic over strain energy", "largest difference"]
    far = ["default finger", "periods a load", "largest over least frequency", "steps", "over the path", "core hours"]
    text = prose("performance")["explicit"].format(**found)
    return f"{text}\n\n{table([*head, 'over implicit', 'processor s'], rows)}\n\n{table(far, costs)}"


def _origin(numbers: Mapping[str, Any]) -> str:
    by = {name: Made(**part["made"]) for name, part in numbers.items()}
    rows = [
        [name, f"{b.version}, {b.commit or b.source}", b.date, f"{numbers[name]['load']:.2f}"] for name, b in by.items()
    ]
    return table(["part", "version, commit or source", "date", "load average at its start"], rows)


def draw(docs: Path) -> Path:
    """Write docs/performance.md from docs/performance.json."""
    found, text = kept("performance", docs), prose("performance")
    of = {name: part["found"] for name, part in found.numbers.items()}
    run, sizes = of["run"], of["operations"]
    path, largest = sum(run["path"].values()), max(run["path"], key=run["path"].__getitem__)
    power = exponent([s["unknowns"] for s in sizes], [_step(s) for s in sizes])
    own = next(size["processor"] for size in sizes if size["factor"] == 1.0)
    saved = (own["tangent"] + own["factorisation"]) / (own["solution"] + own["residual"])
    finding = text["finding"].format(
        **run, units=path / unit(run), largest=largest, share=100 * run["path"][largest] / path, power=power
    )  # fmt: skip
    cold, warm = (of["compile"][state] for state in ("cold", "warm"))
    two = f"{text['ranks']}\n\n{_two(of['ranks'])}" if "ranks" in of else "Not measured: the machine was busy."
    body = [
        f"## Counts and ratios\n\n{_work(run)}",
        f"## Where the time goes\n\n{_parts(run)}",
        text["layer"].format(calls=run["calls"][LAYER], share=100 * run["path"][LAYER] / path),
        text["compile"].format(files=of["compile"]["files"], ratio=cold["seconds"] / unit(run), cold=cold, warm=warm),
        f"## How the cost grows\n\n{text['growth'].format(saved=saved)}\n\n{_growth(sizes)}",
        f"## Two ranks\n\n{two}",
        f"{text['cluster']}\n\n{_cluster(sizes)}\n\n{text['array']}",
        f"## Explicit dynamics\n\n{_explicit(of['explicit'], run)}",
        f"## Versions and load\n\n{_origin(found.numbers)}",
    ]
    file, command = docs / "performance.md", "make performance"
    return harness.page(file, "Performance", finding, text["how"], body, command, found.made, ["performance"])


def main(given: Sequence[str] | None = None) -> int:
    """Measure, keep and draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--part", action="append", choices=PARTS, help="measure this part alone; may be repeated")
    parser.add_argument("--docs", type=Path, default=harness.DOCS, help="folder of the page and its numbers")
    parser.add_argument("--draw", action="store_true", help="measure nothing, draw the page from the kept numbers")
    args = parser.parse_args(given)
    if not args.draw:
        measure(args.part or list(PARTS), args.docs)
    print(draw(args.docs))
    return 0


if __name__ == "__main__":
    sys.exit(main())
