r"""Friction that depends on time: laws with a memory at each point of the skin.

A law with a memory m, one number at each point, has a second argument of its limit, :math:`t_{max}(p_n, m)`, and a
rule for what a step leaves of it (:meth:`variational.contact.friction.Friction.remembered`). The rule is part of the
step's equations, so that it is implicit. The memory is history: it moves on when a step is accepted
(:mod:`variational.history`), and a step that takes no time leaves it.

**Growth of contact.** The memory of a :class:`Growing` law is the part m of the growth that is done at a point, of
first order in time: :math:`1 - m \leftarrow (1 - m) e^{-\Delta / T}` over a step of duration Δ. The area of fingerprint
ridges on glass grows by first-order kinetics and saturates within some 20 s, as trapped sweat softens the stratum
corneum (Dzidek et al. 2017, doi 10.1073/pnas.1706233114, read as abstract). *Assumption*: a point that leaves the
screen begins anew at once. A law of one's own that grows has a ``limit(p, memory=0.0)`` and a field ``time``.
"""

from dataclasses import dataclass
from typing import Any, ClassVar

from variational.coefficients import parameter, ufl
from variational.contact.friction import Friction, Part


class Growing(Friction):
    """A law of friction that grows with the time of contact, see the head of this module."""

    memory: ClassVar[float | None] = 0.0
    time: float
    """Time T (s) in which what is left of the growth falls to 37 %."""

    @property
    def times(self) -> tuple[float, ...]:
        """The time of the growth (s)."""
        return (self.time,)

    def remembered(self, memory, p, way, lapse):
        """Return the part of the growth that is done, 0 out of contact; UFL."""
        grown = 1 - (1 - memory) * ufl.exp(-lapse / self.time)
        return ufl.conditional(ufl.gt(p, 0.0), grown, 0.0)


@dataclass(frozen=True)
class Occlusion(Growing):
    r"""A friction coefficient that grows with the time of contact, as sweat is trapped below each ridge.

    .. math:: t_{max} = \mu p_n, \qquad \mu = \mu_{dry} + m (\mu_{wet} - \mu_{dry})

    On smooth glass friction of a finger pad was seen to grow for some 20 s.
    """

    mu_dry: float = parameter(1e-6, 5.0)
    """Friction coefficient of a point that begins to touch."""
    mu_wet: float = parameter(1e-6, 5.0)
    """Friction coefficient after a long time of contact."""
    time: float = parameter(1e-6, 1e6, "s", default=20.0)
    """Time (s) in which the difference of the two falls to 37 %. *Assumption*: friction on glass grew for some 20 s."""

    def limit(self, p, memory=0.0):
        """Return the limit (Pa)."""
        return (self.mu_dry + memory * (self.mu_wet - self.mu_dry)) * p


@dataclass(frozen=True)
class GrowingShear(Growing):
    r"""Coulomb's law with a shear stress that comes as ridges soften and touch the screen with their whole area.

    .. math:: t_{max} = \mu_f p_n + m \tau_0 \frac{p_n}{\sqrt{p_n^2 + p_{reg}^2}}

    :class:`~variational.contact.friction.Derjaguin` whose shear stress grows. At first only asperities touch, in an
    area proportional to the load, so that the friction coefficient does not depend on the load. Later the whole area of
    a ridge is sheared; it grows less than the load, so that the coefficient falls with the load. Both were measured on
    glass, for contacts shorter and longer than 10 s (Dzidek et al. 2017, see the head of this module).
    """

    mu_f: float = parameter(1e-6, 2.0, zero=True)
    """Friction coefficient of a point that begins to touch."""
    tau_0: float = parameter(1e-3, 1e9, "Pa", zero=True)
    """Shear stress without load after a long time of contact (Pa of reference area)."""
    time: float = parameter(1e-6, 1e6, "s", default=7.0)
    """Time T (s) in which what is left of the growth falls to 37 %. Three of 7 s are the 20 s in which ridges on glass
    were seen to grow."""
    p_reg: float = parameter(1e-3, 1e9, "Pa", default=1e3)
    """Contact pressure (Pa) below which tau_0 fades out. *Assumption*."""

    def limit(self, p, memory=0.0):
        """Return the limit (Pa)."""
        return self.mu_f * p + memory * self.tau_0 * p / (p**2 + self.p_reg**2) ** 0.5

    def limit_over(self, part: Part, *memory):
        """Return mu_f times the point's pressure and tau_0, as far as it grew, times the share in contact (Pa)."""
        return self.mu_f * part.p + memory[0] * self.tau_0 * part.share(self.p_reg)


@dataclass(frozen=True)
class Speed(Friction):
    r"""A friction coefficient that depends on the speed v of the skin over the screen.

    .. math:: t_{max} = \mu_f \Big(1 + \frac{v}{v_0}\Big)^n p_n

    The memory is the speed of the last step that took time, which a step without time keeps. *Assumption*: the form,
    a power above v_0 and a constant below.
    """

    memory: ClassVar[float | None] = 0.0

    mu_f: float = parameter(1e-6, 5.0)
    """Friction coefficient at rest."""
    v_0: float = parameter(1e-9, 1e3, "m/s", default=1e-3)
    """Speed (m/s) from which the coefficient changes."""
    exponent: float = parameter(1e-6, 2.0, zero=True, sides=2, default=0.0)
    """Exponent n: below 0 friction falls with the speed."""

    def limit(self, p, memory=0.0):
        """Return the limit (Pa)."""
        return self.mu_f * (1 + memory / self.v_0) ** self.exponent * p

    def remembered(self, memory, p, way, lapse) -> Any:
        """Return the speed of the step (m/s); UFL."""
        takes_time = ufl.gt(lapse, 0.0)
        return ufl.conditional(takes_time, abs(way) / ufl.conditional(takes_time, lapse, 1.0), memory)
