"""What the answers of programs are compared by: forces, half-width, peak pressure."""

from collections.abc import Sequence

import numpy as np
from numpy.polynomial import Polynomial

from benchmarks.peers.exchange import Array, Ridge, State

_TO_POWERS = np.linalg.inv(np.vander([0.0, 1.0, 0.5], increasing=True))  # of the coordinate along an edge


def values(state: State, ridge: Ridge) -> list[float]:
    """Return normal force, friction (N/mm), half-width (mm) and peak pressure (MPa) of a state."""
    return [state.f_n, state.f_t, half_width(ridge, state), max(state.p_n)]


def half_width(ridge: Ridge, state: State) -> float:
    """Return half the current length (mm) of the skin below the plane, its ends located inside edges."""
    places = ridge.points[ridge.skin] + np.array(state.displacement).reshape(-1, 3, 2)
    return sum(_length_below(edge) for edge in places) / 2


def _length_below(edge: Array) -> float:
    """Return the length over which the parabola through an edge's nodes, shape (3, 2), has y < 0."""
    x, y = (Polynomial(_TO_POWERS @ z) for z in edge.T)
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


def differences(found: Sequence[float], reference: Sequence[float]) -> list[float | None]:
    """Return relative differences; None for friction that vanishes by symmetry."""
    judged = (True, abs(reference[1]) > 1e-2 * reference[0], True, True)
    return [a / b - 1 if judge else None for a, b, judge in zip(found, reference, judged, strict=True)]
