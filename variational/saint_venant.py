r"""Saint Venant-Kirchhoff solid in plane strain: linear elastic at finite rotation.

.. math:: W = \frac{\lambda}{2} (\operatorname{tr} E)^2 + \mu E : E, \qquad E = \tfrac12 (F^T F - I)

For the nail and its bed, which turn but hardly strain. It softens in large compression, so it is not for skin.
"""

import ufl


def energy(F, lame, shear_modulus):
    """Return the strain energy density W (J/m^3) for Lamé's constants (Pa)."""
    E = (F.T * F - ufl.Identity(2)) / 2
    return lame / 2 * ufl.tr(E) ** 2 + shear_modulus * ufl.inner(E, E)


def lame_constants(young: float, poisson: float) -> tuple[float, float]:
    """Return (lambda, mu) in Pa for Young's modulus (Pa) and Poisson's ratio."""
    return young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))
