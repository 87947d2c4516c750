r"""Contact by an augmented Lagrangian with Uzawa's iteration.

.. math:: \gamma_n = \epsilon_n, \quad \gamma_t = \epsilon_t, \qquad
          \lambda_n \leftarrow p_n, \quad \lambda_t \leftarrow t_t

in :mod:`~variational.contact.formulation`, the multipliers kept at the Gauss points and corrected after each solve
until the skin neither penetrates nor, where it sticks, has moved by more than a tolerance (Simo and Laursen 1992, doi
10.1016/0045-7949(92)90540-G). Each solve is one of the penalty's, and the stiffness decides how fast the iteration
contracts, not what it ends in. It is slow for tractions that the displacement hardly depends on: a facet has more Gauss
points than displacements of its own. These tractions stay undetermined, and friction goes with them: at full slip it
depends on the load path and creeps as the body slides on, less on finer facets.

The slip of a step counts from the accepted place :math:`x_n`, so that
:math:`t^{tr} = \lambda_t - \epsilon_t (x - x_n) = -\epsilon_t (x - a)`: :math:`\lambda_t` is folded into the anchor,
:math:`a = x_n + \lambda_t / \epsilon_t`.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from variational.caution import Caution
from variational.coefficients import parameter
from variational.contact.formulation import Contact, Formulation, History, Skin, Springs, SurfaceState
from variational.contact.friction import CONE_ROUNDOFF, Friction


@dataclass(frozen=True)
class AugmentedLagrangian(Formulation):
    """Stiffness, normal and tangential (Pa/m of reference area), and what is left of penetration and slip (m)."""

    eps_n: float = parameter(1e7, 1e17, "Pa/m", default=1.5e13)
    """Normal stiffness (Pa/m of reference area), ten times the penalty's, which saves coupling iterations."""
    eps_t: float = parameter(1e6, 1e17, "Pa/m", default=5e11)
    """Tangential stiffness (Pa/m of reference area)."""
    tolerance: float = parameter(1e-12, 1e-6, "m", default=5e-9)
    """Penetration and elastic slip (m) at which the augmented Lagrangian's iteration ends. The default is a
    three-hundredth of the smallest d_eq. Range: from roundoff to the size of the air gap."""

    symmetric_start: ClassVar[bool] = False  # its multipliers, corrected within a step, are not put on the whole
    less_penetration: ClassVar[str] = "a smaller tolerance of the contact reduces it"

    def cautions(self) -> list[Caution]:
        """Return that the method is for comparison."""
        text = (
            "contact by a method for comparison, which takes several times the factorisations of the penalty and may "
            "miss equilibria that it finds"
        )
        return [Caution("contact_compared", text)]

    def springs(self, skin: Skin) -> Springs:
        """Return springs that the multiplier preloads."""
        return Springs(skin.multiplier, 0.0, skin.constant(self.eps_n), skin.constant(self.eps_t))

    def opening(self, skin: Skin, contact: Contact):
        """Return the gap where it is open, elsewhere the pressure over the skin's own stiffness, negative.

        The augmented gap has a kink at the edge of contact, as sharp as eps_n is stiff, which would spoil the
        interpolation by which the edge is located in a facet; over the skin's stiffness the two are alike.
        """
        import ufl

        return ufl.conditional(ufl.lt(contact.gap, 0.0), -contact.p_n / skin.stiffness(), skin.y)

    def error(self, state: SurfaceState, history: History, friction: Friction | None) -> float:
        """Return the largest depth, or opening under pressure, and elastic slip at this rank's points (m)."""
        depth = np.abs(state.p_n - history["pressure"]) / self.eps_n
        sticking = (state.p_n > 0) & (np.abs(state.t_t) < state.limit * (1 - CONE_ROUNDOFF))
        slip = np.where(sticking, np.abs(state.x - history["x"]), 0.0)
        return float(max(depth.max(initial=0.0), slip.max(initial=0.0)))

    def corrected(self, state: SurfaceState, history: History) -> History:
        """Return the history with the tractions of a solve as multipliers; the accepted place stays."""
        return {**history, "pressure": state.p_n, "anchor": state.anchor - (state.x - history["x"])}
