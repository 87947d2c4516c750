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

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Penalty(Formulation):
    """Stiffness of the screen, normal and tangential (Pa/m of reference area)."""

    eps_n: float = parameter(1e7, 1e17, "Pa/m", default=1.5e12)
    """Normal stiffness (Pa/m of reference area). *Assumption*: the default keeps the penetration below a tenth of d_eq.
    Range: at 1e7 the finger sinks in by millimetres; at 1e17 the roundoff of a length of 1 mm is 20 kPa."""
    eps_t: float = parameter(1e6, 1e17, "Pa/m", default=5e10)
    """Tangential stiffness (Pa/m of reference area) (*assumption*)."""

    less_penetration: ClassVar[str] = "a larger eps_n of the contact reduces it"

    def __post_init__(self) -> None:
        """Refuse negative stiffnesses; without any there is no screen.

        Raises:
            ValueError: one that is below 0 or not finite.
        """
        refuse_not_positive(self, zero=True)

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
