"""Unknowns of a deformable body glued to a rigid one that translates.

All nodes on the rim of the rigid body share one node of two unknowns, its translation: in the local-to-global
map of the linear system the rim's nodes simply point to that node. Assembly then adds the rows and columns
of the rim up by itself, in parallel too. The translation's rows of the residual are the rigid body's force
balance; the matrix stays square, as sparse as before and, where the laws are, symmetric, and the line search
sees the rigid body as it sees every other unknown. (Bordering would need a second back-substitution an iteration and
a norm of its own for the line search; a multipoint constraint eliminates the same unknowns with more code.)
"""

import dolfinx
import numpy as np
from dolfinx import fem
from numpy.typing import NDArray
from petsc4py import PETSc

Array = NDArray[np.float64]


class RigidRimLayout:
    """Global numbering of a vector space in which the nodes of a rim are one.

    Attributes:
        rigid_rows: global rows (2,) of the rigid body's translation in x and y.
        owns_rigid: whether this rank owns those rows.
    """

    def __init__(self, V: fem.FunctionSpace, rim_facets: NDArray[np.int32]) -> None:
        """Number the unknowns.

        Args:
            V: vector space of block size 2.
            rim_facets: facets on the rim known to this rank.
        """
        comm, index_map = V.mesh.comm, V.dofmap.index_map
        owned = index_map.size_local
        rim = fem.locate_dofs_topological(V, V.mesh.topology.dim - 1, rim_facets)
        self.is_rim = np.zeros(owned + index_map.num_ghosts, dtype=bool)
        self.is_rim[rim] = True
        free = ~self.is_rim[:owned]
        first = comm.scan(int(free.sum())) - int(free.sum())
        rigid = comm.allreduce(int(free.sum()))
        numbers = dolfinx.la.vector(index_map, 1, np.int64)
        numbers.array[:owned] = np.where(free, first + np.cumsum(free) - 1, rigid)
        numbers.scatter_forward()
        blocks = numbers.array.astype(PETSc.IntType)

        self.comm = comm
        self.owns_rigid = comm.rank == comm.size - 1
        self.rigid_rows = np.array([2 * rigid, 2 * rigid + 1], dtype=PETSc.IntType)
        self.local_size = 2 * (int(free.sum()) + int(self.owns_rigid))
        self.global_size = 2 * (rigid + 1)
        self._map = PETSc.LGMap().create(blocks, bsize=2, comm=comm)
        self._free = np.repeat(free, 2)
        rows = (2 * blocks[:, None] + np.arange(2, dtype=PETSc.IntType)).ravel()
        self.rows = rows  # global row of every local unknown, ghosts included
        self._local = PETSc.Vec().createSeq(len(rows), comm=PETSc.COMM_SELF)
        source = PETSc.IS().createGeneral(rows, comm=PETSc.COMM_SELF)
        self._scatter = PETSc.Scatter().create(self.create_vector(), source, self._local, None)

    def create_vector(self) -> PETSc.Vec:
        """Return a vector of unknowns."""
        return PETSc.Vec().createMPI((self.local_size, self.global_size), bsize=2, comm=self.comm)

    def create_matrix(self) -> PETSc.Mat:
        """Return an empty matrix; its pattern is found by the first assembly."""
        size = (self.local_size, self.global_size)
        A = PETSc.Mat().create(comm=self.comm)
        A.setSizes((size, size), bsize=2)
        A.setType(PETSc.Mat.Type.AIJ)
        A.setLGMap(self._map, self._map)
        A.setUp()
        A.setOption(PETSc.Mat.Option.KEEP_NONZERO_PATTERN, True)
        return A

    def to_nodes(self, x: PETSc.Vec, nodal: Array) -> None:
        """Write unknowns into an array of nodal values, ghosts included."""
        self._scatter.scatter(x, self._local, addv=False, mode=PETSc.ScatterMode.FORWARD)
        nodal[:] = self._local.array_r

    def add_to_unknowns(self, nodal: Array, f: PETSc.Vec) -> None:
        """Add nodal contributions, ghosts' and rim's included, to a vector of unknowns."""
        self._local.array_w[:] = nodal
        self._scatter.scatter(self._local, f, addv=True, mode=PETSc.ScatterMode.REVERSE)

    def from_nodes(self, nodal: Array, rigid: Array, x: PETSc.Vec) -> None:
        """Write nodal values and the rigid body's translation (2,) into a vector of unknowns."""
        values = nodal[: len(self._free)][self._free]
        x.array_w[:] = np.concatenate([values, rigid]) if self.owns_rigid else values

    def rigid_part(self, x: PETSc.Vec) -> Array:
        """Return the rigid body's two entries of a vector of unknowns, on every rank."""
        mine = x.array_r[-2:].copy() if self.owns_rigid else None
        return np.asarray(self.comm.bcast(mine, root=self.comm.size - 1))
