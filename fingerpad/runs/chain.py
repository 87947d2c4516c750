"""Full slip of many scenes by the full model, each solved for from its neighbour: sweeps of ``states="full_slip"``.

Points that share a mesh are followed in chains: the first one by its path, each further one from the full slip of the
one before (:mod:`fingerpad.model.full_slip`), or by a path of its own where it is not found from there. Neighbours in
a chain differ in one value of one key. Where another number of ridges touches than at the neighbour, the chain also
goes back: skin may have two states of full slip, and each of them is found from one side. Both are then reported.

Each point is written when it is solved. A process is ``python3 -m fingerpad.runs.chain ASKED.json FOLDER LIMIT``.
"""

import fcntl
import itertools
import json
import sys
import threading
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fingerpad.results.answer import Cost
from fingerpad.results.files import below, lock_file, replace_json
from fingerpad.results.result import Result
from fingerpad.runs import batch
from fingerpad.runs.context import RunContext
from fingerpad.runs.processes import End, Pool, limit_processor_time, run
from fingerpad.runs.solve import Summary, kept
from fingerpad.runs.sweep_columns import OTHER
from fingerpad.scene import Scene, SceneError, from_data
from fingerpad.scene.messages import show
from fingerpad.scene.reading import DEFAULT_MODEL
from variational.state import ContactState

if TYPE_CHECKING:
    from fingerpad.model.full_slip import FullSlips, Solved
    from fingerpad.model.options import FingerModel
    from fingerpad.startup import MPI

_FREE = ("f_ext", "voltage", "friction", "roughness", "electric", "slide_length", "output")
"""Keys in which neighbours may differ: they change neither the mesh nor the layers."""
_SAME = 1e-5  # relative difference of f_t up to which two states are one; air gaps are solved to 1e-6
_SHORTEST = 8  # points of a chain, of which the first takes the time of some fifteen others
_LIMIT = 4 * 3600.0  # s of processor time for a chain
_LOOK = 1.0  # s between two looks for points that are finished


def refuse_others(scene: Scene) -> None:
    """Refuse a scene of which full slip is not that of press, charge and slide under a force per length.

    Raises:
        SceneError: in one sentence.
    """
    for key in ("history", "force", "accuracy"):
        if (value := getattr(scene, key)) is not None:
            given = show(value) if key == "force" else "given"
            raise SceneError(f"{key} is {given}; with states='full_slip' it must be left out, or give states='all'")
    if scene.supply is not None and not scene.supply.circuit.lossless:
        raise SceneError(
            "voltage is a drive in a circuit with losses, where each ridge has its own share of it; with "
            "states='full_slip' it must be a number, or give states='all'"
        )


