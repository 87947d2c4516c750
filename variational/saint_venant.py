r"""Saint Venant-Kirchhoff solid in plane strain: linear elastic at finite rotation.

.. math:: W = \frac{\lambda}{2} (\operatorname{tr} E)^2 + \mu E : E,
          \qquad E = \tfrac12 (F^T F - I) = \tfrac12 (H + H^T + H^T H)

For the nail and its bed, which turn but hardly strain. It softens in large compression, so it is not for skin. The
strain is written in the displacement gradient H = F - I: of a nail of 170 MPa whose strains are 1e-6 the difference
of F^T F and I would lose six digits, and nodal forces of 1e-11 N/m with them.
"""

import ufl


def energy(H, lame, shear_modulus):
    """Return the strain energy density W (J/m^3) for a displacement gradient H, (2, 2), and Lamé's constants (Pa)."""
    E = (H + H.T + H.T * H) / 2
    return lame / 2 * ufl.tr(E) ** 2 + shear_modulus * ufl.inner(E, E)


def lame_constants(young: float, poisson: float) -> tuple[float, float]:
    """Return (lambda, mu) in Pa for Young's modulus (Pa) and Poisson's ratio."""
    return young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))
