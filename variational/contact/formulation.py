r"""Unilateral contact and friction by projecting trial tractions: what every formulation has in common.

Per reference area of the skin, over the screen y = 0, a formulation gives tractions :math:`\lambda_n, \lambda_t` and
stiffnesses :math:`\gamma_n, \gamma_t`, and

.. math:: p_n = \langle \lambda_n - \gamma_n y \rangle_+, \qquad
          t_t = \Pi_{|t| \le t_{max}(p_n)} \left( \lambda_t - \gamma_t (u_x - s) \right)

With the traction itself for :math:`\lambda` these are Signorini's conditions and a law of friction with the limit
:math:`t_{max}` (:mod:`~variational.contact.friction`; Coulomb's is :math:`\mu_f p_n`), for any positive
:math:`\gamma` (Alart and Curnier 1991, doi 10.1016/0045-7825(91)90022-X); with zero they are those of springs. The
virtual work of the contact on the skin is :math:`\int p_n v_y + t_t v_x \,dS`. A point is in contact where the
augmented gap :math:`\hat g = y - \lambda_n / \gamma_n` is negative.

Friction on the screen is by return mapping (Forsbach et al. 2023, Eqs. 6 and 7),

.. math:: t^{tr} = \lambda_t - \gamma_t (u_x - s_n), \qquad
          t_t = t^{tr} \min\left(1, t_{max} / |t^{tr}|\right), \qquad s_{n+1} = u_x + (t_t - \lambda_t) / \gamma_t

per reference area (Simo and Laursen 1992, doi 10.1016/0045-7949(92)90540-G, for :math:`\lambda_t = 0`). Its one history
variable is the anchor s: the place of a sticking point where the spring would be slack, and where :math:`\lambda_t` is
its traction, the place itself. A point without contact carries its anchor along. Where a point slips, the derivative
of the virtual work with respect to the pressure makes the tangent unsymmetric.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from variational.caution import Caution
from variational.coefficients import LawError, Named, refuse_not_positive, said
from variational.contact.friction import Friction, Part

Array = NDArray[np.float64]
STICKS, SLIPS = 1e-9, -1e-9
"""First guesses for points on the friction cone, see :func:`traction`."""


def traction(u_x, anchor, limit, gamma_t, guess=0.0, lambda_t=0.0):
    """Return the tangential traction on the skin (Pa of reference area).

    Args:
        u_x: tangential displacement (m).
        anchor: accepted anchor s_n (m).
        limit: largest friction under the pressure at hand (Pa of reference area).
        gamma_t: tangential stiffness (Pa/m).
        guess: a point that slipped sits on the cone to roundoff when its next step starts; a positive number well
            above roundoff lets it count as sticking then, a negative one as slipping. A point without contact
            is on its cone too.
        lambda_t: traction at the anchor (Pa of reference area).
    """
    import ufl

    trial = lambda_t - gamma_t * (u_x - anchor)
    slipping = ufl.conditional(ufl.gt(trial, 0.0), limit, -limit)
    return ufl.conditional(ufl.ge(abs(trial), (1 + guess) * limit), slipping, trial)


def new_anchor(u_x, t_t, gamma_t, lambda_t=0.0):
    """Return the anchor that a step leaves when it is accepted (m)."""
    return u_x + (t_t - lambda_t) / gamma_t


def pressure(gap, gamma_n):
    """Return the contact pressure p_n >= 0 (Pa of reference area) for an augmented gap (m) and a stiffness (Pa/m)."""
    import ufl

    return ufl.conditional(ufl.lt(gap, 0.0), -gamma_n * gap, 0.0)


@dataclass(frozen=True)
class Skin:
    """Quantities of the touching skin that a formulation may use; UFL, tractions in Pa of reference area."""

    u: Any
    """Displacement (m)."""
    w: Any
    """Displacement relative to the bone (m), by which forms are differentiated."""
    y: Any
    """Current height above the screen (m)."""
    anchor: Any
    """Accepted anchor (m); None without friction."""
    multiplier: Any
    """Accepted contact pressure (Pa), as corrected since."""
    elastic: Callable[[], Any]
    """Gives P N, the traction in the skin."""
    attraction: Any
    """Traction of the attractions, (p_el + p_ad) cof F N."""
    stiffness: Callable[[], Any]
    """Gives the constrained modulus of the skin over the facet's length (Pa/m)."""
    constant: Callable[[float], Any]
    """Gives a constant that leaves the compiled form as it is when its value changes."""
    memory: Any = None
    """Accepted memory of the law of friction; None where it has none."""
    way: Any = None
    """Of the skin over the screen since (m), with a memory."""
    lapse: Any = None
    """Time since (s), with a memory."""
    along: Any = ()
    """Heights (m) along the part of its facet that each point stands for, with a law of friction that goes by area."""


@dataclass(frozen=True)
class Springs:
    """Tractions (Pa) and stiffnesses (Pa/m) of which a formulation makes its trial tractions; UFL."""

    lambda_n: Any
    lambda_t: Any
    gamma_n: Any
    gamma_t: Any


