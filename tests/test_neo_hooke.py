"""The neo-Hookean solid against closed forms, and what a material of one's own must and need not have."""

from dataclasses import dataclass

import numpy as np
import pytest
import ufl

from benchmarks.verification.constitutive import Points
from geometry import tags
from tests.test_laws import Mine
from tests.test_problem import D_EQ, H_0, check_jacobian, direction, disturb, make
from variational.contact.interface import Interface
from variational.contact.nitsche import Nitsche
from variational.contact.penalty import Penalty
from variational.materials.material import Material, _unloaded
from variational.materials.neo_hooke import NeoHooke
from variational.materials.ogden import Ogden
from variational.materials.saint_venant import SaintVenant
from variational.problem import Problem
from variational.surface import Surface

G, NU = 2.5e3, 0.45
K = 2 * G * (1 + NU) / (3 * (1 - 2 * NU))
ROUNDOFF = 1e-12  # of the bulk modulus: a dozen operations on numbers of its size


@pytest.fixture(scope="module")
def evaluate():
    """Energy, P, Cauchy stress and tangent of the solid in plane strain at deformation gradients (n, 2, 2)."""
    points = Points(NeoHooke(1.0))
    return lambda F: points(np.asarray(F, dtype=float), G, K)


def test_is_ogdens_solid_with_exponent_two(evaluate):
    """I1-bar is the sum of squares of the stretches."""
    ogden = Ogden(G, 2.0, NU, "abaqus")
    F = np.array([[[1.2, 0.3], [0.0, 0.8]], [[0.7, 0.0], [0.1, 1.1]]])
    values = [getattr(ogden, name) for name in ogden.names()]
    for ours, theirs in zip(evaluate(F), Points(Ogden(1.0, 1.0, 0.3))(F, *values), strict=True):
        np.testing.assert_allclose(ours, theirs, atol=10 * ROUNDOFF * K)


@pytest.mark.parametrize("formulation", [Penalty(1e12, 1e11), Nitsche(10.0, 0)], ids=["penalty", "nitsche"])
@pytest.mark.parametrize("element", ["P2", "P2 reduced"])
def test_jacobian(square, element, formulation):
    problem = make(square, solid=NeoHooke(G), element=element, formulation=formulation)
    disturb(problem)
    check_jacobian(problem, direction(problem))


# -- one's own -------------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Hencky(Material):
    """A solid without a volumetric part of its own: all of its energy is in one piece."""

    lame: float
    shear_modulus: float

    @property
    def constrained_modulus(self):
        return self.lame + 2 * self.shear_modulus

    def energy(self, F):
        C = F.T * F
        I3 = ufl.det(C)
        return self.shear_modulus / 2 * (ufl.tr(C) - 3 - ufl.ln(I3)) + self.lame / 8 * ufl.ln(I3) ** 2


def problem_of(body, solids, element="P2"):
    surface = Surface(body.mesh, body.facet_tags, {0: tags.ridge(0)})
    return Problem(body.mesh, body.cell_tags, surface, solids, Interface(Penalty(1e12, 1e11), 0.25, H_0), element)


def test_own_material_in_one_piece(square):
    """Without a bulk modulus the mixed element gives it no pressure, and the tangent is still its residual's."""
    assert problem_of(square, {tags.STRATUM_CORNEUM: Hencky(1e5, 1e4)}, "P2-P1").pressure is None
    problem = problem_of(square, {tags.STRATUM_CORNEUM: Hencky(1e5, 1e4)})
    problem.set_air_gaps(np.array([D_EQ]))
    disturb(problem)
    check_jacobian(problem, direction(problem))


