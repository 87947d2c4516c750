"""The accepted state of a path, whole and free of its ranks, from which another process of the program goes on.

It holds unknowns, all fields of history, the skin as solved, air gaps and gains, what is prescribed, and how far the
path has come to its target. All else that a path needs is evaluated from that. Values are those of the whole body, by
the places of nodes and Gauss points in the unloaded body, so that any number of ranks can take them over; what is put
in is what was taken, to the last bit. A factorisation is not kept: a path that is to go on as one that was never cut
short has to forget its own where its state is taken (:meth:`variational.solvers.iteration.Iteration.forget`).
"""

from collections.abc import Callable
from dataclasses import fields, replace
from typing import Any

import numpy as np
import ufl
from mpi4py import MPI
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from variational.contact.formulation import SurfaceState
from variational.history import SkinField
from variational.solvers.continuation import Continuation

Array = NDArray[np.float64]
_MAX_DISTANCE = 1e-9  # m, within which two places are one
_KIND = 1.0  # m, by which the places of displacements in x and y and of pressures in each layer are set apart
_SURFACE = [field.name for field in fields(SurfaceState) if field.name != "history"]


class OtherBody(ValueError):
    """A state of another mesh."""


def take(path: Continuation) -> dict[str, Any]:
    """Return the accepted state; collective.

    Returns:
        Arrays, dataclasses and numbers by name, whole on rank 0.
    """
    coupling, solver, problem = path.coupling, path.solver, path.problem
    together = _together(path)
    history: dict[str, tuple[str, Array]] = {}
    for name, field in problem.history.fields.items():
        values = problem.history.accepted[name]
        if isinstance(field, SkinField):
            history[name] = "points", together(values.ravel())
        else:
            own = field.by_cell(values)
            history[name] = name, together(own.reshape(-1, own.shape[2]))
    return {
        "places": {kind: together(own) for kind, own in _places(path).items()},
        "unknowns": together(solver.x.array_r.copy()),
        "history": history,
        "surface": {name: together(getattr(path.surface_state, name).ravel()) for name in _SURFACE},
        "d_eq": coupling.d_eq.copy(),
        "gain": coupling.gain.copy(),
        "control": replace(solver.control),
        "voltage": float(problem.voltage.value),
        "guess": float(problem.guess.value),
        "dt": float(problem.dt.value),
        "reaction": solver.reaction.copy(),
        "floor": solver.floor,
        "counts": replace(solver.counts),
        "seconds": dict(solver.timings.seconds),
        "steps": path.steps,
        "slip": path.slip,
        "time": path.time,
        "progress": replace(path.progress),
        "touching": path.touching,
    }


def put(path: Continuation, state: dict[str, Any]) -> None:
    """Go on from a state; collective, with the whole of it on every rank.

    Raises:
        OtherBody: it is of another mesh; on every rank.
    """
    coupling, solver, problem = path.coupling, path.solver, path.problem
    mine = order(path, state["places"])
    problem.voltage.value, problem.guess.value, problem.dt.value = state["voltage"], state["guess"], state["dt"]
    solver.control = state["control"]
    coupling.set_air_gaps(state["d_eq"].copy())
    coupling.gain = state["gain"].copy()
    shape = path.surface_state.x.shape
    accepted = {}
    for name, field in problem.history.fields.items():
        if name not in state["history"]:
            raise OtherBody(f"it has no history of the name {name}")
        kind, whole = state["history"][name]
        values = mine(kind, whole)
        if isinstance(field, SkinField):
            accepted[name] = values.reshape(shape)
        else:
            accepted[name] = field.from_cells(values.reshape(*field.cells.shape, -1))
    problem.history.accept(accepted)
    solver.x.array_w[:] = mine("unknowns", state["unknowns"])
    solver.equations.residual(solver.x, solver.iteration.f)
    solver.reaction, solver.iteration.floor = state["reaction"].copy(), state["floor"]
    vars(solver.counts).update(vars(state["counts"]))
    solver.timings.seconds.update(state["seconds"])
    surface = {name: mine("points", state["surface"][name]).reshape(shape) for name in _SURFACE}
    skin = {field.name: accepted[field.name] for field in problem.history.skin}
    path.surface_state = replace(path.surface_state, **surface, history=skin)
    path.steps, path.slip, path.time = state["steps"], tuple(state["slip"]), state["time"]
    path.progress, path.touching = state["progress"], state["touching"]
    path.resume()


def order(path: Continuation, places: dict[str, Array]) -> Callable[[str, Array], Array]:
    """Return what picks this rank's values, by kind, among those of all places; collective.

    Raises:
        OtherBody: the places are of another mesh; on every rank.
    """
    found, comm = {}, path.solver.layout.comm
    for kind, own in _places(path).items():
        whole = places.get(kind, np.empty(0))
        known = len(own) and len(whole)
        far, found[kind] = cKDTree(whole).query(own) if known else (np.full(len(own), np.inf), own[:, 0].astype(int))
        total = comm.allreduce(len(own))
        if total != len(whole) or comm.allreduce(float(np.max(far, initial=0.0)), op=MPI.MAX) > _MAX_DISTANCE:
            raise OtherBody(f"{len(whole)} {kind} are kept, and the mesh has {total} or has them elsewhere")
    return lambda kind, values: np.asarray(values[found[kind]])


def _together(path: Continuation) -> Callable[[Array], Array]:
    comm = path.solver.layout.comm

    def together(own: Array) -> Array:
        parts = comm.gather(own)
        return np.concatenate(parts) if parts is not None else np.empty(0)

    return together


def _places(path: Continuation) -> dict[str, Array]:
    """Return the places of this rank's values in the unloaded body (m), by kind."""
    surface, history = path.observer.surface, path.problem.history
    points = surface.evaluate(surface.compile(list(ufl.SpatialCoordinate(surface.mesh))))
    nodes = {field.name: field.places()[1].reshape(-1, 2) for field in history.body}
    return {"unknowns": _unknowns(path), "points": np.moveaxis(points, 0, -1).reshape(-1, 2), **nodes}


def _unknowns(path: Continuation) -> Array:
    """Return the places of this rank's unknowns in its part of a vector, set apart by kind."""
    layout, problem = path.solver.layout, path.problem
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
