r"""Elements for skin that hardly changes its volume.

The energy of the skin has two parts, :math:`W = W_{iso}(F) + \frac K2 (J - 1)^2`. As Poisson's ratio nears 1/2 the
second asks for J = 1 wherever it is integrated, and with more such conditions than the displacement can meet the
element locks. By name:

``"P1"``, ``"P2"``
    Displacement alone: the condition at one point of a triangle with three nodes, at three of one with six. The
    first locks; the second only loses an order.
``"P3"``
    The same with ten nodes and six points.
``"P2 reduced"``
    Selective reduced integration: the volumetric part at the centroid alone, the rest at three points. In small
    strain it is the same as a constant pressure on each triangle (Malkus and Hughes 1978,
    doi 10.1016/0045-7825(78)90005-1).
``"P2-P1"``
    A pressure p of its own, positive in tension (perturbed Lagrangian; Sussman and Bathe 1987,
    doi 10.1016/0045-7949(87)90265-3): a stationary point of

    .. math:: \int W_{iso}(F) + p (J - 1) - \frac{p^2}{2K} \,dX,

    so that p = K (J - 1) weakly. u is quadratic; p is linear and continuous inside a layer (Taylor and Hood), but
    jumps from one layer to the next, as the true one does: what is continuous is the traction, not its volumetric
    part. With a pressure continuous throughout, two layers pressed flat would already have a wrong stress.

A law without a volumetric part of its own (Saint Venant-Kirchhoff: nail and bed, nu = 0.3) is integrated in full
in all of them, and has no pressure.
"""

from dataclasses import dataclass

import ufl
from dolfinx import fem


@dataclass(frozen=True)
class Element:
    """How displacement and volume are approximated."""

    degree: int
    """Polynomial degree of the displacement."""
    reduced: bool = False
    """Whether the volumetric energy is integrated at the centroid alone."""
    mixed: bool = False
    """Whether there is a pressure."""

    @property
    def quadrature_degree(self) -> int:
        """Degree up to which energies are integrated: linear elasticity exactly, so that the order is kept."""
        return max(2 * (self.degree - 1), 1)  # strains are of degree p - 1

    @property
    def volumetric_degree(self) -> int:
        """The same for the volumetric part."""
        return 1 if self.reduced else self.quadrature_degree


ELEMENTS = {
    "P1": Element(1),
    "P2": Element(2),
    "P2 reduced": Element(2, reduced=True),
    "P2-P1": Element(2, mixed=True),
    "P3": Element(3),
}


def at_centroid(H, centroids: fem.Function):
    """Return H (2, 2) at its triangle's centroid, for a displacement of degree 2 at most; ``centroids`` in m."""
    return H + ufl.dot(ufl.grad(H), centroids - ufl.SpatialCoordinate(centroids.function_space.mesh))
