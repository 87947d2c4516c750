"""Where the solver converges, and at what cost: single runs of a layered strip, and random scenes of the whole finger.

environment/run python3 -m benchmarks.stability [--part single | random | fingers] [--jobs 2] [--draw]

Each run has a process of its own and is kept in results/stability; after a change of the solver delete that folder.
Writes docs/stability.json, and from it docs/performance.md. The part ``fingers``, hours of processor time, is run only
where it is asked for: fingers that people have under random loads, whose table it prints.
"""

import argparse
import json
import sys
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.harness import keep, kept, made, main, page, run, solve, table
from benchmarks.stability.solve import Case
from fingerpad.runs.batch import Summary
from fingerpad.scene import Scene, from_data

COUNT, SEED = 20, 20  # random scenes
FORMULATIONS = ("penalty", "nitsche", "augmented")
LIMIT = 180.0  # s of processor time of a run
FINGERS, FINGER_LIMIT = ("fitted", "moist", "held"), 1800.0  # fingers that people have, and s of each of their runs
COARSE = {"contact": 20e-6, "interface": 120e-6, "growth": 0.5}  # their mesh
MESH = {"contact": 30e-6, "interface": 150e-6, "growth": 0.8}
SYMBOLS = {"converged": "● converged", "continuation": "▲ through continuation", "failed": "✕ failed"}
_MODULI = {"subcutis": 25e3, "dermis": 2.55e3, "viable_epidermis": 61.75e3, "stratum_corneum": 86.76e3}  # Pa
_SHOWN = "status reason load newton factorisations cutbacks penetration f_t contact_length f_ext".split()
_REFERENCED = "locking"
"""Group of single runs that have errors beside a reference."""
Row = Mapping[str, Any]


# -- single runs of a strip ----------------------------------------------------------------------------------
def named() -> dict[str, dict[str, Case]]:
    """Return the known failures by name, with the runs that reproduce them."""
    groups = tomllib.loads((Path(__file__).parent / "named.toml").read_text(encoding="utf-8"))
    return {
        title: {words: replace(Case(), **group.get("all", {}), **more) for words, more in group["runs"].items()}
        for title, group in groups.items()
    }


def single(args: argparse.Namespace) -> list[dict[str, Any]]:
    """Run the strips that are missing; return the rows of all."""
    groups = named()
    every = [case for group in groups.values() for case in group.values()]
    every += [case.reference for case in groups[_REFERENCED].values()]
    cases = {json.dumps(case.changed, ensure_ascii=False): case for case in every}
    data = {name: case.changed for name, case in cases.items()}
    found = solve("benchmarks.stability.solve", data, args.out / "map", args.jobs, LIMIT)
    of = {case: found[name] for name, case in cases.items()}
    return [{"case": case.changed} | _row(case, of) for case in of]


def _row(case: Case, of: Mapping[Case, dict[str, Any]]) -> dict[str, Any]:
    """Return what the page shows of a case; relative errors, with their signs, where its reference was found, too."""
    own, finest = of[case], of.get(case.reference)
    if "failure" in own:
        return {"status": "failed", "reason": own["failure"]}
    row = {name: own[name] for name in _SHOWN}
    if finest is None or "failed" in (own["status"], finest.get("status", "failed")):
        return row
    compared = {"f_t": case.slide, "contact_length": True, "f_ext": case.indentation}
    names = [name for name, shown in compared.items() if shown and finest[name]]
    return row | {f"error_{name}": (own[name] - finest[name]) / abs(finest[name]) for name in names}


# -- random scenes of the whole finger -----------------------------------------------------------------------
def drawn(number: int) -> dict[str, Any]:
    """Return the physical parameters of a scene; force and friction coefficient are evenly spread on a logarithm.

    Args:
        number: of the scene, from 0; even ones have the paper's printed exponent, odd ones that of Abaqus.
    """

    def digits(value: float) -> float:
        return float(f"{value:.3g}")

    chance = np.random.default_rng([SEED, number])
    force, friction = (digits(a * (b / a) ** chance.random()) for a, b in ((2.0, 200.0), (0.05, 1.0)))
    voltage = digits(300 * chance.random())
    layers = {layer: {"shear_modulus": digits(g * chance.uniform(0.7, 1.3))} for layer, g in _MODULI.items()}
    lengths = {"h_rms": 3.1e-6, "wavelength": 100e-6}
    return {
        "f_ext": force,
        "voltage": voltage,
        "friction": friction,
        "materials": {**layers, "exponent": ("printed", "abaqus")[number % 2]},
        "roughness": {name: digits(value * chance.uniform(0.6, 1.4)) for name, value in lengths.items()},
    }


def random(args: argparse.Namespace) -> dict[str, Any]:
    """Run the scenes that are missing; return the rows of all, and by which version they were made."""
    quick: dict[str, Any] = {"mesh": MESH, "output": {"receptors": False, "errors": False}}
    keys = {f"scene {k}, {name}": (k, name) for name in FORMULATIONS for k in range(COUNT)}
    asked: dict[str, Scene] = {
        text: from_data(drawn(k) | quick | {"contact": {"formulation": name}}) for text, (k, name) in keys.items()
    }
    found = run(asked, args, LIMIT)
    rows = [{"number": k, "formulation": name} | summed(found[text]) for text, (k, name) in keys.items()]
    by = made(found.values())
    return {"made": f"version {by.version} of {by.date} (source {by.source})", "runs": rows}


