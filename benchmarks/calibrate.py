"""Calibration of keys by synthetic tables: keys found again, cover of the regions, choice of laws, people held out.

environment/run python3 -m benchmarks.calibrate [--full] [--draw]     also: make calibrate

Writes docs/calibrate.json, and from it the numbers of docs/calibrate.md; some minutes. Tables are made by the closed
form from known values, with normal noise on logarithms, from seeds. ``--full`` computes those by full runs alone, of
some ten minutes, which are kept in results/traces.
"""

import argparse
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import fingerpad as fp
from benchmarks.harness import keep, kept, made, main, page, run
from fingerpad.measurements import prediction
from fingerpad.measurements.table import observations
from fingerpad.runs import batch
from fingerpad.slices.total import at_force, profile

NOISE, TABLES, CHOICES, PEOPLE = 0.03, 100, 10, 10
FORCES, VOLTAGES = (0.1, 0.3, 0.6, 1.0), (0.0, 60.0, 120.0, 200.0)  # N, V
QUANTITIES = ("friction force (N)", "gross area (m^2)", "air gap (m)")
SCENE = fp.Scene(force=0.5, friction={"law": "Derjaguin", "mu_f": 0.2, "tau_0": 4e3})
TRUTH = {  # of the five keys
    "friction.mu_f": 0.3, "friction.tau_0": 2.5e3, "roughness.h_rms": 3.8e-6, "electric.d_i": 1.5e-6,
    "slices.radius": 22e-3,
}  # fmt: skip
LAWS = {"Coulomb": {"friction": 0.3}, "shear stress": {"friction": {"law": "Derjaguin", "mu_f": 0.0, "tau_0": 9e3}}}
MADE = ((0.2, 3.4e-6), (0.25, 2.9e-6))  # friction and roughness.h_rms of the tables by full runs
FULL_FORCES, FULL_VOLTAGES, MESH = (0.1, 0.2, 0.4), (100.0, 200.0), {"contact": 20e-6, "receptor": 100e-6}
LIMIT = 3600.0  # s of processor time of a full run
SPREADS = {"friction": 0.4, "roughness.h_rms": 0.15}  # between people, of logarithms


def table(scene: fp.Scene, conditions: Any, quantities: Any, noise: float, rng: Any, **more: Any) -> pd.DataFrame:
    """Return a table of the closed form of a scene, with noise."""
    rows = pd.DataFrame(conditions, columns=["force (N)", "voltage (V)"]).assign(**{each: 1.0 for each in quantities})
    seen = observations(rows)
    values = np.exp(prediction.ClosedForm(scene, (), seen.rows, seen.state).rows(scene))
    values = values.reshape(len(rows), -1) * np.exp(noise * rng.normal(size=(len(rows), len(quantities))))
    return rows.assign(**dict(zip(quantities, values.T, strict=True)), **more)


def fitted(rows: pd.DataFrame, scene: fp.Scene, keys: Any, **more: Any) -> fp.Calibration:
    """Return the calibration of a table, without files."""
    return fp.calibrate(rows, scene, list(keys), out=None, **more)


def grid(forces: Any = FORCES, voltages: Any = VOLTAGES) -> list[tuple[float, float]]:
    """Return all pairs of force and voltage."""
    return [(force, voltage) for force in forces for voltage in voltages]


def _scene(values: dict[str, float], scene: fp.Scene = SCENE) -> fp.Scene:
    return prediction.with_values(scene, values)


def again() -> dict[str, float]:
    """Return the largest relative error of the five keys without noise."""
    rows = table(_scene(TRUTH), grid(), QUANTITIES, 0.0, np.random.default_rng(0))
    found = fitted(rows, SCENE, TRUTH).values.value
    return {key: float(found[key] / value - 1) for key, value in TRUTH.items()}


def cover(count: int = TABLES) -> dict[str, int]:
    """Return in how many tables with noise the regions contain the values that made them, by key."""
    inside = dict.fromkeys(TRUTH, 0)
    for seed in range(count):
        rows = table(_scene(TRUTH), grid(), QUANTITIES, NOISE, np.random.default_rng(seed))
        for key, v in fitted(rows, SCENE, TRUTH, evidence=False).values.iterrows():
            inside[key] += bool(v.low <= TRUTH[key] <= v.high)
    return inside


def choices(count: int = CHOICES) -> dict[str, int]:
    """Return for how many tables of each law it has less AICc than the other one, by eight forces without voltage."""
    found = dict.fromkeys(LAWS, 0)
    law: Any
    for name, law in LAWS.items():
        for seed in range(count):
            uncharged = grid(np.geomspace(0.1, 1.0, 8), (0.0,))
            rows = table(fp.Scene(force=0.5, **law), uncharged, QUANTITIES[:1], NOISE, np.random.default_rng(seed))
            laws = fitted(rows, fp.Scene(force=0.5), ["friction"]).evidence.set_index("name").AICc
            found[name] += bool(laws[list(LAWS)].idxmin() == name)
    return found


