r"""Persson's contact theory as a closure: contact area, mean separation and distribution of gaps by integrals.

A self-affine spectrum has waves from q_0 to q_1 without roll-off. With h(q)^2 the mean square height of the waves
beyond q and s(q, q')^2 the mean square slope of those between q and q', the part of the area that seems in contact
where waves up to q are seen is (Persson 2001, doi:10.1063/1.1388626)

.. math:: A(q) = \operatorname{erf} \frac{\sqrt2\, p_c}{E^* s(q_0, q)}.

There the pressure is :math:`p(q) = p_c / A(q)`, and the mean separation (Yang and Persson 2008,
doi:10.1088/0953-8984/20/21/215214), with :math:`w(q, q') = \sqrt2 / s(q, q')` and C the spectrum,

.. math:: \bar u(q) = \sqrt\pi \int_q^{q_1} q'^2 C(q') w \int_{w p(q) / E^*}^\infty
          \frac1x \left[ \gamma + 3 (1 - \gamma) \operatorname{erf}^2 x \right] e^{-x^2} dx\, dq'.

The gaps of the area that leaves the contact from one q to the next are distributed about a separation u_1 as the
heights of the waves beyond (Almqvist et al. 2011, doi:10.1016/j.jmps.2011.08.004),

.. math:: P(g) = \int \frac{-A'(q)}{\sqrt{2\pi} h(q)} \left[ e^{-(g - u_1)^2 / 2 h^2}
          + e^{-(g + u_1)^2 / 2 h^2} \right] dq, \qquad u_1 = \bar u + \bar u' A / A'.

The rest of the area, A(q_1), has a gap of zero. Almqvist et al. fitted gamma = 0.45 to exact solutions.

**Mean separation.** The folded distributions have a larger mean than u_1. With 16 shortest waves to the largest and
H = 0.75 the mean of P(g) is 5 % above the separation at q_0 where 4 % of the area touch, 22 % above it where a fifth
does, and more than twice it at four fifths. Exact contacts of the same spectrum confirm the separation at q_0 to 10 %
where 0.5 to 50 % of the area touch. So that is the closure's mean separation. Its attraction is that of P(g).
"""

from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
import scipy  # its parts are imported where they are used first: to read a scene needs none
from numpy.typing import NDArray

from variational.roughness.gaps import EDGES, FULL, PRESSURES, GapTable
from variational.roughness.tabulated import TabulatedClosure

Array = NDArray[np.float64]
_GAMMA = 0.45
_LEAST_SLOPE = 1e-5  # rms slope of the first waves over q_0 h_rms, far below the least pressure
_MAGNIFICATIONS, _NODES = 300, 48
_SMALLEST, _LARGEST = 1e-9, 10.0  # arguments between which the inner integral is tabulated


@dataclass(frozen=True)
class Persson(TabulatedClosure):
    """A rough ridge by Persson's contact theory; SI units."""

    def tables(self) -> list[tuple[float, GapTable]]:
        """Return the table of the spectrum.

        Raises:
            ValueError: an exponent of 1 or more, or a shortest wave that is no shorter than the largest; in one
                sentence.
        """
        if not self.hurst < 1:
            raise ValueError(f"hurst is {self.hurst:g}; a self-affine surface has an exponent below 1")
        ratio = self.wavelength / self.shortest_wave
        if not ratio > 1.5:
            raise ValueError(
                f"shortest_wave is {self.shortest_wave:g} m; it must be below two thirds of the largest wavelength, "
                f"{self.wavelength / 1.5:.4g} m"
            )
        return [(1.0, table_of(self.hurst, ratio))]


@dataclass(frozen=True, eq=False)
class TheoryTable(GapTable):
    """Gaps by the theory, whose mean separation is not the mean of its distribution."""

    separation: Array
    """Mean separation at q_0, shape (1, pressures)."""

    def mean_gap(self) -> Array:
        """Return the mean separation, shape (1, pressures)."""
        return self.separation


