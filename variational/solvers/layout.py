"""Unknowns of a deformable body glued to a rigid one that translates.

All nodes on the rim of the rigid body share one node, its translation: in the local-to-global
map of the linear system the rim's nodes simply point to that node. Assembly then adds the rows and columns
of the rim up by itself, in parallel too. The translation's rows of the residual are the rigid body's force
balance; the matrix stays square, as sparse as before and, where the laws are, symmetric, and the line search
treats the rigid body like every other unknown. (Bordering would need a second back-substitution an iteration and
a norm of its own for the line search; a multipoint constraint eliminates the same unknowns with more code.)

Displacements are unknowns either by themselves, as the forms are differentiated, or relative to the rigid body, as a
solver keeps them so that a rigid translation adds no digits (:meth:`RigidRimLayout.translate` goes from one to the
other).

The pressures of a mixed element (:mod:`variational.element`) come first among the unknowns of each rank. The map then
goes on from the displacement's local unknowns to the pressure's, and forms are added to the matrix block by block.
"""

import dolfinx
import numpy as np
from dolfinx import fem
from dolfinx.fem import petsc as fem_petsc
from numpy.typing import NDArray
from petsc4py import PETSc

from variational.element import LayerwisePressure

Array = NDArray[np.float64]


class RigidRimLayout:
    """Global numbering of a vector space in which the nodes of a rim are one, and of a pressure's unknowns.

    Attributes:
        rows: global row of each of the space's local unknowns, ghosts included.
        rigid_rows: global rows (dimension,) of the rigid body's translation.
        owns_rigid: whether this rank owns those rows.
        pressure_count: number of the pressure's unknowns on all ranks.
        displacement_rows: this rank's global rows of displacements, the rigid body's included.
        rim: this rank's nodes on the rim, ghosts included.
    """

    def __init__(
        self, V: fem.FunctionSpace, rim_facets: NDArray[np.int32], pressure: "LayerwisePressure | None" = None
    ) -> None:
        """Number the unknowns.

        Args:
            V: vector space, of the mesh's dimension.
            rim_facets: facets on the rim known to this rank.
            pressure: further unknowns, if any.
        """
        comm, index_map, size = V.mesh.comm, V.dofmap.index_map, V.dofmap.index_map_bs
        owned = index_map.size_local
        rim = fem.locate_dofs_topological(V, V.mesh.topology.dim - 1, rim_facets)
        is_rim = np.zeros(owned + index_map.num_ghosts, dtype=bool)
        is_rim[rim] = True
        free = ~is_rim[:owned]
        self.comm = comm
        self.owns_rigid = comm.rank == comm.size - 1
        pressures = pressure.owned if pressure else 0
        self.pressure_count = comm.allreduce(pressures)
        self._size = size
        self._block_size = 1 if pressure else size
        self.local_size = pressures + size * (int(free.sum()) + int(self.owns_rigid))
        self.global_size = comm.allreduce(self.local_size)
        first = comm.scan(self.local_size) - self.local_size
        rigid = self.global_size - size
        self.rigid_rows = np.arange(rigid, rigid + size, dtype=PETSc.IntType)
        self.displacement_rows = np.arange(first + pressures, first + self.local_size, dtype=PETSc.IntType)
        numbers = dolfinx.la.vector(index_map, 1, np.int64)
        numbers.array[:owned] = np.where(free, first + pressures + size * (np.cumsum(free) - 1), rigid)
        numbers.scatter_forward()
        nodes = numbers.array.astype(PETSc.IntType)
        self.rows = rows = (nodes[:, None] + np.arange(size, dtype=PETSc.IntType)).ravel()
        self._free = np.repeat(free, size)
        self.rim = np.flatnonzero(nodes == rigid)
        self._pressures = pressures
        self._scatter = self._scatter_from(rows)
        self._parts: list[PETSc.IS] = []
        if pressure is None:
            self._map = PETSc.LGMap().create(nodes // size, bsize=size, comm=comm)
            return
        more = pressure.rows(first).astype(PETSc.IntType)
        self._map = PETSc.LGMap().create(np.concatenate([rows, more]), bsize=1, comm=comm)
        self._parts = [
            PETSc.IS().createBlock(size, np.arange(len(nodes), dtype=PETSc.IntType), comm=PETSc.COMM_SELF),
            PETSc.IS().createStride(len(more), len(rows), 1, comm=PETSc.COMM_SELF),
        ]
        self._numbered = more >= 0
        self._pressure_scatter = self._scatter_from(more[self._numbered])

    def _scatter_from(self, rows: NDArray[np.int64]) -> tuple[PETSc.Scatter, PETSc.Vec]:
        """Return what brings rows of a vector of unknowns to this rank, and where to."""
        local = PETSc.Vec().createSeq(len(rows), comm=PETSc.COMM_SELF)
        source = PETSc.IS().createGeneral(rows, comm=PETSc.COMM_SELF)
        return PETSc.Scatter().create(self.create_vector(), source, local, None), local

    def create_vector(self) -> PETSc.Vec:
        """Return a vector of unknowns."""
        return PETSc.Vec().createMPI((self.local_size, self.global_size), bsize=self._block_size, comm=self.comm)

    def create_matrix(self) -> PETSc.Mat:
        """Return an empty matrix; its pattern is found by the first assembly."""
        size = (self.local_size, self.global_size)
        A = PETSc.Mat().create(comm=self.comm)
        A.setSizes((size, size), bsize=self._block_size)
        # Entries added in blocks take half the time. A mixed element's rows have no common block.
        A.setType(PETSc.Mat.Type.AIJ if self._parts else PETSc.Mat.Type.BAIJ)
        A.setLGMap(self._map, self._map)
        A.setUp()
        A.setOption(PETSc.Mat.Option.KEEP_NONZERO_PATTERN, True)
        return A

    def add_to_matrix(self, A: PETSc.Mat, form: fem.Form, part: tuple[int, int]) -> None:
        """Add a form to the rows and columns of the displacement (0) or pressure (1)."""
        if not self._parts:
            fem_petsc.assemble_matrix(A, form)
            return
        block = A.getLocalSubMatrix(*(self._parts[k] for k in part))
        fem_petsc.assemble_matrix(block, form)
        A.restoreLocalSubMatrix(*(self._parts[k] for k in part), block)

    def to_nodes(self, x: PETSc.Vec, nodal: Array) -> None:
        """Write unknowns into an array of nodal values, ghosts included."""
        nodal[:] = _forward(x, *self._scatter)

    def to_pressure(self, x: PETSc.Vec, values: Array) -> None:
        """Write unknowns into an array of the pressure's values, ghosts included."""
        values[self._numbered] = _forward(x, *self._pressure_scatter)

    def add_to_unknowns(self, nodal: Array, f: PETSc.Vec) -> None:
        """Add nodal contributions, ghosts' and rim's included, to a vector of unknowns."""
        _reverse(nodal, *self._scatter, f)

    def add_to_pressure(self, values: Array, f: PETSc.Vec) -> None:
        """Add the pressure's contributions, ghosts' included, to a vector of unknowns."""
        _reverse(values[self._numbered], *self._pressure_scatter, f)

    def from_nodes(self, nodal: Array, rigid: Array, x: PETSc.Vec) -> None:
        """Write nodal values and the rigid body's translation into a vector of unknowns."""
        values = nodal[: len(self._free)][self._free]
        x.array_w[self._pressures :] = np.concatenate([values, rigid]) if self.owns_rigid else values

    def translate(self, x: PETSc.Vec, translation: Array) -> None:
        """Add a translation to the displacements in a vector of unknowns, the rigid body's left out."""
        free = x.array_w[self._pressures : self._pressures + int(self._free.sum())]
        free.reshape(-1, self._size)[:] += translation

    def moved(self, x: PETSc.Vec, at: NDArray[np.int64], translation: Array) -> Array:
        """Return some of this rank's entries of a vector of unknowns as :meth:`translate` would leave them.

        Args:
            x: vector of unknowns.
            at: places in this rank's part of it.
            translation: of the dimension's shape.
        """
        nodes = (at >= self._pressures) & (at < self._pressures + int(self._free.sum()))
        return np.asarray(x.array_r[at] + np.where(nodes, translation[(at - self._pressures) % self._size], 0.0))

    def rigid_part(self, x: PETSc.Vec) -> Array:
        """Return the rigid body's entries of a vector of unknowns, on every rank."""
        mine = x.array_r[-self._size :].copy() if self.owns_rigid else None
        return np.asarray(self.comm.bcast(mine, root=self.comm.size - 1))


def _forward(x: PETSc.Vec, scatter: PETSc.Scatter, local: PETSc.Vec) -> Array:
    scatter.scatter(x, local, addv=False, mode=PETSc.ScatterMode.FORWARD)
    return np.asarray(local.array_r)


def _reverse(values: Array, scatter: PETSc.Scatter, local: PETSc.Vec, f: PETSc.Vec) -> None:
    local.array_w[:] = values
    scatter.scatter(local, f, addv=True, mode=PETSc.ScatterMode.REVERSE)
