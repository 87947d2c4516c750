"""Random scenes of the whole finger, each by three formulations of the contact: how they are drawn, run and kept."""

import argparse
import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from benchmarks.harness import made, run
from fingerpad.runs.batch import Summary
from fingerpad.scene import Scene, from_data

COUNT, SEED = 20, 20
FORMULATIONS = ("penalty", "nitsche", "augmented")
LIMIT = 180.0  # s of processor time for one run
MESH = {"contact": 30e-6, "interface": 150e-6, "growth": 0.8}
_MODULI = {"subcutis": 25e3, "dermis": 2.55e3, "viable_epidermis": 61.75e3, "stratum_corneum": 86.76e3}  # Pa


def _digits(value: float) -> float:
    """Return a number of three digits, with which the scene can be written down."""
    return float(f"{value:.3g}")


def drawn(number: int) -> dict[str, Any]:
    """Return the physical parameters of a scene; force and friction coefficient are evenly spread on a logarithm.

    Args:
        number: of the scene, from 0; even ones have the paper's printed exponent, odd ones that of Abaqus.
    """
    chance = np.random.default_rng([SEED, number])
    force, friction = (_digits(a * (b / a) ** chance.random()) for a, b in ((2.0, 200.0), (0.05, 1.0)))
    voltage = _digits(300 * chance.random())
    layers = {layer: {"shear_modulus": _digits(g * chance.uniform(0.7, 1.3))} for layer, g in _MODULI.items()}
    lengths = {"h_rms": 3.1e-6, "wavelength": 100e-6}
    return {
        "f_ext": force,
        "voltage": voltage,
        "friction": friction,
        "materials": {**layers, "exponent": ("printed", "abaqus")[number % 2]},
        "roughness": {name: _digits(value * chance.uniform(0.6, 1.4)) for name, value in lengths.items()},
    }


def scenes() -> dict[tuple[int, str], Scene]:
    """Return all scenes by number and formulation."""
    plain = {"mesh": MESH, "output": {"receptors": False, "errors": False}}
    keys = [(number, name) for name in FORMULATIONS for number in range(COUNT)]
    return {
        (number, name): from_data(drawn(number) | plain | {"contact": {"formulation": name}}) for number, name in keys
    }


def row(summary: Summary) -> dict[str, Any]:
    """Return what the page shows of a run; factorisations are those of restarts too."""
    again = summary.get("restarts", [])
    finer = [restart for restart in again if restart["contact"] < MESH["contact"]]
    return {
        "full_slip": bool(summary.get("full_slip")),
        "contact": summary.get("path_mesh", MESH)["contact"],
        "factorisations": summary.get("factorisations", 0) + sum(restart["factorisations"] for restart in again),
        "newton": summary.get("newton_iterations", 0) + sum(restart["newton_iterations"] for restart in again),
        "failure": reason(finer[0]["reason"] if finer else summary.get("failure", "")),
    }


def reason(failure: str) -> str:
    """Return load and name of a failure, ``slide: DIVERGED_MAX_IT``; empty where there is none."""
    load, name = re.search(r"^step \d+ \((\w+),", failure), re.search(r"\b[A-Z]{3,}(_[A-Z]+)+\b", failure)
    return ": ".join(found for found in (load[1] if load else "", name[0] if name else failure) if found)


def numbers(args: argparse.Namespace) -> dict[str, Any]:
    """Run the scenes that are missing; return the rows of all, and by which version they were made."""
    asked = scenes()
    names = {f"scene {number}, {name}": (number, name) for number, name in asked}
    found: Mapping[str, Summary] = run({text: asked[key] for text, key in names.items()}, args, LIMIT)
    rows = [{"number": number, "formulation": name} | row(found[text]) for text, (number, name) in names.items()]
    by = made(found.values())
    return {"made": f"version {by.version} of {by.date} (source {by.source})", "runs": rows}
