"""Fields for ParaView, and what a picture needs of them on rank 0.

ParaView shows the deformed body with *Warp By Vector* on ``displacement.bp``. Stress and energy density jump from
layer to layer; they are sampled in the corners of each cell by itself and stay discontinuous.
"""

import contextlib
import ctypes
import os
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import basix
import numpy as np
import ufl
from dolfinx import fem
from dolfinx.io import VTXWriter
from numpy.typing import NDArray

from variational import compat, kinematics
from variational.cellwise import Cellwise, owned_cells
from variational.materials import stress

if TYPE_CHECKING:
    from variational.problem import Problem

Array = NDArray[np.float64]


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
        stresses = {tags: stress.cauchy(law, F, problem.pressures[tags]) for tags, law in problem.laws.items()}
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


class MeanDensity:
    """Means of the strain energy density over cells."""

    def __init__(self, problem: "Problem") -> None:
        """Compile the densities at the quadrature points of a cell."""
        # Degree 2 integrates the linear solid's energy at P2 exactly.
        points, weights = basix.make_quadrature(basix.CellType.triangle, 2)
        self._sample = Cellwise(problem.mesh, problem.cell_tags, problem.densities, np.asarray(points))
        self._weights = np.asarray(weights) / np.sum(weights)

    def evaluate(self) -> Array:
        """Return the mean over each own cell (J/m^3), shape (own cells,)."""
        return np.asarray(self._weights @ self._sample.evaluate()[:, :, 0].T)


def sed_per_cell(problem: "Problem") -> tuple[NDArray[np.int32], Array]:
    """Return the cells of this rank and the mean strain energy density of each (J/m^3 of reference volume)."""
    return owned_cells(problem.mesh), MeanDensity(problem).evaluate()


@dataclass(frozen=True)
class Snapshot:
    """A state of the whole body on one rank; straight-sided triangles between vertices."""

    x: Array
    """Reference positions of the vertices (m), shape (vertices, 2)."""
    u: Array
    """Their displacements (m), shape (vertices, 2)."""
    triangles: NDArray[np.int64]
    """Vertices of each cell, shape (cells, 3)."""
    sed: Array
    """Mean strain energy density of each cell (J/m^3), shape (cells,)."""
    tag: NDArray[np.int32]
    """Tag of each cell, zero where it has none, shape (cells,)."""


def gather_mesh(problem: "Problem") -> Snapshot | None:
    """Bring the current state to rank 0, None on the others; numbered as the mesh was before it was distributed."""
    mesh = problem.mesh
    cells, sed = sed_per_cell(problem)
    nodes = compat.cell_geometry(mesh)[cells][:, :3]
    # The first three degrees of freedom of a Lagrange triangle are its vertices, in the geometry's order.
    u = problem.displacement()[problem.V.dofmap.list[cells][:, :3]]
    tag = np.zeros(len(cells), dtype=np.int32)
    own = problem.cell_tags.indices < len(cells)
    tag[problem.cell_tags.indices[own]] = problem.cell_tags.values[own]
    names = np.asarray(mesh.geometry.input_global_indices)[nodes]
    order = np.asarray(mesh.topology.original_cell_index)[cells]
    parts = mesh.comm.gather((mesh.geometry.x[nodes][:, :, :2], u, names, sed, tag, order))
    if parts is None:
        return None
    x, u, names, sed, tag, order = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
    sort = np.argsort(order)
    _, first, vertices = np.unique(names[sort].ravel(), return_index=True, return_inverse=True)
    return Snapshot(
        x[sort].reshape(-1, 2)[first], u[sort].reshape(-1, 2)[first], vertices.reshape(-1, 3), sed[sort], tag[sort]
    )
