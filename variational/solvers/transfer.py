r"""A snapshot of an accepted state, restored on another mesh of the body as the guess from which it is solved again.

On another mesh of the same body an equilibrium is found from one known already, instead of along the whole path of the
loads. A snapshot holds the displacement, the bone's translation, the ridges' air gaps, and the history of contact
and friction. The restored fields are no equilibrium; the state that is solved for from them is. A mixed element's
pressure is not in the snapshot: it follows from the restored displacement by the second equation.

**Displacement.** The old mesh is gathered on every rank (it is two-dimensional: some MB). A node of the new one takes
the value of the old polynomial in the triangle that it is inside of, curved or straight, or, beyond facets that cut off
a boundary, least outside of in barycentric coordinates. Straight facets of another length cut a ridge elsewhere, by
:math:`h^2 \kappa / 8`, half a micron where springs of the screen bear the contact over a tenth of that; curved ones
hardly do. Skin that is too low comes out of the screen in one step of Newton's method, since all of it is in contact;
skin that is too high is not, and comes back point by point. So a node on a ridge is put down to where the old mesh has
the skin at that place of the ridge's chord, and not up.

**History.** What friction keeps is the elastic slip :math:`s - u_x = t_t / \gamma_t` at Gauss points of the skin
(:mod:`~variational.contact.formulation`). It is interpolated linearly along each ridge, over the place on the
ridge's chord, so is the contact pressure, and :math:`s = u_x + (s - u_x)` is made anew with the new :math:`u_x`. So are
all fields of :mod:`variational.history` on the skin; those of the body are evaluated as the displacement is.

**Full slip.** There the traction is the limit of friction, :math:`\mp t_{max}(p_n)`, wherever there is pressure. The
state depends on the path only by where it is, since the screen looks the same everywhere: :math:`u + \delta e_x` is as
good a solution as u. So the body is moved on by :math:`\delta` and the anchors are not. Every point is then far beyond
its cone, none can stick while Newton's method moves the skin by less than :math:`\delta`, and what is solved for is the
state of full slip itself, of which the old mesh's history is no part. In a state with sticking points the history does
remain the old mesh's, interpolated, with the error that its path made.
"""

from dataclasses import dataclass, replace

import basix
import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from variational import compat
from variational.contact.formulation import SurfaceState
from variational.problem import Problem
from variational.reference import reference_places
from variational.solvers.coupling import Coupling
from variational.solvers.target import Control

Array = NDArray[np.float64]
_CANDIDATES = 32  # triangles about a point, by their centroids; sizes of neighbours differ by far less
_CURVED = 4  # of these, those that are looked into as the curved triangles that they are
_TURNS_BACK = 1.5  # way of the skin along an axis over its extent: 1 where it goes one way, 2 there and back
_NEWTON = 4  # iterations that find a place on a facet by its place on the chord
_OUTSIDE = 1.0  # altitudes of a triangle that a point of the same body may be outside of it


@dataclass(frozen=True)
class SkinState:
    """History of one ridge's skin, sorted along its chord; shape (points,) each."""

    origin: Array
    """A point of the chord (m), shape (2,)."""
    chord: Array
    """Its direction, shape (2,)."""
    along: Array
    """Place on the chord (m)."""
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
    here = np.stack([*_reference(problem, state), state.x, state.y, *relative.values()])
    points, ridge = _all(mesh.comm, here, 1), _all(mesh.comm, surface.ridge, 0)
    names, on_facet = list(relative), here.shape[2]
    skin = {j: _ridge(points[:, ridge == k].reshape(len(here), -1), on_facet, names) for k, j in enumerate(numbers)}
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


