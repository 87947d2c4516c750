r"""The layer of elements next to the screen, brought into balance by itself with the rest of the body held.

What is not smooth in the equations is at the skin: a point touches or not, sticks or slips. After a step of Newton's
method for the whole body other points do than before the step, and the residual is largest there. Newton's method for
the layer alone finds them: a nonlinear elimination of the layer (Lanzkron, Rose and Wilkes 1996,
doi 10.1137/S106482759325154X; Cai and Li 2011, doi 10.1137/080736272),

.. math:: x_L \leftarrow x_L - K_{LL}^{-1} r_L(x), \qquad \text{until} \quad \| r_L \| \ll \| r \setminus r_L \|

with the rows and columns L of all nodes of the elements that share a node with skin near the screen. The layer is one
element deep, and has few of the unknowns, so that its factorisation is cheap (``docs/performance.md`` has the figures).
Its forms are the problem's, integrated over fewer cells. An equilibrium of the body is one of the layer, so that the
method changes the way to an equilibrium and not the equilibrium.

The elements behind the skin belong to it: the skin's nodes alone, with all others held, are so stiff that they hardly
move. A second row of elements saves no factorisation.
"""

from dataclasses import replace

import numpy as np
import ufl
from dolfinx import fem, la
from dolfinx.fem import petsc as fem_petsc
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from variational import jit
from variational.solvers.equations import Equations
from variational.solvers.outcome import OUTSIDE

Array = NDArray[np.float64]
Nodes = NDArray[np.bool_]
Domains = dict[fem.IntegralType, list[tuple[int, NDArray[np.int32]]]]
_MAX_ITERATIONS = 12  # of a solve of the layer
_HALVINGS = 5  # of a step which makes the layer's residual
_GROWS = 10.0  # more than so many times as large
_LAYER_HEIGHT = 1.0  # finest facets: skin that is nearer to the screen belongs to the layer;
_MARGIN = 2.0  # the same, when it is made anew


class _Weak:
    """A form of the problem, compiled and searched for its fields once, for all layers.

    ``fem.create_form`` searches the form for its fields each time, and reads nothing else of it. So it is given the
    list of the fields in its place.
    """

    def __init__(self, V: fem.FunctionSpace, form: ufl.Form) -> None:
        compiled = fem.compile_form(V.mesh.comm, form, jit_options=jit.OPTIONS)
        self._mesh, self._spaces = V.mesh, [V] * len(form.arguments())
        self._fields = {each: each for each in ufl.algorithms.extract_coefficients(form)}
        self._constants = {each: each for each in ufl.algorithms.analysis.extract_constants(form)}
        self._compiled = replace(compiled, ufl_form=ufl.classes.ExprList(*self._fields, *self._constants))

    def over(self, domains: Domains) -> fem.Form:
        """Return the form over some of the cells and facets."""
        return fem.create_form(self._compiled, self._spaces, self._mesh, domains, self._fields, self._constants)


