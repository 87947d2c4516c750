"""Named states of a history, and the result of each load; no dolfinx.

* *uncharged* (uncharged normal contact): the last state in contact before a voltage is switched on and before the bone
  first moves sideways,
* *charged* (charged normal contact, in short normal contact): the last state in contact before the bone first moves
  sideways with skin on the screen, at the voltage of that state; at 0 V it is called normal contact. Sideways motion
  without contact does not count, nor does a later return of the bone, nor a first touch before the force is reached,
* *full_slip*: full slip. Every point in contact slips one way, with the same forces while the bone slides a further
  0.2 mm. A full slip begins at its first state. Of several full slips the last one that was held counts.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from operator import attrgetter

from fingerpad.results.over_time import OverTime, over_time, without_parts_of_jumps
from fingerpad.results.quantities import EXTREMES
from fingerpad.scene.loads import Load
from fingerpad.scene.waveform import Waveform
from variational.caution import Caution
from variational.state import ContactState

_STILL = 1e-12  # m, largest sideways displacement of a bone at rest
SLIDE_ON = 0.2e-3  # m, further sliding over which the forces of full slip are constant
STATES = ("uncharged", "charged", "full_slip")
WORDS = {"uncharged": "uncharged normal contact", "charged": "charged normal contact", "full_slip": "full slip"}
FIRST_TOUCH = "touch"
"""Name of the steps that press a finger in the air in a little, before a force can control it."""
_ROUNDOFF = 1e-9  # relative, of a displacement or a voltage
_MEANS = {"f_t": ("f_T", "N/m", 1.0), "contact_length": ("L_R", "mm", 1e3)}
_MEAN_TOLERANCE = 0.02  # of the largest amount in the load: change of a mean on half of the steps that needs no caution
UNLOADED = ContactState(
    f_ext=0.0, voltage=0.0, f_t=0.0, mu_app=math.nan, f_contact=0.0, f_electrostatic=0.0, ridges_in_contact=0,
    contact_length=0.0, time=0.0,
)  # fmt: skip
"""Where a run begins."""


def called(name: str, charge: float) -> str:
    """Return a named state in words.

    Args:
        name: of :data:`STATES`.
        charge: its voltage or its attraction, 0 where the finger is not charged.
    """
    return "normal contact" if name == "charged" and charge == 0 else WORDS[name]


def before_sliding(rows: Sequence[ContactState]) -> Sequence[ContactState]:
    """Return the states before the bone first moves sideways with skin on the screen."""
    place = 0.0
    for k, row in enumerate(rows):
        if row.ridges_in_contact == 0:
            place = row.bone_x
        elif abs(row.bone_x - place) >= _STILL:
            return rows[:k]
    return rows


def full_slip(rows: Sequence[ContactState], row: ContactState, steady: float, least: float) -> tuple[int, bool]:
    """Return the first step of the full slip of a new state, zero without full slip, and whether it was held since.

    Args:
        rows: accepted states before the new one, with ``slip_began`` and ``slip_held``.
        row: the new state.
        steady: relative change of the forces that is not significant.
        least: change of the forces (N/m) that is not significant.
    """
    if not row.all_slip or len(before_sliding([*rows, row])) > len(rows):
        return 0, False
    last = rows[-1] if rows else None
    first = next((r for r in reversed(rows) if last is not None and r.step == last.slip_began), None)
    if last is None or first is None or not _unchanged(first, row, steady, least):
        return row.step, False
    far = abs(row.bone_x - first.bone_x) >= SLIDE_ON * (1 - _ROUNDOFF)
    return first.step, bool(last.slip_held or far)


def _unchanged(first: ContactState, row: ContactState, steady: float, least: float) -> bool:
    """Return whether two states have the same amount of voltage and forces; see :func:`full_slip`."""
    same = abs(abs(row.voltage) - abs(first.voltage)) <= _ROUNDOFF * abs(first.voltage)
    pairs = ((first.f_t, row.f_t), (first.f_ext, row.f_ext))
    return bool(same and all(abs(b - a) <= steady * abs(a) + least for a, b in pairs))


def _of_load(row: ContactState, load: str) -> bool:
    """Return whether a state of a load is none of the automatic first touch, unless the load has its name."""
    return row.load != FIRST_TOUCH or load == FIRST_TOUCH


def named(rows: Sequence[ContactState], names: Sequence[str] = ()) -> dict[str, ContactState]:
    """Return the states of :data:`STATES` in a history so far, by name.

    Args:
        rows: states of the history.
        names: of its loads in order; by default those that the last states have.
    """
    loads = {row.load_number: row.load for row in rows} | dict(enumerate(names, start=1))
    touching = (row for row in before_sliding(rows) if row.ridges_in_contact > 0)
    still = [row for row in touching if _of_load(row, loads[row.load_number])]
    uncharged = still[: next((k for k, row in enumerate(still) if row.voltage != 0), len(still))]
    held = next((row.slip_began for row in reversed(rows) if row.slip_held), None)
    found = {"uncharged": uncharged[-1:], "charged": still[-1:], "full_slip": [r for r in rows if r.step == held][:1]}
    return {name: part[0] for name, part in found.items() if len(part)}


def partial_slip(rows: Sequence[ContactState], last: float | None = None) -> ContactState | None:
    """Return the state of sliding without full slip of which the slipping part is nearest to one half; None without.

    Args:
        rows: states of a history.
        last: number of the last step that may be it; by default that of the last full slip, if there is one.
    """
    if last is None:
        last = named(rows).get("full_slip", rows[-1]).step
    some = [row for row in rows[len(before_sliding(rows)) :] if row.step <= last and not row.slip_began]
    return min(some, key=lambda row: abs(row.slipping - 0.5)) if some else None


def shown(rows: Sequence[ContactState]) -> dict[str, ContactState]:
    """Return the states along whose skin is drawn, by name: charged normal contact, ``partial`` slip and full slip.

    In place of a full slip that was not held it is the last state of sliding.
    """
    found, partial = named(rows), partial_slip(rows)
    slides = 0 < len(before_sliding(rows)) < len(rows)
    last = found.get("full_slip", rows[-1] if slides else None)
    each = {"charged": found.get("charged"), "partial": partial, "full_slip": last}
    return {name: state for name, state in each.items() if state is not None}


def by_load(rows: Sequence[ContactState]) -> Iterator[tuple[str, list[ContactState]]]:
    """Yield each load's name and its states; the states of the first touch belong to the load that follows."""
    for _, group in groupby(rows, key=lambda row: row.load_number):
        mine = list(group)
        yield mine[-1].load, mine


