"""What is evaluated inside of the body: fields for ParaView, mean energy densities, densities at receptor sites.

ParaView shows the deformed body with *Warp By Vector* on ``displacement.bp``. Stress and energy density jump from
layer to layer; they are sampled in the corners of each cell by itself and stay discontinuous.
"""

import contextlib
import ctypes
import os
import re
from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import basix
import dolfinx
import numpy as np
import ufl
from dolfinx import fem, geometry
from dolfinx.io import VTXWriter
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


class Fields:
    """Writes displacement (m), Cauchy stress (Pa, 3 x 3) and strain energy density (J/m^3 of reference volume).

    Attributes:
        displacement, stress, sed: as they were last written; the last two discontinuous and linear in each cell.
    """

    def __init__(self, problem: "Problem", folder: Path | str) -> None:
        """Open ``displacement.bp``, ``stress.bp`` and ``sed.bp``.

        Args:
            problem: whose current state each :meth:`write` writes.
            folder: made if need be, parents included.
        """
        mesh, folder = problem.mesh, Path(folder)
        if mesh.comm.rank == 0:
            folder.mkdir(parents=True, exist_ok=True)
        mesh.comm.barrier()
        F = kinematics.deformation_gradient(ufl.grad(problem.u))
        stresses = {tags: kinematics.cauchy(law, F, problem.pressures[tags]) for tags, law in problem.laws.items()}
        self.stress, self._sample_stress = _sampled(problem, "stress", stresses)
        self.sed, self._sample_sed = _sampled(problem, "sed", problem.densities)
        self._problem, self.displacement = problem, fem.Function(problem.V, name="displacement")
        # One writer a field: a file holds functions of one element.
        files = {"displacement": self.displacement, "stress": self.stress, "sed": self.sed}
        self._writers = [VTXWriter(mesh.comm, folder / f"{name}.bp", [f], engine="BP4") for name, f in files.items()]

    def write(self, time: float) -> None:
        """Append the current state; ``time`` is what ParaView calls it, a step's number for instance."""
        self.displacement.x.array[:] = self._problem.displacement().ravel()
        for function, sample in ((self.stress, self._sample_stress), (self.sed, self._sample_sed)):
            values = sample.evaluate()
            dofs = function.function_space.dofmap.list[: len(values)]
            function.x.array.reshape(-1, values.shape[2])[dofs] = values
            function.x.scatter_forward()
        with self._room():
            for writer in self._writers:
                writer.write(time)

    def close(self) -> None:
        """Close the files; collective.

        Raises:
            OSError: there is no room for what is left to write.
        """
        with self._room():
            for writer in self._writers:
                writer.close()

    def abandon(self) -> None:
        """Leave the files as they are; not collective.

        What has been written can be read. A writer that is deleted closes its file, and ends the process where that
        fails: these are never deleted.
        """
        for writer in self._writers:
            ctypes.pythonapi.Py_IncRef(ctypes.py_object(writer))

    @contextlib.contextmanager
    def _room(self) -> Iterator[None]:
        """Turn ADIOS2's message of a full disk into the right error."""
        try:
            yield
        except RuntimeError as error:
            found = re.search(r"errno = (\d+)", str(error))
            if found is None:
                raise
            self.abandon()
            raise OSError(int(found[1]), os.strerror(int(found[1]))) from None


def _sampled(
    problem: "Problem", name: str, expressions: Mapping[tuple[int, ...], Any]
) -> tuple[fem.Function, Cellwise]:
    """Return a function, discontinuous and linear in each cell, and what samples the expressions at its nodes."""
    shape = next(iter(expressions.values())).ufl_shape
    space = fem.functionspace(problem.mesh, ("Discontinuous Lagrange", 1, shape))
    points = compat.interpolation_points(space.element)
    return fem.Function(space, name=name), Cellwise(problem.mesh, problem.cell_tags, expressions, points)


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
        F, p = kinematics.deformation_gradient(ufl.grad(self._problem.u)), self._problem.pressures
        stresses = {tags: -kinematics.cauchy(law, F, p[tags])[1, 1] for tags, law in self._problem.laws.items()}
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
