r"""Self-affine Gaussian surfaces: their power spectrum and how to make one.

The two-dimensional spectrum of Forsbach et al. 2023, Eq. 8 (doi:10.3389/fmech.2022.1074393), is

.. math:: C(q) = c \left( \frac{h_{rms}}{q_0} \right)^2 \left( \frac{q}{q_0} \right)^{-2-2H},
          \quad q \ge q_0 = 2\pi / \lambda_0

With :math:`h_{rms}^2 = \frac{1}{2\pi} \int q C(q) dq` the prefactor decides what is below q_0: the printed
:math:`c = 4\pi H/(1+H)` needs the plateau :math:`C(q_0)` there, without one it is :math:`c = 4\pi H`. From q_0 up
the printed one holds 1/(1+H) of the variance, 57 % at H = 0.75: read without a plateau, h_rms is not the rms.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from variational.roughness.topography import HeightMap

Array = NDArray[np.float64]


def prefactor(hurst: float, plateau: bool) -> float:
    """Return Eq. 8's c: 4 pi H / (1 + H) for a spectrum that is constant below q_0, 4 pi H for one that is zero."""
    return 4 * np.pi * hurst / (1 + hurst if plateau else 1)


def wavevectors(shape: tuple[int, ...], size: tuple[float, float]) -> Array:
    r"""Return \|q\| (1/m) of the modes of a grid, shape (nx, ny) as numpy.fft.fft2 orders them."""
    q_x, q_y = (2 * np.pi * np.fft.fftfreq(n, length / n) for n, length in zip(shape, size, strict=True))
    return np.hypot(q_x[:, None], q_y[None, :])


@dataclass(frozen=True)
class SelfAffine:
    """A self-affine Gaussian roughness, isotropic; SI units.

    Raises:
        ValueError: h_rms or the wavelength is not positive, or the Hurst exponent is not above 0 and at most 1.
    """

    h_rms: float = 3.1e-6
    """Root mean square height (m) of an unlimited surface."""
    hurst: float = 0.75
    wavelength: float = 100e-6
    """lambda_0 (m), where the power law ends; the largest wavelength if there is no plateau."""
    plateau: bool = True
    """Whether wavelengths above lambda_0 are there, with the spectrum of lambda_0."""

    def __post_init__(self) -> None:
        if not (self.h_rms > 0 and self.wavelength > 0):
            raise ValueError(f"h_rms and wavelength must be positive, not {self.h_rms:g} and {self.wavelength:g} m")
        if not 0 < self.hurst <= 1:
            raise ValueError(f"the Hurst exponent must be above 0 and at most 1, not {self.hurst:g}")

    @property
    def q_0(self) -> float:
        """Wavevector (1/m) of lambda_0."""
        return 2 * np.pi / self.wavelength

    def psd(self, q: ArrayLike) -> Array:
        """Return C (m^4) at wavevectors ``q`` (1/m), Eq. 8 with the plateau's value below q_0; zero at q = 0."""
        ratio = np.asarray(q, dtype=float) / self.q_0
        # A mode at q_0 itself belongs to the power law, whatever the rounding of its wavevector.
        above = ratio > 1 - 1e-9
        below = np.where(ratio > 0, float(self.plateau), 0.0)
        shape = np.where(above, np.where(above, ratio, 1.0) ** (-2 - 2 * self.hurst), below)
        return np.asarray(prefactor(self.hurst, self.plateau) * (self.h_rms / self.q_0) ** 2 * shape)

    def modes(self, shape: tuple[int, int], size: tuple[float, float]) -> Array:
        """Return the expected C (m^4) of each mode of a periodic map, scaled so that its mean square is h_rms^2.

        On a map many lambda_0 wide with pixels far below lambda_0 the factor is near 1. It makes up for the
        difference of a sum over modes from the integral over q: on one no wider than lambda_0 it is large.

        Args:
            shape: pixels along x and y.
            size: lengths (m) along x and y.

        Raises:
            ValueError: no mode of the map has a wavelength of the surface.
        """
        expected = self.psd(wavevectors(shape, size))
        mean_square = expected.sum() / (size[0] * size[1])
        if mean_square == 0:
            raise ValueError(
                f"pixels of {size[0] / shape[0]:g} x {size[1] / shape[1]:g} m are too large for wavelengths "
                f"below {self.wavelength:g} m"
            )
        return np.asarray(expected * (self.h_rms**2 / mean_square))

    def surface(self, shape: tuple[int, int], size: tuple[float, float], seed: int) -> HeightMap:
        """Return a periodic random surface whose expected mean square is h_rms^2; each realisation's differs.

        White noise is filtered in Fourier space (Jacobs et al. 2017, doi:10.1088/2051-672X/aa51f8), which makes
        the heights Gaussian and the modes independent.

        Args:
            shape: pixels along x and y.
            size: lengths (m) along x and y.
            seed: of the random numbers; the same seed gives the same surface.
        """
        noise = np.fft.fft2(np.random.default_rng(seed).standard_normal(shape))
        # The noise has C = size / shape^2 |FFT|^2 = area / pixels on average.
        gain = np.sqrt(self.modes(shape, size) * shape[0] * shape[1] / (size[0] * size[1]))
        return HeightMap(np.fft.ifft2(noise * gain).real, size)
