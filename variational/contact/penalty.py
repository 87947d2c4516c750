r"""Contact as springs of the screen, a penalty.

.. math:: \lambda_n = \lambda_t = 0, \qquad \gamma_n = \epsilon_n, \quad \gamma_t = \epsilon_t

in :mod:`~variational.contact.formulation`: :math:`p_n = \epsilon_n \langle -y \rangle_+` (Wriggers, Computational
Contact Mechanics, 2nd ed., ch. 6). The skin sinks by :math:`p_n / \epsilon_n`, and what sticks yields by
:math:`t_t / \epsilon_t`; without friction the tangent is symmetric.
"""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from variational.coefficients import parameter, refuse_not_positive
from variational.contact.formulation import Formulation, Skin, Springs, SurfaceState
from variational.contact.friction import Friction

Array = NDArray[np.float64]
_BY_AREA = 0.1  # of the tangential stiffness


@dataclass(frozen=True)
class Penalty(Formulation):
    """Stiffness of the screen, normal and tangential (Pa/m of reference area)."""

    eps_n: float = parameter(1e7, 1e17, "Pa/m", default=1.5e12)
    """Normal stiffness (Pa/m of reference area). *Assumption*: the default keeps the penetration below a tenth of d_eq.
    Range: at 1e7 the finger sinks in by millimetres; at 1e17 the roundoff of a length of 1 mm is 20 kPa."""
    eps_t: float = parameter(1e6, 1e17, "Pa/m", default=5e10)
    """Tangential stiffness (Pa/m of reference area) (*assumption*). A law of friction that goes by the area in contact,
    as Derjaguin's, has a tenth of it."""

    less_penetration: ClassVar[str] = "a larger eps_n of the contact reduces it"

    def __post_init__(self) -> None:
        """Refuse negative stiffnesses; without any there is no screen.

        Raises:
            ValueError: one that is below 0 or not finite.
        """
        refuse_not_positive(self, zero=True)

    def beside(self, friction: Friction | None) -> "Penalty":
        """Return softer tangential springs beside a law that goes by area.

        A point sticks within limit / eps_t of its anchor, and by such a law it has the whole limit as soon as it
        touches: Newton's method throws it from slipping one way to slipping the other, past where it sticks. On the
        default finger with tau_0 of 12.1 kPa, pressed and slid at 75 N/m, a tenth of eps_t takes 46 factorisations and
        not 302. Full slip does not depend on it; a point slips some um later.
        """
        return replace(self, eps_t=self.eps_t * _BY_AREA) if friction is not None and friction.by_area else self

    def springs(self, skin: Skin) -> Springs:
        """Return springs without preload."""
        return Springs(0.0, 0.0, skin.constant(self.eps_n), skin.constant(self.eps_t))

    def over_stiffer_screen(self) -> "Penalty":
        """Return springs of twice the stiffness, normal and tangential."""
        return replace(self, eps_n=2 * self.eps_n, eps_t=2 * self.eps_t)

    def stored(self, state: SurfaceState) -> Array:
        """Return the energy of the springs (J/m^2 of reference area)."""
        return np.asarray((state.p_n**2 / self.eps_n + state.t_t**2 / self.eps_t) / 2)

    def slip(self, before: SurfaceState, after: SurfaceState) -> Array:
        """Return how far the tangential springs were dragged (m)."""
        return after.anchor - before.anchor
