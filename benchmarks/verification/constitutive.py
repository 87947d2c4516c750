r"""The laws of the solids at points: by the package's UFL, and in principal stretches by an evaluation of their own.

.. math:: P_i = \frac{2 G}{a \lambda_i} \Big(\bar\lambda_i^a - \frac13 \sum_j \bar\lambda_j^a\Big)
                + K (J - 1) \frac{J}{\lambda_i}, \qquad \bar\lambda_i = J^{-1/3} \lambda_i, \quad i = 1, 2, 3

with all three stretches free (Ogden, Non-linear Elastic Deformations, 1984, chapters 4 and 7), without plane strain or
the series about F = I. The body is in plane strain, lambda_3 = 1. In each mode all three principal stresses are
compared.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI
from numpy.typing import NDArray
from scipy.optimize import brentq

from benchmarks.verification.case import Case, Row, worst
from variational import compat, jit, kinematics
from variational.materials.material import Material
from variational.materials.ogden import Ogden

Array = NDArray[np.float64]


# -- in principal stretches -----------------------------------------------------------------------------
class Solid(NamedTuple):
    """Shear modulus G (Pa), exponent a and bulk modulus K (Pa)."""

    name: str
    shear: float
    exponent: float
    bulk: float


def nominal(solid: Solid, stretches: Sequence[Any]) -> Array:
    """Return P_i (Pa), shape (3, ...), at principal stretches of that shape."""
    lam = np.stack(np.broadcast_arrays(*stretches))
    J = lam.prod(axis=0)
    powers = (lam * J ** (-1 / 3)) ** solid.exponent
    distortion = 2 * solid.shear / (solid.exponent * lam) * (powers - powers.mean(axis=0))
    return np.asarray(solid.bulk * (J - 1) * J / lam + distortion)


def cauchy(solid: Solid, F: Array) -> Array:
    """Return sigma = sum_i (lambda_i P_i / J) n_i n_i^T (Pa), (n, 3, 3), at F in the plane, (n, 2, 2)."""
    full = np.zeros((len(F), 3, 3))
    full[:, :2, :2], full[:, 2, 2] = F, 1.0
    squares, n = np.linalg.eigh(full @ full.transpose(0, 2, 1))
    lam = np.sqrt(squares).T
    sigma = lam * nominal(solid, lam) / lam.prod(axis=0)
    return np.asarray(np.einsum("kia,ak,kja->kij", n, sigma, n))


def free_stretch(solid: Solid, stretch: float) -> float:
    """Return the in-plane lateral stretch at which P_2 = 0, with lambda_3 = 1."""
    ends = 0.4 / stretch, 2.5 / stretch  # J from 0.4 to 2.5
    return float(brentq(lambda x: nominal(solid, (stretch, x, 1.0))[1], *ends, xtol=1e-15, rtol=1e-15))


# -- by the package --------------------------------------------------------------------------------------
class Evaluation(NamedTuple):
    """W (n,), P (n, 2, 2), sigma (n, 3, 3) and dP/dF (n, 2, 2, 2, 2), in Pa."""

    density: Array
    P: Array
    sigma: Array
    tangent: Array


class Points:
    """Energy, stresses and tangent of a law; compiled once. Each rank evaluates all points by itself."""

    def __init__(self, solid: Material) -> None:
        """Compile the law; its numbers are replaced at each evaluation."""
        self._mesh = mesh.create_unit_square(MPI.COMM_SELF, 8, 8)
        self._cells = np.arange(128, dtype=np.int32)

        def field(*shape: int) -> fem.Function:
            return fem.Function(fem.functionspace(self._mesh, ("Discontinuous Lagrange", 0, shape)))

        self._F, self._parameters = field(2, 2), [field() for _ in solid.names()]
        made = solid.with_values(dict(zip(solid.names(), self._parameters, strict=True)))
        F = ufl.variable(self._F)
        P = kinematics.first_piola_kirchhoff(made, F)
        parts: list[Any] = [made.density(F), P, kinematics.cauchy(made, F), ufl.diff(P, F)]
        entries = [part[index] if index else part for part in parts for index in np.ndindex(part.ufl_shape)]
        self._compiled = fem.Expression(ufl.as_vector(entries), np.array([[1 / 3, 1 / 3]]), jit_options=jit.OPTIONS)

    def __call__(self, F: Array, *parameters: Any) -> Evaluation:
        """Evaluate at deformation gradients (n, 2, 2), n up to 128, for the law's numbers, each of shape () or (n,)."""
        n = len(F)
        self._F.x.array[:] = np.tile(np.eye(2).ravel(), len(self._cells))
        self._F.x.array[: 4 * n] = np.asarray(F).ravel()
        for function, value in zip(self._parameters, parameters, strict=True):
            function.x.array[:] = 1.0
            function.x.array[:n] = value
        found = compat.evaluate_on_cells(self._compiled, self._mesh, self._cells)[:n]
        W, P, sigma, tangent = np.split(found, (1, 5, 14), axis=1)
        shapes = P.reshape(n, 2, 2), sigma.reshape(n, 3, 3), tangent.reshape(n, 2, 2, 2, 2)
        return Evaluation(W[:, 0], *shapes)