@dataclass(frozen=True)
class Spectrum:
    """A self-affine spectrum in units of q_0 and h_rms."""

    hurst: float
    ratio: float
    """q_1 / q_0."""
    level: float = field(init=False)
    """C at q_0: the mean square height is 2 pi times the integral of q C."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "level", self.hurst / np.pi / (1 - self.ratio ** (-2 * self.hurst)))

    def height(self, q: Array) -> Array:
        """Return the rms height of the waves beyond q."""
        end = self.ratio ** (-2 * self.hurst)
        return np.sqrt(np.maximum(q ** (-2 * self.hurst) - end, 0.0) / (1 - end))

    def slope_squared(self, q: Array) -> Array:
        """Return the mean square slope of the waves up to q."""
        n = 2 - 2 * self.hurst
        return np.asarray(2 * np.pi * self.level * np.expm1(n * np.log(q)) / n)

    def magnifications(self) -> Array:
        """Return wavevectors from 1 to the ratio, the slopes up to which are evenly spread in the logarithm."""
        n, most = 2 - 2 * self.hurst, float(self.slope_squared(np.array(self.ratio)))
        slopes = np.geomspace(_LEAST_SLOPE**2, most, _MAGNIFICATIONS)
        q = np.exp(np.log1p(slopes * n / (2 * np.pi * self.level)) / n)
        return np.concatenate([[1.0], q[:-1], [self.ratio]])


def contact_area(pressure: Array, spectrum: Spectrum, q: Array) -> Array:
    """Return the part of the area that seems in contact at wavevectors q, shape (pressures, wavevectors)."""
    slope = np.sqrt(spectrum.slope_squared(q))
    with np.errstate(divide="ignore"):
        return np.asarray(scipy.special.erf(np.sqrt(2) * pressure[:, None] / slope))


@lru_cache(maxsize=1)
def _inner() -> tuple[Array, Array]:
    """Return the logarithm of x and the integral from x on of 3 erf^2 exp(-x^2) / x."""
    ln_x = np.linspace(np.log(_SMALLEST), np.log(_LARGEST), 6001)
    x = np.exp(ln_x)
    up = scipy.integrate.cumulative_simpson(3 * scipy.special.erf(x) ** 2 * np.exp(-(x**2)), x=ln_x, initial=0.0)
    return ln_x, up[-1] - up


def separation(pressure: Array, spectrum: Spectrum, q: Array) -> Array:
    """Return the mean separation of the area that seems in contact at wavevectors q, shape (pressures, wavevectors).

    Args:
        pressure: mean contact pressures over E* q_0 h_rms.
        spectrum: of the surface.
        q: wavevectors over q_0.
    """
    p = pressure[:, None] / contact_area(pressure, spectrum, q)
    # The slope of waves between q and q' begins as the root of ln q' - ln q, which is the variable.
    t, weight = np.polynomial.legendre.leggauss(_NODES)
    end = np.sqrt(np.log(spectrum.ratio / q))[:, None]
    root, weight = end * (1 + t) / 2, end * weight / 2
    there = q[:, None] * np.exp(root**2)
    between = np.maximum(spectrum.slope_squared(there) - spectrum.slope_squared(q)[:, None], 1e-300)
    w = np.sqrt(2 / between)
    outer = spectrum.level * there ** (1 - 2 * spectrum.hurst) * w * 2 * root * weight
    x = np.clip(w * p[:, :, None], _SMALLEST, None)
    inner = _GAMMA * scipy.special.exp1(x**2) / 2 + (1 - _GAMMA) * np.interp(np.log(x), *_inner(), right=0.0)
    return np.asarray(np.sqrt(np.pi) * (outer * inner).sum(axis=-1))


@lru_cache(maxsize=64)
def table_of(hurst: float, ratio: float) -> TheoryTable:
    """Return the table of gaps of a spectrum at the pressures of every table, as far as gaps are left.

    Args:
        hurst: Hurst exponent.
        ratio: of the longest wave to the shortest.
    """
    spectrum = Spectrum(hurst, ratio)
    area = contact_area(PRESSURES, spectrum, np.array([ratio]))[:, 0]
    return gap_table(spectrum, PRESSURES[area < FULL])


def gap_table(spectrum: Spectrum, pressure: Array) -> TheoryTable:
    """Return the table of gaps at mean contact pressures over E* q_0 h_rms, in equal steps of the logarithm."""
    q = spectrum.magnifications()
    area, u = contact_area(pressure, spectrum, q), separation(pressure, spectrum, q)
    lost = -np.diff(area)
    middle, change = (area[:, 1:] + area[:, :-1]) / 2, np.diff(u)
    ratio_of = np.divide(change * middle, lost, out=np.zeros_like(lost), where=lost > 0)
    u_1 = np.maximum((u[:, 1:] + u[:, :-1]) / 2 - ratio_of, 0.0)
    h = spectrum.height(np.sqrt(q[1:] * q[:-1]))
    moments = _moments(u_1, h) * lost[:, :, None, None]
    weight, first, second = np.moveaxis(moments.sum(axis=1), -2, 0)
    some = np.where(weight > 0, weight, 1.0)
    mean = np.maximum(first, 0.0) / some
    deviation = np.sqrt(np.maximum(second / some - mean**2, 0.0))
    columns = (area[:, -1], np.maximum(weight, 0.0), mean, np.minimum(deviation, mean), u[:, 0])
    return TheoryTable(pressure, *(each[None] for each in columns))


def _moments(u: Array, h: Array) -> Array:
    """Return the moments 0 to 2 of normal distributions folded at zero, by bin of gaps; shape (*u.shape, 3, bins).

    Args:
        u: means, shape (pressures, parts).
        h: standard deviations, shape (parts,).
    """
    s = h[:, None]
    found = np.zeros((*u.shape, 3, len(EDGES)))
    for mean in (u[:, :, None], -u[:, :, None]):
        z = (EDGES - mean) / s
        below, density = scipy.special.ndtr(z), np.exp(-(z**2) / 2) / np.sqrt(2 * np.pi)
        at = (below, mean * below - s * density, (mean**2 + s**2) * below - s * (EDGES + mean) * density)
        ends = (np.ones_like(mean), mean, mean**2 + s**2)
        for k, (values, end) in enumerate(zip(at, ends, strict=True)):
            found[:, :, k] += np.diff(values, axis=-1, append=end)
    return found
