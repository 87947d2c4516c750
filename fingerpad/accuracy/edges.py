"""Arc lengths of contact edges, where the final mesh is refined.

The pressure falls as a root where contact ends, so that a length in contact has an error of first order in the facets
there, and hardly any from the others. On coarse facets a contact is too short: its end lies outside of where they have
it, by some tenth of a facet to a third. So facets are small over that way.
"""

from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import NDArray

from geometry.parameters import MeshSize
from variational.solvers.state_snapshot import SkinState, StateSnapshot

Array = NDArray[np.float64]
Along = Callable[[Array], Array]
_OUTSIDE = 0.3  # of a facet: how far outside of where it is found contact may end
_APART = 4.0  # small facets between two places about which they are small
_DIGITS = 0.1  # of a small facet: to what places are rounded, so that roundoff of a state changes no mesh


def about(ends: Iterable[tuple[Array, float]], size: MeshSize) -> tuple[float, ...]:
    """Return the arc lengths (m), on the side x >= 0 and of the mirror image, about which facets are to be small.

    Args:
        ends: of each state, :func:`ends` and the length of the facets there (m).
        size: of the mesh to be made.
    """
    found = [np.empty(0)]
    for places, facet in ends:
        outwards = np.arange(0.0, _OUTSIDE * facet + _APART * size.edge / 2, _APART * size.edge)
        side = np.tile([-1.0, 1.0], len(places) // 2)
        found.append((places + side * outwards[:, None]).ravel())
    unit = _DIGITS * size.edge
    return tuple(float(k * unit) for k in np.unique(np.rint(np.abs(np.concatenate(found)) / unit)))


def ends(snapshot: StateSnapshot, along: Along, facet: float) -> Array:
    """Return where contact begins and ends, one after the other, as arc lengths (m).

    Args:
        snapshot: the state.
        along: returns the arc lengths (m) of places on the unloaded skin (m), shape (points, 2).
        facet: length of its facets where contact ends (m); gaps within a contact that are shorter are of the facets.
    """
    found = [_of_ridge(skin, along, facet) for skin in snapshot.skin.values() if (skin.gap < 0).any()]
    return np.concatenate([np.empty(0), *found])


def _of_ridge(skin: SkinState, along: Along, facet: float) -> Array:
    s = along(skin.reference)
    order = np.argsort(s)
    s, gap = s[order], skin.gap[order]
    closed = np.concatenate([[False], gap < 0, [False]])
    first, last = np.flatnonzero(closed[1:-1] & ~closed[:-2]), np.flatnonzero(closed[1:-1] & ~closed[2:])
    if not len(first):
        return np.empty(0)
    wide = s[first[1:]] - s[last[:-1]] > facet
    first, last = first[np.concatenate([[True], wide])], last[np.concatenate([wide, [True]])]
    return np.column_stack([_end(s, gap, first, -1), _end(s, gap, last, 1)]).ravel()


def _end(s: Array, gap: Array, inside: NDArray[np.int64], way: int) -> Array:
    """Return where the gap is zero between the last point inside and the next one."""
    outside = np.clip(inside + way, 0, len(s) - 1)
    rise = gap[outside] - gap[inside]
    part = np.divide(-gap[inside], rise, out=np.zeros(len(inside)), where=rise > 0)
    return np.asarray(s[inside] + np.clip(part, 0.0, 1.0) * (s[outside] - s[inside]))
