"""The contact's half-width from the skin's displaced nodes, the same for every program."""

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from benchmarks.peers.exchange import Ridge, State

_TO_POWERS = np.linalg.inv(np.vander([0.0, 1.0, 0.5], increasing=True))  # of the coordinate along an edge


def half_width(ridge: Ridge, state: State) -> float:
    """Return half the current length (mm) of the skin below the plane, its ends located inside edges."""
    places = ridge.points[ridge.skin] + np.array(state.displacement).reshape(-1, 3, 2)
    return sum(_length_below(edge) for edge in places) / 2


def _length_below(edge: NDArray[np.float64]) -> float:
    """Return the length over which the parabola through an edge's nodes, shape (3, 2), has y < 0."""
    x, y = (Polynomial(_TO_POWERS @ z) for z in edge.T)
    if edge[:, 1].max() < 0 or (edge[:, 1] > 0).all():
        cuts = [0.0, 1.0]
    else:
        roots = y.roots()
        real = roots[np.abs(np.imag(roots)) < 1e-12].real
        cuts = [0.0, *np.sort(real[(real > 0) & (real < 1)]), 1.0]
    gauss, weights = np.polynomial.legendre.leggauss(6)
    length = 0.0
    for a, b in zip(cuts, cuts[1:], strict=False):
        if y((a + b) / 2) < 0:
            xi = (a + b) / 2 + (b - a) / 2 * gauss
            length += (b - a) / 2 * float(weights @ np.hypot(x.deriv()(xi), y.deriv()(xi)))
    return length
