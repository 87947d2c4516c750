r"""A closure by the gaps of one kind of surface: values at the pressures of a table, a smooth monotone curve between.

The logarithms of air gap, mean separation and contact area are piecewise cubic in the logarithm of the pressure, with
the slopes of Fritsch and Butland (1984, doi:10.1137/0905021), which make no oscillation between the table's pressures:
each is monotone where the table is. Half way between two nodes the air gap is that of the contact itself to 0.3 %, and
without field in contact to 1.5 %, by ``tests/test_gaps.py``. Without it the air gap widens again beyond some 0.7 of the
unit of pressure: the area beside the contact vanishes. Of several realisations the attractions are averaged, as over
the many patches of a ridge; :meth:`TabulatedClosure.spread` has the scatter from one to the next.
"""

from abc import abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
import scipy  # its parts are imported where they are used first: to read a scene needs none
from numpy.typing import ArrayLike, NDArray

from variational.coefficients import parameter
from variational.roughness.closure import PAST_THE_FOLD, STICKING, AirGap, RoughSurface
from variational.roughness.gaps import GapTable, Slopes, Statistics, breaking_gaps

Array = NDArray[np.float64]
_EPS_0 = 8.854e-12  # F/m, Table 3
_SIDE = 4.0  # largest waves in the side of the surface whose scatter is meant


class _Curve:
    """A piecewise cubic through values at equal steps of an abscissa."""

    def __init__(self, x: Array, y: Array) -> None:
        """Take abscissas, shape (n,) and increasing by equal steps, and values of the same shape."""
        a, b, c, d = scipy.interpolate.PchipInterpolator(x, y).c
        self._begin = x[0] + float((x[-1] - x[0]) / (len(x) - 1)) * np.arange(len(x) - 1)
        self._inner = self._begin[1:]
        self._c = np.array([[a, np.zeros_like(a)], [b, 3 * a], [c, 2 * b], [d, c]])  # of values and of derivatives

    def __call__(self, x: Array) -> Array:
        """Return values and derivatives at abscissas inside the range, shape (2, ...) before that of the abscissas."""
        k = self._inner.searchsorted(x, "right")  # of not-a-number the last: it stays one
        t = x - self._begin.take(k)
        found, second, third, last = self._c.take(k, axis=-1)
        for each in (second, third, last):  # Horner's rule for both at once
            found *= t
            found += each
        return found


