"""The named states of a path, as they are kept to be solved again on other meshes, finest where their contact ends.

The pressure falls as a root where contact ends, so that a length in contact has an error of first order in the facets
there, and hardly any from the others. On coarse facets a contact is too short: its end lies outside of where they have
it, by some tenth of a facet to a third. So facets are small over that way.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fingerpad.model.slopes import StateSlopes
from fingerpad.results.fields import View
from fingerpad.results.quantities import FRICTION, RESULTS, in_table
from geometry.parameters import MeshSize
from variational.solvers.state_snapshot import SkinState, StateSnapshot
from variational.state import ContactState

Array = NDArray[np.float64]
_OUTSIDE = 0.3  # of a facet: how far outside of where it is found contact may end
_EDGE_SPACING = 4.0  # small facets between two places about which they are small
_DIGITS = 0.1  # of a small facet: to what places are rounded, so that roundoff of a state changes no mesh


@dataclass(frozen=True)
class State:
    """A state that can be solved again, the same on every rank."""

    snapshot: StateSnapshot
    direction: int
    """The way the bone slides at full slip, zero in normal contact."""
    state: ContactState
    lengths: Array
    """Length in contact (m) of every ridge of the finger, shape (ridges,)."""
    frictions: Array
    """Friction on the skin (N/m), likewise; negative where the bone slides towards x > 0."""
    peaks: Array
    """Highest pressure (Pa), likewise."""
    sed: dict[int, float]
    """Strain energy density (J/m^3) at the Merkel sites of the ridges that can touch."""
    facet: float
    """Length of the facets where contact ends (m)."""
    slopes: StateSlopes | None = None
    """By the numbers of the scene, where they are wanted."""


@dataclass(frozen=True)
class Solve:
    """States on one mesh, and what they cost."""

    states: dict[str, State]
    """By ``uncharged``, ``charged`` and ``full_slip``."""
    mesh: MeshSize
    unknowns: int
    factorisations: int
    processor_seconds: float
    """Of this rank."""
    newton: int = 0
    """Newton iterations."""
    stiffer: "Solve | None" = None
    """The states over a screen of twice the stiffness, on the same mesh."""
    soft: str = ""
    """Why they were not found, where they were wanted."""
    doubts: tuple[str, ...] = ()
    """States that roundoff may have chosen among others, in words."""
    views: dict[str, View] = field(default_factory=dict)
    """What tables and pictures show of states that were solved again, by name."""

    def values(self) -> dict[str, float]:
        """Return the quantities of interest, by the prefix of the state and the name of the quantity."""
        return {
            f"{name}_{quantity}": value
            for name, state in self.states.items()
            for quantity, value in quantities(name, state).items()
        }

    def parts(self) -> dict[str, ArrayLike]:
        """Return the same, but for energy densities by ridge, shape (ridges,)."""
        found: dict[str, ArrayLike] = dict(self.values())
        for name, state in self.states.items():
            parts: dict[str, ArrayLike] = {"contact_length": state.lengths, "p_max": state.peaks}
            parts |= {"f_t": -state.frictions, "mu_app": -state.frictions / (state.state.f_ext or math.nan)}
            found |= {f"{name}_{key}": part for key, part in parts.items() if f"{name}_{key}" in found}
        return found


def quantities(name: str, state: State) -> dict[str, float]:
    """Return the quantities of interest of a named state, in SI; friction is that of full slip.

    Without a force that presses the finger there is no coefficient.
    """
    wanted = (key for key in in_table("estimated") if name == "full_slip" or key not in FRICTION)
    values = {quantity: float(getattr(state.state, quantity)) for quantity in wanted}
    found = {quantity: value for quantity, value in values.items() if not math.isnan(value)}
    return found | {f"sed_{j}": value for j, value in state.sed.items()}


def with_values(path: ContactState, final: State) -> ContactState:
    """Return a state as a path has it, with the results that it has on the final mesh; its errors are as before."""
    return replace(path, **{key: getattr(final.state, key) for key in (*RESULTS, "f_ext", "ridges", "mesh_contact")})


def together(solves: Sequence[Solve]) -> Solve:
    """Return the states of solves on meshes of the same sizes as those of one."""
    first, *others = solves
    if not others:
        return first
    over = [solve.stiffer for solve in solves if solve.stiffer is not None]
    return replace(
        first,
        states={name: state for solve in solves for name, state in solve.states.items()},
        views={name: view for solve in solves for name, view in solve.views.items()},
        unknowns=max(solve.unknowns for solve in solves),
        factorisations=sum(solve.factorisations for solve in solves),
        processor_seconds=sum(solve.processor_seconds for solve in solves),
        newton=sum(solve.newton for solve in solves),
        stiffer=together(over) if len(over) == len(solves) else None,
        soft=next((solve.soft for solve in solves if solve.soft), ""),
        doubts=tuple(each for solve in solves for each in solve.doubts),
    )


# -- where contact ends ----------------------------------------------------------------------------------------
def edge_places(ends: Iterable[tuple[Array, float]], size: MeshSize) -> tuple[float, ...]:
    """Return the arc lengths (m), on the side x >= 0 and of the mirror image, about which facets are to be small.

    Args:
        ends: of each state, :func:`contact_ends` and the length of the facets there (m).
        size: of the mesh to be made.
    """
    found = [np.empty(0)]
    for places, facet in ends:
        outwards = np.arange(0.0, _OUTSIDE * facet + _EDGE_SPACING * size.edge / 2, _EDGE_SPACING * size.edge)
        side = np.tile([-1.0, 1.0], len(places) // 2)
        found.append((places + side * outwards[:, None]).ravel())
    unit = _DIGITS * size.edge
    return tuple(float(k * unit) for k in np.unique(np.rint(np.abs(np.concatenate(found)) / unit)))


def contact_ends(snapshot: StateSnapshot, along: Callable[[Array], Array], facet: float) -> Array:
    """Return where contact begins and ends, one after the other, as arc lengths (m).

    Args:
        snapshot: the state.
        along: returns the arc lengths (m) of places on the unloaded skin (m), shape (points, 2).
        facet: length of its facets where contact ends (m); gaps within a contact that are shorter are of the facets.
    """
    found = [_of_ridge(skin, along, facet) for skin in snapshot.skin.values() if (skin.gap < 0).any()]
    return np.concatenate([np.empty(0), *found])


def _of_ridge(skin: SkinState, along: Callable[[Array], Array], facet: float) -> Array:
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