def people(seed: int = 60) -> pd.DataFrame:
    """Return a table of ten people at three forces and four voltages."""
    rng, tables = np.random.default_rng(seed), []
    for k in range(PEOPLE):
        own = {key: value * np.exp(rng.normal() * SPREADS[key]) for key, value in _typical().items()}
        conditions = grid((0.2, 0.5, 1.0), (0.0, 70.0, 140.0, 200.0))
        scene = _scene(own, fp.Scene(force=0.5))
        tables.append(table(scene, conditions, QUANTITIES[:1], NOISE, rng, participant=str(k + 1)))
    return pd.concat(tables, ignore_index=True)


def _typical() -> dict[str, float]:
    return {"friction": 0.3, "roughness.h_rms": 3.4e-6}


def held_out() -> dict[str, Any]:
    """Return how many rows of each held-out person are within their band, and the time of one calibration."""
    rows, inside, began = people(), list[int](), time.process_time()
    whole = fitted(rows, fp.Scene(force=0.5), SPREADS)
    seconds = time.process_time() - began
    for k in range(PEOPLE):
        found = fitted(rows, fp.Scene(force=0.5), SPREADS, hold_out={"participant": k + 1}, evidence=False).rows
        held = found[found.held_out]
        inside.append(int(held.measured.between(held.low, held.high).sum()))
    return {"inside": inside, "of": len(rows) // PEOPLE, "rows": len(rows), "seconds": seconds,
            "values": whole.values.reset_index(names="key").to_dict("records")}  # fmt: skip


def by_full_runs(args: argparse.Namespace) -> list[dict[str, Any]]:
    """Return regions from tables of friction forces by full runs, with noise, and how far the closed form is off.

    Without a voltage Coulomb's friction is the coefficient times the force in any model. The spread of a row has the
    noise and the known error of the closed form at the scene that a fit starts from.
    """
    found, start = [], fp.Scene(force=FULL_FORCES[-1])
    for seed, (friction, h_rms) in enumerate(MADE):
        truth = {"friction": friction, "roughness.h_rms": h_rms}
        own = _scene(truth, start.replace(mesh=MESH))
        scenes = {f"table {seed}, {volts:g} V": own.replace(voltage=volts) for volts in FULL_VOLTAGES}
        run(scenes, args, LIMIT)
        rng, off = np.random.default_rng(seed), []
        made = [(force, 0.0, friction * force, 0.0) for force in FULL_FORCES]
        for volts, scene in zip(FULL_VOLTAGES, scenes.values(), strict=True):
            finger: Any = fp.Result.load(args.out / batch.key(scene)).finger
            trace = finger.traces["full_slip"]
            for force in FULL_FORCES:
                f_t = at_force(profile(scene.slices), trace, force, scene.slices.count).totals["f_t"]
                here: Any = fp.run(own.replace(force=force, voltage=volts), model="cylinders").finger
                off.append(here.full_slip.f_t / f_t - 1)
                head = fp.run(start.replace(force=force, voltage=volts), model="cylinders").headline
                made.append((force, volts, f_t, head.error / head.value))
        rows = [(*at, f_t * np.exp(NOISE * rng.normal()), 100 * np.hypot(NOISE, known)) for *at, f_t, known in made]
        heads = ["force (N)", "voltage (V)", "friction force (N)", "spread (%)"]
        values = fitted(pd.DataFrame(rows, columns=heads), start, truth, evidence=False).values
        inside = {name: bool(v.low <= truth[name] <= v.high) for name, v in values.iterrows()}
        found.append({"truth": truth, "inside": inside, "off": [min(off), max(off)],
                      "values": values.reset_index(names="key").to_dict("records")})  # fmt: skip
    return found


def compute(args: argparse.Namespace) -> None:
    """Compute and keep the numbers, with those that are not asked for as they are."""
    before = kept("calibrate", args.docs)
    numbers: dict[str, Any] = dict(before.numbers)
    if args.full:
        numbers["by_full_runs"] = by_full_runs(args)
    for part in () if args.full else (again, held_out, choices, cover):
        print(f"{time.process_time():5.0f} s  {part.__name__}", flush=True)
        numbers[part.__name__] = part()
    print(f"{time.process_time():5.0f} s", flush=True)
    others: Any = [{"provenance": {"versions": {"source": before.made.source}}}]  # who made what is not asked for
    keep("calibrate", numbers, made(others if args.full else ()), args.docs)


def _region(key: dict[str, float], unit: float = 1.0) -> str:
    value, low, high = (f"{unit * key[name]:.3g}" for name in ("value", "low", "high"))
    return f"{value} ({low} to {high})"


def draw(docs: Path) -> Path:
    """Put the numbers in place in docs/calibrate.md."""
    return page(docs, "calibrate", "make calibrate", globals() | {"found": kept("calibrate", docs).numbers})


if __name__ == "__main__":
    sys.exit(main(__doc__, compute, draw, full={"action": "store_true", "help": "only the tables by full runs"}))
