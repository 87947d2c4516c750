r"""Bearing area model of a rough ridge (Forsbach et al. 2023, Eqs. 9 to 15; Ciavarella and Papangelo 2020).

The repulsion is Persson's for intermediate separations, the attraction a constant stress over the area in
which the surfaces are closer than h_0:

.. math:: p_c = \beta E^* q_0 h_{rms} e^{-\bar u / (\gamma h_{rms})}, \qquad
          p_{ext} = p_c - \sigma_0 A_{att} / A_0

The equivalent air gap :math:`d_{eq}(\bar u)` follows from equating attractions (Eq. 13). Keyed on the mean
contact pressure p_c it is closed form, single valued and free of the voltage.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import scipy  # its parts are imported where they are used first: to read a scene needs none
from numpy.typing import ArrayLike, NDArray

from variational.coefficients import parameter
from variational.roughness.closure import PAST_THE_FOLD, STICKING, AirGap, RoughSurface
from variational.roughness.gaps import Slopes, Statistics, breaking_gaps

Array = NDArray[np.float64]
_EPS_0 = 8.854e-12  # F/m, Table 3
_SEPARATION = 1e-15  # error of a separation that is a root, over h_rms
_REACH = 1.5  # of the attraction over the repulsion's decay length, up to which a voltage of sticking is computed


@dataclass(frozen=True)
class BearingArea(RoughSurface):
    """A self-affine Gaussian roughness on stratum corneum (Table 3); h_0 is the range of the attraction; SI units."""

    gamma: float = parameter(1e-2, 10.0, default=0.5)
    """Decay length of the repulsion, relative to h_rms; Persson's theory gives 0.4 to 0.5."""
    beta: float = parameter(1e-2, 100.0, default=1.0)
    """Prefactor of the repulsion: 1 in Eq. 9, 3/4 in Eq. 15. *Assumption*: Eq. 9 is meant."""
    p_floor: float = parameter(1e-3, 1e9, "Pa", default=1e3)
    """Mean contact pressure (Pa) below which the air gap is held constant (*assumption*): a ridge that is let go does
    not follow d_eq to infinity. It must be below the pressure at zero separation."""
    shared: ClassVar[tuple[str, ...]] = ("h_0", "h_rms", "wavelength", "young", "p_floor")
    end: ClassVar[str] = "the pressure at zero separation"

    @property
    def full_pressure(self) -> float:
        """Contact pressure (Pa) at zero mean separation, where the repulsion law ends."""
        return self.beta * 4 / 3 * self.young * 2 * np.pi / self.wavelength * self.h_rms

    @property
    def pressures(self) -> tuple[float, float]:
        """Range of mean contact pressures (Pa) in which the air gap follows the pressure."""
        return self.p_floor, self.full_pressure

    def separation(self, p_c: ArrayLike) -> Array:
        """Return the mean separation u_bar (m) at contact pressure ``p_c`` (Pa), inverse of Eq. 9's first term."""
        return np.asarray(-self.gamma * self.h_rms * np.log(np.asarray(p_c, dtype=float) / self.full_pressure))

    def contact_pressure(self, u_bar: ArrayLike) -> Array:
        """Return the repulsion (Pa) at mean separation ``u_bar`` (m), first term of Eq. 9."""
        return np.asarray(self.full_pressure * np.exp(-np.asarray(u_bar, dtype=float) / (self.gamma * self.h_rms)))

    def _twice_area(self, u_bar: ArrayLike) -> tuple[Array, Array]:
        """Return 2 A_att / A_0 (Eq. 11) and its derivative with respect to u_bar (1/m)."""
        u_bar = np.asarray(u_bar, dtype=float)
        width = np.sqrt(2) * self.h_rms
        near, far = (u_bar - self.h_0) / width, u_bar / width
        slope = -2 / np.sqrt(np.pi) / width * (np.exp(-(near**2)) - np.exp(-(far**2)))
        return np.asarray(scipy.special.erfc(near) - scipy.special.erfc(far)), np.asarray(slope)

    def air_gap(self, u_bar: ArrayLike) -> Array:
        """Return d_eq (m) at mean separation ``u_bar`` (m), Eq. 13."""
        area, _ = self._twice_area(u_bar)
        return np.asarray(self.h_0 * (np.sqrt(2 / area) - 1))

    def contact_area(self, u_bar: ArrayLike) -> Array:
        r"""Return the real area of contact over the nominal one at mean separation ``u_bar`` (m).

        It is the bearing area, the part of the surface that is higher than the separation: second term of Eq. 11,

        .. math:: A_c / A_0 = \tfrac12 \operatorname{erfc}(\bar u / \sqrt2 h_{rms}).
        """
        return np.asarray(scipy.special.erfc(np.asarray(u_bar, dtype=float) / (np.sqrt(2) * self.h_rms)) / 2)

    def attraction(self, u_bar: ArrayLike, voltage: float) -> Array:
        """Return the attraction (Pa) at mean separation ``u_bar`` (m) and ``voltage`` (V): sigma_0 A_att / A_0."""
        area, _ = self._twice_area(u_bar)
        return np.asarray(_EPS_0 * voltage**2 / (4 * self.h_0**2) * area)

    def external_pressure(self, u_bar: ArrayLike, voltage: float) -> Array:
        """Return p_ext (Pa) at mean separation ``u_bar`` (m) and ``voltage`` (V), Eq. 9."""
        return np.asarray(self.contact_pressure(u_bar) - self.attraction(u_bar, voltage))

    def __call__(self, p_c: ArrayLike) -> AirGap:
        """Return the air gap at mean contact pressures (Pa), held below p_floor and above full_pressure."""
        p_c = np.asarray(p_c, dtype=float)
        held = np.clip(p_c, self.p_floor, self.full_pressure)
        u_bar = self.separation(held)
        area, slope = self._twice_area(u_bar)
        d_eq = self.h_0 * (np.sqrt(2 / area) - 1)
        gradient = -self.h_0 / 2 * np.sqrt(2 / area) / area * slope * (-self.gamma * self.h_rms / held)
        return AirGap(d_eq, np.where(held == p_c, gradient, 0.0))

    def statistics(self, p_c: ArrayLike, voltage: float = 0.0) -> Statistics:
        """Return the gaps at mean contact pressures (Pa), and their breakdown at a voltage (V).

        Heights are Gaussian and undeformed: the contact is the bearing area, where they are above the separation.

        Raises:
            ValueError: a pressure outside of p_floor to full_pressure; in one sentence.
        """
        p_c = self.inside(p_c)
        u_bar, (d_eq, slope) = self.separation(p_c), self(p_c)
        assert slope is not None
        per_pressure = np.asarray(-self.gamma * self.h_rms / p_c)
        narrows = -np.exp(-((u_bar / self.h_rms) ** 2) / 2) / (np.sqrt(2 * np.pi) * self.h_rms)
        square = (self.h_0 + d_eq) ** -2
        slopes = Slopes(narrows * per_pressure, per_pressure, -2 * square / (self.h_0 + d_eq) * slope, slope)
        broken = np.zeros_like(p_c)
        for low, high in breaking_gaps(voltage, self.h_0):
            broken += self.contact_area(u_bar - high) - self.contact_area(u_bar - low)
        return Statistics(self.contact_area(u_bar), u_bar, square, d_eq, broken, slopes)

    def state(self, p_c: float, voltage: float) -> str:
        """Return where a ridge is on the closure; empty where the air gap closes as the pressure rises.

        At one of the ends, past the pull-off fold, or nearer than half of the insulators' effective thickness. There
        A_att of Eq. 11 falls, and d_eq rises with pressure.
        """
        if p_c <= 0:
            return ""
        if p_c < self.p_floor:
            return "below p_floor"
        if p_c > self.full_pressure:
            return "beyond zero separation"
        fold = self.pull_off_fold(voltage)
        if fold is not None and p_c < self.contact_pressure(fold):
            return PAST_THE_FOLD
        widens = self.separation(p_c) < self.h_0 / 2
        return "where d_eq rises with pressure, since the insulators are thick for this roughness" if widens else ""

    def pull_off_fold(self, voltage: float) -> float | None:
        """Return u_bar (m) of the least p_ext on the branch that starts at u_bar = 0, None if there is none."""
        if voltage == 0:
            return None
        # p_ext falls up to h_0 / 2, where the attraction is largest. From there on the logarithm of the repulsion's
        # slope over the attraction's is a convex function of u_bar, which is zero at the fold.
        first, last = self.h_0 / 2 * (1 + 1e-9), self.h_0 + (1 + 1 / self.gamma) * self.h_rms
        least = scipy.optimize.brentq(lambda u: self._steeper(u, voltage)[1], first, last)
        if self._steeper(least, voltage)[0] >= 0:
            return None
        if self._steeper(first, voltage)[0] <= 0:
            return first
        error = _SEPARATION * self.h_rms
        return float(scipy.optimize.brentq(lambda u: self._steeper(u, voltage)[0], first, least, xtol=error))

    def _steeper(self, u_bar: float, voltage: float) -> tuple[float, float]:
        """Return the logarithm of the repulsion's slope over the attraction's beyond h_0 / 2, and its slope (1/m)."""
        width, decay = np.sqrt(2) * self.h_rms, self.gamma * self.h_rms
        near, beyond = (u_bar - self.h_0) / width, (2 * u_bar - self.h_0) * self.h_0 / width**2
        pull = _EPS_0 * voltage**2 / (2 * np.sqrt(np.pi) * self.h_0**2 * width)
        part = -np.expm1(-beyond)
        return (
            float(np.log(self.full_pressure / decay / pull / part) - u_bar / decay + near**2),
            float(-1 / decay + 2 * near / width - 2 * self.h_0 / width**2 * np.exp(-beyond) / part),
        )

    def threshold(self, approximate: bool = False) -> float:
        """Return the voltage (V) of macroscopic stickiness.

        Args:
            approximate: Eq. 15's estimate instead of minimising Eq. 9.
        """
        if approximate:
            return 1.8 * self.h_rms * float(np.sqrt(self.h_0 * 4 / 3 * self.young / (_EPS_0 * self.wavelength)))
        return self._pulled_off(0.0)

    def sticking_voltage(self) -> float | None:
        """Return the voltage (V) at which the pull-off stress, minus the least p_ext, reaches :data:`.STICKING`.

        None where the reach of the attraction, h_0, is above 1.5 decay lengths gamma h_rms of the repulsion. Beyond 1.6
        of them a thicker insulator would need less voltage, by attraction of surfaces that hardly touch.
        """
        return self._pulled_off(STICKING) if self.h_0 <= _REACH * self.gamma * self.h_rms else None

    def _pulled_off(self, stress: float) -> float:
        """Return the voltage (V) at which the least p_ext is minus ``stress`` (Pa)."""
        # Its square is the least ratio of repulsion and stress to the attraction at 1 V. The ratio's logarithm is
        # convex, and where it is least both may be smaller than any number of the computer.
        with np.errstate(divide="ignore"):
            held = np.log(stress / self.full_pressure)

        def ratio(u_bar: float) -> float:
            near, far = (scipy.special.log_ndtr((end - u_bar) / self.h_rms) for end in (self.h_0, 0.0))
            pressures = np.logaddexp(-u_bar / (self.gamma * self.h_rms), held)
            return float(pressures - near - np.log1p(-np.exp(far - near)))

        end, error = self.h_0 + (1 + 1 / self.gamma) * self.h_rms, {"xatol": 1e-9 * self.h_rms}
        found = scipy.optimize.minimize_scalar(ratio, bounds=(0.0, end), method="bounded", options=error)
        constant = self.full_pressure * 2 * self.h_0**2 / _EPS_0
        return float(np.sqrt(constant * np.exp(min(found.fun, ratio(0.0)))))
