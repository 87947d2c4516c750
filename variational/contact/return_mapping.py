r"""Friction on the screen by return mapping (Forsbach et al. 2023, Eqs. 6 and 7).

.. math:: t^{tr} = \lambda_t - \gamma_t (u_x - s_n), \qquad
          t_t = t^{tr} \min\left(1, t_{max} / |t^{tr}|\right), \qquad s_{n+1} = u_x + (t_t - \lambda_t) / \gamma_t

per reference area (Simo and Laursen 1992, doi 10.1016/0045-7949(92)90540-G, for :math:`\lambda_t = 0`), with the limit
:math:`t_{max}(p_n)` of a law of :mod:`~variational.contact.friction`. The one history
variable is the anchor s: the place of a sticking point where the spring would be slack, and where :math:`\lambda_t` is
its traction, the place itself. A point without contact carries its anchor along. The virtual work is
:math:`\int t_t v_x \,dS`. Where a point slips, its derivative with respect to the pressure makes the tangent
unsymmetric.
"""


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
