r"""A ridge's law: contact and attraction of a smooth skin that stands for a ridged one.

Let a flat, layered skin have equal ridges of period :math:`\lambda`, and another the same layers, but their mean planes
in place of the waves. Both bear the mean traction P. Far from the surface, at a depth of some :math:`\lambda / 2\pi`,
they are alike, so that the ridged one sinks by

.. math:: w_{ridged}(P) = w_{flat}(P) + \delta(P),

and :math:`\delta` is the ridges' own. Let y be the height of the smooth skin over the screen, less that of the ridged
skin's mean plane when its tips touch: :math:`y = -\delta`. One ridge's contact force :math:`f_c`, attraction
:math:`f_{el}` and length in contact :math:`\ell` are tabulated over y, at one voltage, microscale and all, and the
smooth skin gets per reference area

.. math:: p_n = \frac{f_c(y)}{\lambda}, \qquad p_{el} = \frac{f_{el}(y)}{\lambda}, \qquad
          |t_t| \le \mu_0 p_n .

Coulomb's law acts on the contact force, so at full slip :math:`f_T = \mu_0 \int p_n \,dS`, as in the full model; the
contact length is :math:`\int \ell(y) / \lambda \,dS`. A ridge's way to full slip is a spring, of its own tangential
stiffness. Since sliding changes :math:`f_c(y)`, there is a table for either state. The law is single valued: under
voltage a ridge is taken to hang on as it does when it is lifted, up to where it lets go; that one which comes down
jumps on later is left out. At a fold of P over y the table goes on where the force falls.

What the law leaves out is what neighbours do to each other when they are not alike, over some
:math:`\lambda / 2\pi`, and what stretching or bending of the skin does to its ridges.

Between knots the tables are linear, a sum of ramps:
:math:`f(y) = \sum_k c_k \langle y_k - y \rangle_+`, :math:`f = 0` above the last knot.
"""

from dataclasses import dataclass

import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import NDArray

from variational.contact.formulation import Contact, Formulation, Skin, Springs

Array = NDArray[np.float64]
KNOTS = 48
"""Rows of a law, and the most that a table has."""
_GAMMA = 1e9  # Pa/m, by which a pressure becomes an augmented gap; cancels


@dataclass(frozen=True)
class RidgeTable:
    """One ridge over its height; arrays of shape (n,), the heights ascending; forces per out-of-plane length."""

    y: Array
    """Height (m), negative where the ridge is pressed."""
    contact: Array
    """Contact force (N/m), zero from where the ridge has let go."""
    attraction: Array
    """Resultant of the attraction (N/m), zero at the end."""
    length: Array
    """Length in contact (m)."""

    def __post_init__(self) -> None:
        """Refuse what is no table.

        Raises:
            ValueError: heights that do not ascend, forces that do not end with zero, or too many rows.
        """
        if not (np.diff(self.y) > 0).all():
            raise ValueError("heights of a ridge's table do not ascend; make the table anew")
        if self.contact[-1] or self.attraction[-1] or self.length[-1]:
            raise ValueError("a ridge's table ends before its forces vanish; make the table anew")
        if len(self.y) > KNOTS:
            raise ValueError(f"a ridge's table has {len(self.y)} rows; at most {KNOTS}")

    def at(self, y: Array) -> tuple[Array, Array, Array]:
        """Return contact force, attraction (N/m) and length in contact (m) at heights (m)."""
        return tuple(np.interp(y, self.y, values) for values in (self.contact, self.attraction, self.length))  # type: ignore[return-value]


def ramps(y: Array, values: Array) -> Array:
    """Return the c_k of the piecewise linear function through values at ascending knots, the last value zero."""
    slopes = np.concatenate([[0.0], np.diff(values) / np.diff(y)])
    # The first slope goes on below the first knot, whose own ramp is then none.
    slopes[0] = slopes[1]
    return np.concatenate([np.diff(slopes), [-slopes[-1]]])


class RidgeLaw(Formulation):
    """A table as contact with the screen. Its values can be changed between solves; the compiled form stays."""

    def __init__(self, table: RidgeTable, period: float, eps_t: float) -> None:
        """Start with a table.

        Args:
            table: one ridge's.
            period: lambda (m).
            eps_t: tangential stiffness (Pa/m of reference area).
        """
        self.period, self.eps_t = period, eps_t
        self._constants: list[tuple[fem.Constant, fem.Constant, fem.Constant]] = []
        self.set(table)

    def set(self, table: RidgeTable) -> None:
        """Put another table in place."""
        self.table = table
        rows = np.zeros((KNOTS, 3))
        forces = (ramps(table.y, np.asarray(f / self.period, dtype=float)) for f in (table.contact, table.attraction))
        rows[: len(table.y)] = np.stack([table.y, *forces], axis=1)
        self._rows = rows
        for constants, row in zip(self._constants, rows, strict=False):
            for constant, value in zip(constants, row, strict=True):
                constant.value = value

    def _ramps(self, skin: Skin):
        """Return contact and attraction (Pa of reference area); UFL."""
        if not self._constants:
            self._constants = [tuple(skin.constant(float(value)) for value in row) for row in self._rows]  # type: ignore[misc]
        contact = attraction = 0
        for knot, c, a in self._constants:
            ramp = ufl.max_value(knot - skin.y, 0.0)
            contact, attraction = contact + c * ramp, attraction + a * ramp
        return contact, attraction

    def springs(self, skin: Skin) -> Springs:
        """Return springs preloaded so that the contact pressure is the law's."""
        gamma = skin.constant(_GAMMA)
        return Springs(self._ramps(skin)[0] + gamma * skin.y, 0.0, gamma, skin.constant(self.eps_t))

    def virtual_work(self, skin: Skin, contact: Contact, v):
        """Return the work of contact, friction and attraction."""
        return super().virtual_work(skin, contact, v) + self._ramps(skin)[1] * v[1]
