r"""The laws of the solids at points: by the package's UFL, and in principal stretches by an evaluation of their own.

.. math:: W = \sum_p \frac{2 G_p}{a_p^2} \Big(\sum_i \bar\lambda_i^{a_p} - 3\Big) + \frac K2 (J - 1)^2, \qquad
          P_i = \sum_p \frac{2 G_p}{a_p \lambda_i} \Big(\bar\lambda_i^{a_p} - \frac13 \sum_j \bar\lambda_j^{a_p}\Big)
                + K (J - 1) \frac{J}{\lambda_i}

with i = 1, 2, 3 and :math:`\bar\lambda_i = J^{-1/3} \lambda_i`, all three stretches free (Ogden, Non-linear Elastic
Deformations, 1984, chapters 4 and 7), differentiated by hand, without plane strain or the series about F = I.

The body is in plane strain, lambda_3 = 1: a mode of the laboratory is reached where it leaves one stretch alone. In
each mode all three principal stresses are compared.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI
from numpy.typing import NDArray
from scipy.optimize import brentq

from benchmarks.verification.case import Case, Row, worst
from variational import compat, jit, kinematics
from variational.materials import ogden, stress
from variational.materials.material import Material
from variational.materials.ogden import Ogden

Array = NDArray[np.float64]


# -- in principal stretches -----------------------------------------------------------------------------
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


def nominal(solid: Solid, stretches: Sequence[Any]) -> NDArray[Any]:
    """Return P_i (Pa), shape (3, ...), at principal stretches of that shape; complex ones are differentiated with."""
    lam = np.stack(np.broadcast_arrays(*stretches))
    J = lam.prod(axis=0)
    P = solid.bulk * (J - 1) * J / lam
    for G, a in solid.terms:
        powers = (lam * J ** (-1 / 3)) ** a
        P = P + 2 * G / (a * lam) * (powers - powers.mean(axis=0))
    return P


def cauchy(solid: Solid, F: Array) -> NDArray[Any]:
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
    ends = 0.4 / stretch, 2.5 / stretch  # J from 0.4 to 2.5
    return float(brentq(lambda x: nominal(solid, (stretch, x, 1.0))[1], *ends, xtol=1e-15, rtol=1e-15))


def moduli(solid: Solid, stretches: Sequence[float], step: float = 1e-30) -> NDArray[Any]:
    """Return dP_i / dlambda_j (Pa), shape (3, 3), by complex steps, exact to roundoff."""
    lam = np.array(stretches, dtype=complex)
    return np.stack([nominal(solid, lam + 1j * step * e).imag / step for e in np.eye(3)], axis=1)


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
        P = stress.first_piola_kirchhoff(made, F)
        parts: list[Any] = [made.density(F), P, stress.cauchy(made, F), ufl.diff(P, F)]
        entries = [part[index] if index else part for part in parts for index in np.ndindex(part.ufl_shape)]
        centre = np.array([[1 / 3, 1 / 3]])
        self._compiled = fem.Expression(ufl.as_vector(entries), centre, jit_options=jit.OPTIONS)

    def __call__(self, F: Array, *parameters: Any) -> Evaluation:
        """Evaluate.

        Args:
            F: deformation gradients, (n, 2, 2), n up to 128.
            parameters: its numbers in the order of the law's names, each a number or of shape (n,).
        """
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
LAYERS = [
    skin(f"{name}, {'-' if sign < 0 else '+'}alpha", *values, 0.48, sign)
    for name, values in TABLE.items()
    for sign in (-1, 1)
]
# Treloar's rubber in three terms mu_p (lambda^a - 1) / a: Ogden 1972. Here mu_p = 2 G_p / a_p.
RUBBER = ((6.3e5, 1.3), (1.2e3, 5.0), (-0.1e5, -2.0))  # mu_p in Pa, a_p
ROUNDOFF = 1e-13
_OGDEN = "Ogden 1984, Non-linear Elastic Deformations"
_WHY = "of the largest modulus: roundings; the series about F = I leaves 3e-14 of the tangent"


@cache
def one_term() -> Points:
    """Return the package's Ogden law."""
    return Points(Ogden(1.0, 2.0, 0.3))


def in_package(solid: Solid, F: Array) -> Evaluation:
    """Return what the package computes for a solid of one term."""
    ((G, a),) = solid.terms
    return one_term()(F, G, solid.bulk, a)


def plane(xx: Any, yy: Any, xy: Any = 0.0) -> Array:
    """Return deformation gradients of two stretches and a shear, shape (n, 2, 2)."""
    xx, yy, xy = np.broadcast_arrays(xx, yy, xy)
    return np.asarray(np.stack([xx, xy, 0.0 * xx, yy], axis=-1).reshape(-1, 2, 2))