def restore(snapshot: StateSnapshot, coupling: Coupling, slide: float = 0.0) -> None:
    """Set a coupling on another mesh of the same body to the fields, history and controls of a state; collective.

    Args:
        snapshot: the state.
        coupling: on the other mesh.
        slide: how far the body is moved on sideways without its anchors (m), for a state of full slip: against the
            friction on the skin, and farther than the skin will move when the state is solved for.

    Raises:
        ValueError: another body or other ridges; on every rank.
    """
    problem, solver = coupling.solver.problem, coupling.solver
    numbers = problem.surface.ridge_numbers
    if numbers != list(snapshot.d_eq):
        raise ValueError(
            f"the state has ridges {min(snapshot.d_eq)} to {max(snapshot.d_eq)} that can touch and the mesh "
            f"{min(numbers)} to {max(numbers)}; they must be the same"
        )
    nodes = problem.V.tabulate_dof_coordinates()[:, :2]
    u, outside = interpolate(snapshot, nodes)
    farthest = float(np.max(problem.mesh.comm.allgather(outside)))
    if farthest > _OUTSIDE:
        raise ValueError(f"a node lies {farthest:.3g} triangles outside the state's mesh; it is of another body")
    for k, j in enumerate(numbers):
        skin, on_ridge = snapshot.skin[j], problem.surface.nodes(problem.V, k)
        there = place(skin, skin.position, nodes[on_ridge]) - nodes[on_ridge]
        lower = there[:, 1] < u[on_ridge, 1]
        u[on_ridge[lower]] = there[lower]
    shift = np.array([slide, 0.0])
    solver.set_displacement(u + shift, snapshot.bone + shift)
    solver.control = replace(snapshot.control, x=snapshot.control.x + slide)
    problem.voltage.value = snapshot.voltage
    coupling.set_air_gaps(np.array([snapshot.d_eq[j] for j in numbers]))
    coupling.gain = np.array([snapshot.gain[j] for j in numbers])

    state = coupling.observer.state()
    reference = np.stack(_reference(problem, state), axis=-1)
    restored = {}
    for inner in problem.history.body:
        places, inside = inner.places()
        found = _restored(snapshot, snapshot.history[inner.name], places.reshape(-1, 2), inside.reshape(-1, 2))
        restored[inner.name] = inner.from_cells(found.reshape(*places.shape[:2], -1))
    followed = problem.history.followed(state.history)
    for field in problem.history.skin:
        relative = np.zeros_like(state.x)
        for k, j in enumerate(numbers):
            mine, ridge = problem.surface.ridge == k, snapshot.skin[j]
            along = (reference[mine] - ridge.origin) @ ridge.chord
            relative[mine] = np.interp(along, ridge.along, ridge.history[field.name])
        back = 0.0 if field.follows is None else slide
        restored[field.name] = followed[field.name] - back + relative
    problem.history.accept(restored)


def interpolate(snapshot: StateSnapshot, points: Array) -> tuple[Array, float]:
    """Return the displacement (m) at reference points (m), shape (n, 2) both, and how far one is outside at most.

    The distance is in altitudes of the triangle that the value is taken from, zero if every point is inside.
    """
    cell, X, outside = _locate(snapshot, points)
    return _evaluate(snapshot.u, cell, X), outside


def _restored(snapshot: StateSnapshot, values: Array, nodes: Array, inside: Array) -> Array:
    """Return values by cell at reference points (m), of the cells of the snapshot that points beside them are in."""
    cell, _, _ = _locate(snapshot, inside)
    return _evaluate(values, cell, reference_places(snapshot.x[cell], nodes))


def _locate(snapshot: StateSnapshot, points: Array) -> tuple[NDArray[np.int64], Array, float]:
    """Return each point's triangle, its coordinates there, shape (n, 2), and how far one is outside at most."""
    if len(points) == 0:
        return np.zeros(0, dtype=np.int64), np.zeros((0, 2)), 0.0
    a, b, c = np.moveaxis(snapshot.x[:, :3], 1, 0)
    tree = cKDTree((a + b + c) / 3)
    near = tree.query(points, min(_CANDIDATES, len(a)))[1].reshape(len(points), -1)
    edges = np.stack([b - a, c - a], axis=-1)
    to_reference = np.linalg.inv(edges)
    local = np.einsum("nkij,nkj->nki", to_reference[near], points[:, None] - a[near])
    row = np.arange(len(points))
    near = near[row[:, None], np.argsort(-_least(local), axis=1)[:, :_CURVED]]
    places = reference_places(snapshot.x[near.ravel()], np.repeat(points, near.shape[1], axis=0))
    local = places.reshape(*near.shape, 2)
    inside = _least(local)
    best = inside.argmax(axis=1)
    return near[row, best], local[row, best], float(max(0.0, -inside[row, best].min()))


