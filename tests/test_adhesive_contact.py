"""Contact whose attraction deforms: without deformation it is the closure's, and a weak attraction hardly deforms."""

import pytest

from benchmarks.microscale.adhesive import attraction_of, pressed
from variational.attraction.electroadhesion import VACUUM_PERMITTIVITY
from variational.roughness.halfspace import press
from variational.roughness.spectrum import SelfAffine

H_0, MODULUS = 0.514e-6, 4 / 3 * 1e6


@pytest.fixture(scope="module")
def rough():
    spectrum = SelfAffine(3.1e-6, 0.75, 100e-6, plateau=False, shortest=12.5e-6)
    return spectrum.surface((64, 64), (200e-6, 200e-6), 2)


@pytest.mark.parametrize("in_contact", [True, False])
def test_balance(rough, in_contact):
    """The screen bears external pressure and attraction, to the iteration's 3e-3 of the attraction."""
    found = pressed(rough, 20e3, MODULUS, H_0, 50.0, in_contact, deforms=False)
    assert found.p_c == pytest.approx(20e3 + found.attraction, abs=6e-3 * found.attraction)


def test_undeformed_attraction_is_that_of_the_contact(rough):
    """Eq. 3 over the gaps of the contact under the whole pressure, to what 3e-3 of the attraction changes of it."""
    found = pressed(rough, 20e3, MODULUS, H_0, 70.0, True, deforms=False)
    alone = press(rough, found.p_c, MODULUS)
    exact = attraction_of(alone.gap, alone.pressure > 0, 70.0, H_0, True).mean()
    assert found.attraction == pytest.approx(float(exact), rel=5e-3)


def test_weak_attraction_hardly_deforms(rough):
    """At 10 V both agree within 1 %; at 70 V the deformed one attracts less: contact balances it on the spot."""
    weak = [pressed(rough, 20e3, MODULUS, H_0, 10.0, True, deforms).attraction for deforms in (False, True)]
    assert weak[1] == pytest.approx(weak[0], rel=0.01)
    strong = [pressed(rough, 20e3, MODULUS, H_0, 70.0, True, deforms).attraction for deforms in (False, True)]
    assert strong[1] < 0.95 * strong[0]


@pytest.mark.parametrize("voltage", [20.0, 30.0, 50.0, 100.0])
def test_same_as_adhesion(voltage):
    """Pressure, attraction, contact and gap of another program on the same map (MIT licence): ``make test-contact``.

    It minimises the energy at a held approach, here in kPa and um; its Coulomb potential repels, and is negated. The
    tolerance is ten times that of the iteration here.
    """
    adhesion = pytest.importorskip("Adhesion.System", reason="make test-contact")
    interactions = pytest.importorskip("Adhesion.Interactions")
    mechanics, topography = pytest.importorskip("ContactMechanics"), pytest.importorskip("SurfaceTopography")

    class Attraction(interactions.Coulomb):
        def evaluate(self, *args, **options):
            return tuple(None if part is None else -part for part in super().evaluate(*args, **options))

    n, side, p_ext = 128, 200e-6, 20e3
    spectrum = SelfAffine(3.1e-6, 0.75, 100e-6, plateau=False, shortest=12.5e-6)
    rough = spectrum.surface((n, n), (side, side), 2)
    found = pressed(rough, p_ext, MODULUS, H_0, voltage, True, deforms=True, tolerance=1e-6)
    size = (side * 1e6, side * 1e6)
    substrate = mechanics.PeriodicFFTElasticHalfSpace((n, n), MODULUS / 1e3, size)
    h = rough.heights * 1e6
    insulators = (VACUUM_PERMITTIVITY * 1e9, 1.0, 1.0, 1.0, H_0 * 1e6 / 2, H_0 * 1e6 / 2, voltage)
    other = adhesion.BoundedSmoothContactSystem(
        substrate, Attraction(*insulators), topography.Topography(h, size, periodic=True)
    )
    sunk = p_ext / 1e3 / float(substrate.surface_stiffness.flat[0].real)  # of the whole surface, under the mean
    tight = {"maxiter": 20000, "maxfun": 100000, "gtol": 1e-7, "ftol": 1e-18, "maxcor": 20}
    other.minimize_proxy(offset=sunk - h.mean() - found.gap * 1e6, lbounds="auto", method="L-BFGS-B", options=tight)
    gap = other.gap * 1e-6
    assert other.compute_normal_force() / size[0] ** 2 * 1e3 == pytest.approx(p_ext, rel=1e-5)
    assert attraction_of(gap, gap == 0, voltage, H_0, True).mean() == pytest.approx(found.attraction, rel=1e-5)
    assert (gap == 0).mean() == pytest.approx(found.fraction, rel=1e-3)
    assert gap.mean() == pytest.approx(found.gap, rel=1e-5)
