"""Height maps: trends, spectrum, fit, synthesis, files, and the roughness that a small map misses."""

import importlib

import numpy as np
import pytest

from variational.roughness.bam import BearingArea
from variational.roughness.spectrum import SelfAffine, power_spectrum, roughness_table
from variational.roughness.topography import HeightMap, polynomials

UM = 1e-6
SHAPE, SIZE = (256, 256), (800 * UM, 800 * UM)


@pytest.fixture
def rough() -> HeightMap:
    return SelfAffine().surface(SHAPE, SIZE, seed=3)


def grid(shape, size):
    """Return x and y (m) of the pixels."""
    return np.meshgrid(*(length / n * np.arange(n) for n, length in zip(shape, size, strict=True)), indexing="ij")


def wave(shape=(48, 32), size=(60 * UM, 80 * UM), periods=(3, 2), amplitude=2 * UM) -> HeightMap:
    x, y = grid(shape, size)
    return HeightMap(amplitude * np.sin(2 * np.pi * (periods[0] * x / size[0] + periods[1] * y / size[1])), size)


@pytest.mark.parametrize("trend", ["tilt", "curvature"])
def test_a_trend_is_removed_exactly(trend):
    """Polynomials of the trend's degree leave rounding errors of a projection, far below 1e-12 of their height."""
    x, y = grid((20, 31), (100 * UM, 70 * UM))
    h = 3 * UM + 0.02 * x - 0.1 * y
    if trend == "curvature":
        h = h + 300 * x**2 - 200 * x * y + 100 * y**2
    flat = HeightMap(h, (100 * UM, 70 * UM)).detrended(trend)
    assert np.abs(flat.heights).max() < 1e-12 * np.ptp(h)


def test_parseval(rough):
    """Without a window the spectrum's sum is the mean square, to rounding; the radial average keeps the sum."""
    spectrum = power_spectrum(rough)
    assert spectrum.h_rms == pytest.approx(rough.h_rms, rel=1e-12, abs=0)
    ring = spectrum.radial()
    assert np.sqrt(np.sum(ring.psd * ring.modes) / np.prod(SIZE)) == pytest.approx(rough.h_rms, rel=1e-12, abs=0)


def test_spectrum_of_a_sine():
    """A sine of amplitude a has C = a^2 A / 4 at q and -q, and nothing else. Tolerance: roundoff."""
    m = wave()
    psd = power_spectrum(m).psd
    assert psd[3, 2] == pytest.approx((2 * UM) ** 2 * 60 * UM * 80 * UM / 4, rel=1e-12, abs=0)
    assert psd[3, 2] + psd[-3, -2] == pytest.approx(psd.sum(), rel=1e-12, abs=0)
    assert power_spectrum(m).q[3, 2] == pytest.approx(2 * np.pi * np.hypot(3 / (60 * UM), 2 / (80 * UM)))


@pytest.mark.parametrize("plateau", [True, False])
def test_prefactor_is_the_variance(plateau):
    """The integral of q C over a fine grid of q to 1e5 q_0, where 1e-7 of the variance is left.

    Tolerance: without plateau the spectrum begins with a jump, which the trapezoidal rule spreads over an interval
    of q_0 / 2000: that adds 4e-4.
    """
    kind = SelfAffine(plateau=plateau)
    q = kind.q_0 * np.concatenate([np.linspace(1e-6, 1, 2000, endpoint=False), np.geomspace(1, 1e5, 200_000)])
    assert np.trapezoid(q * kind.psd(q), q) / (2 * np.pi) == pytest.approx(kind.h_rms**2, rel=5e-4, abs=0)


@pytest.mark.parametrize("plateau", [True, False])
def test_surfaces_have_the_rms_asked_for(plateau):
    """12 surfaces scatter by 2 % each (64 patches of lambda_0^2); three standard errors of the mean are 2 %."""
    rms = [SelfAffine(plateau=plateau).surface(SHAPE, SIZE, seed).h_rms for seed in range(12)]
    assert np.mean(rms) == pytest.approx(3.1 * UM, rel=0.02)


def test_fit_recovers_a_surface():
    """Three times the scatter found over 12 surfaces of four times the pixels, doubled for half the range of q."""
    kind = SelfAffine(h_rms=2 * UM, hurst=0.6, wavelength=80 * UM)
    fit = power_spectrum(kind.surface(SHAPE, SIZE, seed=5)).fit()
    assert fit.resolved
    assert fit.hurst == pytest.approx(0.6, abs=0.04)
    assert fit.wavelength == pytest.approx(80 * UM, rel=0.15)
    assert fit.h_rms(plateau=True) == pytest.approx(2 * UM, rel=0.1)


@pytest.mark.parametrize("wavelength", [3 * UM, 12 * UM])
def test_roll_off_that_pixels_do_not_show_is_refused(wavelength):
    """Pixels of 2 um show wavelengths from 16 um on; one of 20 um is found, to 15 %, as above."""
    shape, size = (256, 256), (512 * UM, 512 * UM)
    with pytest.raises(ValueError, match="rolls off at a wavelength of 1.6e-05 m or less, which pixels of 2e-06 m"):
        power_spectrum(SelfAffine(wavelength=wavelength).surface(shape, size, seed=5)).fit()
    fit = power_spectrum(SelfAffine(wavelength=20 * UM).surface(shape, size, seed=5)).fit()
    assert fit.wavelength == pytest.approx(20 * UM, rel=0.15)


