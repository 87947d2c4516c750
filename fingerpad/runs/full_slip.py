"""Full slip of many scenes by the full model, each solved for from its neighbour: sweeps of ``states="full_slip"``.

Points that share a mesh are followed in chains: the first one by its path, each further one from the full slip of the
one before (:mod:`fingerpad.model.full_slip`), or by a path of its own where it is not found from there. Neighbours in
a chain differ in one value of one key. Where skin has two states of full slip, a chain reports the one on its side.

With errors (``output.errors``) a chain is followed on the mesh of a run's path, whose elements are larger. Each of its
states is solved for again on the scene's own mesh, finest where the state's own contact ends, and the two meshes give
its estimated error (:func:`fingerpad.accuracy.richardson.of_two_meshes`). Where it is not found there, the point is a
run of its own. Without errors the chain is followed on the scene's mesh.

Each point is written when it is solved. A process is ``python3 -m fingerpad.runs.full_slip CHAIN.json FOLDER LIMIT``.
"""

import json
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from fingerpad.startup import MPI  # isort: skip  # before the libraries of finite elements
from fingerpad.accuracy.estimate import Estimate, with_errors
from fingerpad.accuracy.richardson import rigid
from fingerpad.accuracy.solves import StateRecorder, solve_again
from fingerpad.accuracy.states import Solve
from fingerpad.model.cautions import lost
from fingerpad.model.drive_loads import EQUAL, gap_factor
from fingerpad.model.finger import Finger
from fingerpad.model.full_slip import Conditions, FullSlips, Solved
from fingerpad.model.options import FingerModel, by_rule, plan
from fingerpad.model.report import Clock
from fingerpad.model.simulation import RestartRequired, Simulation
from fingerpad.model.state import broken
from fingerpad.results.data import Cost, valued
from fingerpad.results.files import below
from fingerpad.results.provenance import provenance
from fingerpad.results.quantities import OUTPUTS
from fingerpad.results.result import Result
from fingerpad.runs import batch
from fingerpad.runs.context import RunContext
from fingerpad.runs.post import kept
from fingerpad.runs.processes import limit_processor_time
from fingerpad.runs.restarts import finer
from fingerpad.scene import Scene, from_data
from fingerpad.scene.messages import counted
from fingerpad.scene.reading import DEFAULT_MODEL
from fingerpad.scene.remarks import coefficient
from variational.caution import Caution
from variational.solvers.continuation import StepFailed
from variational.solvers.outcome import Counts
from variational.state import PATH, ContactState

_SLIP = "full_slip"
_OF_RUN = ("path_mesh", "accuracy", "restarts", "force_error", "provenance")  # what a point keeps of a run's record


class Fine(NamedTuple):
    """Full slip on the mesh that a scene gives."""

    state: ContactState
    """With its estimated errors."""
    solve: Solve
    """What it cost on that mesh."""


class FineSolver:
    """Solves for the full slips of a simulation again on the scene's mesh, and estimates errors from the two meshes."""

    def __init__(self, simulation: Simulation, comm: MPI.Comm) -> None:
        """Find the receptor sites of a simulation on the path's mesh, whose present states are solved for again."""
        self._simulation, self._comm, self._recorder = simulation, comm, StateRecorder(simulation)

    def solve(self, model: FingerModel, state: ContactState) -> Fine:
        """Return the present state, of these loads and laws, on the model's final mesh; collective.

        Raises:
            StepFailed: no steady full slip was found on one of the meshes.
        """
        assert model.final is not None
        arc = {"touching_half_arc": self._simulation.model.mesh.touching_half_arc}
        final = model.final.model_copy(update=arc)
        self._recorder.keep(_SLIP)
        path, coarser = self._recorder.solve(), model.coarser(final)
        stiffer, estimate = model.contact.over_stiffer_screen(), Estimate(model, path, self._comm)
        fine = solve_again(model.changed(mesh=final), path.states, self._comm, stiffer=stiffer)
        same = path.mesh == coarser
        estimate.compare(path if same else solve_again(model.changed(mesh=coarser), path.states, self._comm), fine)
        if fine.stiffer is not None:
            estimate.penalty = rigid(fine.values(), fine.stiffer.values())
        return Fine(with_errors(estimate, {_SLIP: state}, OUTPUTS)[_SLIP], fine)