@dataclass(frozen=True)
class Extreme:
    """Least and largest value of a quantity over the states of a load, their steps, and in a run over time their times.

    A time is in s, NaN where no load of the run is over time.
    """

    min: float
    min_step: int
    max: float
    max_step: int
    min_time: float = math.nan
    max_time: float = math.nan


@dataclass(frozen=True, eq=False)
class LoadResult:
    """Result of a load."""

    name: str
    end: ContactState
    extremes: dict[str, Extreme]
    """By quantity: friction force, contact length, attraction, and apparent friction coefficient where one is known."""
    full_slip_reached: bool
    full_slip_held: bool
    stable: bool | None
    """Whether the state at the end is stable; None where this was not examined."""
    over_time: OverTime | None = None
    """Means over time and spectrum of friction; None where the load takes no time."""
    full_slip_part: float = math.nan
    """Part of the load's states after its begin that are of full slip; NaN where it has no waveform."""
    needs: float = math.nan
    """About how far from where it was unloaded the bone must be for full slip at every voltage of the load (m); NaN
    where it is there, or where friction does not grow from there on."""

    @property
    def sticking(self) -> str:
        """In words that friction is not that of sliding; empty where every state is of full slip, or unexamined."""
        part = self.full_slip_part
        if math.isnan(part) or part == 1:
            return ""
        if part == 0:
            words = "part of the skin sticks in every state, so that friction stays below that of sliding"
            if math.isnan(self.needs):
                return words
            goes = 1e3 * abs(self.end.bone_x)
            return f"{words}: full slip needs some {1e3 * self.needs:.2g} mm, and the bone goes {goes:.2g} mm"
        return f"full slip in {100 * part:.0f} % of its states; in the others part of the skin sticks"

    def rubs(self, least: float) -> bool:
        """Return whether there is friction in the load, above a force (N/m) up to which it is roundoff."""
        f_t = self.extremes["f_t"]
        return max(abs(f_t.min), abs(f_t.max)) > max(least, _ROUNDOFF * abs(self.end.f_ext))


