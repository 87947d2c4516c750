"""What is evaluated inside of the body: means of each cell, and energy densities at receptor sites.

Stress, strain and energy density jump from layer to layer, so that each cell has its own. States of the whole body are
gathered on one rank.
"""

from collections.abc import Mapping
from functools import cached_property
from typing import Any

import basix
import dolfinx
import numpy as np
import ufl
from dolfinx import fem, geometry
from mpi4py import MPI
from numpy.typing import NDArray

from variational import compat, jit, kinematics
from variational.problem import Problem
from variational.snapshot import Snapshot, outline

Array = NDArray[np.float64]
_NEWTON, _STEP = 12, 0.5  # iterations that find a place in a curved triangle, and the longest step of one
_NEAR = 1e-7  # step after which a place is found to roundoff, by quadratic convergence
_STRAIGHT = 1e-11  # of the triangle's size: what roundoff of the nodes leaves of an edge's bend
_FLAT = 0.05  # of the straight triangle's area: least determinant, outside of the triangle
_MIDDLES = np.array([[0.5, 0.5], [0.0, 0.5], [0.5, 0.0]])  # of the reference triangle's edges, by opposite vertex
_ROUNDOFF = 1e-8  # of a barycentric coordinate: a site on a facet belongs to both cells
_BEYOND = 1e-3  # of the body's size: what a curved edge may be beyond its nodes


def owned_cells(mesh: dolfinx.mesh.Mesh) -> NDArray[np.int32]:
    """Return the numbers of this rank's own cells."""
    return np.arange(mesh.topology.index_map(mesh.topology.dim).size_local, dtype=np.int32)


class Cellwise:
    """An expression for each solid, on the cells with its tags only, evaluated at reference points of own cells.

    Attributes:
        shape: shape of the expressions' values.
    """

    def __init__(
        self,
        mesh: dolfinx.mesh.Mesh,
        cell_tags: dolfinx.mesh.MeshTags,
        expressions: Mapping[tuple[int, ...], Any],
        points: Array,
    ) -> None:
        """Compile the expressions.

        Args:
            mesh: the body (m).
            cell_tags: tags of its cells.
            expressions: UFL expressions of one shape, by the tags of the cells on which they hold.
            points: reference points of a cell, shape (points, 2), the same on every rank.
        """
        self.mesh, self._points = mesh, len(points)
        self.shape = next(iter(expressions.values())).ufl_shape
        self._compiled = [fem.Expression(e, points, jit_options=jit.OPTIONS) for e in expressions.values()]
        self._group = np.full(len(owned_cells(mesh)), -1)
        for k, tags in enumerate(expressions):
            for tag in tags:
                cells = cell_tags.find(tag)
                self._group[cells[cells < len(self._group)]] = k

    def evaluate(self, cells: NDArray[np.int32] | None = None) -> Array:
        """Return values on own cells, by default all, shape (cells, points, components); NaN without expression."""
        if cells is None:
            cells = owned_cells(self.mesh)
        values = np.full((len(cells), self._points, int(np.prod(self.shape, dtype=int))), np.nan)
        for k, compiled in enumerate(self._compiled):
            mine = self._group[cells] == k
            found = compat.evaluate_on_cells(compiled, self.mesh, np.ascontiguousarray(cells[mine]))
            values[mine] = found.reshape((int(mine.sum()), *values.shape[1:]))
        return values


def _stresses(problem: Problem) -> dict[tuple[int, ...], Any]:
    """Return the Cauchy stress (Pa), shape (3, 3), of each law by the tags of its cells."""
    F = kinematics.deformation_gradient(ufl.grad(problem.u))
    return {tags: kinematics.cauchy(law, F, problem.pressures[tags]) for tags, law in problem.laws.items()}


