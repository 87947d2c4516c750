"""Strain energy density at receptor sites: material points, given in the reference configuration."""

import dolfinx
import numpy as np
from dolfinx import fem, geometry
from mpi4py import MPI
from numpy.typing import NDArray

from variational import compat, jit
from variational.cellwise import Cellwise, owned_cells, reference_places
from variational.problem import Problem

Array = NDArray[np.float64]
_ROUNDOFF = 1e-8  # of a barycentric coordinate: a site on a facet belongs to both cells
_BEYOND = 1e-3  # of the body's size: what a curved edge may be beyond its nodes


class Receptors:
    """Sites in the body, each evaluated by the ranks that own its cells.

    A site on a facet has the mean over all its cells, since a strain jumps there: so neither the numbering nor the
    number of ranks matters, and a site on the axis of a mirrored mesh does not belong to one half.

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
        self._first = sum(comm.allgather(len(site))[: comm.rank])  # pair of this rank
        self._count = np.bincount(self._site, minlength=len(self.sites))
        nowhere = np.flatnonzero(self._count == 0)
        if len(nowhere):
            x, y = self.sites[nowhere[0]]
            raise ValueError(f"receptor site {nowhere[0]} at x = {x:.6g} m, y = {y:.6g} m lies outside the mesh")
        # One kernel for all ranks: it evaluates every pair's reference point, of which each cell needs one.
        points = np.concatenate(comm.allgather(points))
        self._density = Cellwise(mesh, problem.cell_tags, problem.densities, points)
        self._displacement = fem.Expression(problem.u, points, jit_options=jit.OPTIONS)

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
