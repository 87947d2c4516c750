"""Full slip of many scenes by the full model, each solved for from its neighbour: sweeps of ``states="full_slip"``.

Points that share a mesh are followed in chains: the first one by its path, each further one from the full slip of the
one before (:mod:`fingerpad.model.full_slip`), or by a path of its own where it is not found from there. Neighbours in
a chain differ in one value of one key. Where another number of ridges touches than at the neighbour, the chain also
goes back: skin may have two states of full slip, and each of them is found from one side. Both are then reported. An
end of a chain has a neighbour on one side alone; from the other side it is solved for from a state a step beyond, if
other ridges touch there.

With errors (``output.errors``) a chain is followed on the mesh of a run's path, whose elements are larger. Each of its
states is solved for again on the scene's own mesh, and the two meshes give its estimated error
(:mod:`fingerpad.accuracy.sharpened`). Where it is not found there, the point is a run of its own. Without errors the
chain is followed on the scene's mesh.

Each point is written when it is solved. A process is ``python3 -m fingerpad.runs.chain ASKED.json FOLDER LIMIT``.
"""

import json
import math
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from fingerpad.results.files import below
from fingerpad.results.result import Result
from fingerpad.runs import batch
from fingerpad.runs.context import RunContext
from fingerpad.runs.points import Point, of_run, one, with_other
from fingerpad.runs.post import kept
from fingerpad.runs.processes import limit_processor_time
from fingerpad.scene import Scene, from_data
from fingerpad.scene.reading import DEFAULT_MODEL
from variational.state import ContactState

if TYPE_CHECKING:
    from fingerpad.accuracy.sharpened import Sharpened, Sharpener
    from fingerpad.model.full_slip import Conditions, FullSlips, Solved
    from fingerpad.model.options import FingerModel
    from fingerpad.startup import MPI


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
        from fingerpad.model.drive_loads import gap_factor
        from fingerpad.model.options import plan

        self._scenes, self._half_arc, self._comm = scenes, half_arc, comm
        strongest = max(scenes, key=lambda scene: abs(scene.volts))
        self._options = plan(strongest)
        self._shared = any(gap_factor(scene) is not None for scene in scenes)
        self._slips: FullSlips | None = None
        self._sharpener: Sharpener | None = None  # of their states
        self._solved: list[Solved | None] = []  # of the present mesh, by scene
        self.results: list[Result] = []

    def follow(self) -> Iterator[int]:
        """Solve for the scenes one after the other; yield the number of each that has a new result; collective."""
        for k, scene in enumerate(self._scenes):
            self.results.append(self._next(scene))
            yield k
            yield from self._back(k)
        yield from self._ends()

    def model(self, scene: Scene) -> "FingerModel":
        """Return the model of a scene, with the parts and the ridges of all."""
        from fingerpad.model.drive_loads import EQUAL
        from fingerpad.model.options import FingerModel, by_rule

        if self._half_arc is not None and scene.mesh.touching_half_arc is None:
            mesh = scene.mesh.model_copy(update={"touching_half_arc": self._half_arc})
            scene = scene.model_copy(update={"mesh": mesh})
        found = FingerModel(by_rule(scene), self._options).of_path()
        return found.changed(share=EQUAL) if self._shared and found.share is None else found

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
            self._slips, self._sharpener, self._solved = slips, None, [None] * len(self._solved)
        self._solved.append(found)
        assert self._slips is not None
        try:
            final = self._final(model, found.state)
        except StepFailed as error:
            return of_run(scene, str(error), clock, self._comm)
        finger = self._slips.finger
        notes = [f"It was not found from its neighbour: {why}."] if why else []
        return Point(scene, found.state, finger, final).result(clock.cost(finger.solver.counts, 0), counts, notes)

    def _final(self, model: "FingerModel", state: ContactState) -> "Sharpened | None":
        """Return the present state on the scene's own mesh; None without errors, where that is the one it is on.

        Raises:
            StepFailed: it was not found there.
        """
        from fingerpad.accuracy.sharpened import Sharpener

        if model.final is None:
            return None
        if self._sharpener is None:
            assert self._slips is not None
            self._sharpener = Sharpener(self._slips.simulation, self._comm)
        return self._sharpener.sharpened(model, state)

    def _path(self, model: "FingerModel") -> "FullSlips":
        """Return the full slips at the end of a path, with what the path turns out to need."""
        from fingerpad.model.adhesion import lost
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
                    state = simulation.states[-1] if simulation.states else None
                    raise StepFailed(lost(error, state, model.closure)) from error
            if restart is None:
                return FullSlips(simulation)
            simulation.finger.solver.iteration.free()
            model = restart.model

    def _back(self, k: int) -> Iterator[int]:
        """Solve for the scenes before a scene from there, where another number of ridges touches, while they differ."""
        start, before = self._solved[k], self._solved[k - 1] if k else None
        if start is None or before is None or start.state.ridges_in_contact == before.state.ridges_in_contact:
            return
        yield from self._others(start, range(k - 1, -1, -1))

    def _ends(self) -> Iterator[int]:
        """Solve for the scenes at the ends from a step beyond, where another number of ridges touches."""
        from variational.solvers.continuation import StepFailed

        count = len(self._solved)
        for order in (range(count), range(count - 1, -1, -1)):
            end, neighbour = (self._solved[k] for k in order[:2]) if count > 1 else (None, None)
            if end is None or neighbour is None or self._slips is None:
                continue
            beyond = _beyond(end.conditions, neighbour.conditions)
            if beyond is None:
                continue
            try:
                start = self._slips.solve(beyond, end)
            except StepFailed:
                continue
            if start.state.ridges_in_contact != end.state.ridges_in_contact:
                yield from self._others(start, order)

    def _others(self, start: "Solved", order: Sequence[int]) -> Iterator[int]:
        """Solve for scenes, one from the other, while another state than theirs is found; yield their numbers."""
        from variational.solvers.continuation import StepFailed

        for j in order:
            mine = self._solved[j]
            if mine is None or self._slips is None:
                return
            try:
                start = self._slips.solve(mine.conditions, start)
            except StepFailed:
                return
            if one(start.state, mine.state):
                return
            try:
                final = self._final(self.model(self._scenes[j]), start.state)
            except StepFailed:  # on the scene's own mesh it is none
                continue
            other, known = start.state if final is None else final.state, self.results[j].full_slip
            if known is not None and not one(other, known):
                self.results[j] = with_other(self.results[j], other)
                yield j


def _beyond(end: "Conditions", neighbour: "Conditions") -> "Conditions | None":
    """Return conditions as far beyond an end as its neighbour is on this side; None where there are none.

    Steps are of the logarithm of the force, or of the square of the voltage, which the attraction follows.
    """
    if replace(end, f_ext=0.0, voltage=0.0) != replace(neighbour, f_ext=0.0, voltage=0.0):
        return None
    square = 2 * end.voltage**2 - neighbour.voltage**2
    voltage = math.copysign(max(square, 0.0) ** 0.5, end.voltage)
    found = replace(end, f_ext=end.f_ext**2 / neighbour.f_ext, voltage=voltage)
    return None if found in (end, neighbour) else found


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