def pure_shear(solid: Solid, stretches: Array) -> Array:
    """Return deformation gradients with a lateral stretch that is free, shape (n, 2, 2)."""
    return plane(stretches, np.array([free_stretch(solid, x) for x in stretches]))


STRETCHES = np.array([0.6, 0.75, 0.9, 0.99, 1.0, 1.01, 1.1, 1.3, 1.6])
MODES: dict[str, Callable[[Solid], Array]] = {
    "pure shear (λ, free, 1)": lambda solid: pure_shear(solid, STRETCHES),
    "equibiaxial (λ, λ, 1)": lambda solid: plane(STRETCHES, STRETCHES),
    "isochoric (λ, 1/λ, 1)": lambda solid: plane(STRETCHES, 1 / STRETCHES),
    "confined (λ, 1, 1)": lambda solid: plane(STRETCHES, 1.0),
    "simple shear 0 to 1.5": lambda solid: plane(1.0, 1.0, np.linspace(0, 1.5, 9)),
}


def compared(mode: str, solid: Solid, F: Array, ours: Evaluation) -> list[Row]:
    """Return a row for each state: the component of the Cauchy stress that is furthest off, in kPa.

    Those that are zero are shown only if they are not.
    """
    rows = []
    for mine, theirs, A in zip(ours.sigma, cauchy(solid, F), ours.tangent, strict=True):
        tolerance = ROUNDOFF * float(np.abs(A).max())
        error = np.abs(mine - theirs)
        k = int(np.where((np.abs(theirs) > tolerance) | (error > tolerance), error, -1.0).argmax())
        quantity, pair = f"{mode}, {solid.name}: sigma_{k // 3 + 1}{k % 3 + 1} (kPa)", (mine.flat[k], theirs.flat[k])
        rows.append(Row(quantity, pair[0] / 1e3, pair[1] / 1e3, tolerance / 1e3, _WHY, absolute=True))
    return rows


def modes(small: bool) -> list[Row]:
    """Homogeneous states of the paper's layers, both signs of the exponent."""
    return [
        worst([row for s in LAYERS for row in compared(mode, s, states(s), in_package(s, states(s)))])
        for mode, states in MODES.items()
    ]


@dataclass(frozen=True)
class Rubber(Material):
    """The sum of Ogden terms (G_p, a_p): the package's energies add up."""

    bulk: float
    terms: Sequence[tuple[float, float]]

    @property
    def shear_modulus(self) -> float:
        return sum(G for G, _ in self.terms)

    def distortion(self, H):
        return sum(ogden.isochoric_energy(kinematics.deformation_gradient(H), G, a) for G, a in self.terms)

    def distortion_zz(self, F):
        return sum(ogden.isochoric_sigma_zz(F, G, a) for G, a in self.terms)


def three_terms(small: bool) -> list[Row]:
    """A sum of three terms, nearly incompressible, also against the incompressible law in pure shear."""
    terms = tuple((mu * a / 2, a) for mu, a in RUBBER)
    # J - 1 = p / K of about 1e-6 changes the stress by as much, and by as much times the exponents
    solid = Solid("rubber", terms, 1e6 * sum(G for G, _ in terms))
    points = Points(Rubber(solid.bulk, terms))
    stretches = np.array([0.5, 0.8, 0.999, 1.001, 1.5, 2.0, 3.0, 4.0, 5.0])
    F, sheared = pure_shear(solid, stretches), plane(1.0, 1.0, np.linspace(0, 3, 7))
    pulled = points(F, solid.bulk)
    rows = [
        worst(compared("pure shear (λ, free, 1)", solid, F, pulled)),
        worst(compared("simple shear 0 to 3", solid, sheared, points(sheared, solid.bulk))),
    ]
    why = "compressibility, K = 1e6 G: J - 1 of the order of the stress over K"
    for x in (0.5, 2.0, 5.0):
        ours = float(pulled.P[list(stretches).index(x), 0, 0])
        reference = sum(mu * (x ** (a - 1) - x ** (-a - 1)) for mu, a in RUBBER)
        quantity = f"pure shear, λ = {x:g}, incompressible: P_1 (kPa)"
        rows.append(Row(quantity, ours / 1e3, reference / 1e3, 1e-5, why))
    return rows


CASES = (
    Case("Homogeneous states", f"{_OGDEN}, chapters 4 and 7, in NumPy", modes),
    Case("Three Ogden terms", "Ogden 1972, doi 10.1098/rspa.1972.0026 (Treloar's rubber), in NumPy", three_terms),
)
