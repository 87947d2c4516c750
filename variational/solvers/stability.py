r"""Whether the state reached is one the skin would stay in.

Let the touching skin be overdamped and everything else follow at once: :math:`\eta M \dot e = -K e` for a small
disturbance e, K the tangent with the prescribed rows left out, M the mass of the touching skin per unit density. The
eigenvalues of :math:`K e = \lambda M e` (Pa/m) decide: the state is stable if all have a positive real part. Those of

.. math:: (K + \eta M)^{-1} \eta M \, e = g \, e, \qquad \lambda = \eta (1/g - 1)

are the growth of e over an implicit Euler step; stable ones lie in (0, 1), so unstable ones are at the ends of the
spectrum, above 1 (:math:`\lambda` in :math:`(-\eta, 0)`) or below 0 (beyond :math:`-\eta`), where a Krylov space finds
them first: Arnoldi's method in the inner product of M, one factorisation, some tens of back-substitutions (Saad 2011,
doi 10.1137/1.9781611970739, ch. 6 to 8). The power iteration would take more of them and miss what lies beyond
:math:`-2 \eta`. Where K is symmetric its negative pivots can be counted instead (Sylvester's law of inertia), which
needs no iteration and gives no rate: the tests compare with these.

Growths of eigenvalues far beyond :math:`-\eta` lie next to zero, among those of the stiffest disturbances, where a
Krylov space may end before it finds them. But each real eigenvalue below :math:`-\eta` turns the sign of
:math:`\det(K + \eta M)` round, which the factorisation brings: an odd number of them is not missed.

The verdict has three limits. K is the tangent at frozen air gaps; how these react is the gain of the loop over the
scales (:mod:`~variational.solvers.coupling`), below one where the loop is stable. Points on the friction cone are taken
to slip on in their direction, the softer choice. And a disturbance is infinitely small.

Of half a body that is its own mirror image, the disturbances that keep the symmetry and those that turn it round are
examined one after the other: the tangent of the whole does not couple the two.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from variational.contact.formulation import SLIPS
from variational.solvers.newton import Solver
from variational.solvers.outcome import NotConverged, linear_failure

Array = NDArray[np.float64]
Rows = NDArray[np.int64]
_ETA = 2e8  # Pa/m, of the order of the softest disturbances of a fingerpad
_MAX_VECTORS = 50  # of the Krylov space
_ROUGH = 0.1  # residual of a Ritz pair over its own growth above which it is not significant
_SETTLED = 1e-6  # residual of the Ritz pair over the largest growth
_EMPTY = 1e-12  # of a vector's norm, below which the space is exhausted


@dataclass(frozen=True)
class Stability:
    """Verdict on a state at frozen air gaps."""

    lambda_min: float
    """Least real part of the eigenvalues found (Pa/m): the rate at which the slowest disturbance dies times eta."""
    settled: bool
    """Whether its residual fell below the tolerance; if not, ``lambda_min`` is an upper bound where K is symmetric, or
    where it is minus eta."""

    @property
    def stable(self) -> bool:
        """Whether every disturbance dies out."""
        return self.lambda_min > 0


class StabilityCheck:
    """Examines the solver's present state; leaves solver and problem as they were."""

    def __init__(self, solver: Solver) -> None:
        """Examine a solver's states."""
        self.solver = solver
        # Kept from check to check with the analysis of the pattern, which is always the same.
        self._K: PETSc.Mat | None = None
        self._ksp: PETSc.KSP | None = None

    def free(self) -> None:
        """Free matrix and factorisation, which the next check makes anew; collective."""
        for kept in (self._ksp, self._K):
            if kept is not None:
                kept.destroy()
        self._ksp = self._K = None

    def _tangent(self, eta: float, rows: Rows) -> PETSc.Mat:
        if self._K is None:
            self._K = self.solver.iteration.tangent.empty()
        problem, A = self.solver.problem, self._K
        A.zeroEntries()
        guess = float(problem.guess.value)
        problem.guess.value, problem.eta.value = SLIPS, eta
        try:
            self.solver.equations.assemble_tangent(A)
        finally:
            problem.guess.value, problem.eta.value = guess, 0.0
        A.zeroRowsColumns(rows, diag=self.solver.equations.stiffness)
        return A

    def _mass_matrix(self, rows: Rows) -> PETSc.Mat:
        A = self.solver.layout.create_matrix()
        self.solver.layout.add_to_matrix(A, self.solver.problem.skin_mass, (0, 0))
        A.assemble()
        A.zeroRowsColumns(rows, diag=0.0)
        return A

    def _solver(self, A: PETSc.Mat) -> PETSc.KSP:
        """Return a direct solver that is not factorised yet."""
        ksp = PETSc.KSP().create(self.solver.layout.comm)
        ksp.setOperators(A)
        ksp.setType(PETSc.KSP.Type.PREONLY)
        pc = ksp.getPC()
        pc.setType(PETSc.PC.Type.LU)
        pc.setFactorSolverType(PETSc.Mat.SolverType.MUMPS)
        return ksp

    def _factorise(self, ksp: PETSc.KSP) -> None:
        pc = ksp.getPC()
        pc.setFactorSetUpSolverType()
        pc.getFactorMatrix().setMumpsIcntl(8, 0)  # no scaling, as in the solves
        pc.getFactorMatrix().setMumpsIcntl(33, 1)  # the determinant, too
        ksp.setOperators(ksp.getOperators()[0])  # of other values, else it is factorised only in the first solve
        ksp.setUp()
        self.solver.counts.factorisations += 1
        if pc.getFailedReason():
            reason, irrecoverable = linear_failure(pc)
            raise NotConverged(reason, False, irrecoverable)

    def check(self, eta: float = _ETA) -> Stability:
        """Find the eigenvalue with the least real part; collective.

        Args:
            eta: shift (Pa/m): what is of its size or below settles fast.

        Raises:
            NotConverged: the factorisation failed.
        """
        kinds = [self.solver.equations.prescribed_rows(), self.solver.equations.antisymmetric_rows()]
        with self.solver.timings.phase("stability"):
            found = [self._least(rows, eta) for rows in kinds if rows is not None]
        return min(found, key=lambda stability: stability.lambda_min)

    def _least(self, rows: Rows, eta: float) -> Stability:
        """Examine the disturbances that are zero in the rows given."""
        K, M = self._tangent(eta, rows), self._mass_matrix(rows)
        if self._ksp is None:
            self._ksp = self._solver(K)
        try:
            self._factorise(self._ksp)
        except NotConverged:  # after which MUMPS would fail for ever
            M.destroy()
            self.free()
            raise
        result = self._arnoldi(self._ksp, M, rows, eta)
        M.destroy()
        missed = self._odd_beyond(self._ksp) and result.lambda_min > -eta
        return Stability(-eta, False) if missed else result

    def _odd_beyond(self, ksp: PETSc.KSP) -> bool:
        """Return whether an odd number of eigenvalues lies below -eta, by the sign of the determinant of K + eta M.

        Each unknown pressure turns it round: those in equilibrium take away from the energy.
        """
        pressures = self.solver.layout.pressure_count
        return (ksp.getPC().getFactorMatrix().getMumpsRinfog(12) < 0) != (pressures % 2 == 1)

    def _start(self, rows: Rows) -> PETSc.Vec:
        """Return a disturbance without symmetry that depends on position alone, not on the partition."""
        problem, layout = self.solver.problem, self.solver.layout
        x = problem.V.tabulate_dof_coordinates()[:, :2] / 1e-3
        phases = np.stack([x @ [7.13, 3.77], x @ [4.31, 9.19]], axis=1)
        nodal = sum(np.sin(k * phases + k**2) for k in (1, 3, 8, 21, 55))
        start = layout.create_vector()
        layout.from_nodes(np.asarray(nodal).ravel(), np.array([0.3, 1.0]), start)
        start.array_w[rows - start.getOwnershipRange()[0]] = 0.0
        return start

    def _arnoldi(self, ksp: PETSc.KSP, M: PETSc.Mat, rows: Rows, eta: float) -> Stability:
        w = self._start(rows)
        Mw = w.duplicate()
        M.mult(w, Mw)
        ksp.solve(Mw, w)  # into the range of the operator: what does not move the skin is left out
        M.mult(w, Mw)
        basis, masses = [], []
        H = np.zeros((_MAX_VECTORS + 1, _MAX_VECTORS))
        norm = np.sqrt(w.dot(Mw))
        best = Stability(np.inf, False)
        for k in range(_MAX_VECTORS):
            basis.append(w / norm)
            masses.append(Mw / norm)
            ksp.solve(eta * masses[-1], w)
            before = np.sqrt(max(self._norm2(M, w, Mw), 0.0))
            for _ in range(2):  # twice is enough
                for i, mass in enumerate(masses):
                    h = w.dot(mass)
                    H[i, k] += h
                    w.axpy(-h, basis[i])
            norm = np.sqrt(max(self._norm2(M, w, Mw), 0.0))
            H[k + 1, k] = norm
            best = self._judge(H[: k + 2, : k + 1], eta)
            if best.settled or norm <= _EMPTY * before:
                break
        return best

    @staticmethod
    def _norm2(M: PETSc.Mat, w: PETSc.Vec, Mw: PETSc.Vec) -> float:
        M.mult(w, Mw)
        return float(w.dot(Mw))

    @staticmethod
    def _judge(H: Array, eta: float) -> Stability:
        """Return the least eigenvalue of the Hessenberg matrix, shape (k + 1, k)."""
        growth, vectors = np.linalg.eig(H[:-1])
        residuals = H[-1, -1] * np.abs(vectors[-1])
        accuracy = _SETTLED * np.abs(growth).max()
        rates = np.real(eta * (1 / growth - 1))
        rates[residuals > _ROUGH * np.abs(growth)] = np.inf  # growths next to zero of either sign
        least = int(np.argmin(rates))
        return Stability(float(rates[least]), bool(np.isfinite(rates[least]) and residuals[least] <= accuracy))
