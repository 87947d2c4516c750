"""The paper's 40 loads as states of full slip, each solved for from its neighbour, beside the path to each of them.

environment/run python3 -m benchmarks.paper.states [--jobs 2] [--draw]     a quarter of an hour

The states are those of ``fp.sweep(states="full_slip")`` over all forces and voltages, on the default mesh. Beside paths
they are computed again on elements twice as large, where a path takes some ten seconds. Paths and states are of the
same mesh there: all scenes have the ridges of the widest contact. Writes docs/paper_states.json, of which docs/paper.md
has a section.
"""

import argparse
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import fingerpad as fp
from benchmarks.harness import keep, kept, made, main, run
from benchmarks.runs import FORCES, VOLTAGES, plain
from fingerpad.runs.batch import Summary
from fingerpad.scene import Scene
from geometry.parameters import MeshSize

_LIMIT = 3600.0  # s of processor time for one path
EQUAL = 1e-6  # relative difference of f_T up to which two states are one, the tolerance of the air gaps
LARGER = {name: 2 * getattr(MeshSize(), name) for name in ("contact", "growth", "interface", "coarsest")}
_PARTS = {"output": {"errors": False, "receptors": False}}


@dataclass(frozen=True)
class Beside:
    """A path's full slip beside that of the sweep."""

    f_ext: float
    voltage: float
    f_t: float
    """Of the path (N/m), and"""
    ridges: int
    state: float
    """f_T of the sweep (N/m), and"""
    touching: int
    reached: str

    @property
    def equal(self) -> bool:
        """Whether both are one state."""
        return abs(self.state / self.f_t - 1) <= EQUAL


def widest(mesh: Mapping[str, float]) -> Scene:
    """Return the scene of the widest contact, with sizes of elements and the ridges that it needs."""
    return plain({"f_ext": max(FORCES), "voltage": max(VOLTAGES), "mesh": dict(mesh)} | _PARTS)


def states(scene: Scene, out: Path, jobs: int) -> list[dict[str, Any]]:
    """Return the states over all forces and voltages; those in the folder are taken from there."""
    found = fp.sweep(scene, out, jobs=jobs, quiet=True, states="full_slip", f_ext=FORCES, voltage=VOLTAGES)
    return [
        {"f_ext": point.scene.f_ext, "voltage": point.scene.volts, "f_t": point.full_slip.f_t,
         "ridges": point.full_slip.ridges_in_contact, "reached": point.full_slip.reached,
         "factorisations": point.cost.factorisations, "processor_seconds": point.cost.processor_seconds}
        for point in found.results if point.full_slip is not None
    ]  # fmt: skip


def paths(mesh: Mapping[str, float], args: argparse.Namespace) -> dict[tuple[float, float], Summary]:
    """Return the summaries of the paths by force (N/m) and voltage (V)."""
    scene = widest(mesh)
    named = {f"{f:g} N/m, {u:g} V": scene.replace(f_ext=f, voltage=u) for f in FORCES for u in VOLTAGES}
    found = run(named, args, _LIMIT)
    return {(scene.f_ext, scene.volts): found[name] for name, scene in named.items()}


def beside(rows: Sequence[Mapping[str, Any]], found: Mapping[tuple[float, float], Summary]) -> list[dict[str, Any]]:
    """Return the paths that reached full slip beside the states."""
    listed = []
    for row in rows:
        path = found[row["f_ext"], row["voltage"]]
        if path.get("full_slip_f_t") is not None:
            listed.append(
                {"f_ext": row["f_ext"], "voltage": row["voltage"], "f_t": path["full_slip_f_t"],
                 "ridges": path["full_slip_ridges_in_contact"], "state": row["f_t"], "touching": row["ridges"],
                 "reached": row["reached"]}
            )  # fmt: skip
    return listed


def compute(args: argparse.Namespace) -> None:
    """Compute what is missing and keep the numbers."""
    folder = args.out / "states"
    numbers: dict[str, Any] = {"default": states(fp.Scene(**_PARTS), folder / "default", args.jobs)}
    larger, found = states(widest(LARGER), folder / "larger", args.jobs), paths(LARGER, args)
    seconds = [summary["processor_seconds"] for summary in found.values() if "processor_seconds" in summary]
    numbers |= {"larger": larger, "beside": beside(larger, found), "seconds_of_paths": seconds}
    keep("paper_states", numbers, made(found.values()), args.docs)


def compared(numbers: Mapping[str, Any]) -> list[Beside]:
    """Return the paths beside the states of docs/paper_states.json."""
    return [Beside(**each) for each in numbers["beside"]]


def shown(docs: Path) -> dict[str, Any]:
    """Return what docs/paper.md has of the states."""
    numbers = kept("paper_states", docs).numbers
    listed = compared(numbers)
    direct = [row for row in numbers["default"] if row["reached"] != "path"]
    larger = [row["processor_seconds"] for row in numbers["larger"] if row["reached"] != "path"]
    return {
        "beside": listed,
        "equal": [each for each in listed if each.equal],
        "other": [each for each in listed if not each.equal],
        "count": len(numbers["default"]),
        "direct": len(direct),
        "factorisations": sum(row["factorisations"] for row in direct) / len(direct),
        "mean": sum(larger) / len(larger),
        "path": sum(numbers["seconds_of_paths"]) / len(numbers["seconds_of_paths"]),
    }


def draw(docs: Path) -> Path:
    """Draw docs/paper.md."""
    from benchmarks.paper import __main__ as paper

    return paper.draw(docs)


if __name__ == "__main__":
    sys.exit(main(__doc__, compute, draw))
