r"""Unilateral contact with the rigid screen y = 0 by a penalty.

.. math:: p_n = \epsilon_n \langle -g_n \rangle_+

per reference area, with the normal gap g_n = current height (Wriggers, Computational Contact Mechanics,
2nd ed., ch. 6). The virtual work of the contact on the skin is :math:`\int p_n v_y \,dS`; its derivative is
symmetric.
"""

import ufl


def pressure(g_n, eps_n):
    """Return the contact pressure p_n >= 0 (Pa of reference area) for a gap (m) and a stiffness (Pa/m)."""
    return ufl.conditional(ufl.lt(g_n, 0.0), -eps_n * g_n, 0.0)
