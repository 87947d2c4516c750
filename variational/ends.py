r"""How fast the ends of contact move as a state changes.

As an end moves over a facet, points come into contact one by one, and the end that is located within the facet
(:meth:`variational.surface.Surface.closed_length`) moves by fits and starts: at fixed points in contact the derivative
of a ridge's length is wrong by up to a half. The facets next to it are in full contact. The pressure falls as a root,
so that the square of it is smooth up to the end; in the contact of cylinders it is a parabola (Johnson 1985, Contact
Mechanics, Eq. 4.43). A cubic q(x) goes through the means of :math:`p^2` over facets beside both ends of a contact, in
the least squares, and another one through their derivatives at fixed places. An end is a root of the first, and

.. math:: q(x_e) = 0, \qquad \dot x_e = -\dot q(x_e) / q'(x_e)
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from variational.contact.formulation import SurfaceState
from variational.surface import Surface

Array = NDArray[np.float64]
_FACETS = 5  # beside each end; the last one in contact is left out
_POWERS = np.arange(4)
_ITERATIONS = 6  # of Newton's method, from the last facets' middles to the roots


class Ends:
    """The ends of the contacts of a state on all ranks.

    Attributes:
        located: of each ridge whether its ends are found; not where a contact has few facets, or is as wide as they.
    """

    def __init__(self, surface: Surface, state: SurfaceState) -> None:
        """Find the contacts, and the facets beside their ends; collective."""
        self._surface, ridges = surface, len(surface.ridge_numbers)
        self._p_n, place = state.p_n, surface.ends()[:, :, 0].mean(axis=1)
        means = self._means(state.x, state.p_n**2)
        place, ridge, closed, x, squares = self._together(place, surface.ridge, np.any(state.p_n > 0, axis=1), *means)
        order = np.lexsort((place, ridge))
        ridge, closed = ridge[order], closed[order]
        inside = np.concatenate([[False], closed[1:] & closed[:-1] & (ridge[1:] == ridge[:-1]), [False]])
        first, last = np.flatnonzero(closed & ~inside[:-1]), np.flatnonzero(closed & ~inside[1:])
        at_end = np.concatenate([[True], ridge[1:] != ridge[:-1], [True]])
        few = (last - first < 2 * _FACETS + 1) | at_end[first] | at_end[last + 1]
        self.located = ~np.isin(np.arange(ridges), ridge[first[few]])
        first, last = first[~few], last[~few]
        self._ridge, self._ridges, beside = ridge[first], ridges, np.arange(1, _FACETS + 1)
        self._facets = order[np.concatenate([first[:, None] + beside, last[:, None] - beside], axis=1)]
        ends = x[order[np.stack([first, last], axis=1)]]
        half = np.diff(ends, axis=1) / 2
        t = (x[self._facets] - ends.mean(axis=1, keepdims=True)) / half
        self._fit = np.linalg.pinv(t[:, :, None] ** _POWERS)
        q = self._cubic(squares[self._facets])
        self._slope = _values(q, t, 1) / half
        self._roots = np.broadcast_to([-1.0, 1.0], ends.shape)
        for _ in range(_ITERATIONS):
            self._roots = self._roots - _values(q, self._roots) / _values(q, self._roots, 1)
        self._steep = _values(q, self._roots, 1) / half

    def _means(self, *values: Array) -> list[Array]:
        return [each @ self._surface.weights for each in values]

    def _together(self, *mine: Any) -> list[Any]:
        found = self._surface.mesh.comm.allgather(mine)
        return [np.concatenate(each) for each in zip(*found, strict=True)]

    def _cubic(self, values: Array) -> Array:
        """Return the coefficients of cubics through values at the facets, shape (contacts, 4)."""
        return np.asarray(np.einsum("ckf,cf->ck", self._fit, values))

    def rates(self, change: SurfaceState) -> Array:
        """Return the derivatives of the ridges' lengths (m) along a change of the state, shape (ridges,); collective.

        Args:
            change: derivatives of the values at this rank's points.
        """
        means = self._together(*self._means(change.x, 2 * self._p_n * change.p_n))
        x, squares = (each[self._facets] for each in means)
        q = self._cubic(squares - self._slope * x)
        moves = -_values(q, self._roots) / self._steep
        return np.asarray(np.bincount(self._ridge, np.diff(moves, axis=1)[:, 0], self._ridges), dtype=float)


def _values(cubics: Array, t: Array, order: int = 0) -> Array:
    """Return cubics, shape (n, 4), or their derivatives, at places of their own, shape (n, ...)."""
    powers = t[:, :, None] ** np.maximum(_POWERS - order, 0) * (_POWERS if order else 1)
    return np.asarray(np.einsum("ctk,ck->ct", powers, cubics))
