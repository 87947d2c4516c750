r"""Anderson acceleration of Newton's method with a kept factorisation.

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

Array = NDArray[np.float64]
_DEPTH = 6  # differences
_INDEPENDENT = 1e-8  # singular value below which, over the largest, differences count as dependent


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
