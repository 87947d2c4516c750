"""Estimated errors of runs, from the meshes of path and named states, against known errors.

environment/run python3 -m benchmarks.two_meshes [--jobs 2] [--draw]     a minute of processor time for each scene
python3 -m benchmarks.two_meshes CASE LIMIT     JSON of a scene, prints JSON

A run without an ``[accuracy]`` follows its path on elements twice as large as the scene's, and solves its named states
again on the scene's sizes, the final mesh; the two meshes make its estimated error
(:func:`fingerpad.accuracy.richardson.of_two_meshes`). Here the states are solved once more with half of all sizes,
which shows the error that they had: the *known error* is what that changes. The default scene and the ten of
:func:`benchmarks.accuracy.drawn`. Writes docs/two_meshes.json and docs/errors.md. fingerpad/accuracy/richardson.py
takes its factors TWO and SITES from them; tests/test_calibration.py checks the coverage.
"""

import argparse
import json
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from benchmarks import harness
from benchmarks.accuracy import drawn
from fingerpad.accuracy.refinement import Refinement
from fingerpad.accuracy.richardson import SITES, TWO, of_two_meshes, value
from fingerpad.accuracy.solves import StateRecorder, solve_again
from fingerpad.accuracy.states import Solve
from fingerpad.model.finger import Step
from fingerpad.model.options import FingerModel, by_rule, plan
from fingerpad.model.simulation import RestartRequired, Simulation
from fingerpad.runs.processes import limit_processor_time
from fingerpad.scene import Scene, from_data

_LIMIT = 3600.0  # s of processor time for one scene
DEFAULT = "default scene"
MESHES = ("coarse", "final", "finer")
KINDS = {
    "friction": "mu_app",
    "contact length": "contact_length",
    "highest pressure": "p_max",
    "energy density": "_sed_",
}
"""What is in the name of a quantity, by its kind."""


# -- in a process of its own ---------------------------------------------------------------------------------
def _refined(model: FingerModel) -> Refinement:
    """Return a path's states on the final mesh with their errors, as a run finds them."""

    def on_step(step: Step, done: float) -> None:
        recorder.record(step)

    def show(line: str) -> None:
        print(line, file=sys.stderr)

    while True:
        simulation = Simulation(model, MPI.COMM_WORLD, on_step)
        recorder = StateRecorder(simulation)
        restart: RestartRequired | None = simulation.run()
        if restart is None:
            path = recorder.solve()
            simulation.finger.solver.iteration.free()
            refinement = Refinement(model, path, MPI.COMM_WORLD, show, lambda: None)
            restart = refinement.run()
            if restart is None:
                return refinement
        show(restart.reason)
        model = restart.model


def _solve(scene: Scene) -> dict[str, Any]:
    refinement = _refined(FingerModel(scene, plan(scene)).of_path())
    if not refinement.estimates():
        raise RuntimeError("; ".join(refinement.notes))
    final, model = refinement.base, refinement.model
    sizes = model.coarser(final.mesh)
    coarse = next(solve for solve in refinement.found if solve.mesh == sizes)
    finer = solve_again(model.changed(mesh=final.mesh.scaled(0.5)), final.states, MPI.COMM_WORLD)
    return {name: _summary(solve) for name, solve in zip(MESHES, (coarse, final, finer), strict=True)}


def _summary(solve: Solve) -> dict[str, Any]:
    """Return the parts of a solve's quantities, to seven digits, its facets where contact ends, and its cost."""
    parts = {name: np.vectorize(lambda v: float(f"{v:.7g}"))(part).tolist() for name, part in solve.parts().items()}
    facets = {name: float(f"{state.facet:.7g}") for name, state in solve.states.items()}
    cost = {name: getattr(solve, name) for name in ("unknowns", "factorisations", "processor_seconds")}
    return {"parts": parts, "facets": facets} | cost