class SkinLayer:
    """The skin near the screen and the elements behind it."""

    def __init__(self, equations: Equations) -> None:
        """Start without a layer; collective.

        Args:
            equations: of a problem without pressure, whose unknowns are displacements alone.
        """
        self._equations, self._problem, self._layout = equations, equations.problem, equations.layout
        V, surface = self._problem.V, self._problem.surface
        self._comm, self._map = V.mesh.comm, V.dofmap.index_map
        self._dofs = V.dofmap.list
        self._skin = equations.skin[0] // 2
        self._height = V.tabulate_dof_coordinates()[self._skin, 1]
        finest = float(surface.length.min(initial=np.inf))
        self._finest = self._comm.allreduce(finest, op=MPI.MIN)
        self._nodal = np.zeros_like(self._problem.w.x.array)
        own = self._layout.rows.reshape(-1, 2)[: self._map.size_local]
        self._at = equations.local(own)  # of this rank's nodes, in its part of a vector
        self._nodes: Nodes = np.zeros(self._map.size_local + self._map.num_ghosts, dtype=bool)
        self._rows: NDArray[np.int64] = np.empty(0, dtype=np.int64)
        self._weak: list[_Weak] = []  # residual and tangent
        self._ksp: PETSc.KSP | None = None

    # -- which elements --------------------------------------------------------------------------------
    def _follow(self, x: PETSc.Vec) -> None:
        """Make the layer anew if skin has come near the screen that is not in it; collective."""
        self._layout.to_nodes(x, self._nodal)
        height = self._height + self._nodal[2 * self._skin + 1] + self._layout.rigid_part(x)[1]
        near = self._skin[height < _LAYER_HEIGHT * self._finest]
        if not self._comm.allreduce(bool((~self._nodes[near]).any()), op=MPI.LOR):
            return
        self.free()
        seeds = np.zeros_like(self._nodes)
        seeds[self._skin[height < _MARGIN * self._finest]] = True
        self._make(self._with_neighbours(seeds))

    def _with_neighbours(self, nodes: Nodes) -> Nodes:
        """Return the nodes of all cells that have one of these nodes, the bone's left out; on all ranks."""
        found = la.vector(self._map, 1, np.int64)
        owned = self._dofs[: self._problem.mesh.topology.index_map(2).size_local]
        found.array[:] = nodes
        self._agree(found)
        cells = found.array[owned].any(axis=1)
        found.array[np.unique(owned[cells])] = 1
        self._agree(found)
        found.array[self._layout.rim] = 0
        return np.asarray(found.array > 0)

    @staticmethod
    def _agree(flags: la.Vector) -> None:
        """Raise a flag on all ranks where it is raised on one."""
        flags.scatter_reverse(la.InsertMode.add)
        flags.scatter_forward()

    def _make(self, nodes: Nodes) -> None:
        """Number the unknowns of nodes, and set the forms and the solver up."""
        self._nodes = nodes
        owned = nodes[: self._map.size_local]
        size = int(owned.sum())
        numbers = la.vector(self._map, 1, np.int64)
        numbers.array[:] = -1  # entries that PETSc leaves out
        numbers.array[: len(owned)][owned] = self._comm.scan(size) - size + np.arange(size)
        numbers.scatter_forward()
        self._rows = self._at[owned].ravel()
        if not self._weak:
            self._weak = [_Weak(self._problem.V, form) for form in self._problem.weak]
        domains = self._domains()
        self._residual, self._jacobian = (form.over(domains) for form in self._weak)
        K = self._K = PETSc.Mat().create(self._comm)
        K.setSizes(((2 * size, PETSc.DETERMINE), (2 * size, PETSc.DETERMINE)), bsize=2)
        K.setType(PETSc.Mat.Type.BAIJ)
        lgmap = PETSc.LGMap().create(numbers.array.astype(PETSc.IntType), bsize=2, comm=self._comm)
        K.setLGMap(lgmap, lgmap)
        K.setUp()
        K.setOption(PETSc.Mat.Option.KEEP_NONZERO_PATTERN, True)
        self._step, self._force = K.createVecs()
        ksp = self._ksp = PETSc.KSP().create(self._comm)
        ksp.setOperators(K)
        ksp.setType(PETSc.KSP.Type.PREONLY)
        pc = ksp.getPC()
        pc.setType(PETSc.PC.Type.LU)
        if self._comm.size == 1:  # faster than MUMPS for so small a matrix
            pc.setFactorSolverType(PETSc.Mat.SolverType.PETSC)
            pc.setFactorOrdering(PETSc.Mat.OrderingType.ND)
        else:
            pc.setFactorSolverType(PETSc.Mat.SolverType.MUMPS)

    def _domains(self) -> Domains:
        """Return the cells that have a node of the layer, and their facets, by kind and tag."""
        mesh, tags, surface = self._problem.mesh, self._problem.cell_tags, self._problem.surface
        mine = np.zeros(len(self._dofs), dtype=bool)
        own = mesh.topology.index_map(2).size_local
        mine[:own] = self._nodes[self._dofs[:own]].any(axis=1)
        cells = {int(tag): tags.find(tag) for tag in np.unique(tags.values)}
        pairs, ridge = (each[mine[surface.pairs[:, 0]]] for each in (surface.pairs, surface.ridge))
        return {
            fem.IntegralType.cell: [(tag, each[mine[each]].astype(np.int32)) for tag, each in cells.items()],
            fem.IntegralType.exterior_facet: [(tag, pairs[ridge == k].ravel()) for k, tag in enumerate(surface.tags)],
        }

    # -- balance ---------------------------------------------------------------------------------------
    def balance(self, x: PETSc.Vec, f: PETSc.Vec, enough: float, most: float) -> None:
        """Bring the layer into balance with the rest held; collective.

        Where that does not help, the unknowns stay as they are.

        Args:
            x: unknowns, of which the layer's are changed.
            f: for the layer's residual (N/m); what the rest of it then holds means nothing.
            enough: norm of the layer's residual (N/m) with which it is in balance.
            most: norm from which the unknowns stay as they are.
        """
        self._follow(x)
        ksp = self._ksp
        if ksp is None:
            return
        self._equations.residual(x, f, self._residual)
        first = size = self._norm(f)
        if first >= min(most, OUTSIDE / 2):
            return
        start = x.array_r[self._rows].copy()
        for _ in range(_MAX_ITERATIONS):
            if size <= enough:
                return
            size = self._iterate(ksp, x, f, max(first, size))
            if size >= OUTSIDE / 2:
                break
        if size >= first:
            x.array_w[self._rows] = start

    def _iterate(self, ksp: PETSc.KSP, x: PETSc.Vec, f: PETSc.Vec, largest: float) -> float:
        """Take a step of Newton's method for the layer; return the norm of its residual then, ``OUTSIDE`` in vain."""
        equations, K = self._equations, self._K
        with equations.timings.phase("assembly"):
            K.zeroEntries()
            fem_petsc.assemble_matrix(K, self._jacobian)
            K.assemble()
            K.zeroRows(self._prescribed(), diag=equations.stiffness)
        self._force.array_w[:] = f.array_r[self._rows]
        ksp.solve(self._force, self._step)
        if ksp.getConvergedReason() <= 0:  # as of a singular tangent, after which MUMPS would fail for ever
            ksp.getPC().reset()
            ksp.setOperators(K)
            return OUTSIDE
        start, step = x.array_r[self._rows].copy(), self._step.array_r.copy()
        for _ in range(_HALVINGS + 1):
            x.array_w[self._rows] = start - step
            equations.residual(x, f, self._residual)
            norm = self._norm(f)
            if norm < _GROWS * largest:
                break
            step /= 2
        return norm

    def _prescribed(self) -> NDArray[np.int64]:
        """Return the layer's rows of this rank whose displacement is prescribed, by their global numbers."""
        rows = self._equations.local(self._equations.prescribed_rows())
        first = int(self._K.getOwnershipRange()[0])
        return (first + np.flatnonzero(np.isin(self._rows, rows))).astype(PETSc.IntType)

    def _norm(self, f: PETSc.Vec) -> float:
        """Return the norm of the layer's part of a residual."""
        mine = f.array_r[self._rows]
        return float(np.sqrt(self._comm.allreduce(float(mine @ mine))))

    def forget(self) -> None:
        """Have the next iterate alone say which elements are in the layer; collective."""
        self.free()
        self._nodes[:] = False

    def free(self) -> None:
        """Free matrix and factorisation; collective."""
        if self._ksp is not None:
            self._ksp.destroy()
            self._K.destroy()
            self._ksp = None
