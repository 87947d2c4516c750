r"""Power spectra: of self-affine Gaussian surfaces, and of a height map, with Hurst exponent and roll-off from it.

The two-dimensional spectrum of Forsbach et al. 2023, Eq. 8 (doi:10.3389/fmech.2022.1074393), is

.. math:: C(q) = c \left( \frac{h_{rms}}{q_0} \right)^2 \left( \frac{q}{q_0} \right)^{-2-2H},
          \quad q \ge q_0 = 2\pi / \lambda_0

With :math:`h_{rms}^2 = \frac{1}{2\pi} \int q C(q) dq` the prefactor decides what is below q_0: the printed
:math:`c = 4\pi H/(1+H)` needs the plateau :math:`C(q_0)` there, without one it is :math:`c = 4\pi H`. From q_0 up
the printed one holds 1/(1+H) of the variance, 57 % at H = 0.75: read without a plateau, h_rms is not the rms.

With a = the pixel's and A = the map's area, the two-dimensional spectrum of the heights h times a window w is

.. math::
    C(\mathbf q) = \frac{a^2}{A \langle w^2 \rangle} \Big| \sum_k w_k h_k e^{-i \mathbf q \cdot \mathbf x_k} \Big|^2,
    \quad h_{rms}^2 = \frac{1}{A} \sum_{\mathbf q \ne 0} C = \frac{1}{2\pi} \int q C(q) dq

(Jacobs et al. 2017, doi:10.1088/2051-672X/aa51f8). A map cut out of a larger surface jumps where its ends meet, and the
jump's spectrum falls only as q^-2 along the axes: Hann's window takes it away.

C of one mode scatters about its expectation like an exponential variable, so C_0, H and q_0 of
C_0 min(1, (q / q_0)^(-2-2H)) are fitted by likelihood (Whittle 1953, doi:10.1007/BF02590998): least is

.. math:: \sum_{\mathbf q} \ln \hat C(\mathbf q) + C(\mathbf q) / \hat C(\mathbf q)
"""

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize_scalar

from variational.roughness.topography import HeightMap, wavevectors

Array = NDArray[np.float64]
_Window = Literal["none", "hann"]
HURST = (0.01, 2.0)
"""Range in which the Hurst exponent is searched; above 1 a surface is not self-affine, which the fitted value shows."""
_END = 1e-3  # distance of an exponent from an end of that range at which it is the end's
_SIGNIFICANT = 2.0  # gain in log-likelihood, two standard deviations, that tells a roll-off from none


def prefactor(hurst: float, plateau: bool) -> float:
    """Return Eq. 8's c: 4 pi H / (1 + H) for a spectrum that is constant below q_0, 4 pi H for one that is zero."""
    return 4 * np.pi * hurst / (1 + hurst if plateau else 1)


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
    shortest: float = 0.0
    """Smallest wavelength (m), 0 for none. The prefactor is that of an unlimited surface; :meth:`modes` scales."""

    def __post_init__(self) -> None:
        if not (self.h_rms > 0 and self.wavelength > 0):
            raise ValueError(f"h_rms and wavelength must be positive, not {self.h_rms:g} and {self.wavelength:g} m")
        if not 0 < self.hurst <= 1:
            raise ValueError(f"the Hurst exponent must be above 0 and at most 1, not {self.hurst:g}")
        if not 0 <= self.shortest < self.wavelength:
            raise ValueError(
                f"the shortest wavelength must be below {self.wavelength:g} m and at least 0, not {self.shortest:g} m"
            )

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
        shape = np.where(ratio * self.shortest < self.wavelength * (1 + 1e-9), shape, 0.0)
        return np.asarray(prefactor(self.hurst, self.plateau) * (self.h_rms / self.q_0) ** 2 * shape)

    def modes(self, shape: tuple[int, int], size: tuple[float, float]) -> Array:
        """Return the expected C (m^4) of each mode of a periodic map, scaled so that its mean square is h_rms^2.

        On a map many lambda_0 wide with pixels far below lambda_0 the factor is near 1. It makes up for the
        difference of a sum over modes from the integral over q: on one no wider than lambda_0 it is large.

        Args:
            shape: pixels along x and y.
            size: lengths (m) along x and y.

        Raises:
            ValueError: no mode of the map has a wavelength of the surface, or its pixels do not resolve the shortest.
        """
        pixel = max(size[0] / shape[0], size[1] / shape[1])
        if 0 < self.shortest < 2 * pixel * (1 - 1e-9):
            raise ValueError(
                f"pixels of {pixel:g} m do not resolve the shortest wavelength of {self.shortest:g} m; they must be "
                f"{self.shortest / 2:g} m or less"
            )
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