def test_table_feeds_the_closure(rough):
    """A map of many lambda_0 shows its roll-off. Three times the scatter of surfaces this large."""
    table = roughness_table(rough)
    closure = BearingArea(0.514 * UM, **table)
    assert closure.h_rms == rough.detrended("curvature").h_rms == pytest.approx(3.1 * UM, rel=0.1)
    assert closure.wavelength == pytest.approx(100 * UM, rel=0.2)


def expected_rms(kind: SelfAffine, n: int, pixels: int) -> float:
    """Return the root of the expected mean square (m) of a spot without its curvature, from the spectrum alone.

    The spot's expected square along a polynomial phi is the sum over modes of C / A times the square of phi's Fourier
    transform. The sides of the surface and of the spot have ``n`` and ``pixels`` pixels.
    """
    variance, spot = kind.modes((n, n), SIZE) / np.prod(SIZE), (pixels, pixels)
    modes = (np.abs(np.fft.fft2(phi.reshape(spot), s=(n, n))) for phi in polynomials(spot, 2).T)
    return float(np.sqrt(kind.h_rms**2 - sum(float(np.sum(variance * mode**2)) for mode in modes) / pixels**2))


def test_a_spot_of_100_um_shows_2_2_um_of_3_1():
    """With the plateau, the curvature removed; without the plateau it shows 2.73 um. Tolerance: 2 %, said of both."""
    with_plateau, without = (expected_rms(SelfAffine(plateau=each), 256, 32) for each in (True, False))
    assert with_plateau == pytest.approx(2.2 * UM, abs=0.05 * UM)
    assert without == pytest.approx(2.73 * UM, abs=0.05 * UM)


@pytest.mark.parametrize(
    ("heights", "size", "words"),
    [
        (np.full((4, 4), np.nan), (1.0, 1.0), "16 of 16 heights are missing"),
        (np.zeros((4, 4)), (1.0, np.nan), "two positive lengths"),
        (np.zeros((2, 8)), (1.0, 1.0), "at least 3 x 3"),
    ],
)
def test_bad_maps(heights, size, words):
    with pytest.raises(ValueError, match=words):
        HeightMap(heights, size)


def test_nothing_to_analyse():
    flat = HeightMap(np.zeros((32, 32)), (1.0, 1.0))
    with pytest.raises(ValueError, match="no roughness"):
        power_spectrum(flat).fit()
    with pytest.raises(ValueError, match="factor of 3"):
        power_spectrum(flat).fit((1.0, 2.9))
    with pytest.raises(ValueError, match="same shape"):
        power_spectrum(flat, wave())
    with pytest.raises(ValueError, match="not inside"):
        flat.cut((20, 0), (16, 16))
    with pytest.raises(ValueError, match="too large"):
        SelfAffine(plateau=False, wavelength=1 * UM).surface((8, 8), SIZE, 0)
    with pytest.raises(ValueError, match="Hurst"):
        SelfAffine(hurst=1.2)


@pytest.fixture
def other():
    return pytest.importorskip("SurfaceTopography", reason="pip install fingerpad[topography]")


def test_same_as_surface_topography(other, rough):
    """rms, spectrum mode by mode, its mean in rings and the heights without curvature: the same up to rounding."""
    theirs = other.Topography(rough.heights, rough.size, unit="m", periodic=True)
    ours = power_spectrum(rough)
    assert theirs.Sq() == pytest.approx(rough.h_rms, rel=1e-12, abs=0)
    edges = 2 * np.pi / SIZE[0] * np.array([3.5, 7.5, 15.5, 31.5, 63.5])
    _, rings, psd = theirs.power_spectrum_from_area(collocation=edges, return_map=True)
    np.testing.assert_allclose(psd.ravel()[1:], ours.psd.ravel()[1:], rtol=1e-9, atol=0)
    means = [ours.psd[(ours.q >= a) & (ours.q < b)].mean() for a, b in zip(edges, edges[1:], strict=False)]
    np.testing.assert_allclose(np.asarray(rings), means, rtol=1e-9, atol=0)
    flat = theirs.detrend("curvature").heights()
    np.testing.assert_allclose(flat, rough.detrended("curvature").heights, rtol=0, atol=1e-9 * rough.h_rms)


def test_fit_of_a_surface_made_by_surface_topography(other):
    """Its generator is not ours: H, roll-off and rms are found as in our own surfaces, within three scatters."""
    theirs = importlib.import_module("SurfaceTopography.Generation").fourier_synthesis(
        SHAPE, SIZE, hurst=0.75, rms_height=3.1 * UM, long_cutoff=100 * UM, unit="m", rng=np.random.default_rng(2)
    )
    fit = power_spectrum(HeightMap(theirs.heights(), SIZE)).fit()
    assert fit.hurst == pytest.approx(0.75, abs=0.04)
    assert fit.wavelength == pytest.approx(100 * UM, rel=0.15)
    assert fit.h_rms(plateau=True) == pytest.approx(3.1 * UM, rel=0.1)
