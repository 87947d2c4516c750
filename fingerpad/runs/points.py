"""Results of full slip alone, the points of sweeps of ``states="full_slip"``."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from fingerpad.results.result import Cost, Result
from fingerpad.runs.context import RunContext
from fingerpad.runs.sweep_columns import OTHER
from fingerpad.scene import Scene
from fingerpad.scene.messages import counted
from fingerpad.scene.reading import DEFAULT_MODEL
from variational.state import PATH, ContactState

if TYPE_CHECKING:
    from fingerpad.accuracy.sharpened import Sharpened
    from fingerpad.model.finger import Finger
    from fingerpad.model.report import Clock
    from fingerpad.startup import MPI
    from variational.solvers.outcome import Counts

_SAME = 1e-3  # relative difference of f_t up to which states with equal ridges are one: from two sides 3e-5 is seen
_OF_RUN = ("path_mesh", "accuracy", "restarts", "force_error", "provenance")  # what a point keeps of a run's record


@dataclass(frozen=True)
class Point:
    """Full slip that was solved for from a neighbour, or at the end of a path."""

    scene: Scene
    state: ContactState
    """On the mesh of the chain."""
    finger: "Finger"
    """With that mesh."""
    final: "Sharpened | None"
    """The state on the scene's own mesh, where that is another one."""

    def result(self, cost: Cost, before: "Counts", notes: Sequence[str]) -> Result:
        """Return the result.

        Args:
            cost: of all states on the mesh of the chain so far.
            before: counts of their solver before this one.
            notes: on how the state was found.
        """
        from fingerpad.model.state import broken
        from fingerpad.results.provenance import provenance
        from fingerpad.scene.remarks import coefficient

        finger, state, solve = self.finger, self.state, None
        newton, factorisations = cost.newton_iterations - before.newton, cost.factorisations - before.factorisations
        unknowns, record = finger.unknowns, dict[str, Any]()
        words = "without an error estimate; it was reached by"
        if self.final is not None:
            state, solve = self.final.state, self.final.solve
            newton, factorisations = newton + solve.newton, factorisations + solve.factorisations
            unknowns, words = (
                solve.unknowns,
                "solved for again on the scene's mesh; on larger elements it was reached by",
            )
            record = {"path_mesh": finger.size.model_dump(), "accuracy": {"mesh": solve.mesh.model_dump()}}
        record |= {"reached": state.reached, "force_error": finger.force_error, "provenance": provenance()}
        return Result(
            self.scene,
            DEFAULT_MODEL,
            None,
            None,
            state,
            cost=replace(cost, newton_iterations=newton, factorisations=factorisations, unknowns=unknowns),
            failure=broken(state, finger.force_error, coefficient(self.scene)),
            notes=(f"This is full slip alone, {words}: {state.reached}.", *notes),
            cautions=tuple(self._differences()),
            record=record,
        )

    def _differences(self) -> list[str]:
        """Return a caution where other ridges touch on the two meshes."""
        if self.final is None or self.final.state.ridges_in_contact == self.state.ridges_in_contact:
            return []
        larger, own = (
            f"{s.f_t:.6g} N/m with {counted(s.ridges_in_contact, 'ridge')}" for s in (self.state, self.final.state)
        )
        return [f"full slip has f_T {own} on the scene's mesh, and {larger} on larger elements: the error has both"]


def of_run(scene: Scene, why: str, clock: "Clock", comm: "MPI.Comm") -> Result:
    """Return full slip of a run of its own; collective.

    Args:
        scene: of the point.
        why: it was not found on the scene's mesh.
        clock: of the point.
        comm: communicator of the run.
    """
    from fingerpad.runs.full import run
    from variational.solvers.outcome import Counts

    found = run(scene, RunContext(comm=comm, bar=False, report=False))
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


def one(a: ContactState, b: ContactState) -> bool:
    """Return whether two states are the same one."""
    return a.ridges_in_contact == b.ridges_in_contact and abs(a.f_t - b.f_t) <= _SAME * abs(b.f_t)


def with_other(result: Result, other: ContactState) -> Result:
    """Return a result with a second state of full slip, and a caution that gives both."""
    mine = result.full_slip
    assert mine is not None
    names = ("f_t", "mu_app", "contact_length", "f_electrostatic", "ridges_in_contact", "reached")
    said = [f"f_T {s.f_t:.6g} N/m with {counted(s.ridges_in_contact, 'ridge')} ({s.reached})" for s in (mine, other)]
    caution = f"there are two states of full slip: {said[0]} and {said[1]}"
    record = result.record | {OTHER: {name: getattr(other, name) for name in names}}
    return replace(result, record=record, cautions=(*result.cautions, caution))
