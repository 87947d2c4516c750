r"""Adhesion without a voltage: laws of attraction between skin and screen over the gap y between them.

.. math:: p_{ad}(y) = \phi'(y), \qquad w = \int_0^\infty p_{ad} \,dy = -\phi(0)

with the work of adhesion w (J/m²). The attraction acts beside the electrostatic one, in the same weak form and with a
potential as that has (:mod:`~variational.attraction.electroadhesion`). What it stores is part of the energy of a state.
The gap is the height of the skin, without the roughness that a closure resolves: the law is that of rough skin.
Both functions are written with arithmetic alone, so that they take NumPy's numbers and UFL expressions alike.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from variational.coefficients import Law, parameter

_GAPS = np.linspace(-1e-6, 50e-6, 200)  # m, at which a law is examined
_FAR = 1e-3  # m, where attraction must have ended, to
_ENDED = 1e-6  # of that in contact
_STEP, _SAME = 1e-11, 1e-3  # m, of a difference quotient; its largest error, over the attraction in contact


class Adhesion(Law, ABC):
    """A law of adhesion."""

    @abstractmethod
    def pressure(self, y):
        """Return the attraction p_ad (Pa of current area) over a gap y (m), which is below 0 where springs give way."""

    @abstractmethod
    def potential(self, y):
        """Return the potential (J/m² per projected current area): the pressure is its derivative, and it ends at 0."""

    @property
    def work(self) -> float:
        """Work of adhesion w (J/m²)."""
        return -float(self.potential(0.0))

    @property
    def reach(self) -> float:
        """Distance (m) to which it acts: the work over the attraction in contact."""
        return self.work / float(self.pressure(0.0))

    def check(self) -> None:
        """Refuse what is no law of adhesion.

        Raises:
            ValueError: numbers that are not finite, an attraction that is negative or goes on for ever, or a potential
                that is not its integral; in one sentence.
        """
        self.refuse_numbers()
        p, most = np.asarray(self.pressure(_GAPS), dtype=float), float(self.pressure(0.0))
        if not (np.isfinite(p).all() and (p >= -_ENDED * most).all() and most >= 0):
            raise ValueError(f"the pressure of {self} is {p.min():g} Pa; it must be finite and not negative")
        if abs(self.pressure(_FAR)) > _ENDED * most or abs(self.potential(_FAR)) > _ENDED * self.work:
            raise ValueError(f"the pressure of {self} is {self.pressure(_FAR):g} Pa at {_FAR:g} m; it must end before")
        slope = (self.potential(_GAPS + _STEP) - self.potential(_GAPS - _STEP)) / (2 * _STEP)
        if not np.abs(slope - p).max() <= _SAME * most:
            raise ValueError(f"the potential of {self} is not the integral of its pressure over the gap; it must be")


@dataclass(frozen=True)
class Dugdale(Adhesion):
    r"""A constant attraction up to a distance, smoothed where it ends.

    .. math:: p_{ad} = p_0 (1 - 3 s^2 + 2 s^3), \qquad s = \frac{y - h_0 + b}{2 b} \text{ within } 0 \le s \le 1,
              \qquad w = p_0 h_0

    (D. S. Dugdale 1960, doi 10.1016/0022-5096(60)90013-2; for adhesion D. Maugis 1992, J. Colloid Interface Sci. 150,
    243, doi 10.1016/0021-9797(92)90285-T). The cubic s is this program's, so that Newton's method has a tangent.
    """

    p_0: float = parameter(1e-3, 1e9, "Pa", zero=True)
    """Attraction p_0 in contact (Pa). 0 is no adhesion."""
    distance: float = parameter(1e-9, 1e-4, "m", default=2e-6)
    """Distance h_0 (m) to which it acts. The work of adhesion is p_0 times the distance. *Assumption*: that of rough
    skin."""
    width: float = parameter(1e-9, 1e-4, "m", default=1e-6)
    """Half the width b (m) over which it ends, at most the distance. *Assumption*."""

    def check(self) -> None:
        """Refuse a width beyond the distance, and what is no law; raises as :meth:`Adhesion.check`."""
        if not 0 < self.width <= self.distance:
            raise ValueError(f"width is {self.width:g} m; it must be at most the distance, {self.distance:g} m")
        super().check()

    def _ended(self, y):
        """Return s, the part of the way over which the attraction ends, from 0 to 1."""
        s = (y - self.distance) / (2 * self.width) + 0.5
        return (abs(s) - abs(s - 1) + 1) / 2

    def pressure(self, y):
        """Return the attraction (Pa)."""
        s = self._ended(y)
        return self.p_0 * (1 - s**2 * (3 - 2 * s))

    def potential(self, y):
        """Return its potential (J/m²)."""
        s, inside = self._ended(y), self.distance - self.width - y
        return -self.p_0 * (self.width * (1 - s * (2 - s**2 * (2 - s))) + (inside + abs(inside)) / 2)
