"""Limits of scenes under refinement: states of a coarse path, solved again on meshes with all sizes halved.

python3 -m benchmarks.limits SCENE.json LEVELS LIMIT [uncharged]     one scene, prints JSON

The path is followed on the coarse mesh that an ``[accuracy]`` starts from. Its states are solved again on each of
:func:`meshes`: by halves, since a state put onto elements a quarter of its own is far from equilibrium. From the first
of these meshes the states are also solved again on the scene's own mesh. Full slip does not depend on the load path, so
that it is that of a whole run. Normal contact keeps the friction history of the coarse path; the comparison of the own
mesh with a whole run on it shows by how much (``docs/errors.md``). Where a state is not found on a mesh after the
third, the limit is that of the meshes before, with their larger bar.
"""

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from mpi4py import MPI

from benchmarks.convergence import Limit, limit
from fingerpad.accuracy.recompute import Solve, StateRecorder, solve_again
from fingerpad.io.files import replace
from fingerpad.io.states import PREFIXES
from fingerpad.model.finger import Step
from fingerpad.model.options import plan
from fingerpad.model.simulation import Simulation
from fingerpad.runs.batch import key, progress
from fingerpad.runs.processes import End, Pool, limit_processor_time, run
from fingerpad.scene import Scene, from_data, start
from geometry.parameters import MeshSize
from variational.solvers.continuation import StepFailed

_FIRST = {"contact": 10e-6, "growth": 0.5, "receptor": 10e-6, "interface": 120e-6}
_HALVED = ("contact", "growth", "receptor", "interface", "coarsest")
_STARTS = (20e-6, 10e-6, 5e-6)  # m, contact sizes of the path, the next where one fails
_FEWEST = 3  # meshes that a limit is of, where a state is not found on a finer one
_LIMIT = 14400.0  # s of processor time for one scene


def meshes(mesh: MeshSize, levels: int) -> list[MeshSize]:
    """Return meshes of one family, each with half the sizes of the one before, with the touching ridges of ``mesh``."""
    first = mesh.model_copy(update=_FIRST)
    return [first.model_copy(update={s: getattr(first, s) / 2**n for s in _HALVED}) for n in range(levels)]


def kept(scene: Scene, levels: int, folder: Path) -> dict[str, Any] | None:
    """Return the kept output, None if there is none."""
    file = folder / f"{key(scene)}-{levels}.json"
    return dict(json.loads(file.read_text(encoding="utf-8"))) if file.exists() else None


def ask_all(
    scenes: Mapping[str, Scene], levels: int, folder: Path, jobs: int, uncharged: bool = True
) -> dict[str, dict[str, Any]]:
    """Solve the scenes that are not kept yet, each in a process of its own, and keep their output.

    Args:
        scenes: press, charge and slide, by name.
        levels: number of meshes.
        folder: of the results.
        jobs: processes at a time.
        uncharged: whether uncharged normal contact is solved again, too.

    Returns:
        By name: ``path``, ``own`` (the scene's mesh) and ``levels``, each a mesh, its cost and its values; or
        ``failure``.
    """
    folder.mkdir(parents=True, exist_ok=True)
    found = {name: known for name, scene in scenes.items() if (known := kept(scene, levels, folder)) is not None}
    missing = [name for name in scenes if name not in found]

    def job(name: str) -> End:
        file = folder / f"{key(scenes[name])}.scene.json"
        file.write_text(json.dumps(scenes[name].parameters()), encoding="utf-8")
        given = [str(file), str(levels), str(_LIMIT), *(["uncharged"] if uncharged else [])]
        return run("benchmarks.limits", given, _LIMIT)

    def done(name: str, end: End, left: int) -> None:
        if not end.reason:
            replace(folder / f"{key(scenes[name])}-{levels}.json", end.stdout)
        found[name] = {"failure": f"{end.reason}: {end.message}"} if end.reason else dict(json.loads(end.stdout))
        words = found[name].get("failure", "done")
        bar.console.print(f"limit of {name}: {words}", highlight=False, markup=False, soft_wrap=True)
        bar.advance(task)

    with progress() as bar:
        task = bar.add_task("limits", total=len(missing))
        Pool[str, End](job, jobs).run(missing, done)
    return found


def limits(found: Mapping[str, Any]) -> dict[str, Limit]:
    """Return the limits of the quantities under refinement; of at least three meshes."""
    levels = [level["values"] for level in found["levels"]]
    return {name: limit([values[name] for values in levels]) for name in levels[-1]}


# -- in a process of its own -------------------------------------------------------------------------------
def _path(scene: Scene, uncharged: bool, comm: MPI.Comm) -> Solve:
    """Return the states of a scene's path on the coarsest mesh on which it can be followed."""

    def on_step(step: Step, done: float) -> None:
        keeper.record(step)

    def on_load() -> None:
        if "uncharged" not in keeper.states and uncharged:
            keeper.keep("uncharged")

    for contact in _STARTS:
        sizes = start({}) | {"receptor": 2 * _FIRST["receptor"], "contact": contact}
        coarse = scene.model_copy(update={"mesh": scene.mesh.model_copy(update=sizes)})
        simulation = Simulation(coarse, plan(scene), comm, on_step, on_load)
        keeper = StateRecorder(simulation)
        try:
            restart = simulation.run()
            if restart is not None:
                raise RuntimeError(f"{restart.reason}; give mesh.touching_half_arc")
            return keeper.solve()
        except StepFailed as error:
            failure = error
    raise failure


def _solve(scene: Scene, levels: int, uncharged: bool) -> dict[str, Any]:
    comm = MPI.COMM_WORLD
    path = _path(scene, uncharged, comm)
    solves = [path]
    for mesh in meshes(scene.mesh, levels):
        try:
            solves.append(solve_again(scene.model_copy(update={"mesh": mesh}), plan(scene), solves[-1].states, comm))
        except StepFailed as error:
            if len(solves) <= _FEWEST:
                raise
            print(error, file=sys.stderr)
            break
        print(mesh, solves[-1].unknowns, solves[-1].factorisations, file=sys.stderr)
    own = solve_again(scene, plan(scene), solves[1].states, comm)

    def summary(solve: Solve) -> dict[str, Any]:
        ridges = {f"{PREFIXES[name]}_ridges_in_contact": s.state.ridges_in_contact for name, s in solve.states.items()}
        cost = {name: getattr(solve, name) for name in ("unknowns", "factorisations", "processor_seconds")}
        return {"mesh": solve.mesh.model_dump()} | cost | {"values": solve.values() | ridges}

    return {"path": summary(path), "own": summary(own), "levels": [summary(solve) for solve in solves[1:]]}


def _main(arguments: Sequence[str]) -> None:
    limit_processor_time(float(arguments[2]))
    scene = from_data(json.loads(Path(arguments[0]).read_text(encoding="utf-8")))
    print(json.dumps(_solve(scene, int(arguments[1]), arguments[3:] == ["uncharged"])))


if __name__ == "__main__":
    _main(sys.argv[1:])
