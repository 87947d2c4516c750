r"""The laws of the solids against stresses in principal stretches, by an evaluation of their own.

The body is in plane strain, lambda_3 = 1, so a mode of the laboratory is reached where it leaves one stretch alone:

* pure shear (planar tension), (lambda, free, 1): the same in three dimensions, where the wide strip's width is held;
* simple shear, and isochoric shear (lambda, 1/lambda, 1): likewise;
* uniaxial: only as (lambda, free, 1), its third stretch is held; that is pure shear again. The bar that may contract
  both ways, (lambda, free, free), is out of reach of a law in plane strain, and so
* equibiaxial is (lambda, lambda, 1), not the balloon's (lambda, lambda, free);
* volumetric is confined compression (lambda, 1, 1) and the former, J = lambda^2; (lambda, lambda, lambda) is out of
  reach, but both parts of the law that it would be made of are met.

In each, all three principal stresses are compared, the one normal to the plane included.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.verification import principal
from benchmarks.verification.case import Case, Curves, Outcome, Row, worst
from benchmarks.verification.points import Points
from benchmarks.verification.principal import Solid, skin
from variational import kinematics
from variational.materials import ogden
from variational.materials.material import Material
from variational.materials.ogden import Ogden

Array = NDArray[np.float64]
TABLE = {"SC": (86.76e3, -14.53), "VE": (61.75e3, -14.53), "dermis": (2.55e3, -14.53), "subcutis": (25e3, 5.0)}
POISSON = 0.48
LAYERS = [
    skin(f"{name}, {'-' if sign < 0 else '+'}alpha", *TABLE[name], POISSON, sign) for name in TABLE for sign in (-1, 1)
]
# Treloar's rubber in three terms mu_p (lambda^a - 1) / a: Ogden 1972. Here mu_p = 2 G_p / a_p.
RUBBER = ((6.3e5, 1.3), (1.2e3, 5.0), (-0.1e5, -2.0))  # mu_p in Pa, a_p
_OGDEN = "Ogden 1984, Non-linear Elastic Deformations"
_ROUNDOFF = 1e-13
_WHY = "of the largest modulus: roundings; the series about F = I leaves 3e-14 of the tangent"


@cache
def one_term() -> Points:
    """Return the package's Ogden law."""
    return Points(Ogden(1.0, 2.0, 0.3))


def in_package(solid: Solid, F: Array) -> tuple[Array, Array, Array, Array]:
    """Return what the package makes of a solid of one term."""
    ((shear, a),) = solid.terms
    return one_term()(F, shear, solid.bulk, a)


def shear(amounts: NDArray[Any]) -> Array:
    """Return simple shears, shape (n, 2, 2)."""
    F = np.tile(np.eye(2), (len(amounts), 1, 1))
    F[:, 0, 1] = amounts
    return F


def stretched(one: NDArray[Any], other: NDArray[Any] | float) -> Array:
    """Return stretches along the axes, shape (n, 2, 2)."""
    F = np.zeros((len(one), 2, 2))
    F[:, 0, 0], F[:, 1, 1] = one, other
    return F


STRETCHES = np.array([0.6, 0.75, 0.9, 0.99, 1.0, 1.01, 1.1, 1.3, 1.6])
MODES: dict[str, Callable[[Solid], Array]] = {
    "pure shear (λ, free, 1)": lambda s: stretched(
        STRETCHES, np.array([principal.free_stretch(s, x) for x in STRETCHES])
    ),
    "equibiaxial (λ, λ, 1)": lambda s: stretched(STRETCHES, STRETCHES),
    "isochoric (λ, 1/λ, 1)": lambda s: stretched(STRETCHES, 1 / STRETCHES),
    "confined (λ, 1, 1)": lambda s: stretched(STRETCHES, 1.0),
    "simple shear 0 to 1.5": lambda s: shear(np.linspace(0, 1.5, 9)),
}


def compared(mode: str, solid: Solid, F: Array, ours: Array, tangent: Array) -> list[Row]:
    """Return a row for each state: the component of the Cauchy stress that is furthest off, in kPa.

    Those that are zero are shown only if they are not.
    """
    rows = []
    for mine, theirs, A in zip(ours, principal.cauchy(solid, F), tangent, strict=True):
        tolerance = _ROUNDOFF * float(np.abs(A).max())
        error = np.abs(mine - theirs)
        shown = np.where((np.abs(theirs) > tolerance) | (error > tolerance), error, -1.0)
        k = int(shown.argmax())
        quantity, pair = f"{mode}, {solid.name}: sigma_{k // 3 + 1}{k % 3 + 1} (kPa)", (mine.flat[k], theirs.flat[k])
        rows.append(Row(quantity, pair[0] / 1e3, pair[1] / 1e3, tolerance / 1e3, _WHY, absolute=True))
    return rows


def modes(small: bool) -> Outcome:
    """Homogeneous states of the paper's layers, both signs of the exponent."""
    rows = []
    for mode, states in MODES.items():
        found: list[Row] = []
        for solid in LAYERS:
            F = states(solid)
            _, _, sigma, tangent = in_package(solid, F)
            found += compared(mode, solid, F, sigma, tangent)
        rows.append(worst(found))

    return Outcome(tuple(rows))


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


def three_terms(small: bool) -> Outcome:
    """A sum of three terms, nearly incompressible, also against the incompressible law in pure shear."""
    terms = tuple((mu * a / 2, a) for mu, a in RUBBER)
    # J - 1 = p / K of about 1e-6 changes the stress by as much, and by as much times the exponents
    solid = Solid("rubber", terms, 1e6 * sum(G for G, _ in terms))
    points = Points(Rubber(solid.bulk, terms))
    stretches = np.array([0.5, 0.8, 0.999, 1.001, 1.5, 2.0, 3.0, 4.0, 5.0])
    F = stretched(stretches, np.array([principal.free_stretch(solid, x) for x in stretches]))
    _, P, sigma, tangent = points(F, solid.bulk)
    rows = [worst(compared("pure shear (λ, free, 1)", solid, F, sigma, tangent))]
    F_shear = shear(np.linspace(0, 3, 7))
    _, _, sigma, tangent = points(F_shear, solid.bulk)
    rows.append(worst(compared("simple shear 0 to 3", solid, F_shear, sigma, tangent)))

    def incompressible(x: NDArray[Any]) -> NDArray[Any]:
        return sum((mu * (x ** (a - 1) - x ** (-a - 1)) for mu, a in RUBBER), np.zeros_like(x))

    for x, ours in zip(stretches, P[:, 0, 0], strict=True):
        if x in (0.5, 2.0, 5.0):
            reference = float(incompressible(np.array(x))) / 1e3
            why = "compressibility, K = 1e6 G: J - 1 of the order of the stress over K"
            rows.append(Row(f"pure shear, λ = {x:g}, incompressible: P_1 (kPa)", ours / 1e3, reference, 1e-5, why))

    x, label = np.linspace(0.5, 5, 301), "nominal stress P_1 (kPa)"
    known = {"incompressible, closed form": (x, incompressible(x) / 1e3)}
    return Outcome(tuple(rows), Curves("stretch λ", label, known, {"K = 1e6 G": (stretches, P[:, 0, 0] / 1e3)}))


CASES = (
    Case("Homogeneous states", f"{_OGDEN}, chapters 4 and 7, in NumPy", modes),
    Case("Three Ogden terms", "Ogden 1972, doi 10.1098/rspa.1972.0026 (Treloar's rubber), in NumPy", three_terms),
)
