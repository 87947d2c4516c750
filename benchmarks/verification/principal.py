r"""Ogden solids in principal stretches, differentiated by hand, in NumPy: what the package's UFL is compared with.

.. math:: W = \sum_p \frac{2 G_p}{a_p^2} \Big(\sum_i \bar\lambda_i^{a_p} - 3\Big) + \frac K2 (J - 1)^2, \qquad
          P_i = \sum_p \frac{2 G_p}{a_p \lambda_i} \Big(\bar\lambda_i^{a_p} - \frac13 \sum_j \bar\lambda_j^{a_p}\Big)
                + K (J - 1) \frac{J}{\lambda_i}

with i = 1, 2, 3 and :math:`\bar\lambda_i = J^{-1/3} \lambda_i`, all three stretches free (Ogden, Non-linear Elastic
Deformations, 1984, chapters 4 and 7): independent of plane strain, of the series about F = I and of the package.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

Array = NDArray[Any]


@dataclass(frozen=True)
class Solid:
    """Terms (G_p in Pa, a_p) of the isochoric part and bulk modulus K (Pa)."""

    name: str
    terms: tuple[tuple[float, float], ...]
    bulk: float


def skin(name: str, shear_modulus: float, alpha: float, poisson: float, sign: int) -> Solid:
    """Return a layer of Table 2 by Eqs. 1 and 2; ``sign`` -1 as the paper prints the exponent, +1 as Abaqus does."""
    D = 3 * (1 - 2 * poisson) / (shear_modulus * (1 + poisson))
    return Solid(name, ((shear_modulus, sign * alpha),), 2 / D)


def nominal(solid: Solid, stretches: Sequence[Any]) -> Array:
    """Return P_i (Pa), shape (3, ...), at principal stretches of that shape; complex ones are differentiated with."""
    lam = np.stack(np.broadcast_arrays(*stretches))
    J = lam.prod(axis=0)
    P = solid.bulk * (J - 1) * J / lam
    for G, a in solid.terms:
        powers = (lam * J ** (-1 / 3)) ** a
        P = P + 2 * G / (a * lam) * (powers - powers.mean(axis=0))
    return P


def cauchy(solid: Solid, F: Array) -> Array:
    """Return the Cauchy stress (Pa), shape (n, 3, 3), at in-plane deformation gradients (n, 2, 2), lambda_3 = 1.

    From the eigenvectors n_i of b = F F^T: sigma = sum_i (lambda_i P_i / J) n_i n_i^T.
    """
    full = np.zeros((len(F), 3, 3))
    full[:, :2, :2], full[:, 2, 2] = F, 1.0
    squares, n = np.linalg.eigh(full @ full.transpose(0, 2, 1))
    lam = np.sqrt(squares).T
    sigma = lam * nominal(solid, lam) / lam.prod(axis=0)
    return np.asarray(np.einsum("kia,ak,kja->kij", n, sigma, n))


def free_stretch(solid: Solid, stretch: float) -> float:
    """Return the in-plane lateral stretch at which P_2 = 0, with lambda_3 = 1."""

    def lateral(x: float) -> float:
        return float(nominal(solid, (stretch, x, 1.0))[1])

    return float(brentq(lateral, 0.4 / stretch, 2.5 / stretch, xtol=1e-15, rtol=1e-15))  # J from 0.4 to 2.5


def moduli(solid: Solid, stretches: Sequence[float], step: float = 1e-30) -> Array:
    """Return dP_i / dlambda_j (Pa), shape (3, 3), by complex steps, exact to roundoff."""
    lam = np.array(stretches, dtype=complex)
    return np.stack([nominal(solid, lam + 1j * step * e).imag / step for e in np.eye(3)], axis=1)