class Contact:
    """The projected tractions; UFL.

    Attributes:
        springs: what the trial tractions are made of.
        gap: augmented gap (m), negative in contact.
        p_n: contact pressure (Pa of reference area).
        t_t: tangential traction on the skin (Pa of reference area).
        traction: the two as a vector (t_t, p_n).
        limit: largest tangential traction (Pa of reference area).
        new_anchor: anchor that a step leaves when it is accepted (m).
        memory: that of the law of friction which a step leaves; None where it has none.
    """

    def __init__(self, skin: Skin, springs: Springs, friction: "Friction | None", guess, ease=1.0) -> None:
        """Project the trial tractions.

        Args:
            skin: what touches.
            springs: what the trial tractions are made of.
            friction: its law, with numbers that UFL can read; None without friction.
            guess: as in :func:`traction`.
            ease: part of the tangential stiffness that acts.
        """
        import ufl

        self.springs = s = springs
        self.gap = skin.y - s.lambda_n / s.gamma_n
        self.p_n = pressure(self.gap, s.gamma_n)
        self.memory = None
        if friction is None:
            self.limit, self.t_t, self.new_anchor = ufl.zero(), ufl.zero(), skin.u[0]
        else:
            part = Part(self.p_n, [s.lambda_n - s.gamma_n * y for y in skin.along])
            if skin.memory is not None:
                self.memory = friction.remembered(skin.memory, part.mean, skin.way, skin.lapse)
            self.limit = _limit(friction, part, self.memory)
            self.t_t = traction(skin.u[0], skin.anchor, self.limit, ease * s.gamma_t, guess, s.lambda_t)
            self.new_anchor = new_anchor(skin.u[0], self.t_t, s.gamma_t, s.lambda_t)
        self.traction = ufl.as_vector([self.t_t, self.p_n])


def _limit(friction: Friction, part: Part, memory):
    """Return the limit of friction (Pa) as the weak form has it.

    Raises:
        LawError: the law cannot be written in UFL.
    """
    import ufl

    try:
        return ufl.as_ufl(friction.limit_over(part, *([] if memory is None else [memory])))
    except Exception as error:  # whatever the user's limit raises
        raise LawError(
            f"the limit of the law {type(friction).__name__} cannot be put into the weak form: {said(error)}; write it "
            "with arithmetic, or with ufl's functions where p is a UFL expression (docs/laws.md)"
        ) from error


History = Mapping[str, Array]
"""Values of the fields of :mod:`variational.history`. Formulations read three of them, at this rank's Gauss points:
``anchor`` of friction (m), contact ``pressure`` (Pa of reference area) and current abscissa ``x`` (m), each of shape
(facets, points)."""


@dataclass(frozen=True)
class SurfaceState:
    """Values at this rank's Gauss points, shape (facets, points)."""

    x: Array
    y: Array
    gap: Array
    """Length (m) that is negative in contact, see :meth:`Formulation.opening`."""
    anchor: Array
    p_n: Array
    t_t: Array
    p_el: Array
    area_x: Array
    area_y: Array
    limit: Array
    """Largest tangential traction (Pa of reference area)."""
    history: History = field(default_factory=dict)
    """What the state leaves in the fields of the skin when it is accepted."""

    @property
    def touching(self) -> NDArray[np.bool_]:
        """Whether the points are in contact, or at least a place in the part of a facet that they stand for."""
        return (self.p_n > 0) | (self.limit > 0)


class Formulation(Named, ABC):
    """How contact and friction enter the weak form: a frozen dataclass, importable without UFL.

    What a run, a check or a report must consider of a formulation is an attribute here; none of them compares names.
    """

    tolerance: float = 0.0
    """Error of the contact's conditions (m) that is left."""
    symmetric_start: ClassVar[bool] = True
    """Whether a state that was reached on one half of a symmetric body can be put on the whole."""
    less_penetration: ClassVar[str] = "a stiffer contact reduces it"
    """Remedy against skin that is too deep in the screen."""
    unloaded_energy: ClassVar[str] = ""
    """Remedy against a body that stores energy without a load; empty where no such equilibria are known."""

    def __post_init__(self) -> None:
        """Refuse numbers that are no stiffness.

        Raises:
            ValueError: one that is not greater than 0 and finite.
        """
        refuse_not_positive(self)

    def beside(self, friction: Friction | None) -> Self:
        """Return the formulation as it is taken beside a law of friction; mostly it is the same."""
        return self

    def cautions(self) -> list[Caution]:
        """Return what a check of a scene prints of the formulation before a run."""
        return []

    @abstractmethod
    def springs(self, skin: Skin) -> Springs:
        """Return what the trial tractions are made of."""

    def over_stiffer_screen(self) -> Self | None:
        """Return the contact over a screen of twice the stiffness; None where the screen is rigid already.

        With one, the effect of a rigid screen is estimated beside the error of the mesh
        (:mod:`fingerpad.accuracy.richardson`).
        """
        return None

    def virtual_work(self, skin: Skin, contact: Contact, v):
        """Return the contact's part of the residual (J/m^2 of reference area) for a test function."""
        import ufl

        return -ufl.dot(contact.traction, v)

    def opening(self, skin: Skin, contact: Contact):
        """Return a length (m), smooth within a facet, that is negative where the augmented gap is."""
        return contact.gap

    def error(self, state: SurfaceState, history: History, friction: "Friction | None") -> float:
        """Return the largest error (m) at this rank's points that :meth:`corrected` can lower; mostly none."""
        return 0.0

    def corrected(self, state: SurfaceState, history: History) -> History:
        """Return the history with which to solve again where there is an error."""
        return history

    def stored(self, state: SurfaceState) -> Array:
        """Return the energy of the contact's springs (J/m^2 of reference area) at the points; mostly there are none."""
        return np.zeros_like(state.p_n)

    def slip(self, before: SurfaceState, after: SurfaceState) -> Array:
        """Return how far each of this rank's points slipped over the screen (m) from one state to the next."""
        return after.x - before.x
