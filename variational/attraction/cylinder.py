r"""A charged ridge as an elastic cylinder on the screen, with the microscale inside: closed forms and two roots.

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

The tip touches over :math:`a_1` without attraction, and its contact force goes with a power p of the length in contact
(:mod:`~variational.attraction.tip`). So a and m both follow from :math:`x = a / a_1`, the one unknown:

.. math:: 2 \sigma a_1 \sqrt{m^2 - 1} = f \left( x^p - 1 \right) / x .

The screen bears what presses and what attracts, over the length in contact, and the microscale says how far apart the
surfaces are under that pressure (Forsbach et al. 2023, Eqs. 3, 4 and 13):

.. math:: 2 a p_c = f + 2 \sigma c, \qquad d_{eq} = d_{eq}(p_c).

Without voltage this is Hertz's law. A tip that is no cylinder has its own force and gap in the place of those with R.
E* may grow with p_c, as in a ridge that friction shears. The gap at c grows with x, which leaves one x at each p_c,
and one equation in p_c. It can have several roots: that of the highest pressure is the branch in contact, on which the
loop over the scales contracts; others are unstable, or states of a ridge that has not jumped on the screen yet. Where
the highest root vanishes the ridge is past its pull-off fold and there is none.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from variational.attraction.dielectric import VACUUM_PERMITTIVITY
from variational.attraction.tip import Tip
from variational.roughness.closure import Closure

Array = NDArray[np.floating[Any]]
Voltage = float | Array | Callable[[Array], Array]
"""A voltage U (V), of all loads or of each, or one of Eq. 3 by the air gap (m) where a drive loses a part of it that
depends on the gap."""
_PRESSURES = np.geomspace(10.0, 1e7, 181)  # Pa, among which roots are separated
_LEAST, _START, _MOST = 4e-5, 1.7, 1e6  # of the root of m^2 - 1
_WIDEST = 200.0  # ln x^p at most
_NO_PULL = 1e-100  # Pa, in place of no attraction
_ROUNDOFF = 2e-16  # relative
_ROUGH = 1e-3  # of Newton's method where only the sign of an excess is looked for
_STEP = 1e-7  # of Newton's method, relative; the next one would be of its square
_TOLERANCE = 1e-12  # of the pressure, relative
_ITERATIONS = 100  # of a root, at most; bisection to roundoff takes 60
_NO_EDGE = 1e-6  # relative difference of gap and reach behind which there is no root


class NoEquilibriumError(ValueError):
    """A ridge without an equilibrium in contact under its loads; one sentence."""


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
class _Loads:
    """What ridges bear; arrays of shape (ridges,)."""

    f: Array
    """External force per length (N/m)."""
    modulus: Array
    """Of each ridge (Pa)."""
    h_0: Array
    """Effective insulator thickness (m)."""
    number: NDArray[np.intp]
    """Place among the loads."""
    tip: Tip

    def __getitem__(self, chosen: NDArray[np.intp]) -> "_Loads":
        return _Loads(*(getattr(self, each.name)[chosen] for each in fields(self)))


@dataclass(frozen=True)
class Cylinder:
    """A ridge; SI units."""

    tip: Tip
    """Its shape; where it differs from load to load its arrays have the shape (loads,)."""
    modulus: float | Array
    """Plane strain modulus E* (Pa): of all loads, or of each, shape (loads,)."""
    h_0: float | Array
    """Effective insulator thickness (m), of all loads or of each."""
    closure: Closure | Sequence[Closure]
    """The microscale, of all loads or of each."""
    stiffening: Callable[..., Array] | None = None
    """What the modulus gains (Pa) at mean contact pressures (Pa); None where it is constant. Where each load has a
    closure of its own, it takes the numbers of the loads as a second argument, in the shape of the pressures."""

    def under_loads(self, f: ArrayLike, voltage: Voltage) -> list[RidgeState]:
        """Return the state under each of several external forces.

        Args:
            f: forces per length (N/m), positive, shape (loads,).
            voltage: (V).

        Raises:
            NoEquilibriumError: no branch in contact, or the attraction is beyond what a finger can bear, under the
                first force that is refused.
        """
        f = np.asarray(f, dtype=float)
        if not np.all(f > 0):
            raise NoEquilibriumError(f"the force on a ridge is {f[~(f > 0)][0]:g} N/m; it must be greater than 0")
        voltage = voltage if callable(voltage) else np.broadcast_to(np.asarray(voltage, dtype=float), f.shape)
        modulus, h_0 = (np.broadcast_to(np.asarray(x, dtype=float), f.shape) for x in (self.modulus, self.h_0))
        loads = _Loads(f, modulus, h_0, np.arange(len(f)), self.tip)
        pressures = _PRESSURES[:: self.tip.stride]
        count, every = len(f), len(pressures)
        grid = loads[np.tile(np.arange(count), every)]
        edges, values = (each.reshape(every, count) for each in self._excess(pressures, voltage, grid))
        crossed = np.sign(values[:-1]) != np.sign(values[1:])
        none = ~crossed.any(axis=0) | (values[-1] <= 0)
        if none.any():
            at = "a drive" if callable(voltage) else f"{voltage[none][0]:g} V"
            raise NoEquilibriumError(
                f"no contact pressure from {_PRESSURES[0]:g} to {_PRESSURES[-1]:g} Pa bears {f[none][0]:g} N/m on a "
                f"ridge at {at}; try another force or length"
            )
        k, load = np.nonzero(crossed)
        crossing, near = loads[load], edges[k, load]

        def excess(p_c: Array) -> Array:
            nonlocal near
            near, found = self._excess(p_c, voltage, crossing, near)
            return found

        roots = _roots(excess, (pressures[k], values[k, load]), (pressures[k + 1], values[k + 1, load]))
        found = [np.flatnonzero(load == n) for n in range(count)]  # places of growing pressure
        last = np.array([places[-1] for places in found])
        p_c = roots[last]
        a, edge, sigma, d_eq, _ = self._at(p_c, voltage, loads, near[last])
        attraction = 2 * sigma * a * (1 + edge)
        columns: Any = np.array([2 * a, 2 * a * (1 + edge), p_c, d_eq, f + attraction, attraction]).T.tolist()
        others = (tuple(map(float, roots[places[:-1]])) for places in found)
        return [RidgeState(*(*each, more)) for each, more in zip(columns, others, strict=True)]

    # -- the gap at c ----------------------------------------------------------------------------------
    def _edge(self, loads: _Loads, sigma: Array, reach: Array, near: Array | None = None) -> tuple[Array, Array, Array]:
        """Return a (m), m - 1 and ln(a / a_1 - 1) where the gap at c is the reach of the attraction.

        By Newton's method on logarithms, between bounds: in them the gap is nearly a straight line.

        Args:
            loads: of each ridge.
            sigma: strength of the attraction (Pa).
            reach: of the attraction (m).
            near: values of ln(a / a_1 - 1) to start at, of edges that are known to be there; without them the gap is
                the reach to a millionth.

        Raises:
            NoEquilibriumError: the gap at c is smaller up to the largest m, or larger from the least m on.
        """
        p, alone = loads.tip.power, loads.tip.alone(loads.modulus, loads.f)
        sigma = np.maximum(sigma, _NO_PULL)
        scale, pulled = loads.f / (2 * sigma * alone), 4 * sigma / (np.pi * loads.modulus)

        def at(y: Array) -> tuple[Array, ...]:
            """Return a, its derivative, root, m - 1 and the derivative of m, all with respect to y."""
            wider = np.exp(y)
            x, more = 1 + wider, np.expm1(p * np.log1p(wider))
            root = scale * more / x
            m = np.sqrt(1 + root * root)
            by_m = root / m * scale * wider * (p + (p - 1) * more) / (x * x)
            return alone * x, alone * wider, root, root * root / (1 + m), by_m

        def opening(y: Array) -> tuple[Array, Array, Array]:
            """Return the logarithm of the gap over the reach, its derivative, and m - 1."""
            a, a_slope, root, beyond, m_slope = at(y)
            m, angle, logarithm = 1 + beyond, np.arcsinh(root), np.log1p(beyond)  # of both: arcosh m, ln m
            part = pulled * (root * angle - m * logarithm)
            gap, by_a, by_m = loads.tip.gap(a, beyond, root, angle)
            gap = gap + a * part
            grows = a_slope * (by_a + part) + m_slope * (by_m + pulled * a * (m / root * angle - logarithm))
            return np.log(gap / reach), grows / gap, beyond

        def bound(root: float, power: Any) -> Array:
            """Return y near a value of the root: below it of the power p, above it of p - 1."""
            return np.asarray(np.log(np.expm1(np.minimum(np.log1p(root / scale) / power, _WIDEST / p))))

        low, high = bound(_LEAST, p), bound(_MOST, p - 1)
        y, close = (bound(_START, p - 0.5), _ROUGH) if near is None else (near, _STEP)
        for _ in range(_ITERATIONS):
            value, slope, beyond = opening(y)
            below, step = value < 0, value / slope
            low, high = np.where(below, y, low), np.where(below, high, y)
            after = y - step
            small = abs(step) <= close + 4 * _ROUNDOFF / beyond  # the gap is a difference, good to 1e-16 / (m - 1)
            y = np.where(((after > low) & (after < high)) | small, after, (low + high) / 2)
            if small.all():
                break
        else:
            none = abs(opening(y)[0]) > _NO_EDGE
            if none.any():
                k = int(np.argmax(none))
                raise NoEquilibriumError(
                    f"no contact bears {loads.f[k]:g} N/m under an attraction of {sigma[k]:.3g} Pa; "
                    "try a smaller voltage or another force"
                )
        a, _, _, beyond, _ = at(y)
        return a, beyond, y

    # -- the microscale --------------------------------------------------------------------------------
    def _at(
        self, p_c: Array, voltage: Voltage, loads: _Loads, near: Array | None = None
    ) -> tuple[Array, Array, Array, Array, Array]:
        """Return a (m), m - 1, strength of attraction (Pa), air gap (m) and ``near``, at contact pressures (Pa).

        Args:
            p_c: of each ridge, or of as many ridges after each other as there are more ridges than pressures.
            voltage: (V).
            loads: of each ridge.
            near: values of ln(a / a_1 - 1) to start at.
        """
        d_eq, gain = self._laws_at(p_c, loads)
        loads = loads if gain is None else replace(loads, modulus=loads.modulus + gain)
        volts = voltage(d_eq) if callable(voltage) else voltage[loads.number]  # type: ignore[index]
        sigma = VACUUM_PERMITTIVITY * volts**2 / 2 / (loads.h_0 + d_eq) ** 2
        a, beyond, near = self._edge(loads, sigma, loads.h_0 + 2 * d_eq, near)
        return a, beyond, sigma, d_eq, near

    def _laws_at(self, p_c: Array, loads: _Loads) -> tuple[Array, Array | None]:
        """Return the air gap (m) of each ridge, and what its modulus gains (Pa); arguments of :meth:`_at`."""
        count = len(loads.f) // len(p_c)
        if not isinstance(self.closure, Sequence):
            gain = None if self.stiffening is None else np.repeat(self.stiffening(p_c), count)
            return np.repeat(np.asarray(self.closure(p_c).d_eq, dtype=float), count), gain
        pressures, d_eq = np.repeat(p_c, count), np.empty(len(loads.f))
        order = np.argsort(loads.number, kind="stable")
        for places in np.split(order, np.flatnonzero(np.diff(loads.number[order])) + 1):
            d_eq[places] = self.closure[loads.number[places[0]]](pressures[places]).d_eq
        return d_eq, None if self.stiffening is None else self.stiffening(pressures, loads.number)

    def _excess(self, p_c: Array, voltage: Voltage, loads: _Loads, near: Array | None = None) -> tuple[Array, Array]:
        """Return ``near``, and what pressures bear beyond attraction and force (N/m); arguments of :meth:`_at`."""
        a, beyond, sigma, _, near = self._at(p_c, voltage, loads, near)
        return near, 2 * a * (np.repeat(p_c, len(a) // len(p_c)) - sigma * (1 + beyond)) - loads.f


def _roots(function: Callable[[Array], Array], low: tuple[Array, Array], high: tuple[Array, Array]) -> Array:
    """Return the roots of a function between ends at which it has other signs, by Chandrupatla's method.

    T. R. Chandrupatla 1997, Adv. Eng. Softw. 28, 145, doi 10.1016/S0965-9978(96)00051-8; it starts as the secant does.

    Args:
        function: of arrays, shape (roots,).
        low: places, and the values there.
        high: as ``low``, of the other ends.
    """
    (x_1, f_1), (x_2, f_2) = low, high
    t = f_1 / (f_1 - f_2)
    for _ in range(_ITERATIONS):
        x = x_1 + t * (x_2 - x_1)
        f = function(x)
        same = np.sign(f) == np.sign(f_1)
        x_3, f_3 = np.where(same, x_1, x_2), np.where(same, f_1, f_2)
        x_2, f_2 = np.where(same, x_2, x_1), np.where(same, f_2, f_1)
        x_1, f_1 = x, f
        limit = _TOLERANCE * abs(x) / abs(x_2 - x_1)
        if np.all((limit > 0.5) | (f == 0)):
            break
        with np.errstate(divide="ignore", invalid="ignore"):
            xi, phi = (x_1 - x_2) / (x_3 - x_2), (f_1 - f_2) / (f_3 - f_2)
            inverse = f_1 / (f_2 - f_1) * f_3 / (f_2 - f_3)
            inverse += (x_3 - x_1) / (x_2 - x_1) * f_1 / (f_3 - f_1) * f_2 / (f_3 - f_2)
        t = np.where((phi**2 < xi) & ((1 - phi) ** 2 < 1 - xi), inverse, 0.5)
        t = np.clip(t, np.minimum(limit, 0.5), np.maximum(1 - limit, 0.5))
    return np.where(abs(f_1) < abs(f_2), x_1, x_2)
