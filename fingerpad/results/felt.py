r"""What mechanoreceptive afferents answer to a run over time: stimuli at its sites, and spikes.

Stimuli are known in the accepted states. Between two of a load they follow the monotone cubic curve of Fritsch and
Carlson, cut at the ends of loads; a jump of the voltage takes half a sample. The state at t = 0 is taken as a steady
state. A class is refused where two states are further apart than its ``longest_step`` and its stimulus changes between
them by more than a hundredth of its range.
"""

import math
from collections.abc import Iterable, Sequence
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from fingerpad.afferents import DEFAULT, Afferent, History, find
from fingerpad.results.data import ResultData
from fingerpad.results.over_time import without_parts_of_jumps
from fingerpad.results.spikes import Densities, Span, Spikes, Unit
from fingerpad.results.terminal import about
from fingerpad.scene.messages import SceneError, show
from variational.state import ContactState

Array = NDArray[np.float64]
_CHANGE = 0.01  # of the range of a stimulus, which may change between two states however far they are apart
_SITE_ERROR = 0.22
"""Largest known error of energy densities at three Merkel sites on the mesh of the default path, 20 µm in contact and
at the sites (``again`` in docs/errors.json)."""
_OVER_TIME = {
    "f_t": "friction",
    "merkel_stress": "stress at Merkel sites",
    "meissner_stress": "at Meissner sites",
    "pacinian_stress": "at Pacinian sites",
    "surface_strain": "strain of the surface",
}
_SAMPLE = 1e-4  # s, between two samples of a stimulus
_SIDES = ("left", "right")
_TIME_TOLERANCE = 1e-9  # of the length of a run: two times that are one


def afferents(result: ResultData, laws: str | Afferent | Iterable[str | Afferent] | None = None) -> Spikes:
    """Return the spikes of afferents over a run; see :meth:`fingerpad.results.result.Result.afferents`."""
    given: str | Afferent | Iterable[str | Afferent] = DEFAULT if laws is None else laws
    named = [given] if isinstance(given, str | Afferent) else list(given)
    try:
        chosen = [find(law) for law in named]
    except ValueError as error:
        raise SceneError(str(error)) from None
    names = [name if isinstance(name, str) else name.name for name in named]
    if not chosen:
        raise SceneError("no class of afferents is given; give one at least, such as 'SA1'")
    states = _states(result)
    ridges, at_states = _histories(states)
    time, loads = np.array([state.time for state in states]), [state.load for state in states]
    scale, notes = result.scene.numerics.step_scale, [_mesh(result, states)]
    fine: Array = np.arange(int(time[-1] / _SAMPLE * (1 + 1e-9)) + 1, dtype=np.float64) * _SAMPLE
    units: list[Unit] = []
    trains: list[Array] = []
    refusals: list[str] = []
    for name, law in zip(names, chosen, strict=True):
        if law.site not in at_states:
            raise SceneError(f"the site of {name} is {show(law.site)}; it must be {' or '.join(map(repr, at_states))}")
        stimulus = law.stimulus(at_states[law.site])
        if coarse := _too_coarse(law, stimulus, time, loads, scale):
            refusals.append(coarse)
            if laws is not None:
                raise SceneError(coarse)
            continue
        trains += law.spikes(_between(time, loads, stimulus, fine), _SAMPLE)
        units += _units(name, law, at_states[law.site], ridges, len(units))
    if not units:
        raise SceneError(refusals[0])
    notes += [f"Left out: {coarse}." for coarse in refusals]
    parts = [list(group) for _, group in groupby(range(1, len(time)), key=lambda k: loads[k])]
    spans = tuple(Span(loads[part[0]], float(time[part[0] - 1]), float(time[part[-1]])) for part in parts)
    densities = Densities(tuple(map(int, ridges)), time, at_states["merkel"].sed)
    return Spikes(tuple(units), tuple(trains), float(time[-1]), spans, tuple(notes), densities)


def _states(result: ResultData) -> list[ContactState]:
    """Return the states of a run from time 0 on, of which two at a jump have two times.

    Raises:
        SceneError: there is no time, or there are no sites.
    """
    states = list(result.steps)
    if not states or math.isnan(states[-1].time) or not states[-1].time > 0:
        raise SceneError(
            "the run has no load over time, so nothing is felt over time; give its loads a duration or a speed"
        )
    if states[-1].stimuli is None or states[-1].sites is None:
        why = "its mesh is one of your own" if result.scene.output.receptors else "output.receptors is false"
        raise SceneError(f"the run has no stimuli at receptor sites: {why}; run a finger of the package with receptors")
    begin = max(k for k, state in enumerate(states) if state.time == 0.0)
    return without_parts_of_jumps(states[begin:])


