"""Strain energy density at receptor sites: material points, given in the reference configuration."""

import dolfinx
import numpy as np
from dolfinx import fem, geometry
from numpy.typing import NDArray

from variational import compat, jit
from variational.cellwise import Cellwise, owned_cells
from variational.problem import Problem

Array = NDArray[np.float64]
_ROUNDOFF = 1e-8  # of a barycentric coordinate: a site on a facet belongs to both cells
_NOWHERE = np.iinfo(np.int64).max


class Receptors:
    """Sites in the body, each found once and evaluated by the one rank that owns its cell.

    A site on a facet counts to that of its cells which came first before the mesh was distributed, so the number
    of ranks does not matter.

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
        cell, local, name = _find(mesh, self.sites)
        names = np.array(mesh.comm.allgather(name))
        nowhere = np.flatnonzero(names.min(axis=0) == _NOWHERE)
        if len(nowhere):
            x, y = self.sites[nowhere[0]]
            raise ValueError(f"receptor site {nowhere[0]} at x = {x:.6g} m, y = {y:.6g} m lies outside the mesh")
        owner = names.argmin(axis=0)
        self._mine = np.flatnonzero(owner == mesh.comm.rank)
        self._cells = cell[self._mine]
        # One kernel for all ranks: it evaluates every site's reference point, of which each cell needs one.
        points = np.array(mesh.comm.allgather(local))[owner, np.arange(len(owner))]
        self._density = Cellwise(mesh, problem.cell_tags, problem.densities, points)
        self._displacement = fem.Expression(problem.u, points, jit_options=jit.OPTIONS)

    def sed(self) -> Array:
        """Return the strain energy density (J/m^3 of reference volume) at the sites, shape (n,), on every rank."""
        return self._collect(self._density.evaluate(self._cells))[:, 0]

    def positions(self) -> Array:
        """Return the sites' current positions (m), shape (n, 2), on every rank."""
        u = compat.evaluate_on_cells(self._displacement, self._mesh, self._cells)
        return self.sites + self._collect(u.reshape(len(self._cells), len(self.sites), 2))

    def _collect(self, values: Array) -> Array:
        """Pick each own cell's site from values at all sites' points, (own, n, k), and sum over ranks: (n, k)."""
        mine = np.zeros((len(self.sites), values.shape[2]))
        mine[self._mine] = values[np.arange(len(self._mine)), self._mine]
        total = np.empty_like(mine)
        self._mesh.comm.Allreduce(mine, total)
        return total


def _find(mesh: dolfinx.mesh.Mesh, sites: Array) -> tuple[NDArray[np.int32], Array, NDArray[np.int64]]:
    """Find sites among this rank's own cells, straight-sided triangles.

    Returns:
        For each site its cell, (n,), the reference coordinates there, (n, 2), and the cell's number before the mesh was
        distributed, (n,): ``_NOWHERE`` if this rank does not own the site.
    """
    cell = np.full(len(sites), -1, dtype=np.int32)
    local = np.zeros((len(sites), 2))
    name = np.full(len(sites), _NOWHERE, dtype=np.int64)
    cells = owned_cells(mesh)
    if len(cells) == 0:
        return cell, local, name
    extent = float(np.ptp(mesh.geometry.x, axis=0).max())
    tree = geometry.bb_tree(mesh, 2, entities=cells, padding=_ROUNDOFF * extent)
    candidates = geometry.compute_collisions_points(tree, np.column_stack([sites, np.zeros(len(sites))]))
    corners = mesh.geometry.x[compat.cell_geometry(mesh)][:, :, :2]
    original = np.asarray(mesh.topology.original_cell_index)
    for k, site in enumerate(sites):
        for c in candidates.links(k):
            a, b, d = corners[c]
            X = np.linalg.solve(np.column_stack([b - a, d - a]), site - a)
            inside = min(X[0], X[1], 1 - X[0] - X[1]) >= -_ROUNDOFF
            if inside and original[c] < name[k]:
                cell[k], local[k], name[k] = c, X, original[c]
    return cell, local, name