def load(number: int) -> dict[str, float]:
    """Return a random load: a force of 10 to 150 N/m, evenly spread on a logarithm, and a voltage of 0 to 200 V."""
    chance = np.random.default_rng([SEED, number])
    return {"f_ext": float(f"{10 * 15 ** chance.random():.3g}"), "voltage": float(f"{200 * chance.random():.3g}")}


def fingers(args: argparse.Namespace) -> list[dict[str, Any]]:
    """Run the loads that are missing; print how they ended, finger by finger, and return the rows of all."""
    quick = {"mesh": COARSE, "output": {"receptors": False, "errors": False}}
    keys = {f"{name} {k}": (name, k) for name in FINGERS for k in range(COUNT)}
    found = run({text: from_data({"finger": name, **load(k), **quick}) for text, (name, k) in keys.items()}, args,
                FINGER_LIMIT)  # fmt: skip
    rows = [
        {"finger": name, **load(k), **summed(found[text]), "failure": found[text].get("failure", "")}
        for text, (name, k) in keys.items()
    ]
    lines = []
    for name in FINGERS:
        mine = [row for row in rows if row["finger"] == name]
        work = [row["factorisations"] for row in mine if row["full_slip"]]
        ends = [len(work), sum(not row["full_slip"] and bool(row["failure"]) for row in mine), len(mine)]
        lines.append([name, *ends, np.median(work) if work else None, max(work, default=None)])
    print(table(["finger", "full slip", "a sentence", "of", "median factorisations", "most"], lines))
    return rows


def summed(summary: Summary) -> dict[str, Any]:
    """Return what the page shows of a run; factorisations are those of restarts too."""
    again = summary.get("restarts", [])
    work = sum(restart["factorisations"] for restart in again)
    return {"full_slip": bool(summary.get("full_slip")), "factorisations": summary.get("factorisations", 0) + work}


# -- page ----------------------------------------------------------------------------------------------------
def percent(value: float | None) -> str | None:
    """Return a relative number as per cent; below a millionth it is zero."""
    if value is None:
        return None
    return "0" if abs(value) < 1e-6 else f"{100 * value:.2g}" if abs(value) < 1 else f"{100 * value:.0f}"


_COLUMNS = ["run", "outcome", "load", "iterations", "factorisations", "cut steps",
            "penetration (nm)", "f_T (N/m)", "contact length (µm)"]  # fmt: skip
_ERRORS = ["error in f_T (%)", "error in contact length (%)", "normal force (N/m)", "error in it (%)"]


def _group(title: str, cases: Mapping[str, Case], rows: Mapping[str, Row]) -> str:
    """Return a group of runs as a table, one a row."""
    lines = []
    for words, o in ((words, rows[_key(case.changed)]) for words, case in cases.items()):
        because = f": {o['reason']}" if o["status"] == "failed" else ""
        counts = [o.get(name) for name in ("load", "newton", "factorisations", "cutbacks")]
        sizes = [f"{o.get('penetration', 0) * 1e9:.3g}", o.get("f_t"), f"{o.get('contact_length', 0) * 1e6:.2f}"]
        f_t, length, f_ext = (percent(o.get(f"error_{name}")) for name in ("f_t", "contact_length", "f_ext"))
        lines.append([words, SYMBOLS[o["status"]] + because, *counts, *sizes])
        lines[-1] += [f_t, length, o.get("f_ext"), f_ext] if title == _REFERENCED else []
    return table(_COLUMNS + _ERRORS * (title == _REFERENCED), lines)


def _key(changed: Mapping[str, Any]) -> str:
    return json.dumps(changed, sort_keys=True)


def _full_slips(runs: Iterable[Row], formulation: str) -> str:
    """Return how many of the random scenes a formulation leads to full slip, on whatever elements."""
    ends = [row["full_slip"] for row in runs if row["formulation"] == formulation]
    return f"{sum(ends)} of {len(ends)}"


def dearer(runs: Iterable[Row], formulation: str) -> float:
    """Return a formulation's factorisations over the penalty's, in the random scenes that both lead to full slip."""
    work = {(row["formulation"], row["number"]): row["factorisations"] for row in runs if row["full_slip"]}
    both = [number for name, number in work if name == formulation and ("penalty", number) in work]
    return sum(work[formulation, k] for k in both) / max(sum(work["penalty", k] for k in both), 1)


def draw(docs: Path) -> Path:
    """Write docs/performance.md from docs/stability.json."""
    numbers = kept("stability", docs).numbers
    rows, runs = {_key(row["case"]): row for row in numbers["runs"]}, numbers["random"]["runs"]
    names = {
        "named": {title: _group(title, cases, rows) for title, cases in named().items()},
        "slips": {name: _full_slips(runs, name) for name in FORMULATIONS},
    }
    return page(docs, "stability", "environment/run python3 -m benchmarks.stability", globals() | names)


def compute(args: argparse.Namespace) -> None:
    """Run what is missing and keep its numbers."""
    for part, found in (("single", lambda: {"runs": single(args)}), ("random", lambda: {"random": random(args)})):
        if args.part in (None, part):
            old = kept("stability", args.docs)
            keep("stability", old.numbers | found(), made() if part == "single" else old.made, args.docs)
    if args.part == "fingers":
        old = kept("stability", args.docs)
        keep("stability", old.numbers | {"fingers": fingers(args)}, old.made, args.docs)


if __name__ == "__main__":
    alone = {"choices": ("single", "random", "fingers"), "help": "run this part alone, and keep the other's numbers"}
    sys.exit(main(__doc__, compute, draw, out="stability", part=alone))
