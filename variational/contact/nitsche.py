r"""Contact by Nitsche's method: the skin's own traction stands where a spring's would.

.. math:: \lambda = P N - p_{el}\, \mathrm{cof} F N, \qquad \gamma_n = \gamma_t = \gamma_0 \frac{M}{h}

in :mod:`~variational.contact.formulation`, with the facet's length h, and the virtual work

.. math:: - \int p_n v_y + t_t v_x \,dS + \theta \int \frac{p_n - \lambda_n}{\gamma} D(P N)_y[v]
          + \frac{t_t - \lambda_t}{\gamma} D(P N)_x[v] \,dS

(Chouly, Hild and Renard 2015, doi 10.1090/S0025-5718-2014-02913-X; at finite strain Mlika, Renard and Chouly 2017,
doi 10.1016/j.cma.2017.07.015). The solution fulfils it for any :math:`\gamma`: no penetration is needed to have a
pressure, nor an elastic slip to have friction. The error is that of the elements' traction. :math:`\theta = 1`
without friction and voltage is the derivative of

.. math:: \int W \,dX + \int \frac{p_n^2 + t_t^2 - \lambda_n^2 - \lambda_t^2}{2 \gamma} \,dS

and has a symmetric tangent; :math:`\theta = 0` differentiates P once less; :math:`\theta = -1` lets the products of
traction and displacement cancel in the linear problem, so that it is stable for any :math:`\gamma_0 > 0`. The others
need :math:`\gamma_0` above the constant of an inverse inequality,
:math:`h \int |P N|^2 \,dS \le C M \int W \,dX`, in which M is the constrained modulus :math:`K + 4 G_0 / 3`, normal
traction over normal strain where a facet moves by itself. D acts on P N, not on the attraction, so that a
translation does no work in it and forces balance exactly.
"""

from dataclasses import dataclass, field
from typing import ClassVar

from variational.coefficients import parameter
from variational.contact.formulation import Contact, Formulation, Skin, Springs


@dataclass(frozen=True)
class Nitsche(Formulation):
    """Parameter of the stiffness, and which of the variants: theta = 1, 0 or -1."""

    gamma_0: float = parameter(1e-3, 1e6, default=1.0)
    """Nitsche's stiffness, divided by the skin's constrained modulus per facet length. With 10 no equilibrium was
    found while the default finger was pressed (``docs/errors.md``)."""
    theta: int = field(default=0, metadata={"allowed": (-1, 0, 1)})
    """Variant of Nitsche's method. Variants 1 and -1 compile for longer. Variant 1 needs a larger gamma_0: below it
    stresses can remain in the unloaded skin, which is refused where the finger is lifted."""

    less_penetration: ClassVar[str] = "a larger gamma_0 of the contact or smaller elements reduce it"
    unloaded_energy: ClassVar[str] = (
        "Nitsche's method has such equilibria where gamma_0 is too small, so start again with a larger one"
    )

    def __post_init__(self) -> None:
        """Refuse other variants.

        Raises:
            ValueError: ``theta`` is none of the three, or ``gamma_0`` is not positive.
        """
        super().__post_init__()
        if self.theta not in (1, 0, -1):
            raise ValueError(f"theta of Nitsche is {self.theta!r}; it must be 1, 0 or -1")

    def springs(self, skin: Skin) -> Springs:
        """Return springs preloaded by the skin's traction."""
        traction = skin.elastic() - skin.attraction
        gamma = skin.constant(self.gamma_0) * skin.stiffness()
        return Springs(traction[1], traction[0], gamma, gamma)

    def virtual_work(self, skin: Skin, contact: Contact, v):
        """Return the work of the tractions and theta times the residual of the contact's conditions."""
        import ufl

        work = super().virtual_work(skin, contact, v)
        if self.theta == 0:
            return work
        s = contact.springs
        off = ufl.as_vector([(contact.t_t - s.lambda_t) / s.gamma_t, (contact.p_n - s.lambda_n) / s.gamma_n])
        return work + self.theta * ufl.dot(off, ufl.derivative(skin.elastic(), skin.w, v))
