r"""The effect of a penalty, from the same states over a screen of twice the stiffness.

Springs of stiffness :math:`\epsilon` let the skin sink in by :math:`p_n / \epsilon`, which makes its contact longer.
For an error of :math:`C \epsilon^{-p}` of a quantity, two stiffnesses give the change by a rigid screen:

.. math:: q_{rigid} - q(\epsilon) = \frac{q(2 \epsilon) - q(\epsilon)}{1 - 2^{-p}}

The mesh is the same, so that one more solve of some factorisations does; skin that is too low for the stiffer springs
comes out of the screen in a step or two, where softer ones would have to be reached point by point.

The springs act over :math:`\ell = E / \epsilon` from an edge of contact, E the skin's modulus: 0.2 um by default, on
ridges of a half-width a of some 50 um. Without attraction the length of a contact grows by some
:math:`\ell \ln(a / \ell)`, whose order about there is :math:`1 - 1 / \ln(a / \ell) = 0.8`; of a light finger (5 N/m,
200 V, facets of 2.5 um) it is 0.7 from three stiffnesses, and p is :data:`ORDER`. The share is known to a factor of
two: what 5000 MPa/mm change in the default scene is beside what 500 and 1500 predict in ``docs/accuracy.md``. Of that
light finger's 482 um at full slip 7.1 um are predicted to go; ten times the stiffness takes off 6.6 um, and Nitsche's
method tends to 6 um less than the penalty. For friction, which hardly depends on the penalty, only the order of
magnitude is right. On facets far longer than :math:`\ell` a much stiffer screen holds the skin at single Gauss points:
an error of the mesh, and not in here.

Nitsche's method has no such part: its conditions are exact on any mesh. An augmented Lagrangian leaves gaps of up to
``contact.tolerance``, 5 nm by default where the penalty's penetration is of the order of 100 nm: negligible beside the
error of the mesh.
"""

from collections.abc import Mapping
from dataclasses import replace

from variational.solvers.transfer import StateSnapshot

ORDER = 0.75
"""In one over the stiffness, of what the penalty changes."""


def over_stiffer(snapshot: StateSnapshot) -> StateSnapshot:
    """Return a state whose springs, of twice the stiffness, bear the same friction."""
    halved = {j: {**ridge.history, "anchor": ridge.history["anchor"] / 2} for j, ridge in snapshot.skin.items()}
    skin = {j: replace(ridge, history=halved[j]) for j, ridge in snapshot.skin.items()}
    return replace(snapshot, skin=skin)


def rigid(values: Mapping[str, float], stiffer: Mapping[str, float]) -> dict[str, float]:
    """Return by how much a rigid screen would change each quantity, in its unit.

    Args:
        values: at the stiffness in use.
        stiffer: at twice that.
    """
    return {name: (stiffer[name] - value) / (1 - 2**-ORDER) for name, value in values.items() if name in stiffer}