class Radial(NamedTuple):
    """A spectrum averaged over directions, one value a ring."""

    q: Array
    """Mean wavevector (1/m) of the modes in each ring."""
    psd: Array
    """Mean C (m^4)."""
    modes: NDArray[np.int_]
    """Number of modes; a mean scatters by 1 / sqrt(modes / 2), for q and -q are one."""


@dataclass(frozen=True)
class Fit:
    """Plateau and power law through a spectrum."""

    level: float
    """C (m^4) of the plateau."""
    hurst: float
    """Exponent of greatest likelihood in :data:`HURST`; at an end of that range, see :attr:`hurst_found`, it is none of
    the surface."""
    wavelength: float
    """lambda_0 (m) where the plateau ends; without a roll-off the largest wavelength of the fit, a lower bound."""
    resolved: bool
    """Whether a roll-off is told from a power law throughout, by two standard deviations."""
    q_range: tuple[float, float]
    """Wavevectors (1/m) of the fit."""

    @property
    def hurst_found(self) -> bool:
        """Whether the likelihood has its maximum inside of the range searched."""
        return HURST[0] + _END < self.hurst < HURST[1] - _END

    @property
    def q_0(self) -> float:
        """Wavevector (1/m) where the plateau ends."""
        return 2 * np.pi / self.wavelength

    def psd(self, q: ArrayLike) -> Array:
        """Return the fitted C (m^4) at wavevectors ``q`` (1/m)."""
        return np.asarray(self.level * np.maximum(np.asarray(q, dtype=float) / self.q_0, 1.0) ** (-2 - 2 * self.hurst))

    def h_rms(self, plateau: bool) -> float:
        """Return the rms height (m) of an unlimited surface of this spectrum, Eq. 8 with or without the plateau."""
        return self.q_0 * float(np.sqrt(self.level / prefactor(self.hurst, plateau)))


@dataclass(frozen=True, eq=False)
class PowerSpectrum:
    """The two-dimensional spectrum of a map, or the mean of several."""

    q: Array
    r"""\|q\| (1/m) of each mode, shape (nx, ny) in numpy.fft.fft2's order."""
    psd: Array
    """C (m^4) of each mode, zero at q = 0."""
    size: tuple[float, float]
    """Lengths (m) of the map."""
    window: _Window

    @property
    def h_rms(self) -> float:
        """Root mean square height (m): exactly the map's without a window, an estimate of it with one."""
        return float(np.sqrt(self.psd.sum() / (self.size[0] * self.size[1])))

    @property
    def q_range(self) -> tuple[float, float]:
        """Wavevectors (1/m) that are in the fit unless others are asked for.

        From the longest mode of the map's shorter side to half the highest wavevector along its coarser pixel. With
        a window from twice that mode: below, the window mixes modes, and what detrending took is missing.
        """
        finest = min(n / length for n, length in zip(self.q.shape, self.size, strict=True))
        return (1 if self.window == "none" else 2) * 2 * np.pi / min(self.size), np.pi * finest / 2

    def radial(self, rings: int = 10) -> Radial:
        """Return the average over rings of equal width in ln q, ``rings`` to a decade; empty ones are left out."""
        q, psd = self.q.ravel()[1:], self.psd.ravel()[1:]
        # Rings are counted from half a ring below the lowest mode, which is then inside one and not on its edge.
        ring = np.floor(rings * np.log10(q / q.min()) + 0.5).astype(int)
        modes = np.bincount(ring)
        kept = modes > 0
        mean_q, mean_psd = (np.bincount(ring, weights=v)[kept] / modes[kept] for v in (q, psd))
        return Radial(mean_q, mean_psd, modes[kept])

    def fit(self, q_range: tuple[float, float] | None = None) -> Fit:
        """Return plateau and power law of greatest likelihood.

        Args:
            q_range: least and greatest wavevector (1/m) of the modes that count.

        Raises:
            ValueError: that range is narrower than a factor of 3, the spectrum is zero there, or it rolls off at
                shorter wavelengths than that range can show.
        """
        low, high = self.q_range if q_range is None else q_range
        if not 0 < 3 * low <= high:
            raise ValueError(f"a fit needs wavevectors over a factor of 3 or more, not {low:g} to {high:g} 1/m")
        inside = (self.q >= low * (1 - 1e-9)) & (self.q <= high)
        # Modes of the same |q| share an expectation: one term for all of them.
        ratio, index, modes = np.unique(np.round(self.q[inside] / low, 9), return_inverse=True, return_counts=True)
        psd = np.bincount(index, weights=self.psd[inside]) / modes
        if not psd.all():
            raise ValueError("the spectrum is zero; there is no roughness to describe")
        ln_q, weight = np.log(ratio), modes / modes.sum()

        def shape(ln_q_0: float, hurst: float) -> Array:
            return np.asarray(-2 * (1 + hurst) * np.maximum(ln_q - ln_q_0, 0.0))

        def surprise(ln_q_0: float, hurst: float) -> float:
            """Return minus the log-likelihood a mode, the level being the best one."""
            model = shape(ln_q_0, hurst)
            return float(weight @ model + np.log(weight @ (psd * np.exp(-model))))

        def best(ln_q_0: float) -> tuple[float, float]:
            found = minimize_scalar(lambda hurst: surprise(ln_q_0, hurst), bounds=HURST, method="bounded")
            return float(found.fun), float(found.x)

        # The likelihood has a kink wherever q_0 passes a mode: a scan finds the valley, the search its bottom.
        scan = np.linspace(0.0, np.log(high / low / 2), 40)
        lowest = int(np.argmin([best(v)[0] for v in scan]))
        ends = scan[max(lowest - 1, 0)], scan[min(lowest + 1, len(scan) - 1)]
        ln_q_0 = float(minimize_scalar(lambda v: best(v)[0], bounds=ends, method="bounded").x)
        # q and -q are one mode.
        resolved = (best(0.0)[0] - best(ln_q_0)[0]) * modes.sum() / 2 > _SIGNIFICANT
        if resolved and lowest == len(scan) - 1:
            raise ValueError(
                f"the spectrum rolls off at a wavelength of {4 * np.pi / high:.3g} m or less, which pixels of "
                f"{np.pi / high / 2:.3g} m do not resolve; measure with smaller pixels"
            )
        if not resolved:
            ln_q_0 = 0.0
        _, hurst = best(ln_q_0)
        level = float(weight @ (psd * np.exp(-shape(ln_q_0, hurst))))
        return Fit(level, hurst, 2 * np.pi / (low * float(np.exp(ln_q_0))), bool(resolved), (low, high))