def test_layers_of_one_law_share_a_form(square):
    """Other numbers are other values of the same fields: one group, one kernel, and no form compiled again."""
    problem = problem_of(square, {1: Mine(G, K), 2: Mine(2 * G, 3 * K), 3: SaintVenant(1e6, 0.3), 4: NeoHooke(G)})
    assert list(problem.laws) == [(1, 2), (3,), (4,)]
    other = problem_of(square, {1: Mine(7 * G, K), 2: Mine(G, K), 3: SaintVenant(1e5, 0.2), 4: NeoHooke(3 * G)})
    assert other.residual.module.__name__ == problem.residual.module.__name__


# -- refusals --------------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class NoEnergy(Material):
    shear_modulus: float = 1.0
    bulk: float = 1.0


@dataclass(frozen=True)
class Prestressed(Mine):
    def energy(self, F):
        return self.shear_modulus / 2 * (ufl.inner(F, F) - 3)


@dataclass(frozen=True)
class TwiceAsStiff(Mine):
    def energy(self, F):
        return 2 * Mine.energy(self, F)


@dataclass(frozen=True)
class Fibres(Mine):
    """A matrix of 1 kPa with fibres at an angle to x, which add up to 20 Pa in shear."""

    def energy(self, F):
        a = ufl.as_vector([np.cos(0.4), np.sin(0.4), 0.0])
        return Mine.energy(Mine(1e3, 1.0), F) + 20.0 / 2 * (ufl.inner(F * a, F * a) - 1) ** 2


@dataclass(frozen=True)
class Failing(Mine):
    def energy(self, F):
        return self.shear_modulus * np.linalg.det(F)


@dataclass(frozen=True)
class NoBulk(Material):
    shear_modulus: float = 1.0
    energy = Mine.energy


@pytest.mark.parametrize("law", [Ogden, NeoHooke, SaintVenant])
def test_package_laws_are_natural_whatever_their_numbers(law):
    """So that their unloaded state is computed here, and not in each run. A derived class is not meant."""
    assert law.natural and not vars(type("Derived", (law,), {})).get("natural")
    random = np.random.default_rng(7)
    for _ in range(3):
        modulus, poisson = 10 ** random.uniform(0, 9), random.uniform(-0.5, 0.499)
        more = {"alpha": random.choice([-1, 1]) * 10 ** random.uniform(-1, 1.3)} if law is Ogden else {}
        name = "young" if law is SaintVenant else "shear_modulus"
        solid = law(**{name: modulus, "poisson": poisson}, **more)
        stress, shear = _unloaded(solid)
        assert max(map(abs, stress)) < 1e-8 * solid.shear_modulus
        np.testing.assert_allclose(shear, solid.shear_modulus, rtol=1e-6)


@dataclass
class Changing(Material):
    shear_modulus: float = 1.0


@pytest.mark.parametrize(
    ("solid", "sentence"),
    [
        (NoEnergy(), r"NoEnergy has no energy; it must have a method energy\(F\)"),
        (NoBulk(), "has no bulk modulus; it must have a constrained_modulus"),
        (Mine(1.0, -2.0), "bulk is -2 Pa; it must be finite and greater than 0"),
        (Mine(float("nan"), 1.0), "shear_modulus is nan; it must be a finite number"),
        (Prestressed(1.0, 1.0), "has a stress of 1 Pa unloaded; it must have none"),
        (TwiceAsStiff(1e3, 1.0), "shear_modulus is 1000 Pa; it must be that of the unloaded energy, 2000 Pa"),
        (Fibres(900.0, 1.0), "is 900 Pa; it must be that of the unloaded energy, 1000 to 1020 Pa"),
        (Failing(1.0, 1.0), "the energy of .* cannot be evaluated unloaded"),
        (Changing(), "Changing is a law; it must be a @dataclass"),
    ],
    ids=lambda value: type(value).__name__ if isinstance(value, Material) else None,
)
def test_what_is_no_solid_is_refused(square, solid, sentence):
    with pytest.raises(ValueError, match=sentence) as error:
        problem_of(square, {tags.STRATUM_CORNEUM: solid})
    assert "\n" not in str(error.value)