def _tensors_per_cell(problem: Problem) -> tuple[Array, Array]:
    """Return means over the corners of each cell of this rank, which for linear fields are those over the cell.

    Returns:
        Cauchy stress (Pa), xx, yy, zz and xy, shape (cells, 4), and Green's strain, xx, yy and xy, shape (cells, 3).
    """
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    stress = Cellwise(problem.mesh, problem.cell_tags, _stresses(problem), corners).evaluate().mean(axis=1)
    strains = dict.fromkeys(problem.laws, kinematics.green_strain(ufl.grad(problem.u)))
    strain = Cellwise(problem.mesh, problem.cell_tags, strains, corners).evaluate().mean(axis=1)
    return stress[:, [0, 4, 8, 1]], strain


def _sed_per_cell(problem: Problem) -> Array:
    """Return the mean strain energy density of each cell of this rank (J/m^3 of reference volume), shape (cells,)."""
    # Degree 2 integrates the linear solid's energy at P2 exactly.
    points, weights = basix.make_quadrature(basix.CellType.triangle, 2)
    sample = Cellwise(problem.mesh, problem.cell_tags, problem.densities, np.asarray(points))
    means: Array = (np.asarray(weights) / np.sum(weights)) @ sample.evaluate()[:, :, 0].T
    return means


class Receptors:
    """Strain energy density, stress and place at sites in the body: material points of the reference configuration.

    A site is evaluated by the ranks that own its cells. One on a facet has the mean over all its cells, since a strain
    jumps there: so neither the numbering nor the number of ranks matters, and a site on the axis of a mirrored mesh
    does not belong to one half.

    Attributes:
        sites: reference positions (m), shape (n, 2).
    """

    def __init__(self, problem: Problem, sites: Array) -> None:
        """Find the sites' cells.

        Args:
            problem: whose current state is evaluated.
            sites: reference positions (m), shape (n, 2), the same on every rank; n >= 1.

        Raises:
            ValueError: there is no site, or one lies outside the mesh; on every rank.
        """
        self.sites = np.array(sites, dtype=float).reshape(-1, 2)
        if len(self.sites) == 0:
            raise ValueError("no receptor site is given")
        self._mesh = mesh = problem.mesh
        self._cells, site, points = _find(mesh, self.sites)
        comm = mesh.comm
        self._site = np.concatenate(comm.allgather(site))  # of each pair of a site and one of its cells, rank by rank
        first = sum(comm.allgather(len(site))[: comm.rank])
        self._own = np.arange(first, first + len(site))  # pairs of this rank
        self._count = np.bincount(self._site, minlength=len(self.sites))
        nowhere = np.flatnonzero(self._count == 0)
        if len(nowhere):
            x, y = self.sites[nowhere[0]]
            raise ValueError(f"receptor site {nowhere[0]} at x = {x:.6g} m, y = {y:.6g} m lies outside the mesh")
        # One kernel for all ranks: it evaluates every pair's reference point, of which each cell needs one.
        self._points, self._problem = np.concatenate(comm.allgather(points)), problem

    @cached_property
    def _density(self) -> Cellwise:
        return Cellwise(self._mesh, self._problem.cell_tags, self._problem.densities, self._points)

    @cached_property
    def _compression(self) -> Cellwise:
        stresses = {tags: -stress[1, 1] for tags, stress in _stresses(self._problem).items()}
        return Cellwise(self._mesh, self._problem.cell_tags, stresses, self._points)

    @cached_property
    def _displacement(self) -> Cellwise:
        everywhere = tuple(tag for tags in self._problem.laws for tag in tags)
        return Cellwise(self._mesh, self._problem.cell_tags, {everywhere: self._problem.u}, self._points)

    def compression(self) -> Array:
        """Return minus the Cauchy stress normal to the screen (Pa) at the sites, shape (n,), on every rank."""
        return self._mean(self._compression.evaluate(self._cells))[:, 0]

    def sed(self) -> Array:
        """Return the strain energy density (J/m^3 of reference volume) at the sites, shape (n,), on every rank."""
        return self._mean(self._density.evaluate(self._cells))[:, 0]

    def positions(self) -> Array:
        """Return the sites' current positions (m), shape (n, 2), on every rank."""
        return self.sites + self._mean(self._displacement.evaluate(self._cells))

    def _mean(self, values: Array) -> Array:
        """Pick each own pair's value from those at all pairs' points, (own, pairs, k); each site's mean, (n, k)."""
        total = np.zeros((len(self._site), values.shape[2]))
        total[self._own] = values[np.arange(len(self._own)), self._own]
        self._mesh.comm.Allreduce(MPI.IN_PLACE, total)
        mean = np.zeros((len(self.sites), total.shape[1]))
        np.add.at(mean, self._site, total)
        return mean / self._count[:, None]


