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

**More skin that can touch.** A ridge that could not touch on the old mesh has the history of the valley beside it, and
the air gap of one without contact. So a path goes on where more of the skin must be able to touch than was meshed for
it.
"""

from dataclasses import replace

import basix
import dolfinx
import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from variational import compat
from variational.output import reference_places
from variational.problem import Problem
from variational.solvers.coupling import Coupling
from variational.solvers.state_snapshot import SkinState, StateSnapshot, gauss, reference_of_points

Array = NDArray[np.float64]
_CANDIDATES = 8  # triangles about a point, those of the nearest centroids, by distance over size
_CURVED = 4  # of these, those that are looked into as the curved triangles that they are
_NEWTON = 4  # iterations that find a place on a facet by its place on the chord
_FOLDED, _UNFOLD = 0.1, 3  # least det F of a restored displacement, and how often it is made so
_OUTSIDE = 1.0  # altitudes of a triangle that a point of the same body may be outside of it


def restore(snapshot: StateSnapshot, coupling: Coupling, slide: float = 0.0) -> None:
    """Set a coupling on another mesh of the same body to the fields, history and controls of a state; collective.

    Args:
        snapshot: the state.
        coupling: on the other mesh.
        slide: how far the body is moved on sideways without its anchors (m), for a state of full slip: against the
            friction on the skin, and farther than the skin will move when the state is solved for.

    Raises:
        ValueError: another body; on every rank.
    """
    problem, solver = coupling.solver.problem, coupling.solver
    known = [(k, j) for k, j in enumerate(problem.surface.ridge_numbers) if j in snapshot.d_eq]
    nodes = problem.V.tabulate_dof_coordinates()[:, :2]
    u, outside = interpolate(snapshot, nodes)
    farthest = float(np.max(problem.mesh.comm.allgather(outside)))
    if farthest > _OUTSIDE:
        raise ValueError(f"a node lies {farthest:.3g} triangles outside the state's mesh; it is of another body")
    for k, j in known:
        skin, on_ridge = snapshot.skin[j], problem.surface.nodes(problem.V, k)
        there = place(skin, skin.position, nodes[on_ridge]) - nodes[on_ridge]
        lower = there[:, 1] < u[on_ridge, 1]
        u[on_ridge[lower]] = there[lower]
    u = unfolded(problem, u)
    shift = np.array([slide, 0.0])
    solver.set_displacement(u + shift, snapshot.bone + shift)
    solver.control = replace(snapshot.control, x=snapshot.control.x + slide)
    problem.voltage.value = snapshot.voltage
    d_eq, gain = coupling.open_gaps(), np.full_like(coupling.gain, np.nan)
    for k, j in known:
        d_eq[k], gain[k] = snapshot.d_eq[j], snapshot.gain[j]
    coupling.set_air_gaps(d_eq)
    coupling.gain = gain

    state = coupling.observer.state()
    reference = np.stack(reference_of_points(problem, state), axis=-1)
    restored = {}
    for inner in problem.history.body:
        places, inside = inner.places()
        found = _restored(snapshot, snapshot.history[inner.name], places.reshape(-1, 2), inside.reshape(-1, 2))
        restored[inner.name] = inner.from_cells(found.reshape(*places.shape[:2], -1))
    followed = problem.history.followed(state.history)
    for field in problem.history.skin:
        relative = np.zeros_like(state.x)
        for k, j in enumerate(problem.surface.ridge_numbers):
            mine, ridge = problem.surface.ridge == k, snapshot.skin[min(snapshot.skin, key=lambda i: abs(i - j))]
            along = (reference[mine] - ridge.origin) @ ridge.chord  # of another ridge beyond an end, in a valley
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


def unfolded(problem: Problem, u: Array) -> Array:
    """Return a displacement (m), shape (nodes, 2), that turns no element inside out, or nearly; collective.

    Where an interpolated one does, as beside the tip of a junction that the old mesh did not resolve, the nodes between
    the corners take what lies between the displacements of the corners.
    """
    mesh, dofs = problem.mesh, problem.V.dofmap
    cells = dofs.list[: mesh.topology.index_map(2).size_local]
    x = mesh.geometry.x[compat.cell_geometry(mesh)[: len(cells)]][:, :, :2]
    element = problem.V.element.basix_element
    places = np.asarray(element.points)
    inside = np.vstack([basix.make_quadrature(basix.CellType.triangle, 4)[0], places[:3]])
    slopes = np.asarray(element.tabulate(1, inside))[1:, :, :, 0]
    order = 1 if x.shape[1] == 3 else 2
    geometry = basix.create_element(basix.ElementFamily.P, basix.CellType.triangle, order)
    X = np.einsum("dpk,nki->npid", np.asarray(geometry.tabulate(1, inside))[1:, :, :, 0], x)
    between = np.column_stack([1 - places.sum(axis=1), places])[3:]
    folded = dolfinx.la.vector(dofs.index_map, 1, np.int8)
    for _ in range(_UNFOLD):
        moved = X + np.einsum("dpk,nki->npid", slopes, u[cells])
        bad = (np.linalg.det(moved) / np.linalg.det(X)).min(axis=1, initial=1.0) < _FOLDED
        if not mesh.comm.allreduce(bool(bad.any()), op=MPI.LOR):
            break
        folded.array[:] = 0
        folded.array[cells[bad, 3:]] = 1
        folded.scatter_reverse(dolfinx.la.InsertMode.add)
        folded.scatter_forward()
        straight = np.einsum("ek,nki->nei", between, u[cells[:, :3]])
        mine = folded.array[cells[:, 3:]] > 0
        u = u.copy()
        u[cells[:, 3:][mine]] = straight[mine]
    return u


def _restored(snapshot: StateSnapshot, values: Array, nodes: Array, inside: Array) -> Array:
    """Return values by cell at reference points (m), of the cells of the snapshot that points beside them are in."""
    cell, _, _ = _locate(snapshot, inside)
    return _evaluate(values, cell, reference_places(snapshot.x[cell], nodes))


def _locate(snapshot: StateSnapshot, points: Array) -> tuple[NDArray[np.int64], Array, float]:
    """Return each point's triangle, its coordinates there, shape (n, 2), and how far one is outside at most."""
    if len(points) == 0:
        return np.zeros(0, dtype=np.int64), np.zeros((0, 2)), 0.0
    a, b, c = corners = np.moveaxis(snapshot.x[:, :3], 1, 0)
    near = _near(corners, points)
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