def _histories(states: Sequence[ContactState]) -> tuple[NDArray[np.int64], dict[str, History]]:
    """Return the numbers of the ridges that can touch, and the stimuli below them in each state by kind of site.

    Those to the left and to the right of a ridge are in turn.
    """
    first = states[0].stimuli
    assert first is not None
    there = np.isfinite(first.surface_strain_left)

    def rows(*names: str, of: str = "stimuli") -> Array:
        columns = [np.array([getattr(getattr(state, of), name) for state in states]).T[there] for name in names]
        return np.stack(columns, axis=1).reshape(-1, len(states))

    strain = rows("surface_strain_left", "surface_strain_right")
    stress, sed = rows("meissner_stress_left", "meissner_stress_right"), rows("left", "right", of="sites")
    nothing = np.full((int(there.sum()), len(states)), np.nan)
    return first.number[there], {
        "merkel": History(rows("merkel_stress"), rows("merkel", of="sites"), (strain[::2] + strain[1::2]) / 2),
        "meissner": History(stress, sed, strain),
        "pacinian": History(rows("pacinian_stress"), nothing, nothing),
    }


def _too_coarse(law: Afferent, stimulus: Array, time: Array, loads: Sequence[str], scale: float) -> str:
    """Return in a sentence that two states are too far apart for a class; empty where none are."""
    apart = np.diff(time)
    changes = np.abs(np.diff(stimulus, axis=1)).max(axis=0) > _CHANGE * np.ptp(stimulus, axis=1).max()
    wide = np.where(changes & (apart > law.longest_step * (1 + 1e-9)), apart, 0.0)
    if not wide.any():
        return ""
    k = int(wide.argmax())
    enough = float(f"{0.9 * scale * law.longest_step / wide[k]:.1g}")
    return (
        f"{law.name} needs a state every {1e3 * law.longest_step:.2g} ms and the load {show(loads[k + 1])} has two "
        f"{1e3 * wide[k]:.3g} ms apart; give numerics.step_scale = {enough:g}, or a load that takes less time"
    )


def _between(time: Array, loads: Sequence[str], values: Array, fine: Array) -> Array:
    """Return values at states, shape (units, states), at fine times, shape (units, times)."""
    from scipy.interpolate import PchipInterpolator

    moved, near = time.copy(), _TIME_TOLERANCE * time[-1]
    jumps = np.flatnonzero(np.diff(moved) <= near) + 1
    after = np.append(np.diff(moved), _SAMPLE)[jumps]  # to the next state
    moved[jumps] += np.minimum(_SAMPLE, after) / 2
    found = np.repeat(values[:, -1:], len(fine), axis=1)
    for _, group in groupby(range(1, len(time)), key=lambda k: loads[k]):
        part = list(group)
        places = [part[0] - 1, *part]
        cuts = [0, *[n for n, k in enumerate(places) if k in jumps and n > 0], len(places) - 1]
        for a, b in zip(cuts[:-1], cuts[1:], strict=True):
            mine = places[a : b + 1]
            inside = (fine >= moved[mine[0]]) & (fine <= moved[mine[-1]])
            if b > a and inside.any():
                found[:, inside] = PchipInterpolator(moved[mine], values[:, mine], axis=1)(fine[inside])
    return found


def _units(name: str, law: Afferent, history: History, ridges: NDArray[np.int64], first: int) -> list[Unit]:
    """Return the units of a law in the order of its stimulus."""
    if law.population:
        return [Unit(first, name, None, "")]
    count = len(history.stress)
    if count == len(ridges):
        return [Unit(first + k, name, int(number), "") for k, number in enumerate(ridges)]
    return [Unit(first + k, name, int(ridges[k // 2]), _SIDES[k % 2]) for k in range(count)]


def _mesh(result: ResultData, states: Sequence[ContactState]) -> str:
    """Return of which mesh the stimuli are, and what is known of its error."""
    sizes = result.record.get("path_mesh") or {}
    contact = f"{1e6 * states[-1].mesh_contact:.3g} µm in contact"
    sites = f" and {1e6 * sizes['receptor']:.3g} µm at the Merkel sites" if "receptor" in sizes else ""
    begins = f"Stimuli and spikes are of the mesh of the path, with elements of {contact}{sites}."
    over_time = (result.record.get("accuracy") or {}).get("over_time", {})
    known = {words: over_time[key]["error"] for key, words in _OVER_TIME.items() if key in over_time}
    errors = [f"{words} {about(100 * error)} %" for words, error in known.items()]
    if errors:
        return (
            f"{begins} Estimated discretisation errors over time, from the path on elements twice as large, are at "
            f"most, of the largest value: {', '.join(errors)}. Those of spikes are not estimated."
        )
    return (
        f"{begins} Their discretisation error is not estimated. On the path of the default scene, with 20 µm in both, "
        f"energy densities at three Merkel sites are known to be off by up to {_SITE_ERROR:.0%}, and stresses, whose "
        "square they go with, by about half of that (docs/errors.json)."
    )