def _find(mesh: dolfinx.mesh.Mesh, sites: Array) -> tuple[NDArray[np.int32], NDArray[np.int64], Array]:
    """Find sites among this rank's own cells.

    Returns:
        For each pair of a site and one of its cells the cell's number and the site's, both (pairs,), and the reference
        coordinates there, (pairs, 2).
    """
    cells = owned_cells(mesh)
    cell, numbers, points = [], [], []
    if len(cells):
        extent = float(np.ptp(mesh.geometry.x, axis=0).max())
        tree = geometry.bb_tree(mesh, 2, entities=cells, padding=_BEYOND * extent)
        candidates = geometry.compute_collisions_points(tree, np.column_stack([sites, np.zeros(len(sites))]))
        nodes = mesh.geometry.x[compat.cell_geometry(mesh)][:, :, :2]
        for k, site in enumerate(sites):
            near = candidates.links(k)
            places = reference_places(nodes[near], np.broadcast_to(site, (len(near), 2)))
            inside = np.minimum(places.min(axis=1), 1 - places.sum(axis=1)) >= -_ROUNDOFF
            cell.extend(near[inside])
            numbers.extend([k] * int(inside.sum()))
            points.extend(places[inside])
    return np.array(cell, dtype=np.int32), np.array(numbers, dtype=np.int64), np.array(points).reshape(-1, 2)


# -- states of the whole body on one rank ---------------------------------------------------------------------
class Nodes:
    """Brings values to every rank, numbered as the mesh was before it was distributed.

    Attributes:
        coordinates: nodes of the unloaded mesh (m), shape (nodes, 2).
        triangles: nodes of each cell, shape (cells, 3).
    """

    def __init__(self, problem: Problem) -> None:
        mesh = problem.mesh
        self._comm, cells = mesh.comm, owned_cells(mesh)
        # The first three degrees of freedom of a Lagrange triangle are its vertices, in the geometry's order.
        self._dofs = problem.V.dofmap.list[cells][:, :3]
        nodes = compat.cell_geometry(mesh)[cells][:, :3]
        names = self._together(np.asarray(mesh.geometry.input_global_indices)[nodes])
        self._sort = np.argsort(self._together(np.asarray(mesh.topology.original_cell_index)[cells]))
        _, self._first, corners = np.unique(names[self._sort].ravel(), return_index=True, return_inverse=True)
        self.triangles = corners.reshape(-1, 3)
        self.coordinates = self._pick(mesh.geometry.x[nodes][:, :, :2])

    def _together(self, mine: NDArray[Any]) -> NDArray[Any]:
        return np.concatenate(self._comm.allgather(mine))

    def by_cell(self, mine: NDArray[Any]) -> NDArray[Any]:
        """Return one value a cell of those of own cells, on every rank; collective."""
        return np.asarray(self._together(mine)[self._sort])

    def _pick(self, mine: Array) -> Array:
        """Return one value a node of values by cell and corner, shape (cells, 3, 2)."""
        return np.asarray(self.by_cell(mine).reshape(-1, 2)[self._first])

    def gather(self, problem: Problem) -> Array:
        """Return the displacement of all nodes (m), shape (nodes, 2); collective."""
        return self._pick(problem.displacement()[self._dofs])

    def middles(self, problem: Problem) -> tuple[Array, Array]:
        """Return place and displacement (m) of the middle of each cell's edges, shape (cells, 3, 2) each; collective.

        An edge has the number of the opposite vertex.
        """
        cells = owned_cells(problem.mesh)
        nodes = problem.mesh.geometry.x[compat.cell_geometry(problem.mesh)[cells]][:, :, :2]
        straight = (nodes[:, [1, 0, 0]] + nodes[:, [2, 2, 1]]) / 2
        basis = problem.V.element.basix_element.tabulate(0, _MIDDLES)[0, :, :, 0]
        u = np.einsum("mk,cki->cmi", basis, problem.displacement()[problem.V.dofmap.list[cells]])
        places = nodes[:, 3:] if nodes.shape[1] == 6 else straight
        return self.by_cell(places), self.by_cell(u)


