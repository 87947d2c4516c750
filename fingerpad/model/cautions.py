"""Cautions on states: where the closure is outside of its range or overestimates, or the skin is deep in the screen.

They belong to a state, whatever computed it: runs, bodies, cheaper models and tables of the microscale take them here.
"""

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fingerpad.model.adhesion import without_load
from variational.contact.formulation import Formulation
from variational.roughness.closure import Closure, air_gaps
from variational.roughness.tabulated import TabulatedClosure
from variational.state import ContactState

Array = NDArray[np.float64]
BALANCED = 0.1
"""Part of the pressure in contact from which its attraction is overestimated by some 8 %."""
_SHARE = 0.1  # of the contact force, from which ridges outside of the closure's range are mentioned
_MADE = 1e-6  # of the largest dissipation of a branch at a point: roundoff of the others'
_DEEP = 0.1  # of the air gap: largest penetration that is of no matter


def on_states(
    states: Iterable[ContactState], closure: Closure | None, formulation: Formulation | None = None
) -> list[str]:
    """Return the cautions on states of a body.

    Args:
        states: in any order; those without contact have none, and those without a voltage none on the closure.
        closure: from a ridge's pressure to its air gap; without it there are none on it.
        formulation: of the contact, which has the remedy against deep skin; None of states without a mesh.
    """
    states = list(states)
    viscous = _made_energy(states)
    touching = [state for state in states if state.contact_length > 0]
    if closure is None or not touching:
        return viscous
    charged = [(*_pressures(state), state.voltage) for state in touching if state.voltage]
    held = without_load(touching, closure)
    return [*held, *on_closure(closure, charged, "states"), *_deep(touching, closure, formulation), *viscous]


def on_closure(closure: Closure, points: Sequence[tuple[ArrayLike, ArrayLike, float]], noun: str) -> list[str]:
    """Return how many points have ridges under a tenth of the contact force or more outside of the closure's range.

    Args:
        closure: its :meth:`variational.roughness.closure.Closure.state` names the places.
        points: pressure (Pa) and contact force of each ridge, and the voltage (V).
        noun: what the points are.
    """
    counts = Counter[str]()
    for p_c, force, voltage in points:
        borne = defaultdict[str, float](float)
        for pressure, share in zip(np.atleast_1d(p_c), np.atleast_1d(force) / np.sum(force), strict=True):
            borne[closure.state(float(pressure), voltage)] += float(share)
        counts.update(place for place, share in borne.items() if place and share >= _SHARE)
    return [
        f"in {count} of {len(points)} {noun} the closure is out of its range: the mean pressure of ridges is {place}"
        for place, count in counts.items()
    ] + _undeformed(closure, points, noun)


def _undeformed(closure: Closure, points: Sequence[tuple[ArrayLike, ArrayLike, float]], noun: str) -> list[str]:
    """Return the caution on attraction in contact that the closure takes as a load, though it is balanced there."""
    if not isinstance(closure, TabulatedClosure):
        return []
    shares = [float(closure.balanced(p_c, voltage).max(initial=0.0)) for p_c, _, voltage in points]
    count = sum(share >= BALANCED for share in shares)
    if not count:
        return []
    return [
        f"in {count} of {len(points)} {noun} the closure {type(closure).__name__} overestimates the attraction, which "
        f"deforms the asperities: it balances up to {100 * min(max(shares), 1.0):.0f} % of the pressure in contact "
        "(overestimated by 11 % at a share of 14 %, by 85 % at 50 %: docs/microscale.md); the values are upper bounds, "
        "and roughness.field_in_contact=false gives lower ones"
    ]


def _pressures(state: ContactState) -> tuple[Array, Array]:
    """Return pressure (Pa) and contact force (N/m) of each ridge in contact, of all as one where they are not kept."""
    if state.ridges is None:
        return np.array([state.f_contact / state.contact_length]), np.array([state.f_contact])
    inside = state.ridges.length > 0
    return state.ridges.p_c[inside], state.ridges.f_contact[inside]


def _deep(touching: Sequence[ContactState], closure: Closure, formulation: Formulation | None) -> list[str]:
    """Return the caution on states whose penetration is more than a tenth of the least air gap in contact."""
    found = [
        (state.record.penetration, float(air_gaps(closure, _pressures(state)[0]).min()))
        for state in touching
        if state.record is not None
    ]
    deep = [(depth, gap) for depth, gap in found if depth > _DEEP * gap]
    if not deep:
        return []
    depth, gap = max(deep, key=lambda each: each[0] / each[1])
    return [
        f"in {len(deep)} of {len(found)} states the skin is deeper in the screen than a tenth of the air gap, "
        f"{depth * 1e6:.2g} µm where the gap is {gap * 1e6:.2g} µm: attraction and contact length depend on the depth"
        + ("" if formulation is None else f"; {formulation.less_penetration}")
    ]


def _made_energy(states: Sequence[ContactState]) -> list[str]:
    """Return the caution on branches of viscous layers that made energy at a point."""
    least = [state.record.viscous_least for state in states if state.record is not None]
    found = [each for each in least if each < -_MADE]
    if not found:
        return []
    return [
        f"in {len(found)} of {len(least)} steps branches of viscous layers made energy at points and dissipated none, "
        f"up to {-min(found):.1g} of the largest dissipation: quasi-linear viscoelasticity allows that at large "
        "strain, and no material does"
    ]
