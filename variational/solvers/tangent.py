r"""The tangent of a solve and its factorisation, which several iterations may share, by Anderson's acceleration.

With the tangent K of an earlier iterate the iteration :math:`x \leftarrow x - K^{-1} r(x)` contracts linearly. The last
few differences :math:`\Delta x_j, \Delta r_j` of one factorisation say what K misses: with the coefficients
:math:`\gamma` that make :math:`\| r - \sum_j \gamma_j \Delta r_j \|` least,

.. math:: x \leftarrow x - K^{-1} r - \sum_j \gamma_j \, (\Delta x_j - K^{-1} \Delta r_j)

(Walker and Ni 2011, doi 10.1137/10078356X, there of type II.) It takes no residual and no back-substitution more. The
differences are of no use to another factorisation, but go on being of use where the loads or air gaps change a little.
"""

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from variational.solvers.equations import Equations
from variational.solvers.layout import RigidRimLayout
from variational.solvers.outcome import Counts

Array = NDArray[np.float64]
_DEPTH = 6  # differences
_INDEPENDENT = 1e-8  # singular value below which, over the largest, differences count as dependent


class _Relative:
    """The derivative of the residual by the relative unknowns: the tangent K after their change to displacements."""

    def __init__(self, layout: RigidRimLayout, K: PETSc.Mat) -> None:
        self.layout, self.K = layout, K
        self._moved = layout.create_vector()

    def mult(self, A: PETSc.Mat, x: PETSc.Vec, y: PETSc.Vec) -> None:
        """Multiply by a step of the relative unknowns; PETSc's name."""
        x.copy(self._moved)
        self.layout.translate(self._moved, self.layout.rigid_part(x))
        self.K.mult(self._moved, y)


class Tangent:
    """Derivative of the equations, by displacements and by the solver's relative unknowns.

    It is that of the displacement itself, which is sparser; a step that a factorisation proposes is made relative to
    the bone right after it (:meth:`make_relative`).

    Attributes:
        matrix: K, the derivative by displacements, that is factorised.
        relative: the derivative by the relative unknowns.
        stale: the factorisation must be made anew before it is used.
        kept: the present iteration uses a factorisation made before it.
    """

    def __init__(self, equations: Equations, counts: Counts) -> None:
        """Start without a factorisation; factorisations are added to ``counts``."""
        self.equations, self.counts = equations, counts
        self.matrix = equations.layout.create_matrix()
        self.relative = PETSc.Mat().createPython(
            self.matrix.getSizes(), _Relative(equations.layout, self.matrix), comm=equations.layout.comm
        )
        self.stale, self.kept = True, False
        self._prescribed = 0, False  # number of the bone's rows that are prescribed, and whether the skin is

    def start(self) -> None:
        """Begin a solve: a factorisation with another control of the bone, or other skin held, is stale."""
        prescribed = len(self.equations.control.translation), self.equations.holds_skin
        self.stale |= prescribed != self._prescribed
        self._prescribed = prescribed

    def update(self, snes: PETSc.SNES | None, x: PETSc.Vec, A: PETSc.Mat, K: PETSc.Mat) -> None:
        """Make the tangent of the present fields, if the last one is stale; called by SNES."""
        self.kept = not self.stale
        if self.kept:
            return
        self._assemble(K)
        self.counts.factorisations += 1
        self.stale = False

    def empty(self) -> PETSc.Mat:
        """Return an empty matrix of the tangent's pattern, to find which takes as long as ten tangents; collective."""
        if not self.matrix.assembled:
            self._assemble(self.matrix)
        return self.matrix.duplicate()

    def unshifted(self) -> PETSc.Mat:
        """Return K of the present fields without the shift of pseudo-transient continuation, in a matrix of its own."""
        eta, found = self.equations.problem.eta, self.empty()
        shift, eta.value = float(eta.value), 0.0
        self._assemble(found)
        eta.value = shift
        return found

    def _assemble(self, K: PETSc.Mat) -> None:
        """Write the tangent of the present fields into a matrix; collective."""
        with self.equations.timings.phase("assembly"):
            K.zeroEntries()
            self.equations.assemble_tangent(K)
            K.zeroRows(self.equations.prescribed_rows(), diag=self.equations.stiffness)

    def make_relative(self, ksp: PETSc.KSP, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Make the solution of K x = b relative to the bone; what a failed factorisation leaves stays as it is."""
        if ksp.getConvergedReason() > 0:
            layout = self.equations.layout
            layout.translate(x, -layout.rigid_part(x))


class Anderson:
    """Differences of iterates, residuals and steps of one factorisation; arrays have the rank's part."""

    def __init__(self, comm: MPI.Comm) -> None:
        """Start without differences."""
        self._comm = comm
        self._last: tuple[Array, Array, Array] | None = None
        self._differences: list[tuple[Array, Array]] = []  # dr and dx - K^-1 dr

    def forget(self) -> None:
        """Leave out all differences: the factorisation is another one."""
        self._last, self._differences = None, []

    def interrupt(self) -> None:
        """Draw no difference between the last iterate and the next one: the equations changed in between."""
        self._last = None

    def correction(self, x: Array, r: Array, step: Array) -> Array | None:
        """Record an iterate; return what is to be added to its step, None without differences; collective.

        Args:
            x: unknowns.
            r: residual (N/m).
            step: K^-1 r, which is subtracted from x.
        """
        if self._last is not None:
            dx, dr, d_step = (now - last for now, last in zip((x, r, step), self._last, strict=True))
            size = np.sqrt(self._comm.allreduce(float(dr @ dr)))
            if size > 0:
                self._differences = [*self._differences, (dr / size, (dx - d_step) / size)][-_DEPTH:]
        self._last = x.copy(), r.copy(), step.copy()
        if not self._differences:
            return None
        # least squares of rows on several ranks: each brings its triangle
        q, triangle = np.linalg.qr(np.stack([dr for dr, _ in self._differences], axis=1))
        parts = self._comm.allgather((triangle, q.T @ r))
        triangles, right = (np.concatenate(part) for part in zip(*parts, strict=True))
        gamma = np.linalg.lstsq(triangles, right, rcond=_INDEPENDENT)[0]
        return sum(g * d for g, (_, d) in zip(gamma, self._differences, strict=True))