def sweep(scenes: Mapping[str, Scene], folder: Path, jobs: int, quiet: bool) -> dict[str, Summary]:
    """Solve what has not been solved yet, with a progress bar.

    Args:
        scenes: by name, each beside the one before.
        folder: of all results.
        jobs: processes at a time.
        quiet: whether to print nothing, and show no bar.

    Returns:
        The summaries by name; of a point whose process ended before, with its ``failure`` alone.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with lock_file(folder / "lock") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # another sweep may be at it
        missing = [name for name in scenes if batch.result(scenes[name], folder) is None]
        asked = list(chains({name: scenes[name] for name in missing}, jobs))
        ends = _followed(scenes, asked, missing, folder, jobs, quiet)
    lost = {"failure": next((f"{end.reason}: {end.message}" for end in ends if end.reason), "INTERRUPTED")}
    return {name: batch.result(scene, folder) or lost for name, scene in scenes.items()}


def chains(scenes: Mapping[str, Scene], jobs: int) -> Iterator[list[str]]:
    """Yield the names of the scenes of each chain: those that share a mesh, in as many parts as there are jobs."""
    groups = dict[str, list[str]]()
    for name, scene in scenes.items():
        fixed = {key: value for key, value in scene.parameters().items() if key not in _FREE}
        law = type(scene.friction_law()).__name__
        groups.setdefault(json.dumps([fixed, law], sort_keys=True), []).append(name)
    for names in groups.values():
        parts = max(1, min(jobs, len(names) // _SHORTEST))
        ends = [len(names) * k // parts for k in range(parts + 1)]
        yield from (names[a:b] for a, b in itertools.pairwise(ends))


def _followed(
    scenes: Mapping[str, Scene], asked: list[list[str]], missing: list[str], folder: Path, jobs: int, quiet: bool
) -> list[End]:
    """Follow chains in processes of their own; return how these ended."""
    ends: list[End] = []
    files = [folder / f"chain_{k}.json" for k in range(len(asked))]
    half_arc = _half_arc([scenes[name] for name in missing])
    for file, names in zip(files, asked, strict=True):
        replace_json(file, {"half_arc": half_arc, "scenes": [scenes[name].parameters() for name in names]})

    def job(k: int) -> End:
        folders = sorted({place for name in asked[k] for place in scenes[name].law_folders()})
        return run("fingerpad.runs.chain", [str(files[k]), str(folder), str(_LIMIT)], _LIMIT, folders)

    stop = threading.Event()
    with batch.progress(quiet) as bar:
        task, left = bar.add_task("states of full slip", total=len(missing)), list(missing)

        def look() -> None:
            for name in [*left]:
                found = batch.result(scenes[name], folder)
                if found is None:
                    continue
                left.remove(name)
                if not quiet:
                    words = found.get("failure") or f"µ_app {found['full_slip_mu_app']:.4f}"
                    bar.console.print(f"{name}: {words}", highlight=False, markup=False, soft_wrap=True)
                bar.update(task, advance=1)

        def watch() -> None:
            while not stop.wait(_LOOK):
                look()

        watcher = threading.Thread(target=watch, daemon=True)
        watcher.start()
        try:
            Pool[int, End](job, jobs).run(range(len(asked)), lambda k, end, left: ends.append(end))
        finally:
            stop.set()
            watcher.join()
        look()
    for file in files:
        file.unlink(missing_ok=True)
    return ends


def _half_arc(scenes: Sequence[Scene]) -> float | None:
    """Return the ``mesh.touching_half_arc`` (m) of all scenes of a sweep that give none, that of the widest contact."""
    from fingerpad.model.options import by_rule

    free = [scene for scene in scenes if scene.geometry.file is None and scene.mesh.touching_half_arc is None]
    return max((by_rule(scene).mesh.touching_half_arc or 0.0 for scene in free), default=None)


# -- in the process ------------------------------------------------------------------------------------
class Chain:
    """Full slip of scenes that share a mesh.

    Attributes:
        results: so far, in order.
    """

    def __init__(self, scenes: Sequence[Scene], half_arc: float | None, comm: "MPI.Comm") -> None:
        """Take the scenes in order.

        Args:
            scenes: each beside the one before.
            half_arc: ``mesh.touching_half_arc`` (m) where they give none.
            comm: communicator of the mesh.
        """
        from fingerpad.model.options import plan

        self._scenes, self._half_arc, self._comm = scenes, half_arc, comm
        strongest = max(scenes, key=lambda scene: abs(scene.volts))
        self._options = replace(plan(strongest), errors=False)
        self._slips: FullSlips | None = None
        self._solved: list[Solved | None] = []  # of the present mesh, by scene
        self.results: list[Result] = []

    def follow(self) -> Iterator[int]:
        """Solve for the scenes one after the other; yield the number of each that has a new result; collective."""
        for k, scene in enumerate(self._scenes):
            self.results.append(self._next(scene))
            yield k
            yield from self._back(k)

    def model(self, scene: Scene) -> "FingerModel":
        """Return the model of a scene, with the parts and the ridges of all."""
        from fingerpad.model.options import FingerModel, by_rule

        if self._half_arc is not None and scene.mesh.touching_half_arc is None:
            mesh = scene.mesh.model_copy(update={"touching_half_arc": self._half_arc})
            scene = scene.model_copy(update={"mesh": mesh})
        return FingerModel(by_rule(scene), self._options)

    def _next(self, scene: Scene) -> Result:
        """Return the result of a scene, from the one before or by a path."""
        from fingerpad.model.full_slip import Conditions
        from fingerpad.model.report import Clock
        from variational.solvers.continuation import StepFailed
        from variational.solvers.outcome import Counts

        clock, model, why = Clock(self._comm), self.model(scene), ""
        conditions, found = Conditions.of(model), None
        before = next((each for each in reversed(self._solved) if each is not None), None)
        counts = Counts() if self._slips is None else replace(self._slips.finger.solver.counts)
        if before is not None and self._slips is not None:
            try:
                found = self._slips.solve(conditions, before)
            except StepFailed as error:
                why = str(error)
        if found is None:
            try:
                slips = self._path(model)
                found, counts = slips.first(conditions), Counts()
            except StepFailed as error:
                self._solved.append(None)
                return Result(scene, DEFAULT_MODEL, None, None, None, failure=str(error), record={"reached": ""})
            if self._slips is not None:
                self._slips.finger.solver.iteration.free()
            self._slips, self._solved = slips, [None] * len(self._solved)
        self._solved.append(found)
        assert self._slips is not None
        return self._result(scene, found.state, clock.cost(self._slips.finger.solver.counts, 0), counts, why)

    def _path(self, model: "FingerModel") -> "FullSlips":
        """Return the full slips at the end of a path, with what the path turns out to need."""
        from fingerpad.model.full_slip import FullSlips
        from fingerpad.model.simulation import RestartRequired, Simulation
        from fingerpad.runs.restarts import finer
        from variational.solvers.continuation import StepFailed

        while True:
            simulation = Simulation(model, self._comm)
            restart: RestartRequired | None
            try:
                restart = simulation.run()
            except StepFailed as error:
                restart = finer(model, error, self._comm)
                if restart is None:
                    raise
            if restart is None:
                return FullSlips(simulation)
            simulation.finger.solver.iteration.free()
            model = restart.model

    def _back(self, k: int) -> Iterator[int]:
        """Solve for the scenes before a scene from there, where another number of ridges touches, while they differ."""
        from variational.solvers.continuation import StepFailed

        start, slips = self._solved[k], self._slips
        before = self._solved[k - 1] if k else None
        if start is None or slips is None or before is None:
            return
        if start.state.ridges_in_contact == before.state.ridges_in_contact:
            return
        for j in range(k - 1, -1, -1):
            mine = self._solved[j]
            if mine is None:
                return
            try:
                start = slips.solve(mine.conditions, start)
            except StepFailed:
                return
            if _one(start.state, mine.state):
                return
            self.results[j] = with_other(self.results[j], start.state)
            yield j

    def _result(self, scene: Scene, state: ContactState, cost: Cost, before: Any, why: str) -> Result:
        """Return a result with full slip alone.

        Args:
            scene: of the state.
            state: at full slip.
            cost: of all states so far.
            before: counts of the solver before this state.
            why: it was not found from its neighbour; empty where it was.
        """
        from fingerpad.model import cautions
        from fingerpad.model.state import broken
        from fingerpad.results.provenance import provenance
        from fingerpad.scene.remarks import coefficient, remarks

        assert self._slips is not None
        finger = self._slips.finger
        work = {name: getattr(cost, f"{name}_iterations" if name == "newton" else name) - getattr(before, name)
                for name in ("newton", "factorisations")}  # fmt: skip
        cost = replace(
            cost, newton_iterations=work["newton"], factorisations=work["factorisations"], unknowns=finger.unknowns
        )
        notes = [f"This is full slip alone, without an error estimate; it was reached by: {state.reached}."]
        notes += [f"It was not found from its neighbour: {why}."] if why else []
        return Result(
            scene,
            DEFAULT_MODEL,
            None,
            None,
            state,
            cost=cost,
            failure=broken(state, finger.force_error, coefficient(scene)),
            notes=tuple(notes),
            cautions=(
                *remarks(scene),
                *cautions.on_states([state], scene.closure(), finger.problem.interface.formulation),
            ),
            record={"reached": state.reached, "force_error": finger.force_error, "provenance": provenance()},
        )


def _one(a: ContactState, b: ContactState) -> bool:
    """Return whether two states are the same one."""
    return a.ridges_in_contact == b.ridges_in_contact and abs(a.f_t - b.f_t) <= _SAME * abs(b.f_t)


def with_other(result: Result, other: ContactState) -> Result:
    """Return a result with a second state of full slip, and a caution that gives both."""
    mine = result.full_slip
    assert mine is not None
    names = ("f_t", "mu_app", "contact_length", "f_electrostatic", "ridges_in_contact", "reached")
    said = [f"f_T {s.f_t:.6g} N/m with {s.ridges_in_contact} ridges ({s.reached})" for s in (mine, other)]
    caution = f"there are two states of full slip: {said[0]} and {said[1]}"
    record = result.record | {OTHER: {name: getattr(other, name) for name in names}}
    return replace(result, record=record, cautions=(*result.cautions, caution))


def main(asked: Path, folder: Path) -> None:
    """Solve for the full slip of a chain of scenes, each into a folder of its own.

    Args:
        asked: file of the scenes in JSON.
        folder: of all results.
    """
    from fingerpad.startup import MPI

    data = json.loads(asked.read_text(encoding="utf-8"))
    scenes = [from_data(each) for each in data["scenes"]]
    chain = Chain(scenes, data["half_arc"], MPI.COMM_WORLD)
    for k in chain.follow():
        kept(chain.results[k], RunContext(below(folder, batch.key(scenes[k])), report=False))


if __name__ == "__main__":
    limit_processor_time(float(sys.argv[3]))
    main(Path(sys.argv[1]), Path(sys.argv[2]))
