"""What is evaluated inside of the body: means of each cell, and energy densities at receptor sites.

Stress, strain and energy density jump from layer to layer, so that each cell has its own.
"""

from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

import basix
import dolfinx
import numpy as np
import ufl
from dolfinx import fem, geometry
from mpi4py import MPI
from numpy.typing import NDArray

from variational import compat, jit, kinematics
from variational.reference import reference_places

if TYPE_CHECKING:
    from variational.problem import Problem

Array = NDArray[np.float64]
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


def _stresses(problem: "Problem") -> dict[tuple[int, ...], Any]:
    """Return the Cauchy stress (Pa), shape (3, 3), of each law by the tags of its cells."""
    F = kinematics.deformation_gradient(ufl.grad(problem.u))
    return {tags: kinematics.cauchy(law, F, problem.pressures[tags]) for tags, law in problem.laws.items()}


def tensors_per_cell(problem: "Problem") -> tuple[Array, Array]:
    """Return means over the corners of each cell of this rank, which for linear fields are those over the cell.

    Returns:
        Cauchy stress (Pa), components xx, yy, zz and xy, shape (cells, 4), and Green's strain, xx, yy and xy, shape
        (cells, 3).
    """
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    stress = Cellwise(problem.mesh, problem.cell_tags, _stresses(problem), corners).evaluate().mean(axis=1)
    strains = dict.fromkeys(problem.laws, kinematics.green_strain(ufl.grad(problem.u)))
    strain = Cellwise(problem.mesh, problem.cell_tags, strains, corners).evaluate().mean(axis=1)
    return stress[:, [0, 4, 8, 1]], strain


def sed_per_cell(problem: "Problem") -> tuple[NDArray[np.int32], Array]:
    """Return the cells of this rank and the mean strain energy density of each (J/m^3 of reference volume)."""
    # Degree 2 integrates the linear solid's energy at P2 exactly.
    points, weights = basix.make_quadrature(basix.CellType.triangle, 2)
    sample = Cellwise(problem.mesh, problem.cell_tags, problem.densities, np.asarray(points))
    means = (np.asarray(weights) / np.sum(weights)) @ sample.evaluate()[:, :, 0].T
    return owned_cells(problem.mesh), np.asarray(means)


class Receptors:
    """Strain energy density at sites in the body: material points, given in the reference configuration.

    They are each evaluated by the ranks that own its cells.

    A site on a facet has the mean over all its cells, since a strain jumps there: so neither the numbering nor the
    number of ranks matters, and a site on the axis of a mirrored mesh does not belong to one half.

    Attributes:
        sites: reference positions (m), shape (n, 2).
    """

    def __init__(self, problem: "Problem", sites: Array) -> None:
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
        self._first = sum(comm.allgather(len(site))[: comm.rank])  # pair of this rank
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
    def _displacement(self) -> fem.Expression:
        return fem.Expression(self._problem.u, self._points, jit_options=jit.OPTIONS)

    def compression(self) -> Array:
        """Return minus the Cauchy stress normal to the screen (Pa) at the sites, shape (n,), on every rank."""
        return self._mean(self._compression.evaluate(self._cells))[:, 0]

    def sed(self) -> Array:
        """Return the strain energy density (J/m^3 of reference volume) at the sites, shape (n,), on every rank."""
        return self._mean(self._density.evaluate(self._cells))[:, 0]

    def positions(self) -> Array:
        """Return the sites' current positions (m), shape (n, 2), on every rank."""
        u = compat.evaluate_on_cells(self._displacement, self._mesh, self._cells)
        return self.sites + self._mean(u.reshape(len(self._cells), len(self._site), 2))

    def _mean(self, values: Array) -> Array:
        """Pick each own pair's value from those at all pairs' points, (own, pairs, k); each site's mean, (n, k)."""
        own = np.arange(len(self._cells))
        total = np.zeros((len(self._site), values.shape[2]))
        total[self._first + own] = values[own, self._first + own]
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