def load_results(
    rows: Sequence[ContactState],
    loads: Sequence[Load],
    stable: Callable[[ContactState], bool | None],
    mu_0: float | None = None,
) -> tuple[LoadResult, ...]:
    """Return the result of each load.

    Args:
        rows: states of the history.
        loads: its loads.
        stable: returns whether the state at the end of a load is stable; None where this was not examined.
        mu_0: friction coefficient of Coulomb's law; None of another law.
    """
    found, before = list[LoadResult](), list[ContactState]()
    for name, mine in by_load(rows):
        load = next(iter(loads[mine[-1].load_number - 1 :]), None)
        given = (name, None) if load is None else (load.name, load.wave)  # a first touch may be all there is
        found.append(load_result(given[0], mine, stable(mine[-1]), before, given[1], mu_0))
        before = mine[-1:]
    return tuple(found)


def load_result(
    name: str,
    mine: Sequence[ContactState],
    stable: bool | None,
    before: Sequence[ContactState] = (),
    wave: Waveform | None = None,
    mu_0: float | None = None,
) -> LoadResult:
    """Return the result of a load.

    Args:
        name: of the load.
        mine: its states.
        stable: whether the state at its end is stable, None where this was not examined.
        before: the state at its begin, if there is one.
        wave: its waveform; None without one.
        mu_0: see :func:`load_results`.
    """
    # A waveform has a state of its own at its begin, after a jump from the voltage before.
    begin = [] if wave is not None else before or ([UNLOADED] if mine[0].time > 0 else [])
    passed = over_time([*begin, *mine], wave)
    own = [state for state in mine if _of_load(state, name)] or mine
    if passed is not None:
        own = without_parts_of_jumps(own, passed.start) if wave is not None else [*begin, *own]
    extremes = {}
    for quantity in (*EXTREMES, *mine[-1].own):
        of = attrgetter(quantity)
        known = [state for state in own if not math.isnan(getattr(state, quantity, math.nan))]
        if not known:
            continue
        least, most = min(known, key=of), max(known, key=of)
        extremes[quantity] = Extreme(of(least), least.step, of(most), most.step, least.time, most.time)
    slips = any(state.slip_began for state in mine), any(state.slip_held for state in mine)
    # The state at the begin of a waveform may be that at the end of a slide.
    under = [] if wave is None or passed is None else [state for state in own if state.time > passed.start]
    slides = sum(state.slip_began > 0 for state in under) / len(under) if under else math.nan
    needs = _needed(own, mu_0) if slides == 0 else math.nan
    return LoadResult(name, mine[-1], extremes, *slips, stable, passed, slides, needs)


def _needed(states: Sequence[ContactState], mu_0: float | None) -> float:
    """Return how far from where it was unloaded the bone must be for full slip (m), about; NaN where not known.

    *Assumption*: friction grows in proportion to the way. In full runs of the default finger, 10 and 75 N/m, 150 and
    200 V, this is within a tenth from the first steps of sliding on.
    """
    end, contact = states[-1], max(state.f_contact for state in states)
    if not mu_0 or end.f_t * end.bone_x <= 0 or any(abs(state.bone_x) > abs(end.bone_x) for state in states):
        return math.nan
    found = abs(end.bone_x) * mu_0 * contact / abs(end.f_t)
    return found if found > abs(end.bone_x) else math.nan


def long_steps(loads: Iterable[LoadResult], least: float) -> list[Caution]:
    """Return a caution for each load without a waveform whose steps are too long for its means.

    Args:
        loads: of a run.
        least: friction force (N/m) up to which there is none.
    """
    found = list[Caution]()
    for load in loads:
        changes = {} if load.over_time is None else load.over_time.mean_change
        for key, (words, unit, factor) in _MEANS.items():
            ends = load.extremes.get(key)
            most = 0.0 if ends is None else max(abs(ends.min), abs(ends.max))
            change = changes.get(key, 0.0)
            if change > _MEAN_TOLERANCE * most and (key != "f_t" or load.rubs(least)):
                text = (
                    f"In the load {load.name} the mean {words} over time would change by {factor * change:.2g} {unit} "
                    "with every second step alone: its steps are too long for it; give a smaller numerics.step_scale."
                )
                found.append(Caution("long_steps", text, change))
                break
    return found
