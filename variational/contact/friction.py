r"""Laws of friction: the largest tangential traction t_max under a contact pressure p_n.

.. math:: |t_t| \le t_{max}(p_n), \qquad t_{max}(0) = 0

A point sticks below the limit and slips on it, against the motion (:mod:`~variational.contact.formulation`);
tractions are per reference area. Without pressure there is no friction, and no jump of it: a limit that began with a
step would move Newton's method from one equilibrium to another with every point that touches.

Your own law is one frozen dataclass::

    @dataclass(frozen=True)
    class Mine(Friction):
        mu_f: float
        t_most: float  # Pa

        def limit(self, p):
            return self.mu_f * p / (1 + self.mu_f * p / self.t_most)

Its numbers become constants of the compiled form.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from numbers import Real
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from variational.caution import Caution
from variational.coefficients import Law, parameter, said, ufl

Array = NDArray[np.float64]
CONE_ROUNDOFF = 1e-8  # relative: a traction this near the limit counts as on it
_PRESSURES = np.array([0.0, 1.0, 1e2, 1e4, 1e6])  # Pa, at which a law is examined
_JUMP = 1e-6  # Pa, p_n at which the limit must be below _JUMPED
_JUMPED = 1.0  # Pa
_SMALL, _STEEPER = (1e-6, 1.0), 1.5  # Pa, between which the limit over the pressure must not rise by more


class Part:
    """Pressures (Pa) over the part of a facet that a point stands for, linear from place to place along it; UFL.

    Attributes:
        p: contact pressure p_n at the point.
        mean: mean contact pressure over the part; without places that at the point.
    """

    def __init__(self, p, along: Sequence[Any] = ()) -> None:
        """Take the pressure at the point, and those from end to end of the part, negative out of contact."""
        closed = [ufl.conditional(ufl.gt(each, 0.0), each, 0.0) for each in along]
        self.p, self._pieces = p, []
        for first, last, a, b in zip(along[:-1], along[1:], closed[:-1], closed[1:], strict=True):
            ends = ufl.lt(first * last, 0.0)  # contact ends between the two, and the mean is that of a triangle
            self._pieces.append((ufl.conditional(ends, (a + b) ** 2 / abs(first - last), a + b) / 2, a, b))
        self.mean = sum(mean for mean, _, _ in self._pieces) / len(self._pieces) if along else p

    def share(self, p_reg):
        r"""Return the share in contact, of which pressures below p_reg (Pa) have less.

        The mean of :math:`p / \sqrt{p^2 + p_{reg}^2}`, whose integral over a linear pressure is closed form.
        """
        roots = [((a**2 + p_reg**2) ** 0.5 + (b**2 + p_reg**2) ** 0.5) / 2 for _, a, b in self._pieces]
        return sum(mean / root for (mean, _, _), root in zip(self._pieces, roots, strict=True)) / len(roots)


class Friction(Law, ABC):
    """A law of friction."""

    def __init_subclass__(cls) -> None:
        """Take the default :meth:`limit_over` where a law has a limit of its own: that of its base is of another."""
        super().__init_subclass__()
        if "limit" in vars(cls) and "limit_over" not in vars(cls):
            cls.limit_over = Friction.limit_over  # type: ignore[method-assign]

    memory: ClassVar[float | None] = None
    """Memory of a point that never touched, where the law has one: :meth:`limit` then takes the memory as a second
    argument with this default, and :meth:`remembered` is its rule (:mod:`variational.contact.aging`)."""

    @property
    def times(self) -> tuple[float, ...]:
        """Times (s) in which the memory ages; steps in time are short beside the shortest."""
        return ()

    def remembered(self, memory, p, way, lapse):
        """Return the memory that a step leaves, of a law that has one; UFL.

        Args:
            memory: accepted before the step.
            p: contact pressure p_n (Pa of reference area) after it.
            way: of the point over the screen in the step (m).
            lapse: duration of the step (s), 0 where loads change at once.
        """
        raise NotImplementedError

    @property
    def by_area(self) -> bool:
        """Whether the law has a :meth:`limit_over` of its own."""
        return type(self).limit_over is not Friction.limit_over

    def limit_over(self, part: "Part", *memory):
        """Return the mean limit (Pa) over the part of a facet that a point stands for, UFL; by default the point's.

        A limit that is not proportional to the pressure goes with the area in contact. Where that ends within a facet,
        points alone have it with an error of first order in the facet's size, and with jumps as they come and go.
        """
        return self.limit(part.p, *memory)

    @abstractmethod
    def limit(self, p):
        """Return the largest tangential traction t_max (Pa) under a contact pressure p_n >= 0 (Pa).

        Written with arithmetic alone (+, -, *, /, **), it takes numbers, NumPy arrays and UFL expressions alike. In the
        full model both are per reference area, that of the unloaded skin; on one small ridge the contact length
        changed by 0.7 % from there, and so does a limit that is not proportional to the pressure.
        """

    def dissipated(self, before: Array, after: Array, slip: Array) -> tuple[Array, Array]:
        """Return what friction spends on a way (J/m^2), and by how much that may be wrong in a step that jumps.

        By the trapezoidal rule, see :mod:`variational.energy`.

        Args:
            before: limits (Pa) before.
            after: limits (Pa) after, of the same shape as the others.
            slip: how far the points slipped (m), >= 0.
        """
        return np.asarray((before + after) / 2 * slip), np.asarray(np.abs(after - before) / 2 * slip)

    def coefficient(self, p: float) -> float:
        """Return the friction coefficient t_max / p_n at a contact pressure (Pa) above zero."""
        return float(self.limit(p) / p)

    def resultant(self, force: float, length: float) -> float:
        """Return the largest friction (N/m) of a contact force (N/m) spread evenly over a length (m).

        The model "cylinders" gives the current length, while the full model's :meth:`limit` is per reference area.
        """
        return float(self.limit(force / length) * length) if length > 0 else 0.0

    def cautions(self, in_time: bool) -> list[Caution]:
        """Return that a memory has no effect where no load takes time.

        Args:
            in_time: whether a load takes time.
        """
        if in_time or self.memory is None:
            return []
        text = (
            f"friction is {type(self).__name__} and no load takes time, so that friction stays as it begins; "
            "give loads of a history a duration or a speed"
        )
        return [Caution("nothing_ages", text)]

    def check(self) -> None:
        """Refuse what is no law of friction.

        Raises:
            ValueError: numbers that are not finite; a limit that is not zero without pressure, begins with a jump or an
                infinite slope, is negative or no number, or fails. In one sentence.
        """
        self.refuse_numbers()
        try:
            with np.errstate(all="ignore"):
                found = np.asarray(self.limit(_PRESSURES), dtype=float)
                one = float(self.limit(_JUMP))
                slopes = [float(self.limit(p)) / p for p in _SMALL]
        except Exception as error:  # whatever the user's limit raises
            raise ValueError(
                f"the limit of {self} cannot be evaluated for NumPy's numbers: {said(error)}; write it with "
                "arithmetic, or with NumPy's functions where p is no UFL expression (docs/laws.md)"
            ) from error
        if found.shape != _PRESSURES.shape:
            raise ValueError(
                f"the limit of {self} has the shape {found.shape} for {len(_PRESSURES)} pressures; it must have one "
                "value for each"
            )
        for p, value in zip((*_PRESSURES, _JUMP), (*found, one), strict=True):
            if not (np.isfinite(value) and value >= 0):
                raise ValueError(f"the limit of {self} is {value:g} Pa at {p:g} Pa; it must be finite and not negative")
        if found[0] != 0 or one > _JUMPED:
            value, p = (found[0], 0.0) if found[0] else (one, _JUMP)
            raise ValueError(
                f"the limit of {self} is {value:g} Pa at a pressure of {p:g} Pa; it must go to 0 with the pressure"
            )
        if not slopes[0] <= _STEEPER * slopes[1]:
            raise ValueError(
                f"the limit of {self} over the pressure is {slopes[1]:g} at {_SMALL[1]:g} Pa and {slopes[0]:g} at "
                f"{_SMALL[0]:g} Pa; it must begin with a finite slope, as c ((p + a)^n - a^n) does for c p^n"
            )


@dataclass(frozen=True)
class Coulomb(Friction):
    r"""Coulomb's law, :math:`t_{max} = \mu_f p_n`.

    Models without pressures take its friction coefficient for the whole law, so that no law is derived from it.
    """

    mu_f: float = parameter(1e-6, 2.0, zero=True)
    """Friction coefficient. 0 is no friction; 2 is the coefficient of rubber."""

    def __init_subclass__(cls) -> None:
        """Refuse a derived law.

        Raises:
            TypeError: always.
        """
        raise TypeError(f"{cls.__name__} is derived from Coulomb; derive a law of friction from fingerpad.Friction")

    def limit(self, p):
        """Return mu_f p (Pa)."""
        return self.mu_f * p

    def coefficient(self, p: float) -> float:
        """Return mu_f, whatever the pressure."""
        return self.mu_f

    def resultant(self, force: float, length: float) -> float:
        """Return mu_f times the force (N/m), however it is spread."""
        return self.mu_f * force


@dataclass(frozen=True)
class Derjaguin(Friction):
    r"""Coulomb's law with a part that the molecular attraction adds wherever there is contact.

    .. math:: t_{max} = \mu_f p_n + \tau_0 \frac{p_n}{\sqrt{p_n^2 + p_{reg}^2}}

    (B. Derjaguin, Molekulartheorie der äußeren Reibung, Zeitschrift für Physik 88, 1934, pages 661 to 675, where the
    attraction adds a constant pressure p_0 to the load, :math:`\tau_0 = \mu_f p_0`.) The root is this program's, so
    that :math:`\tau_0` does not jump on where contact begins: at ten times p_reg half a percent of tau_0 is missing.

    The share in contact is that of the area, with the ends of contact located within facets (:class:`Part`). So p_reg
    hardly acts: on a small finger of nine ridges slid to full slip at 1 N/m, mu_f = 0.3 and tau_0 of 5 kPa, the
    default of 1 kPa takes 0.3 % off the friction of p_reg = 1 Pa. Newton's method takes 62 iterations with either,
    and 56 for Coulomb's law.
    """

    mu_f: float = parameter(1e-6, 2.0, zero=True)
    """Friction coefficient of the load."""
    tau_0: float = parameter(1e-3, 1e9, "Pa", zero=True)
    """Friction without load (Pa of reference area)."""
    p_reg: float = parameter(1e-3, 1e9, "Pa", default=1e3)
    """Contact pressure (Pa) below which tau_0 fades out. *Assumption*."""

    def limit(self, p):
        """Return the limit (Pa)."""
        return self.mu_f * p + self.tau_0 * p / (p**2 + self.p_reg**2) ** 0.5

    def limit_over(self, part: Part, *memory):
        """Return mu_f times the point's pressure and tau_0 times the share in contact (Pa)."""
        return self.mu_f * part.p + self.tau_0 * part.share(self.p_reg)


def law_of(given: "Friction | float | None") -> Friction | None:
    """Return a law as it is, Coulomb's for a friction coefficient, and None for zero or None.

    Raises:
        ValueError: what is given is no law; in one sentence.
    """
    if isinstance(given, Friction):
        given.check()
        return given
    if given is None:
        return None
    if isinstance(given, bool) or not isinstance(given, Real) or not 0 <= float(given) < np.inf:
        raise ValueError(f"friction is {given!r}; it must be a Friction, a friction coefficient of at least 0, or None")
    return Coulomb(float(given)) if given else None