def power_spectrum(*maps: HeightMap, window: _Window = "none") -> PowerSpectrum:
    """Return the spectrum of a map, or the mean one of maps of the same shape and size, each about its mean.

    Args:
        maps: to be detrended before if they are cut out of a larger surface.
        window: ``"none"`` for a periodic map, ``"hann"`` for any other.

    Raises:
        ValueError: no maps, or maps of different shapes or sizes.
    """
    if not maps or len({(m.heights.shape, m.size) for m in maps}) > 1:
        raise ValueError("a spectrum needs one map, or several of the same shape and size")
    shape, size = maps[0].heights.shape, maps[0].size
    w = np.ones(shape)
    if window == "hann":
        w = np.multiply.outer(*(np.sin(np.pi * np.arange(n) / n) ** 2 for n in shape))
    psd = np.zeros(shape)
    for m in maps:
        h = (m.heights - m.heights.mean()) * w
        psd += np.abs(np.fft.fft2(h)) ** 2 * size[0] * size[1] / (h.size**2 * np.mean(w**2) * len(maps))
    psd[0, 0] = 0.0
    return PowerSpectrum(wavevectors(shape, size), psd, size, window)


def roughness_table(*spots: HeightMap) -> dict[str, float]:
    """Return h_rms and wavelength (m) of a scene's ``[roughness]`` table, and of BearingArea, from measured spots.

    As in the paper: each spot loses its curvature, and h_rms is the root mean square over all of them; the roughness
    that goes with the curvature is not put back. The wavelength is lambda_0 of the mean spectrum if it is seen to
    roll off. If not, the spots are too small to resolve it, and it is their shorter side (*assumption*; the paper's
    100 um are the length of its spots).

    Args:
        spots: height maps of the same shape and size, 100 um x 100 um in the paper.

    Raises:
        ValueError: flat maps, or pixels too large for the roughness.
    """
    flat = [spot.detrended("curvature") for spot in spots]
    spectrum = power_spectrum(*flat, window="hann")
    h_rms = float(np.sqrt(np.mean([m.h_rms**2 for m in flat])))
    if h_rms == 0:
        raise ValueError("without its curvature the map is flat; there is no roughness to describe")
    fit = spectrum.fit()
    return {"h_rms": h_rms, "wavelength": fit.wavelength if fit.resolved else min(spectrum.size)}
