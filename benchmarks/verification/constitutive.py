r"""The laws of the solids against stresses in principal stretches, by an evaluation of their own.

The body is in plane strain, lambda_3 = 1: a mode of the laboratory is reached where it leaves one stretch alone. The
modes are pure shear (lambda, free, 1), equibiaxial (lambda, lambda, 1), isochoric shear (lambda, 1/lambda, 1), confined
compression (lambda, 1, 1) and simple shear. In each, all three principal stresses are compared.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.verification import principal
from benchmarks.verification.case import Case, Row, worst
from benchmarks.verification.points import Evaluation, Points
from benchmarks.verification.principal import Solid, skin
from variational import kinematics
from variational.materials import ogden
from variational.materials.material import Material
from variational.materials.ogden import Ogden

Array = NDArray[np.float64]
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
    return plane(stretches, np.array([principal.free_stretch(solid, x) for x in stretches]))


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
    for mine, theirs, A in zip(ours.sigma, principal.cauchy(solid, F), ours.tangent, strict=True):
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
