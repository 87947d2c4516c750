r"""A charged ridge as an elastic cylinder on the screen, with the microscale inside: closed forms and one scalar root.

The attraction of :mod:`~variational.attraction.electroadhesion` is :math:`\sigma = \varepsilon_0 U^2 / 2 (h_0 +
d_{eq})^2` where the gap is below d_eq, and falls beyond. It is replaced by a constant stress of the same strength and
the same work of adhesion, whose range is

.. math:: \delta = \frac1\sigma \int_0^\infty p_{el} \,dy = h_0 + 2 d_{eq}.

Under such a stress a cylinder of radius R and modulus E*, in contact from -a to a and attracted from -c to c, c = m a,
is Maugis's problem for a line (Baney and Hui 1997, J. Adhesion Sci. Technol. 11, 393; Johnson and Greenwood 2008,
doi 10.1088/0022-3727/41/15/155315). The gap at c is the range, and f is the external force per length:

.. math:: \delta = \frac{a^2}{2R} \left( m \sqrt{m^2 - 1} - \operatorname{arcosh} m \right)
          + \frac{4 \sigma a}{\pi E^*} \left( \sqrt{m^2 - 1} \operatorname{arcosh} m - m \ln m \right), \qquad
          f = \frac{\pi E^* a^2}{4 R} - 2 \sigma a \sqrt{m^2 - 1}.

The screen bears what presses and what attracts, over the length in contact, and the microscale says how far apart the
surfaces are under that pressure (Forsbach et al. 2023, Eqs. 3, 4 and 13):

.. math:: 2 a p_c = f + 2 \sigma c, \qquad d_{eq} = d_{eq}(p_c).

Without voltage this is Hertz's law. There are two ways to close the equations: a is given, and f is borne over it; or
f is given, and a follows. Both leave one equation in p_c. It can have several roots: that of the highest pressure is
the branch in contact, on which the loop over the scales contracts; others are unstable, or states of a ridge that has
not jumped on the screen yet. Where the highest root vanishes the ridge is past its pull-off fold and there is none.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from variational.attraction.insulator import VACUUM_PERMITTIVITY
from variational.roughness.closure import Closure

Array = NDArray[np.float64]
_PRESSURES = np.geomspace(10.0, 1e7, 181)  # Pa, among which roots are separated
_BEYOND = np.geomspace(1e-9, 1e6, 451)  # m - 1, likewise


class NoEquilibriumError(ValueError):
    """A ridge that cannot be in contact as asked; one sentence."""


@dataclass(frozen=True)
class RidgeState:
    """Equilibrium of one ridge; forces per out-of-plane length."""

    length: float
    """In contact, 2a (m)."""
    attracted: float
    """Length under the attraction, 2c (m)."""
    p_c: float
    """Mean contact pressure (Pa)."""
    d_eq: float
    """Equivalent air gap (m)."""
    f_contact: float
    """Contact force (N/m)."""
    f_attraction: float
    """Resultant of the attraction (N/m)."""
    others: tuple[float, ...]
    """Pressures (Pa) of further equilibria, which this branch does not lead to."""


@dataclass(frozen=True)
class Cylinder:
    """A ridge's tip; SI units."""

    radius: float
    """R (m)."""
    modulus: float
    """Plane strain modulus E* (Pa)."""
    h_0: float
    """Effective insulator thickness (m)."""
    closure: Closure
    """The microscale."""

    def under_load(self, f: float, voltage: float) -> RidgeState:
        """Return the state under an external force.

        Args:
            f: force per length (N/m), positive.
            voltage: (V).

        Raises:
            NoEquilibriumError: no branch in contact, or the attraction is beyond what a finger can bear.
        """
        return self._root(lambda sigma, d: self._from_load(f, sigma, d), f, voltage)

    def over_length(self, length: float, f: float, voltage: float) -> RidgeState:
        """Return the state in which a contact of given length bears an external force; arguments as above.

        Raises:
            NoEquilibriumError: no branch in contact.
        """
        half = length / 2
        return self._root(lambda sigma, d: (half, self._from_half_width(half, sigma, d)), f, voltage)

    # -- the gap at c ----------------------------------------------------------------------------------
    def _shapes(self, beyond: Any) -> tuple[Array, Array, Array]:
        """Return the root of m^2 - 1 and the factors of a^2 / 2R and 4 sigma a / pi E*, for m - 1 given."""
        m, root = 1 + beyond, np.sqrt(beyond * (2 + beyond))
        angle = np.arcsinh(root)
        return root, m * root - angle, root * angle - m * np.log1p(beyond)

    def _opening(self, a: Any, beyond: Any, sigma: float) -> Array:
        """Return the gap at c (m)."""
        _, round_part, pulled_part = self._shapes(beyond)
        return np.asarray(a**2 / (2 * self.radius) * round_part + 4 * sigma * a / (np.pi * self.modulus) * pulled_part)

    def _from_half_width(self, a: float, sigma: float, d_eq: float) -> float:
        """Return m - 1 of a contact of half-width ``a`` (m); the gap at c grows with c."""
        reach = self.h_0 + 2 * d_eq
        if float(self._opening(a, _BEYOND[-1], sigma)) < reach:
            raise NoEquilibriumError(
                f"a contact of {2 * a:.3g} m is too short for an attraction that reaches {reach:.3g} m; "
                "try a longer one"
            )
        return float(brentq(lambda b: float(self._opening(a, b, sigma)) - reach, 0.0, _BEYOND[-1], xtol=1e-15))

    def _from_load(self, f: float, sigma: float, d_eq: float) -> tuple[float, float]:
        """Return a (m) and m - 1 under a force (N/m), of the widest contact that bears it."""
        reach = self.h_0 + 2 * d_eq

        def half_width(beyond: Any) -> Array:
            # the positive root of the gap's equation, quadratic in a
            _, round_part, pulled_part = self._shapes(beyond)
            b = 4 * sigma / (np.pi * self.modulus) * pulled_part
            return np.asarray(2 * reach / (b + np.sqrt(b**2 + 2 * round_part / self.radius * reach)))

        def force(beyond: Any) -> Array:
            a = half_width(beyond)
            elastic = np.pi * self.modulus * a**2 / (4 * self.radius)
            return np.asarray(elastic - 2 * sigma * a * self._shapes(beyond)[0])

        borne = force(_BEYOND)
        brackets = np.flatnonzero((borne[:-1] >= f) & (borne[1:] < f))
        if not brackets.size:
            raise NoEquilibriumError(
                f"no contact bears {f:g} N/m under an attraction of {sigma:.3g} Pa; try a smaller voltage "
                "or another force"
            )
        k = int(brackets[0])
        beyond = float(brentq(lambda b: float(force(b)) - f, _BEYOND[k], _BEYOND[k + 1], xtol=1e-16))
        return float(half_width(beyond)), beyond

    # -- the microscale --------------------------------------------------------------------------------
    def _root(self, shape: Callable[[float, float], tuple[float, float]], f: float, voltage: float) -> RidgeState:
        """Return the branch in contact; ``shape`` gives a (m) and m - 1 at a strength (Pa) and an air gap (m)."""
        if not f > 0:
            raise NoEquilibriumError(f"the force on a ridge is {f:g} N/m; it must be greater than 0")

        def at(p_c: float) -> tuple[float, float, float, float]:
            d_eq = float(self.closure(p_c).d_eq)
            sigma = VACUUM_PERMITTIVITY * voltage**2 / 2 / (self.h_0 + d_eq) ** 2
            return *shape(sigma, d_eq), sigma, d_eq

        def excess(p_c: float) -> float:
            a, beyond, sigma, _ = at(p_c)
            return 2 * a * (p_c - sigma * (1 + beyond)) - f

        values = np.array([excess(p) for p in _PRESSURES])
        found = [
            float(brentq(excess, _PRESSURES[k], _PRESSURES[k + 1], xtol=1e-9, rtol=1e-14))
            for k in np.flatnonzero(np.sign(values[:-1]) != np.sign(values[1:]))
        ]
        if not found or values[-1] <= 0:
            raise NoEquilibriumError(
                f"no contact pressure from {_PRESSURES[0]:g} to {_PRESSURES[-1]:g} Pa bears {f:g} N/m on a ridge at "
                f"{voltage:g} V; try another force or length"
            )
        p_c = found[-1]
        a, beyond, sigma, d_eq = at(p_c)
        attraction = 2 * sigma * a * (1 + beyond)
        return RidgeState(2 * a, 2 * a * (1 + beyond), p_c, d_eq, f + attraction, attraction, tuple(found[:-1]))


def hertz_modulus(radius: float, f: float, length: float) -> float:
    """Return the modulus E* (Pa) of the cylinder that has a contact length (m) under a force (N/m), uncharged."""
    return float(4 * radius * f / (np.pi * (length / 2) ** 2))
