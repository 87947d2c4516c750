"""A snapshot of an accepted state, the same on every rank and free of its mesh."""

from dataclasses import dataclass, replace

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from variational import compat
from variational.contact.formulation import SurfaceState
from variational.problem import Problem
from variational.solvers.coupling import Coupling
from variational.solvers.target import Control

Array = NDArray[np.float64]
_IMAGE = np.array([-1.0, 1.0, -1.0, 1.0, 1.0])  # of x, y, current x and y and gap in the mirror image
_TURNS_BACK = 1.5  # way of the skin along an axis over its extent: 1 where it goes one way, 2 there and back


@dataclass(frozen=True)
class SkinState:
    """History of one ridge's skin, sorted along its chord; shape (points,) each.

    Of half a body, ridge 0 is here whole: the line of symmetry is no end of its contact, and friction is odd across it.
    """

    origin: Array
    """A point of the chord (m), shape (2,)."""
    chord: Array
    """Its direction, shape (2,)."""
    along: Array
    """Place on the chord (m)."""
    reference: Array
    """Place in the unloaded body (m), shape (points, 2)."""
    gap: Array
    """What is negative in contact (m), see :class:`variational.contact.formulation.SurfaceState`."""
    position: Array
    """Current place (m), by facet, shape (facets, points on each, 2)."""
    history: dict[str, Array]
    """Fields of history less what they follow (:class:`variational.history.SkinField`): of the anchor s - u_x (m)."""


@dataclass(frozen=True)
class StateSnapshot:
    """An accepted state, the same on every rank and free of its mesh."""

    x: Array
    """Nodes of the geometry of all triangles (m), shape (cells, 3 or 6, 2)."""
    u: Array
    """Displacement at their nodes (m), shape (cells, nodes, 2)."""
    skin: dict[int, SkinState]
    """By the ridge's number."""
    history: dict[str, Array]
    """History of the body by field, shape (cells, nodes, components)."""
    d_eq: dict[int, float]
    """Equivalent air gap (m) by the ridge's number."""
    gain: dict[int, float]
    """See :attr:`variational.solvers.coupling.Coupling.gain`, by the ridge's number."""
    bone: Array
    """The bone's translation (m), shape (2,)."""
    control: Control
    voltage: float


def take_snapshot(coupling: Coupling, state: SurfaceState) -> StateSnapshot:
    """Take the accepted state of a coupling; collective.

    Args:
        coupling: whose fields and controls are those of the state.
        state: its surface.
    """
    problem, solver = coupling.solver.problem, coupling.solver
    mesh, surface, numbers = problem.mesh, problem.surface, problem.surface.ridge_numbers
    cells = np.arange(mesh.topology.index_map(2).size_local)
    x = mesh.geometry.x[compat.cell_geometry(mesh)[cells]][:, :, :2]
    u = problem.displacement()[problem.V.dofmap.list[cells]]
    history = problem.history
    followed = history.followed(state.history)
    relative = {name: state.history[name] - base for name, base in followed.items()}
    here = np.stack([*reference_of_points(problem, state), state.x, state.y, state.gap, *relative.values()])
    points, ridge = _all(mesh.comm, here, 1), _all(mesh.comm, surface.ridge, 0)
    names, on_facet = list(relative), here.shape[2]
    of_ridges = {j: points[:, ridge == k].reshape(len(here), -1) for k, j in enumerate(numbers)}
    if coupling.observer.mirrored:
        odd = [-1.0 if field.follows is not None else 1.0 for field in history.skin]  # places and displacements
        of_ridges[0] = np.concatenate([of_ridges[0], of_ridges[0] * np.append(_IMAGE, odd)[:, None]], axis=1)
    skin = {j: _ridge(each, on_facet, names) for j, each in of_ridges.items()}
    return StateSnapshot(
        _all(mesh.comm, x, 0),
        _all(mesh.comm, u, 0),
        skin,
        {field.name: _all(mesh.comm, field.by_cell(history.accepted[field.name]), 0) for field in history.body},
        {j: float(d) for j, d in zip(numbers, coupling.d_eq, strict=True)},
        {j: float(g) for j, g in zip(numbers, coupling.gain, strict=True)},
        solver.bone,
        replace(solver.control),
        float(problem.voltage.value),
    )


def gauss(n: int) -> Array:
    """Return the places of n Gauss points on a facet of length 1, shape (n,)."""
    return (1 + np.polynomial.legendre.leggauss(n)[0]) / 2


def reference_of_points(problem: Problem, state: SurfaceState) -> tuple[Array, Array]:
    """Return the reference positions (m) of this rank's Gauss points, shape (facets, points) each."""
    u_x, u_y = problem.surface.evaluate(problem.surface.compile([problem.u[0], problem.u[1]]))
    return state.x - u_x, state.y - u_y


def _all(comm: MPI.Comm, values: NDArray, axis: int) -> NDArray:
    return np.concatenate(comm.allgather(values), axis=axis)


def _ridge(points: Array, on_facet: int, names: list[str]) -> SkinState:
    """Sort the points of a ridge along its chord; rows x, y, current x and y, gap, and history by names."""
    xy = points[:2]
    origin = xy.mean(axis=1)
    # The chord is the first principal direction, in which most ridges are wide, unless the skin turns back on the way.
    axes = np.linalg.svd(xy - origin[:, None], full_matrices=False)[0]
    chord = axes[:, 0]
    along = chord @ (xy - origin[:, None])
    on_facets = along.reshape(-1, on_facet)
    span = gauss(on_facet)[-1] - gauss(on_facet)[0]  # of the points on a facet, whose length is 1
    if np.abs(on_facets[:, -1] - on_facets[:, 0]).sum() > _TURNS_BACK * span * np.ptp(along):
        chord = axes[:, 1]
        along = chord @ (xy - origin[:, None])
    order = np.argsort(along)
    position = points[2:4, order].T.reshape(-1, on_facet, 2)
    history = {name: points[5 + k, order] for k, name in enumerate(names)}
    return SkinState(origin, chord, along[order], xy[:, order].T, points[4, order], position, history)