def _least(X: Array) -> Array:
    """Return the least barycentric coordinate of reference coordinates, negative outside of the triangle."""
    return np.asarray(np.minimum(X.min(axis=-1), 1 - X.sum(axis=-1)))


def _evaluate(values: Array, cell: NDArray[np.int64], X: Array) -> Array:
    """Return nodal values, shape (cells, nodes, components), at points X of a cell each, shape (n, components)."""
    if values.shape[1] == 1:
        return values[cell, 0]
    degree = {3: 1, 6: 2, 10: 3}[values.shape[1]]
    element = basix.create_element(
        basix.ElementFamily.P, basix.CellType.triangle, degree, basix.LagrangeVariant.gll_warped
    )
    basis = np.asarray(element.tabulate(0, X))[0, :, :, 0]
    return np.einsum("nk,nki->ni", basis, values[cell])


def place(ridge: SkinState, position: Array, nodes: Array) -> Array:
    """Return where (m) the skin of a ridge is, of its state's ``position``, at reference points on it (m).

    Both have the shape (n, 2).
    """
    n = position.shape[1]
    to_powers = np.linalg.inv(np.vander(_gauss(n), n))
    points, along = ridge.along.reshape(-1, n) @ to_powers.T, (nodes - ridge.origin) @ ridge.chord
    start, end = points[:, -1], points.sum(axis=1)
    facet = np.clip(np.searchsorted(start, along, side="right") - 1, 0, len(start) - 1)
    slopes = points[:, :-1] * np.arange(n - 1, 0, -1)
    xi = (along - start[facet]) / (end - start)[facet]
    for _ in range(_NEWTON):  # the chord's coordinate is quadratic along a curved facet
        off = np.einsum("nk,nk->n", np.vander(xi, n), points[facet]) - along
        xi = xi - off / np.einsum("nk,nk->n", np.vander(xi, n - 1), slopes[facet])
    return np.einsum("nk,nki->ni", np.vander(xi, n) @ to_powers, position[facet])


def _gauss(n: int) -> Array:
    """Return the places of n Gauss points on a facet of length 1, shape (n,)."""
    return (1 + np.polynomial.legendre.leggauss(n)[0]) / 2


def _reference(problem: Problem, state: SurfaceState) -> tuple[Array, Array]:
    """Return the reference positions (m) of this rank's Gauss points, shape (facets, points) each."""
    u_x, u_y = problem.surface.evaluate(problem.surface.compile([problem.u[0], problem.u[1]]))
    return state.x - u_x, state.y - u_y


def _all(comm: MPI.Comm, values: NDArray, axis: int) -> NDArray:
    return np.concatenate(comm.allgather(values), axis=axis)


def _ridge(points: Array, on_facet: int, names: list[str]) -> SkinState:
    """Sort the points of a ridge along its chord; rows x, y, current x and y, and history by names."""
    xy = points[:2]
    origin = xy.mean(axis=1)
    # The chord is the first principal direction, in which most ridges are wide, unless the skin turns back on the way.
    axes = np.linalg.svd(xy - origin[:, None], full_matrices=False)[0]
    chord = axes[:, 0]
    along = chord @ (xy - origin[:, None])
    on_facets = along.reshape(-1, on_facet)
    span = _gauss(on_facet)[-1] - _gauss(on_facet)[0]  # of the points on a facet, whose length is 1
    if np.abs(on_facets[:, -1] - on_facets[:, 0]).sum() > _TURNS_BACK * span * np.ptp(along):
        chord = axes[:, 1]
        along = chord @ (xy - origin[:, None])
    order = np.argsort(along)
    position = points[2:4, order].T.reshape(-1, on_facet, 2)
    history = {name: points[4 + k, order] for k, name in enumerate(names)}
    return SkinState(origin, chord, along[order], position, history)