class Chain:
    """Full slip of scenes that share a mesh.

    Attributes:
        results: so far, in order.
    """

    def __init__(self, scenes: Sequence[Scene], half_arc: float | None, comm: MPI.Comm) -> None:
        """Take the scenes, each beside the one before, with ``mesh.touching_half_arc`` (m) where they give none."""
        self._scenes, self._half_arc, self._comm = scenes, half_arc, comm
        self._options = plan(max(scenes, key=lambda scene: abs(scene.volts)))
        self._shared = any(gap_factor(scene) is not None for scene in scenes)
        self._slips: FullSlips | None = None
        self._fine: FineSolver | None = None  # of their states
        self._before: Solved | None = None  # the last state of the present mesh
        self.results: list[Result] = []

    def follow(self) -> Iterator[int]:
        """Solve for the scenes one after the other; yield the number of each that has a new result; collective."""
        for k, scene in enumerate(self._scenes):
            self.results.append(self._next(scene))
            yield k

    def model(self, scene: Scene) -> FingerModel:
        """Return the model of a scene, with the parts and the ridges of all."""
        if self._half_arc is not None and scene.mesh.touching_half_arc is None:
            mesh = scene.mesh.model_copy(update={"touching_half_arc": self._half_arc})
            scene = scene.model_copy(update={"mesh": mesh})
        found = FingerModel(by_rule(scene), self._options).of_path()
        return found.changed(share=EQUAL) if self._shared and found.share is None else found

    def _next(self, scene: Scene) -> Result:
        """Return the result of a scene, from the one before or by a path."""
        clock, model, why = Clock(self._comm), self.model(scene), ""
        conditions, found = Conditions.of(model), None
        counts = Counts() if self._slips is None else replace(self._slips.finger.solver.counts)
        if self._before is not None and self._slips is not None:
            try:
                found = self._slips.solve(conditions, self._before)
            except StepFailed as error:
                why = str(error)
        if found is None:
            try:
                slips = self._path(model)
                found, counts = slips.first(conditions), Counts()
            except StepFailed as error:
                return Result(scene, DEFAULT_MODEL, None, None, None, failure=str(error), record={"reached": ""})
            if self._slips is not None:
                self._slips.finger.solver.iteration.free()
            self._slips, self._fine = slips, None
        self._before = found
        assert self._slips is not None
        try:
            fine = self._final(model, found.state)
        except StepFailed as error:
            return _of_run(scene, str(error), clock, self._comm)
        finger = self._slips.finger
        notes = [f"It was not found from its neighbour: {why}."] if why else []
        return _of_state(scene, found.state, fine, finger, clock.cost(finger.solver.counts, 0), counts, notes)

    def _final(self, model: FingerModel, state: ContactState) -> Fine | None:
        """Return the present state on the scene's own mesh; None without errors, where that is the one it is on."""
        if model.final is None or self._slips is None:
            return None
        self._fine = self._fine or FineSolver(self._slips.simulation, self._comm)
        return self._fine.solve(model, state)

    def _path(self, model: FingerModel) -> FullSlips:
        """Return the full slips at the end of a path, with what the path turns out to need."""
        kept, states = None, list[ContactState]()
        while True:
            simulation = Simulation(model, self._comm)
            restart: RestartRequired | None
            try:
                if kept is not None:
                    simulation.resume(kept, states)
                restart = simulation.run()
            except StepFailed as error:
                restart = finer(model, error, self._comm)
                if restart is None:
                    state = simulation.states[-1] if simulation.states else None
                    raise StepFailed(lost(error, state, model.closure)) from error
            if restart is None:
                return FullSlips(simulation)
            kept, states = simulation.carried() if restart.carries else None, simulation.states
            simulation.finger.solver.iteration.free()
            model = restart.model