# -- numbers -------------------------------------------------------------------------------------------------
def compute(args: argparse.Namespace) -> None:
    """Solve the scenes that are not kept yet, and keep their numbers."""
    scenes = {DEFAULT: by_rule(Scene())} | drawn()
    cases = {name: {"scene": scene.parameters()} for name, scene in scenes.items()}
    found = harness.solve("benchmarks.two_meshes", cases, args.out.parent / "two_meshes", args.jobs, _LIMIT)
    harness.keep("two_meshes", {name: found[name] for name in scenes}, harness.made(), args.docs)


@dataclass(frozen=True)
class Case:
    """An estimated error beside the known one, in per cent of the value; of energy densities of the state's largest."""

    scene: str
    name: str
    """Of the state and the quantity: ``full_slip_mu_app``."""
    estimated: float
    known: float
    """What half of all sizes changes."""

    kind = property(lambda self: _kind(self.name))
    covered = property(lambda self: self.known <= self.estimated)
    whole = property(lambda self: self.known * (2 if self.kind == "contact length" else 4 / 3))
    """The error that shrinks by ``known`` where it falls with its order: 1 for lengths, 2 for all else."""


def _kind(name: str) -> str:
    """Return the kind of a quantity; empty for one that another has already.

    f_T is mu_app times a given force. Normal contact is symmetric, and so are its energy densities.
    """
    mirrored = "_sed_-" in name and not name.startswith("full_slip")
    return "" if mirrored else next((kind for kind, part in KINDS.items() if part in name), "")


def cases(numbers: Mapping[str, Any], safety: float = TWO, sites: float = SITES) -> list[Case]:
    """Return the cases of docs/two_meshes.json; factors as in :func:`~fingerpad.accuracy.richardson.of_two_meshes`."""
    found = []
    for scene, solves in solved(numbers).items():
        coarse, final, finer = (solves[name] for name in MESHES)
        facets = {state: (coarse["facets"][state], facet) for state, facet in final["facets"].items()}
        estimated = of_two_meshes(coarse["parts"], final["parts"], facets, safety=safety, sites=sites)
        values, limits = ({name: value(name, part) for name, part in s["parts"].items()} for s in (final, finer))
        for name in (name for name in estimated if name in limits and _kind(name)):
            state = name.partition("_sed_")[0]
            alike = [abs(limits[other]) for other in limits if other.startswith(f"{state}_sed_")]
            of = 100 / (max(alike) if "_sed_" in name else abs(limits[name]))
            found.append(Case(scene, name, of * estimated[name], of * abs(limits[name] - values[name])))
    return found


def solved(numbers: Mapping[str, Any]) -> dict[str, Any]:
    """Return the scenes whose states were found on all meshes."""
    return {scene: solves for scene, solves in numbers.items() if "failure" not in solves}


def coverage(known: Iterable[Case], kind: str = "") -> tuple[int, int]:
    """Return how many cases there are, of one kind or all, and of how many the estimate is at least the known error."""
    mine = [case.covered for case in known if kind in ("", case.kind)]
    return len(mine), sum(mine)


# -- page ----------------------------------------------------------------------------------------------------
def draw(docs: Path) -> Path:
    """Draw the page from the kept numbers."""
    numbers = harness.kept("two_meshes", docs).numbers
    known = cases(numbers)
    bare, single = cases(numbers, 1.0, 0.0), cases(numbers, TWO, 0.0)
    table = [
        (kind, *coverage(known, kind), coverage(bare, kind)[1], coverage(single, kind)[1])
        + (sum(case.whole <= case.estimated for case in known if case.kind == kind),)
        + (max((case for case in known if case.kind == kind), key=lambda case: case.known),)
        for kind in KINDS
    ]
    names = {"known": known, "table": table, "scenes": solved(numbers)}
    return harness.page(docs, "two_meshes", "python3 -m benchmarks.two_meshes", globals() | names)


if __name__ == "__main__":
    if len(sys.argv) == 3 and sys.argv[1].startswith("{"):
        limit_processor_time(float(sys.argv[2]))
        print(json.dumps(_solve(from_data(json.loads(sys.argv[1])["scene"]))))
    else:
        sys.exit(harness.main(__doc__, compute, draw))