def _near(corners: Array, points: Array) -> NDArray[np.int64]:
    """Return triangles about points, shape (n, candidates): a point may be in a large one beside many small ones.

    Args:
        corners: of the triangles (m), shape (3, cells, 2).
        points: the points (m), shape (n, 2).
    """
    size = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=2).max(axis=0)
    centroids, level = corners.mean(axis=0), np.frexp(size)[1]
    near, far = [], []
    for each in np.unique(level):
        mine = np.flatnonzero(level == each)
        largest = size[mine].max()
        tree = cKDTree(centroids[mine])
        distance, found = tree.query(points, range(1, 1 + _CANDIDATES), distance_upper_bound=largest)
        near.append(np.append(mine, 0)[found])
        far.append(distance / largest)
    together, distance = np.hstack(near), np.hstack(far)
    nearest = np.argpartition(distance, _CANDIDATES - 1, axis=1)[:, :_CANDIDATES]
    found = np.take_along_axis(together, nearest, axis=1)
    outside = np.flatnonzero(np.isinf(distance.min(axis=1)))  # of a boundary, by more than a triangle
    found[outside] = cKDTree(centroids).query(points[outside])[1][:, None]
    return found


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
    to_powers = np.linalg.inv(np.vander(gauss(n), n))
    points, along = ridge.along.reshape(-1, n) @ to_powers.T, (nodes - ridge.origin) @ ridge.chord
    start, end = points[:, -1], points.sum(axis=1)
    facet = np.clip(np.searchsorted(start, along, side="right") - 1, 0, len(start) - 1)
    slopes = points[:, :-1] * np.arange(n - 1, 0, -1)
    xi = (along - start[facet]) / (end - start)[facet]
    for _ in range(_NEWTON):  # the chord's coordinate is quadratic along a curved facet
        off = np.einsum("nk,nk->n", np.vander(xi, n), points[facet]) - along
        xi = xi - off / np.einsum("nk,nk->n", np.vander(xi, n - 1), slopes[facet])
    return np.einsum("nk,nki->ni", np.vander(xi, n) @ to_powers, position[facet])
