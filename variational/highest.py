r"""The highest pressure on skin in contact, from mean pressures of facets.

Within a facet the pressure of a penalty is high at both ends and low in the middle, or the other way round, by a per
cent and more: the height of the skin is a polynomial of low degree, and the pressure is that times a large number. The
highest value at a Gauss point is therefore too high. The mean over a facet has no such part. The pressure is taken as
the parabola

.. math:: p(t) = \alpha + \beta t + \gamma t^2, \qquad
          \frac{1}{|I_k|} \int_{I_k} p \, dt = p_k, \quad k = -1, 0, 1,

with the same means over three facets :math:`I_k`, as finite volumes reconstruct a density from averages (Colella and
Woodward 1984, doi 10.1016/0021-9991(84)90143-8), where its top lies on the middle one.
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_SAME = 1e-12  # m, within which places are the same
_TO_THE_END = 1 + 1e-6  # of half a facet, so that a top between two is on one of them
_LEAST = 0.1  # of a facet: what a Gauss point stands for, at least about


def highest(force: Array, width: Array, closed: Array, ends: Array) -> float:
    """Return the highest pressure (Pa), zero without contact.

    Args:
        force: contact force per length of each facet (N/m), shape (facets,).
        width: current length of each facet (m).
        closed: its part in contact (m).
        ends: reference places of its ends (m), shape (facets, 2, 2).

    A mean counts, too: of a facet that is partly in contact that over this part.
    """
    touching = (force > 0) & (closed > 0)
    if not touching.any():
        return 0.0
    before, after = _neighbours(ends)
    mean = force / width
    inside = np.flatnonzero(touching & (before >= 0) & (after >= 0) & (closed >= 0.5 * width))
    around = np.stack([before[inside], inside, after[inside]], axis=1)
    means = force[touching] / np.maximum(closed, _LEAST * width)[touching]
    return float(np.concatenate([means, _tops(mean[around], width[around])]).max())


def _neighbours(ends: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the facet beyond each facet's first and second end, -1 where there is none."""
    places = np.rint(ends.reshape(-1, 2) / _SAME).astype(np.int64)
    _, vertex = np.unique(places, axis=0, return_inverse=True)
    vertex = np.asarray(vertex).ravel()
    order = np.argsort(vertex, kind="stable")
    same = np.flatnonzero(vertex[order[1:]] == vertex[order[:-1]])
    beyond = np.full(len(vertex), -1)
    beyond[order[same]], beyond[order[same + 1]] = order[same + 1] // 2, order[same] // 2
    return beyond[::2], beyond[1::2]


def _tops(mean: Array, width: Array) -> Array:
    """Return the highest values of parabolas with given means over three facets, of those that have it on the middle.

    Args:
        mean: (Pa), shape (parabolas, 3).
        width: of the facets (m), likewise.
    """
    half = width[:, 1] / 2
    edges = np.stack([-half - width[:, 0], -half, half, half + width[:, 2]], axis=1)
    a, b = edges[:, :-1], edges[:, 1:]
    moments = np.stack([np.ones_like(a), (a + b) / 2, (a * a + a * b + b * b) / 3], axis=2)
    alpha, beta, gamma = np.linalg.solve(moments, mean[:, :, None])[:, :, 0].T
    on = (gamma < 0) & (np.abs(beta) <= -2 * gamma * half * _TO_THE_END)
    return np.asarray(alpha[on] - beta[on] ** 2 / (4 * gamma[on]))
