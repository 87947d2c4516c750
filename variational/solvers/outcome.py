"""What a solve left, kept so that another process of the same program can take it over instead of solving.

A path of loads is determined by what its solves leave: all else that a run reports is evaluated from that. So a run
that was cut short is gone through again with the outcomes of its solves put in their places, and goes on by itself
where they end. The outcomes are of the whole body, by the places of nodes and Gauss points in the unloaded body, and
any number of ranks can take them over. What is put in is what was kept, to the last bit.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import ufl
from mpi4py import MPI
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from variational.solvers.coupling import Coupling, CouplingHistory
from variational.solvers.failure import NotConverged

Array = NDArray[np.float64]
_SAME = 1e-9  # m, within which two places are one
_KIND = 1.0  # m, by which the places of displacements in x and y and of pressures in each layer are set apart


class OtherBody(ValueError):
    """Outcomes of another mesh."""


@dataclass(frozen=True)
class Outcome:
    """What a solve left."""

    facts: dict[str, Any] = field(default_factory=dict)
    """Ready for JSON: work, iterations of the loop over the scales, and ``failure`` where no equilibrium was found."""
    arrays: dict[str, Array] = field(default_factory=dict)
    """Unknowns, history and air gaps, on rank 0; empty after a failure."""


class Taken:
    """Takes outcomes of one coupled problem, and puts them in.

    Attributes:
        places: where its unknowns are, shape (unknowns, 3) with their kind, and its Gauss points, shape (points, 2),
            (m) in the order of the ranks; on rank 0.
    """

    def __init__(self, coupling: Coupling, kept: Mapping[str, Array] | None = None) -> None:
        """Find the places; collective.

        Args:
            coupling: of a body.
            kept: the ``places`` of the outcomes that will be put in; None where there are none.

        Raises:
            OtherBody: they are of another mesh; on every rank.
        """
        self._coupling, self._comm = coupling, coupling.solver.layout.comm
        self._names = [field.name for field in coupling.solver.problem.history.skin]
        self._own = {"unknowns": _unknowns(coupling), "points": _points(coupling)}
        self.places = {name: self._together(own) for name, own in self._own.items()}
        self._order: dict[str, NDArray[np.int64]] = {}
        if kept is not None:
            self._order = {name: self._find(name, places) for name, places in kept.items()}

    def _find(self, name: str, places: Array) -> NDArray[np.int64]:
        """Return where this rank's values are among those kept."""
        own = self._own[name]
        far, order = cKDTree(places).query(own) if len(own) and len(places) else (np.full(len(own), np.inf), own[:, 0])
        total = self._comm.allreduce(len(own))
        if total != len(places) or self._comm.allreduce(float(np.max(far, initial=0.0)), op=MPI.MAX) > _SAME:
            raise OtherBody(f"{len(places)} {name} are kept, and the mesh has {total} or has them elsewhere")
        return np.asarray(order, dtype=np.int64)

    def _together(self, own: Array) -> Array:
        parts = self._comm.gather(own)
        return np.concatenate(parts) if parts is not None else np.empty(0)

    # -- taking ----------------------------------------------------------------------------------------
    def solve(self, pseudo_transient: bool) -> Outcome:
        """Solve and return the outcome, of a failure too; collective."""
        solver, before = self._coupling.solver, self._work()
        failure = None
        try:
            self._coupling.solve(pseudo_transient)
        except NotConverged as error:
            failure = [error.reason, error.inverted, error.irrecoverable, error.cycling]
        history = self._coupling.history
        facts = {
            "work": [now - then for now, then in zip(self._work(), before, strict=True)],
            "loop": [history.changes, history.ridges, history.errors, sorted(history.jumped)],
            "failure": failure,
        }
        if failure is not None:
            return Outcome(facts)
        facts |= {"floor": solver.floor, "guess": float(solver.problem.guess.value)}
        arrays = {"unknowns": self._together(solver.x.array_r.copy())}
        arrays |= {name: self._together(solver.problem.history.imposed[name].ravel()) for name in self._names}
        arrays |= {"d_eq": self._coupling.d_eq.copy(), "gain": self._coupling.gain.copy()}
        return Outcome(facts, arrays)

    def _work(self) -> tuple[int, int, int]:
        counts = self._coupling.solver.counts
        return counts.newton, counts.factorisations, counts.pseudo_transient

    # -- putting in ------------------------------------------------------------------------------------
    def put(self, outcome: Outcome) -> None:
        """Leave what the solve left; collective, with the whole outcome on every rank.

        Raises:
            NotConverged: as the solve did.
        """
        coupling, solver, facts = self._coupling, self._coupling.solver, outcome.facts
        newton, factorisations, pseudo_transient = facts["work"]
        solver.counts.newton += newton
        solver.counts.factorisations += factorisations
        solver.counts.pseudo_transient += pseudo_transient
        changes, ridges, errors, jumped = facts["loop"]
        coupling.history = CouplingHistory(changes, ridges, errors, set(jumped))
        if facts["failure"] is not None:
            reason, *flags = facts["failure"]
            raise NotConverged(reason, *flags)
        arrays = outcome.arrays
        solver.problem.guess.value = facts["guess"]
        coupling.set_air_gaps(arrays["d_eq"].copy())
        coupling.gain = arrays["gain"].copy()
        points = self._order["points"]
        history = solver.problem.history
        history.impose({n: arrays[n][points].reshape(history.imposed[n].shape) for n in self._names})
        solver.x.array_w[:] = arrays["unknowns"][self._order["unknowns"]]
        solver.equations.residual(solver.x, solver.iteration.f)
        solver.iteration.floor = facts["floor"]

    def forget(self) -> None:
        """Drop what the next solve would use of the last one's and another process does not have."""
        self._coupling.solver.iteration.forget()


def _unknowns(coupling: Coupling) -> Array:
    """Return the places of this rank's unknowns in its part of a vector, set apart by kind."""
    layout, problem = coupling.solver.layout, coupling.solver.problem
    places = np.zeros((layout.local_size, 3))
    vector = layout.create_vector()
    nodes = problem.V.tabulate_dof_coordinates()[:, :2]
    for column, own in enumerate(nodes.T):
        layout.from_nodes(np.repeat(own, 2), np.full(2, np.inf), vector)
        places[:, column] = vector.array_r
    kinds = np.tile([_KIND, 2 * _KIND], len(nodes))
    layout.from_nodes(kinds, np.array([_KIND, 2 * _KIND]), vector)
    places[:, 2] = vector.array_r
    places[~np.isfinite(places)] = -_KIND  # the rigid body's
    if problem.pressure:
        places[: problem.pressure.owned] = problem.pressure.places() + [0.0, 0.0, 3 * _KIND]
    return places


def _points(coupling: Coupling) -> Array:
    """Return the places of this rank's Gauss points in the unloaded body, shape (points, 2)."""
    surface = coupling.observer.surface
    x = surface.evaluate(surface.compile(list(ufl.SpatialCoordinate(surface.mesh))))
    return np.moveaxis(x, 0, -1).reshape(-1, 2)
