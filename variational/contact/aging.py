r"""Friction that depends on time: laws with a memory at each point of the skin.

A law with a memory m, one number at each point, has a second argument of its limit, :math:`t_{max}(p_n, m)`, and a
rule for what a step leaves of it (:meth:`variational.contact.friction.Friction.remembered`). The rule is part of the
step's equations, so that it is implicit. The memory is history: it moves on when a step is accepted
(:mod:`variational.history`), and a step that takes no time leaves it.
"""

from dataclasses import dataclass
from typing import Any, ClassVar

from variational.coefficients import parameter, ufl
from variational.contact.friction import Friction


@dataclass(frozen=True)
class Occlusion(Friction):
    r"""A friction coefficient that grows with the time of contact, as sweat is trapped below each ridge.

    .. math:: t_{max} = \mu p_n, \qquad \dot\mu = (\mu_{wet} - \mu) / T \text{ in contact}

    from mu_dry on. The memory is the part m of the growth, :math:`\mu = \mu_{dry} + m (\mu_{wet} - \mu_{dry})`, with
    the closed form :math:`1 - m \leftarrow (1 - m) e^{-\Delta / T}` over a step. On smooth glass friction of a finger
    pad was seen to grow for some 20 s (Dzidek et al. 2017, doi 10.1073/pnas.1706233114, read as abstract). The first
    order, and that a point which leaves the screen is dry at once, are *assumptions*.
    """

    memory: ClassVar[float | None] = 0.0

    mu_dry: float = parameter(1e-6, 5.0)
    """Friction coefficient of a point that begins to touch."""
    mu_wet: float = parameter(1e-6, 5.0)
    """Friction coefficient after a long time of contact."""
    time: float = parameter(1e-6, 1e6, "s", default=20.0)
    """Time (s) in which the difference of the two falls to 37 %. *Assumption*: friction on glass grew for some 20 s."""

    @property
    def times(self) -> tuple[float, ...]:
        """The time of the growth (s)."""
        return (self.time,)

    def limit(self, p, memory=0.0):
        """Return the limit (Pa)."""
        return (self.mu_dry + memory * (self.mu_wet - self.mu_dry)) * p

    def remembered(self, memory, p, way, lapse):
        """Return the part of the growth that is done, 0 out of contact; UFL."""
        grown = 1 - (1 - memory) * ufl.exp(-lapse / self.time)
        return ufl.conditional(ufl.gt(p, 0.0), grown, 0.0)


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