@dataclass(frozen=True)
class TabulatedClosure(RoughSurface):
    """A rough ridge whose gaps over pressure are a table; SI units."""

    shortest_wave: float = parameter(1e-10, 1e-2, "m", default=6.25e-6)
    """Shortest wavelength of the roughness (m) (*assumption*). Shorter waves lower the contact area and open the air
    gap a little."""
    field_in_contact: bool = True
    """Whether the field acts where asperities touch (*assumption*): insulators meet there, and bear the highest field.
    If false, the area in contact does not attract."""
    p_floor: float = parameter(1e-3, 1e9, "Pa", default=1e3)
    """Mean contact pressure (Pa) below which the air gap is held constant (*assumption*)."""
    hurst: float = parameter(0.05, 0.99, default=0.75)
    """Hurst exponent of the roughness; tables of boundary elements are for 0.6 to 0.9."""
    shared: ClassVar[tuple[str, ...]] = ("h_0", "h_rms", "wavelength", "young", "p_floor", "shortest_wave", "hurst")
    end: ClassVar[str] = "the end of the table of gaps"
    extrapolates: ClassVar[bool] = False

    @abstractmethod
    def tables(self) -> list[tuple[float, GapTable]]:
        """Return tables of the surface, of the same pressures, and the part of each in the whole.

        Raises:
            ValueError: there is none for these parameters; in one sentence.
        """

    @property
    def unit_pressure(self) -> float:
        """E* q_0 h_rms (Pa), the unit of the table's pressures; E* = 4/3 E."""
        return 4 / 3 * self.young * 2 * np.pi / self.wavelength * self.h_rms

    @cached_property
    def pressures(self) -> tuple[float, float]:
        """Range of mean contact pressures (Pa) in which the air gap follows the pressure."""
        nodes = self._nodes
        return max(self.p_floor, float(nodes[0]) * (1 + 1e-12)), float(nodes[-1]) * (1 - 1e-12)

    # -- from the table --------------------------------------------------------------------------------
    @cached_property
    def _tables(self) -> list[tuple[float, GapTable]]:
        return self.tables()

    @cached_property
    def _nodes(self) -> Array:
        """Pressures (Pa) of the table."""
        first, *others = (table.pressure for _, table in self._tables)
        shared = [p for p in first if all(np.isclose(p, other).any() for other in others)]
        return np.array(shared) * self.unit_pressure

    def _mean(self, name: str, *arguments: float) -> Array:
        """Return the mean over tables and realisations of what a table has by this name, at the nodes."""
        found = np.zeros(len(self._nodes))
        for part, table in self._tables:
            values = getattr(table, name)
            values = values(*arguments) if callable(values) else values
            same = np.isclose(table.pressure[:, None] * self.unit_pressure, self._nodes).any(axis=1)
            found += part * values[:, same].mean(axis=0)
        return found

    @cached_property
    def _gaps(self) -> _Curve:
        """Logarithm of d_eq (m) over that of the pressure."""
        square = self._mean("inverse_square", self.h_0 / self.h_rms, self.field_in_contact) / self.h_rms**2
        return _Curve(np.log(self._nodes), np.log(square**-0.5 - self.h_0))

    @cached_property
    def _separation(self) -> _Curve:
        return _Curve(np.log(self._nodes), np.log(self._mean("mean_gap") * self.h_rms))

    @cached_property
    def _area(self) -> _Curve:
        return _Curve(np.log(self._nodes), np.log(self._mean("area")))

    # -- answers ---------------------------------------------------------------------------------------
    def __call__(self, p_c: ArrayLike) -> AirGap:
        """Return the air gap at mean contact pressures (Pa), held below p_floor and beyond the table's pressures."""
        p_c = np.asarray(p_c, dtype=float)
        low, high = self.pressures
        held = np.minimum(np.maximum(p_c, low), high)
        value, slope = self._gaps(np.log(held))
        d_eq = np.exp(value)
        return AirGap(d_eq, np.where(held == p_c, d_eq * slope / held, 0.0))

    def statistics(self, p_c: ArrayLike, voltage: float = 0.0) -> Statistics:
        """Return the gaps at mean contact pressures (Pa) inside :attr:`pressures`; their breakdown is at a voltage (V).

        Raises:
            ValueError: a pressure outside of the table; in one sentence.
        """
        p_c = self.inside(p_c)
        x = np.log(p_c)
        curves = (np.array(curve(x)) for curve in (self._area, self._separation))
        (area, d_area), (u_bar, d_u) = ((np.exp(y), np.exp(y) * slope / p_c) for y, slope in curves)
        d_eq, slope = self(p_c)
        assert slope is not None
        square = (self.h_0 + d_eq) ** -2
        slopes = Slopes(d_area, d_u, -2 * square / (self.h_0 + d_eq) * slope, slope)
        return Statistics(area, u_bar, square, d_eq, self._broken_down(x, voltage), slopes)

    def _broken_down(self, x: Array, voltage: float) -> Array:
        """Return the part of the area that breaks down at logarithms of the pressure."""
        found = np.zeros(len(self._nodes))
        for low, high in breaking_gaps(voltage, self.h_0):
            found += self._mean("closer", high / self.h_rms) - self._mean("closer", low / self.h_rms)
        return np.clip(_Curve(np.log(self._nodes), found)(x)[0], 0.0, 1.0)

    def spread(self, p_c: ArrayLike) -> Array:
        """Return the standard deviation of d_eq (m) from one surface to the next; zero of one surface alone.

        Surfaces are four largest waves long and wide. That of realisations of another size is scaled by their side, as
        that of a mean over independent patches.

        Args:
            p_c: mean contact pressures (Pa), held as in a call.
        """
        found = np.zeros(len(self._nodes))
        for part, table in self._tables:
            same = np.isclose(table.pressure[:, None] * self.unit_pressure, self._nodes).any(axis=1)
            square = table.inverse_square(self.h_0 / self.h_rms, self.field_in_contact)[:, same] / self.h_rms**2
            gaps = square**-0.5 - self.h_0
            found += part * table.waves / _SIDE * (gaps.std(axis=0, ddof=1) if len(gaps) > 1 else 0.0)
        held = np.clip(np.asarray(p_c, dtype=float), *self.pressures)
        return _Curve(np.log(self._nodes), found)(np.log(held))[0]

    def attraction(self, p_c: ArrayLike, voltage: float) -> Array:
        """Return the attraction (Pa) at mean contact pressures (Pa) and a voltage (V)."""
        return np.asarray(_EPS_0 * voltage**2 / 2 / (self.h_0 + self(p_c).d_eq) ** 2)

    def balanced(self, p_c: ArrayLike, voltage: float) -> Array:
        """Return the part of the contact pressure that attraction balances where asperities touch, 0 or more.

        There both act on one spot, and press nothing else together. The closure takes the whole pressure as the load
        that deforms, so this part is a measure of what it overestimates; zero without a field in contact. It is at most
        1 in equilibrium where nothing pulls from outside: the attraction is then no larger than the contact pressure.

        Args:
            p_c: mean contact pressures (Pa), held as in a call.
            voltage: (V).
        """
        held = np.clip(np.asarray(p_c, dtype=float), *self.pressures)
        most = _EPS_0 * voltage**2 / 2 / self.h_0**2 * self.field_in_contact
        return np.asarray(most * np.exp(self._area(np.log(held))[0]) / held)

    def state(self, p_c: float, voltage: float) -> str:
        """Return where a ridge is on the closure; empty where it is stable and within the table."""
        if p_c <= 0:
            return ""
        low, high = self.pressures
        if p_c < low:
            return "below p_floor" if low == self.p_floor else f"below the table's pressures, {low * 1e-3:.3g} kPa on"
        if p_c > high:
            return f"beyond the table's pressures, up to {high * 1e-3:.3g} kPa"
        d_eq, slope = self(p_c)
        assert slope is not None
        grows = -_EPS_0 * voltage**2 / (self.h_0 + float(d_eq)) ** 3 * float(slope)
        return PAST_THE_FOLD if grows > 1 else ""

    def sticking_voltage(self) -> float:
        """Return the voltage (V) from which a flat ridge adheres without a load, by a stress :data:`.STICKING`.

        The attraction exceeds the contact pressure by that stress at one pressure of the table at least.
        """

        def squared(x: float) -> float:
            p_c = np.exp(x)
            return float(2 * (p_c + STICKING) * (self.h_0 + self(p_c).d_eq) ** 2 / _EPS_0)

        low, high = (float(np.log(p)) for p in self.pressures)
        grid = np.linspace(low, high, 200)
        k = int(np.argmin([squared(x) for x in grid]))
        bounds = grid[max(k - 1, 0)], grid[min(k + 1, len(grid) - 1)]
        return float(np.sqrt(scipy.optimize.minimize_scalar(squared, bounds=bounds, method="bounded").fun))
