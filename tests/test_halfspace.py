"""Exact contact of a periodic half-space: closed forms with convergence, two grids, and the 1/q of elasticity."""

import numpy as np
import pytest

from variational.roughness.halfspace import compliance, displacement, press
from variational.roughness.spectrum import SelfAffine
from variational.roughness.topography import HeightMap


def test_displacement_of_a_wave():
    """2 p / (E* q) under a wave of pressure, to roundoff; its mean does not move the surface."""
    n, modulus, q = 32, 3.0, 2 * np.pi * np.hypot(2 / 1.5, 3 / 0.8)
    x, y = np.arange(n)[:, None] * 1.5 / n, np.arange(n)[None] * 0.8 / n
    wave = np.cos(2 * np.pi * (2 * x / 1.5 + 3 * y / 0.8))
    found = displacement(5.0 + wave, compliance((n, n), (1.5, 0.8), modulus))
    np.testing.assert_allclose(found, 2 / (modulus * q) * wave, atol=1e-14)


@pytest.fixture(scope="module")
def rough() -> HeightMap:
    return SelfAffine(1.0, 0.75, 2 * np.pi, plateau=False, shortest=2 * np.pi / 8).surface(
        (128, 128), (8 * np.pi,) * 2, 3
    )


def test_conditions(rough):
    """Mean pressure to roundoff; pressure or gap at each point, never both, and none negative."""
    found = press(rough, 0.05, 1.0)
    assert found.pressure.mean() == pytest.approx(0.05, rel=1e-12, abs=0)
    assert found.pressure.min() >= 0 and found.gap.min() >= 0 and not (found.pressure * found.gap).any()
    assert 0 < found.fraction < 0.5


def _dense(heights: np.ndarray, size: tuple[float, float], mean: float, attraction: np.ndarray) -> np.ndarray:
    """Return the pressure by an active set and the dense matrix of the influence of each pixel on each, E* = 1."""
    (nx, ny), (a, b) = heights.shape, size
    q = 2 * np.pi * np.hypot(np.fft.fftfreq(nx, a / nx)[:, None], np.fft.fftfreq(ny, b / ny)[None])
    kernel = np.fft.ifft2(np.divide(2, q, out=np.zeros_like(q), where=q > 0)).real
    x, y = (each.ravel() for each in np.indices(heights.shape))
    matrix = kernel[x[:, None] - x, y[:, None] - y]
    h = heights.ravel() + matrix @ attraction.ravel()
    touching = h > np.quantile(h, 0.8)
    while True:
        c = np.flatnonzero(touching)
        system = np.block([[matrix[np.ix_(c, c)], np.ones((len(c), 1))], [np.ones((1, len(c))), np.zeros((1, 1))]])
        *pressure, approach = np.linalg.solve(system, np.append(h[c], h.size * mean))
        p = np.zeros(h.size)
        p[c] = pressure
        overlap = ~touching & (matrix @ p + approach < h)
        if not (p < 0).any() and not overlap.any():
            return p.reshape(heights.shape)
        touching = touching & (p >= 0) if (p < 0).any() else touching | overlap


@pytest.mark.parametrize("pulled", [False, True])
@pytest.mark.parametrize(("shape", "size"), [((16, 16), (1.0, 1.0)), ((15, 17), (1.0, 1.0)), ((9, 24), (0.5, 2.0))])
def test_same_as_a_dense_matrix(shape, size, pulled):
    """Any parity and proportion, up to the grid's highest wave, from a few pixels in contact to nearly all."""
    numbers = np.random.default_rng(1)
    heights = numbers.standard_normal(shape) * 0.01
    attraction = numbers.random(shape) * 0.05 * pulled
    for mean in (1e-4, 0.02, 0.15, 0.5):
        found = press(HeightMap(heights, size), mean, 1.0, attraction=attraction, tolerance=1e-9).pressure
        np.testing.assert_allclose(found, _dense(heights, size, mean, attraction), atol=1e-6 * found.max())


@pytest.mark.slow
@pytest.mark.parametrize("mean", [0.02, 0.1, 0.4])
def test_same_as_contact_mechanics(rough, mean):
    """Area, mean gap and pressures of another program on the same map (MIT licence): ``make test-contact``.

    Both are solved to 1e-9 of the height; the tolerance of 1e-6 is what the contact's edge amplifies.
    """
    other = pytest.importorskip("ContactMechanics", reason="make test-contact")
    topography = pytest.importorskip("SurfaceTopography", reason="make test-contact")
    n, length = len(rough.heights), rough.size[0]
    substrate = other.PeriodicFFTElasticHalfSpace((n, n), 1.0, rough.size)
    system = other.make_system(
        substrate=substrate, surface=topography.Topography(rough.heights, rough.size, periodic=True)
    )
    system.minimize_proxy(external_force=mean * length**2, pentol=1e-9, maxiter=2000)
    pressure = np.abs(np.asarray(system.substrate.force)) * (n / length) ** 2
    gap = np.asarray(system.compute_gap(system.disp, system.offset))
    found = press(rough, mean, 1.0, tolerance=1e-9)
    np.testing.assert_allclose(found.pressure, pressure, atol=1e-6 * pressure.max())
    np.testing.assert_allclose(found.gap, np.maximum(gap - gap[pressure > 0].mean(), 0.0), atol=1e-6)


@pytest.mark.parametrize(("pressure", "modulus", "words"), [(0.0, 1.0, "mean pressure"), (1.0, -1.0, "modulus")])
def test_bad_numbers(rough, pressure, modulus, words):
    with pytest.raises(ValueError, match=f"the {words} of a contact is .* greater than 0"):
        press(rough, pressure, modulus)


@pytest.mark.parametrize("pixels", [3, 4, 6, 8])
def test_few_pixels(pixels):
    """From one pixel alone in contact, which has no direction: the load is borne, as from a uniform pressure."""
    for seed in range(5):
        surface = HeightMap(np.random.default_rng(seed).normal(size=(pixels, pixels)), (1.0, 1.0))
        highest = 1.0 * (surface.heights == surface.heights.max())
        for mean in (1e-3, 0.1, 1.0, 20.0):
            alone, found = press(surface, mean, 1.0, start=highest), press(surface, mean, 1.0)
            assert alone.pressure.mean() == pytest.approx(mean)
            np.testing.assert_allclose(alone.pressure, found.pressure, atol=1e-3 * found.pressure.max())
