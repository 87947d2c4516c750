"""The tangent of a solve and its factorisation, which several iterations may share."""

from typing import TYPE_CHECKING

from petsc4py import PETSc

from variational.solvers.timing import Counts

if TYPE_CHECKING:
    from variational.solvers.equations import Equations
    from variational.solvers.layout import RigidRimLayout


class _Relative:
    """The derivative of the residual by the relative unknowns: the tangent K after their change to displacements."""

    def __init__(self, layout: "RigidRimLayout", K: PETSc.Mat) -> None:
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

    def __init__(self, equations: "Equations", counts: Counts) -> None:
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