# -- cases -------------------------------------------------------------------------------------------------
TABLE = {"SC": (86.76e3, -14.53), "VE": (61.75e3, -14.53), "dermis": (2.55e3, -14.53), "subcutis": (25e3, 5.0)}
NU, ROUNDOFF = 0.48, 1e-13
# Table 2 by Eqs. 1 and 2, with the exponent as the paper prints it and as Abaqus has it.
LAYERS = [
    Solid(f"{name}, {'-' if sign < 0 else '+'}alpha", G, sign * alpha, 2 * G * (1 + NU) / (3 * (1 - 2 * NU)))
    for name, (G, alpha) in TABLE.items()
    for sign in (-1, 1)
]
STRETCHES = np.array([0.6, 0.75, 0.9, 0.99, 1.0, 1.01, 1.1, 1.3, 1.6])
MODES: dict[str, Callable[[Solid], tuple[Any, Any, Any]]] = {  # mode: F_11, F_22, F_12
    "pure shear (λ, free, 1)": lambda solid: (STRETCHES, [free_stretch(solid, x) for x in STRETCHES], 0.0),
    "equibiaxial (λ, λ, 1)": lambda _: (STRETCHES, STRETCHES, 0.0),
    "isochoric (λ, 1/λ, 1)": lambda _: (STRETCHES, 1 / STRETCHES, 0.0),
    "confined (λ, 1, 1)": lambda _: (STRETCHES, 1.0, 0.0),
    "simple shear 0 to 1.5": lambda _: (1.0, 1.0, np.linspace(0, 1.5, 9)),
}


def _compared(mode: str, solid: Solid, points: Points) -> list[Row]:
    """Return a row for each state: the component of sigma, zero ones apart, that is furthest off, in kPa."""
    xx, yy, xy = np.broadcast_arrays(*MODES[mode](solid))
    F = np.stack([xx, xy, 0.0 * xx, yy], axis=-1).reshape(-1, 2, 2)
    ours, rows = points(F, solid.shear, solid.bulk, solid.exponent), []
    why = "of the largest modulus: roundings; the series about F = I leaves 3e-14 of the tangent"
    for mine, theirs, A in zip(ours.sigma, cauchy(solid, F), ours.tangent, strict=True):
        tolerance, error = ROUNDOFF * float(np.abs(A).max()), np.abs(mine - theirs)
        k = int(np.where((np.abs(theirs) > tolerance) | (error > tolerance), error, -1.0).argmax())
        quantity, pair = f"{mode}, {solid.name}: sigma_{k // 3 + 1}{k % 3 + 1} (kPa)", (mine.flat[k], theirs.flat[k])
        rows.append(Row(quantity, pair[0] / 1e3, pair[1] / 1e3, tolerance / 1e3, why, absolute=True))
    return rows


def modes(small: bool) -> list[Row]:
    """Homogeneous states of the paper's layers, both signs of the exponent."""
    points = Points(Ogden(1.0, 2.0, 0.3))
    return [worst([row for solid in LAYERS for row in _compared(mode, solid, points)]) for mode in MODES]


_OGDEN = "Ogden 1984, Non-linear Elastic Deformations"
CASES = (Case("Homogeneous states", f"{_OGDEN}, chapters 4 and 7, in NumPy", modes),)