# -- results -------------------------------------------------------------------------------------------------
def _of_state(
    scene: Scene,
    state: ContactState,
    fine: Fine | None,
    finger: Finger,
    cost: Cost,
    before: Counts,
    notes: Sequence[str],
) -> Result:
    """Return the result of full slip from a neighbour, or at the end of a path.

    Args:
        scene: of the point.
        state: on the mesh of the chain.
        fine: the state on the scene's own mesh, where that is another one.
        finger: with the mesh of the chain.
        cost: of all states on that mesh so far.
        before: counts of their solver before this one.
        notes: on how the state was found.
    """
    newton, factorisations = cost.newton_iterations - before.newton, cost.factorisations - before.factorisations
    unknowns, record, cautions = finger.unknowns, dict[str, Any](), list[Caution]()
    words = "without an error estimate; it was reached by"
    if fine is not None:
        if fine.state.ridges_in_contact != state.ridges_in_contact:
            own, larger = (f"{s.f_t:.6g} N/m with {counted(s.ridges_in_contact, 'ridge')}" for s in (fine.state, state))
            words = f"full slip has f_T {own} on the scene's mesh, and {larger} on larger elements: the error has both"
            cautions = [Caution("ridges_differ", words, fine.state.f_t)]
        state, solve = fine
        newton, factorisations = newton + solve.newton, factorisations + solve.factorisations
        unknowns, words = solve.unknowns, "solved for again on the scene's mesh; on larger elements it was reached by"
        record = {"path_mesh": finger.size.model_dump(), "accuracy": {"mesh": solve.mesh.model_dump()}}
    record |= {"reached": state.reached, "force_error": finger.force_error, "provenance": provenance()}
    return Result(
        scene,
        DEFAULT_MODEL,
        None,
        None,
        valued(state, OUTPUTS),
        outputs=OUTPUTS,
        cost=replace(cost, newton_iterations=newton, factorisations=factorisations, unknowns=unknowns),
        failure=broken(state, finger.force_error, coefficient(scene)),
        notes=(f"This is full slip alone, {words}: {state.reached}.", *notes),
        cautions=tuple(cautions),
        record=record,
    )


def _of_run(scene: Scene, why: str, clock: Clock, comm: MPI.Comm) -> Result:
    """Return full slip of a run of its own, which was not found on the scene's mesh, and why; collective."""
    from fingerpad.runs import full  # rarely

    found = full.run(scene, RunContext(comm=comm, bar=False, report=False))
    note = f"This is full slip of a run of its own, since it was not found from a state on larger elements: {why}."
    counts = Counts(found.cost.newton_iterations, found.cost.factorisations)
    return Result(
        scene,
        DEFAULT_MODEL,
        None,
        None,
        found.full_slip,
        cost=clock.cost(counts, found.cost.unknowns),
        failure=found.failure,
        notes=(note, *found.notes),
        cautions=found.cautions,
        record={key: found.record[key] for key in _OF_RUN if key in found.record} | {"reached": PATH},
    )


def main(file: Path, folder: Path) -> None:
    """Solve for the full slip of a chain of scenes (a file of JSON), each into a folder of its own."""
    data = json.loads(file.read_text(encoding="utf-8"))
    scenes = [from_data(each) for each in data["scenes"]]
    chain = Chain(scenes, data["half_arc"], MPI.COMM_WORLD)
    for k in chain.follow():
        kept(chain.results[k], RunContext(below(folder, batch.key(scenes[k])), report=False))


if __name__ == "__main__":
    limit_processor_time(float(sys.argv[3]))
    main(Path(sys.argv[1]), Path(sys.argv[2]))
