"""Differences of a path over time from the same path on another mesh.

Both paths have the same loads. States are compared load by load, by the time since the load began, so that a slide
that ends later on one mesh, at full slip, does not shift what follows. Between two states the other path follows the
monotone cubic curve of Fritsch and Carlson, cut where the voltage jumps. Loads that take no time are compared at their
ends.
"""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from fingerpad.results.over_time import without_parts_of_jumps
from fingerpad.results.states import by_load
from variational.state import ContactState

Array = NDArray[np.float64]
Of = Callable[[ContactState], Array]
Piece = tuple[Array, list[ContactState]]
_TIME_TOLERANCE = 1e-9  # of the length of a run: two times that are one
_STIMULI = {
    "merkel_stress": ("merkel_stress",),
    "meissner_stress": ("meissner_stress_left", "meissner_stress_right"),
    "pacinian_stress": ("pacinian_stress",),
    "surface_strain": ("surface_strain_left", "surface_strain_right"),
}


def differences(path: Sequence[ContactState], other: Sequence[ContactState]) -> dict[str, float]:
    """Return the largest difference over time by quantity, over the largest amount on the path.

    Of stimuli the largest difference at a site counts, over the largest amount at any site.

    Args:
        path: accepted states, with their times.
        other: those of the same loads on another mesh.

    Returns:
        Of friction and contact length, and of stimuli where both paths have them; none of a quantity that is zero.
    """
    wanted: dict[str, Of] = {name: partial(_value, name) for name in ("f_t", "contact_length")}
    if all(state.stimuli is not None for state in (*path, *other)):
        wanted |= {name: partial(_stimulus, parts) for name, parts in _STIMULI.items()}
    pieces = _pieces(path), _pieces(other)
    shared = [(pieces[0][key], pieces[1][key]) for key in pieces[0] if key in pieces[1]]
    found = {}
    for name, of in wanted.items():
        most = np.nanmax([np.abs(of(state)) for state in path], initial=0.0)
        if shared and most > 0:
            found[name] = float(max(_difference(mine, theirs, of) for mine, theirs in shared) / most)
    return found


def _value(name: str, state: ContactState) -> Array:
    return np.atleast_1d(getattr(state, name))


def _stimulus(parts: Sequence[str], state: ContactState) -> Array:
    return np.concatenate([getattr(state.stimuli, part) for part in parts])


def _pieces(states: Sequence[ContactState]) -> dict[tuple[int, int], Piece]:
    """Return the states between two jumps with their times since the load began, by load and number of the jump.

    A load begins with the last state of the load before; of one that takes no time the last state alone is there.
    """
    found = dict[tuple[int, int], Piece]()
    near, before = _TIME_TOLERANCE * states[-1].time, list[ContactState]()
    for _, mine in by_load(states):
        number, rows = mine[-1].load_number, [*before, *mine]
        before = mine[-1:]
        start = rows[0].time if len(rows) > len(mine) else 0.0
        if mine[-1].time - start <= near:
            found[number, 0] = np.zeros(1), before
            continue
        rows = without_parts_of_jumps(rows)
        time = np.array([state.time for state in rows]) - start
        cuts = [0, *(np.flatnonzero(np.diff(time) <= near) + 1), len(rows)]
        for k, (a, b) in enumerate(zip(cuts[:-1], cuts[1:], strict=True)):
            found[number, k] = time[a:b], rows[a:b]
    return found


def _difference(mine: Piece, theirs: Piece, of: Of) -> float:
    """Return the largest difference at the times of the first piece that are within those of the second one."""
    from scipy.interpolate import PchipInterpolator

    (time, states), (times, others) = mine, theirs
    values = np.array([of(state) for state in others])
    both = np.isfinite(values).all(axis=0)
    near = _TIME_TOLERANCE * times[-1]
    inside = (time >= times[0] - near) & (time <= times[-1] + near)
    if not (both.any() and inside.any()):
        return 0.0
    values = values[:, both]
    if len(times) > 1:
        values = PchipInterpolator(times, values)(np.clip(time[inside], times[0], times[-1]))
    own = np.array([of(state) for state in states])[inside][:, both]
    return float(np.nanmax(np.abs(own - values), initial=0.0))