class Lines:
    """The lines of a body, found once, and its states with them; numbered as the mesh was before it was distributed."""

    def __init__(self, problem: Problem) -> None:
        self._nodes, tag = Nodes(problem), np.zeros_like(owned_cells(problem.mesh))
        own = problem.cell_tags.indices < len(tag)
        tag[problem.cell_tags.indices[own]] = problem.cell_tags.values[own]
        self._tag = self._nodes.by_cell(tag)
        self._ends, self._beside, self._edge = outline(self._nodes.coordinates, self._nodes.triangles, self._tag)

    def snapshot(self, problem: Problem, fields: bool = True) -> Snapshot | None:
        """Bring the current state to rank 0, None on the others; collective.

        Args:
            problem: on the mesh of these lines.
            fields: whether energy densities, stresses and strains are computed; densities are 0 otherwise.
        """
        nodes, edges = self._nodes, (self._beside[:, 0], self._edge)
        vertices, middles = (nodes.coordinates, nodes.gather(problem)), nodes.middles(problem)
        tensors = [nodes.by_cell(each) for each in _tensors_per_cell(problem)] if fields else []
        sed = nodes.by_cell(_sed_per_cell(problem)) if fields else np.zeros(len(self._tag))
        if problem.mesh.comm.rank > 0:
            return None
        x, u = (np.concatenate([at, there[edges]]) for at, there in zip(vertices, middles, strict=True))
        middle = len(nodes.coordinates) + np.arange(len(self._ends))
        lines = np.stack([self._ends[:, 0], middle, self._ends[:, 1]], axis=1)
        return Snapshot(x, u, nodes.triangles, sed, self._tag, lines, self._beside, *tensors)


# -- places in the reference triangle -------------------------------------------------------------------------
def reference_places(nodes: Array, places: Array) -> Array:
    """Return the reference coordinates of a place each in triangles of first or second order, shape (n, 2).

    Args:
        nodes: the triangles' nodes (m), in basix' order, shape (n, 3 or 6, 2).
        places: reference positions (m), in the triangle or not far from it, shape (n, 2).
    """
    a, b, c = np.moveaxis(nodes[:, :3], 1, 0)
    X, straight = _solved(b - a, c - a, places - a)
    if nodes.shape[1] == 3:
        return X
    element = basix.create_element(basix.ElementFamily.P, basix.CellType.triangle, 2)
    bend = np.abs(nodes[:, 3:] - (nodes[:, [1, 0, 0]] + nodes[:, [2, 2, 1]]) / 2).max(axis=(1, 2))
    far = np.flatnonzero(bend > _STRAIGHT * np.sqrt(np.abs(straight)))
    for _ in range(_NEWTON):
        basis = np.asarray(element.tabulate(1, X[far]))[:, :, :, 0]
        there, a, b = np.einsum("dnk,nki->dni", basis, nodes[far])
        step = np.clip(_solved(a, b, places[far] - there, _FLAT * straight[far])[0], -_STEP, _STEP)
        X[far] += step
        far = far[np.abs(step).max(axis=1) > _NEAR]
    return X


def _solved(a: Array, b: Array, right: Array, least: Array | float = 0.0) -> tuple[Array, Array]:
    """Return what multiples of a and b, shape (n, 2) each, add up to the right side, and the determinants, (n,)."""
    determinant = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    safe = np.where(np.abs(determinant) > np.abs(least), determinant, least)
    first, second = right[:, 0] * b[:, 1] - right[:, 1] * b[:, 0], a[:, 0] * right[:, 1] - a[:, 1] * right[:, 0]
    return np.stack([first, second], axis=1) / safe[:, None], determinant
