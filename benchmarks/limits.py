r"""Limits under refinement: of a quantity, and of a scene whose states are solved again on meshes of halved sizes.

python3 -m benchmarks.limits CASE LIMIT     JSON of a scene and a number of levels, prints JSON

With values :math:`f_k` on meshes of size :math:`h_k`, each half of the one before, the last three give

.. math:: p = \log_2 \frac{f_1 - f_0}{f_2 - f_1}, \qquad f = f_2 + \frac{f_2 - f_1}{2^p - 1}

and Roache's grid convergence index the error bar, :math:`1.25\,|f - f_2|` (Roache 1994, doi 10.1115/1.2910291). An
order above 2, that of the strains of quadratic elements, is an accident of the last change: p is 2 then, and the bar
that of the change which p = 2 would have left of the one before, :math:`(f_1 - f_0) / 4`. Changes that hardly shrink
(an order below 1/2) or change sign give no order; the limit is the last value then. Its bar is three times the last
change if the changes alternate and shrink, else three times the larger of the last two: the index's factor for two
meshes.

A path is followed on the coarse mesh that an ``[accuracy]`` starts from, and its states are solved again on each of
:func:`meshes`: by halves, since a state put onto elements a quarter of its own is far from equilibrium. All meshes have
curved facets, and facets of a sixteenth where the contact of their states ends, as those of a run. The states are also
solved again on the scene's own mesh, for the effect of the coarse path on normal contact (``docs/errors.md``). Where a
state is not found on a mesh after the third, or that mesh needs too much memory, the limit is that of the meshes
before, with their larger bar.
"""

import argparse
import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from mpi4py import MPI

from benchmarks import harness
from fingerpad.accuracy.solves import StateRecorder, solve_again
from fingerpad.accuracy.states import Solve
from fingerpad.model.finger import Step
from fingerpad.model.options import FingerModel, plan
from fingerpad.model.simulation import Simulation
from fingerpad.runs.processes import limit_processor_time
from fingerpad.scene import Scene, from_data, start
from geometry.parameters import MeshSize
from geometry.profiles import GeometryError
from variational.solvers.continuation import StepFailed

_SAFETY, _UNSAFE = 1.25, 3.0
_LOWEST, _HIGHEST = 0.5, 2.0  # orders used for extrapolation
_FIRST = {"contact": 10e-6, "growth": 0.5, "receptor": 10e-6, "interface": 120e-6}
_HALVED = ("contact", "growth", "receptor", "interface", "coarsest")
_STARTS = (20e-6, 10e-6, 5e-6)  # m, contact sizes of the path, the next where one fails
_FEWEST = 3  # meshes that a limit is of, where a state is not found on a finer one
_LIMIT = 14400.0  # s of processor time for one scene


# -- of a quantity -------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Limit:
    """Limit of a quantity: ``bar`` is half the width of its error bar, ``order`` None where none is observed."""

    value: float
    bar: float
    order: float | None

    @property
    def relative(self) -> float:
        """The bar over the value."""
        return self.bar / abs(self.value)


def limit(values: Sequence[float]) -> Limit:
    """Return the limit of values on meshes of halved size, coarsest first; ValueError if they are fewer than three."""
    if len(values) < 3:
        raise ValueError(f"{len(values)} values were given; an order needs three")
    first, middle, finest = (float(value) for value in values[-3:])
    before, last = middle - first, finest - middle
    ratio = before / last if last else 0.0
    if ratio < 2**_LOWEST:
        return Limit(finest, _UNSAFE * (abs(last) if ratio < -1 else max(abs(before), abs(last))), None)
    factor, order = min(ratio, 2**_HIGHEST), float(np.log2(ratio))
    return Limit(finest + last / (factor - 1), _SAFETY * abs(before) / factor / (factor - 1), order)


# -- of scenes -----------------------------------------------------------------------------------------------
def meshes(mesh: MeshSize, levels: int) -> list[MeshSize]:
    """Return meshes of one family, each with half the sizes of the one before, with the touching ridges of ``mesh``."""
    first = mesh.model_copy(update=_FIRST)
    return [first.model_copy(update={s: getattr(first, s) / 2**n for s in _HALVED}) for n in range(levels)]


def solve_all(scenes: Mapping[str, Scene], levels: int, args: argparse.Namespace) -> dict[str, dict[str, Any]]:
    """Solve the scenes that are not kept yet beside the folder of runs of a study's command line ``args``.

    Return by name ``path``, ``own`` (the scene's mesh) and ``levels``, each a mesh, cost and values; or ``failure``.
    """
    cases = {f"limit of {name}": {"scene": scene.parameters(), "levels": levels} for name, scene in scenes.items()}
    found = harness.solve("benchmarks.limits", cases, args.out.parent / "limits", args.jobs, _LIMIT)
    return {name: found[f"limit of {name}"] for name in scenes}


def limits(found: Mapping[str, Any]) -> dict[str, Limit]:
    """Return the limits of a scene's quantities, from the output of :func:`solve_all`; of at least three meshes."""
    levels = [level["values"] for level in found["levels"]]
    return {name: limit([values[name] for values in levels]) for name in levels[-1]}


# -- in a process of its own ---------------------------------------------------------------------------------
def _path(scene: Scene) -> Solve:
    """Return the states of a scene's path on the coarsest mesh on which it can be followed."""

    def on_step(step: Step, done: float) -> None:
        recorder.record(step)

    def on_load() -> None:
        if "uncharged" not in recorder.states:
            recorder.keep("uncharged")

    for contact in _STARTS:
        sizes = start({}) | {"receptor": 2 * _FIRST["receptor"], "contact": contact}
        coarse = scene.model_copy(update={"mesh": scene.mesh.model_copy(update=sizes)})
        simulation = Simulation(FingerModel(coarse, plan(scene)), MPI.COMM_WORLD, on_step, on_load)
        recorder = StateRecorder(simulation)
        try:
            restart = simulation.run()
            if restart is not None:
                raise RuntimeError(f"{restart.reason}; give mesh.touching_half_arc")
            return recorder.solve()
        except StepFailed as error:
            failure = error
    raise failure


def _solve(scene: Scene, levels: int) -> dict[str, Any]:
    model = FingerModel(scene, plan(scene))

    def again(mesh: MeshSize, before: Solve) -> Solve:
        return solve_again(model.changed(mesh=mesh), before.states, MPI.COMM_WORLD)

    def summary(solve: Solve) -> dict[str, Any]:
        ridges = {f"{name}_ridges_in_contact": s.state.ridges_in_contact for name, s in solve.states.items()}
        cost = {name: getattr(solve, name) for name in ("unknowns", "factorisations", "processor_seconds")}
        forces = {f"{name}_f_contact": s.state.f_contact for name, s in solve.states.items()}
        return {"mesh": solve.mesh.model_dump()} | cost | {"values": solve.values() | ridges | forces}

    solves = [_path(scene)]
    for mesh in meshes(scene.mesh, levels):
        try:
            solves.append(again(mesh, solves[-1]))
        except (StepFailed, GeometryError) as error:  # the latter needs more memory than a run may take
            if len(solves) <= _FEWEST:
                raise
            print(error, file=sys.stderr)
            break
    own = again(scene.mesh, solves[1])
    return {"path": summary(solves[0]), "own": summary(own), "levels": [summary(solve) for solve in solves[1:]]}


if __name__ == "__main__":
    limit_processor_time(float(sys.argv[2]))
    case = json.loads(sys.argv[1])
    print(json.dumps(_solve(from_data(case["scene"]), case["levels"])))
