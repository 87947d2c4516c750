r"""The tip of a ridge before it is charged: its contact force over the length in contact, and the gap beside it.

A tip on an elastic half-plane of modulus E* touches from -a to a under the force per length

.. math:: f_1(a) = E^* k(a), \qquad k(a) = \frac12 \int_{-a}^{a} \frac{x\, g_0'(x)}{\sqrt{a^2 - x^2}} \,dx,

with the undeformed gap :math:`g_0` (Barber 2018, Contact Mechanics, ch. 6). The contact grows as a row of punches of
half-width b, each of which closes the gap at x by :math:`2 f_1'(b)\,db \operatorname{arcosh}(x/b) / \pi E^*`. So the
gap at c = m a is

.. math:: g(c) = \frac2\pi \int_a^c k'(b) \operatorname{arcosh}(c/b) \,db .

A :class:`Round` tip is a cylinder, :math:`k = \pi a^2 / 4R`, Hertz's law. Any other profile is a :class:`Power` about
the contact that it has without voltage, :math:`k = k_0 (a/a_0)^p`:

.. math:: g(c) = \frac2\pi k(a) \left( m^p \int_0^{\arccos 1/m} \cos^{p-1}\theta \,d\theta - \operatorname{arcosh} m
          \right) .

With p = 2 both are the same. :func:`kernel` has k and p of a profile of cosines.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.floating[Any]]
_NODES, _WEIGHTS = (each / 2 for each in np.polynomial.legendre.leggauss(7))
_LEAST_POWER = 1.05  # of a profile beyond its flank: its contact force has to grow


class Tip(ABC):
    """A shape of the tips of ridges; arrays have the shape of the loads."""

    power: Any
    """p of the contact force over the length in contact."""
    stride: ClassVar[int] = 1
    """Roots are separated among every so many of the pressures: more costly tips have fewer."""

    def __getitem__(self, chosen: NDArray[np.intp]) -> Self:
        """Return the tips of some loads."""
        return self._with(lambda _, value: value[chosen] if np.ndim(value) else value)

    def scaled(self, factor: ArrayLike) -> Self:
        """Return tips with all lengths on another scale, one for all loads or one for each."""
        return self._with(lambda name, value: value if name == "power" else factor * value)

    def _with(self, change: Callable[[str, Any], Any]) -> Self:
        names = [each.name for each in fields(self)]  # type: ignore[arg-type]
        return replace(self, **{name: change(name, getattr(self, name)) for name in names})  # type: ignore[type-var]

    @abstractmethod
    def modulus(self, f: ArrayLike, length: ArrayLike) -> Array:
        """Return the modulus E* (Pa) with which contact lengths (m) bear forces (N/m), uncharged."""

    @abstractmethod
    def alone(self, modulus: Array, f: Array) -> Array:
        """Return a (m) under forces (N/m), uncharged."""

    @abstractmethod
    def gap(self, a: Array, beyond: Array, root: Array, angle: Array) -> tuple[Array, Array, Array]:
        r"""Return the gap (m) at c = m a, its derivative with respect to a, and that with respect to m (m).

        Args:
            a: (m).
            beyond: m - 1.
            root: :math:`\sqrt{m^2 - 1}`.
            angle: arcosh m.
        """


@dataclass(frozen=True)
class Round(Tip):
    """A cylinder."""

    radius: float | Array
    """R (m)."""
    power = 2.0

    def modulus(self, f: ArrayLike, length: ArrayLike) -> Array:
        """Return the modulus by Hertz's law."""
        return np.asarray(4 * self.radius * np.asarray(f) / (np.pi * (np.asarray(length) / 2) ** 2))

    def alone(self, modulus: Array, f: Array) -> Array:
        """Return Hertz's half-width."""
        return np.sqrt(4 * self.radius * f / (np.pi * modulus))

    def gap(self, a: Array, beyond: Array, root: Array, angle: Array) -> tuple[Array, Array, Array]:
        """Return the gap beside a cylinder."""
        bent, round_part = a / self.radius, (1 + beyond) * root - angle
        return bent * a / 2 * round_part, bent * round_part, bent * a * root


@dataclass(frozen=True)
class Power(Tip):
    """A tip that is flatter, or sharper, than a cylinder."""

    stride = 4

    power: Array
    """p."""
    depth: Array
    """k_0 (m)."""
    half: Array
    """a_0 (m)."""

    def modulus(self, f: ArrayLike, length: ArrayLike) -> Array:
        """Return the modulus; the power law goes on to other lengths than that of the tip."""
        a = np.asarray(length) / 2
        return np.asarray(np.asarray(f) / (self.depth * (a / self.half) ** self.power))

    def alone(self, modulus: Array, f: Array) -> Array:
        """Return the half-width; the power law goes on to other lengths than that of the tip."""
        return np.asarray(self.half * (f / (modulus * self.depth)) ** (1 / self.power))

    def gap(self, a: Array, beyond: Array, root: Array, angle: Array) -> tuple[Array, Array, Array]:
        """Return the gap beside a power law."""
        p, m = self.power, 1 + beyond
        k, most = self.depth * (a / self.half) ** p, np.arctan(root)
        inside = most * (_WEIGHTS @ np.exp((p - 1) * np.log(np.cos(np.multiply.outer(0.5 + _NODES, most)))))
        open_ = 2 / np.pi * (m**p * inside - angle)
        return k * open_, p * k / a * open_, k * 2 / np.pi * p * m ** (p - 1) * inside


def kernel(heights: ArrayLike, wavelength: float, a: ArrayLike) -> tuple[Array, Array]:
    r"""Return k (m) and the power p of a profile about half-lengths a (m) of its contact, which is at the crest.

    With :math:`g_0 = \sum_j s_j (1 - \cos q_j x)`: :math:`k = \frac{\pi a}{2} \sum_j s_j q_j J_1(q_j a)` and
    :math:`p = a k' / k` with :math:`a k' = \frac{\pi a^2}{2} \sum_j s_j q_j^2 J_0(q_j a)`.

    Args:
        heights: s_j (m) of the harmonics j = 1, 2, …
        wavelength: of a ridge (m).
        a: half-lengths (m), shape (loads,).
    """
    from scipy.special import j0, j1

    a = np.asarray(a, dtype=float)[..., None]
    heights = np.asarray(heights, dtype=float)
    q = 2 * np.pi / wavelength * np.arange(1, len(heights) + 1)
    k, slope = (
        (np.pi * a / 2 * heights * q * j1(q * a)).sum(-1),
        (np.pi * a**2 / 2 * heights * q**2 * j0(q * a)).sum(-1),
    )
    return k, np.maximum(slope / k, _LEAST_POWER)
