"""Cautions on a scene and on its states: closures out of range, deep skin, ridges that adhere, breakdown of air.

They belong to a state, whatever computed it: runs, bodies, cheaper models and tables of the microscale take them here.
A new check is a line of :data:`CHECKS`; closures, laws of friction and formulations answer by a method ``cautions``.

**Adhesion.** A ridge adheres where its attraction is all that the screen bears. On closures of rough contact ridges can
do so at a voltage at which the bearing area model has none; the states then depend on the path, and one may not be
found.

**Breakdown.** A ridge's gap is its equivalent air gap d_eq, and the voltage across it is that of the circuit at each
instant. It breaks down by :func:`variational.roughness.gaps.breakdown_voltage`, in which the total voltage does
not count. Where a state has the mean attraction of a drive, a period of the drive counts, in its steady state.
*Assumption*: skin beside the contact, and ridges above the screen, are not examined.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from fingerpad.model import drive_loads
from fingerpad.results.data import ResultData
from fingerpad.results.states import long_steps
from fingerpad.scene import Scene, remarks
from fingerpad.scene.controls import CarriedWaveform
from fingerpad.scene.drive import Drive, drive_of
from variational.caution import Caution
from variational.contact.formulation import Formulation
from variational.roughness.closure import PAST_THE_FOLD, Closure, air_gaps
from variational.roughness.gaps import breakdown_voltage
from variational.state import ContactState

Array = NDArray[np.float64]
Gap = tuple[str, float, float]
"""Name of a ridge or a state, air gap (m), and voltage (V) of Eq. 3 where the scene has no drive."""
_Across = tuple[str, float, float]
"""Ridge or state, and the instant, in words; air gap (m); largest amount of the voltage across it (V)."""
_MADE = 1e-6  # of the largest dissipation of a branch at a point: roundoff of the others'
_DEEP = 0.1  # of the air gap: largest penetration that is of no matter
_NO_LOAD = 1e-6  # of the contact force: what the balance of forces leaves of a force of zero
_LIGHT = 1e4  # Pa, of a ridge at the edge of a contact, whose gap is the widest


def examine(kind: str, *of: object) -> list[Caution]:
    """Return the cautions by every check of a kind.

    Args:
        kind: a key of :data:`CHECKS`.
        *of: what is examined, as its comment has it.
    """
    return [caution for check in CHECKS[kind] for caution in check(*of)]


def on_scene(scene: Scene, states: Iterable[ContactState] = (), gaps: Iterable[Gap] = ()) -> list[Caution]:
    """Return the cautions on a scene, on states of it in any order, and on gaps of states without ridges."""
    states, found = list(states), examine("scene", scene)
    found += on_states(states, scene.closure(), scene.contact.law) if states else []
    return found + examine("gap", scene, states, gaps)


def on_states(
    states: Iterable[ContactState], closure: Closure | None, formulation: Formulation | None = None
) -> list[Caution]:
    """Return the cautions on states of a body, in any order.

    Args:
        states: those without contact have none, and those without a voltage none on the closure.
        closure: from a ridge's pressure to its air gap; None of a body without a voltage.
        formulation: of the contact, which has the remedy against deep skin; None of states without a mesh.
    """
    return examine("state", list(states), closure, formulation)


# -- states ----------------------------------------------------------------------------------------------
def _touching(states: Iterable[ContactState], charged: bool = False) -> list[ContactState]:
    return [state for state in states if state.contact_length > 0 and (state.voltage or not charged)]


def _beyond_closure(states: Sequence[ContactState], closure: Closure | None, _: object) -> list[Caution]:
    """Return the closure's own cautions on charged states."""
    points = [(*_pressures(state), state.voltage) for state in _touching(states, charged=True)]
    return [] if closure is None or not points else closure.cautions(points)


def _pressures(state: ContactState) -> tuple[Array, Array]:
    """Return pressure (Pa) and contact force (N/m) of each ridge in contact, of all as one where they are not kept."""
    if state.ridges is None:
        return np.array([state.f_contact / state.contact_length]), np.array([state.f_contact])
    inside = state.ridges.length > 0
    return state.ridges.p_c[inside], state.ridges.f_contact[inside]


def _deep(
    states: Sequence[ContactState], closure: Closure | None, formulation: Formulation | None
) -> Iterator[Caution]:
    """Yield the caution on states whose penetration is more than a tenth of the least air gap in contact."""
    if closure is None:
        return
    found = [
        (state.record.penetration, float(air_gaps(closure, _pressures(state)[0]).min()))
        for state in _touching(states)
        if state.record is not None
    ]
    deep = [(depth, gap) for depth, gap in found if depth > _DEEP * gap]
    if deep:
        depth, gap = max(deep, key=lambda each: each[0] / each[1])
        remedy = "" if formulation is None else f"; {formulation.less_penetration}"
        text = (
            f"in {len(deep)} of {len(found)} states the skin is deeper in the screen than a tenth of the air gap, "
            f"{depth * 1e6:.2g} µm where the gap is {gap * 1e6:.2g} µm: attraction and contact length depend on the "
            f"depth{remedy}"
        )
        yield Caution("deep_skin", text, depth)


def _made_energy(states: Sequence[ContactState], *_: object) -> Iterator[Caution]:
    """Yield the caution on branches of viscous layers that made energy at a point."""
    least = [state.record.viscous_least for state in states if state.record is not None]
    found = [each for each in least if each < -_MADE]
    if found:
        text = (
            f"in {len(found)} of {len(least)} steps branches of viscous layers made energy at points and dissipated "
            f"none, up to {-min(found):.1g} of the largest dissipation: quasi-linear viscoelasticity allows that at "
            "large strain, and no material does"
        )
        yield Caution("energy_made", text, -min(found))


# -- adhesion ------------------------------------------------------------------------------------------
def sticking(closure: Closure | None, voltage: float) -> str:
    """Return that ridges adhere without a load at a voltage (V, of either sign), in words; empty where they do not."""
    least = None if closure is None else closure.sticking_voltage()
    if least is None or not abs(voltage) >= least:
        return ""
    return f"by the closure {type(closure).__name__} ridges adhere without a load from {least:.3g} V on"


def adhering(state: ContactState | None, closure: Closure | None) -> str:
    """Return which ridge of a state adheres without a load, or is about to come down or let go; empty for none.

    Below the voltage from which a flat ridge adheres the closure may have folds already, where a path can be lost.
    """
    if closure is None or state is None or state.ridges is None:
        return ""
    ridges, at = state.ridges, f"at {state.voltage:.4g} V"
    inside = np.flatnonzero(ridges.length > 0)
    folded = [k for k in inside if closure.state(float(ridges.p_c[k]), state.voltage) == PAST_THE_FOLD]
    words, most = sticking(closure, state.voltage), _most_attracted(state)
    if not words and not folded:
        return ""
    by = f": {words}" if words else ""
    if most is not None and most[1] >= 0:
        return f"ridge {most[0]} adheres without a load {at}{by}; take a smaller voltage"
    if folded:
        number = ridges.number[max(folded, key=lambda k: ridges.f_contact[k])]
        by = by or f" of the closure {type(closure).__name__}, where it comes down or lets go at once"
        return f"ridge {number} is past the fold {at}{by}; take a smaller voltage or another roughness.law"
    nearest = at if most is None else f"ridge {most[0]} is nearest to adhering without a load {at}:"
    return f"{nearest} {words}; take a smaller voltage or another roughness.law"


def lost(error: Exception | str, state: ContactState | None, closure: Closure | None) -> str:
    """Return why a state was not found: the words of a failure, and the ridge of the state before that adheres."""
    return "; ".join(filter(None, (str(error), adhering(state, closure))))


def _without_slip(result: ResultData, states: Sequence[ContactState]) -> Iterator[Caution]:
    """Yield the caution on a path that ended without full slip where ridges adhere."""
    wanted = any(load.until_full_slip for load in result.scene.loads()) and not result.failure
    if wanted and result.full_slip is None and states and (words := adhering(states[-1], result.scene.closure())):
        yield Caution("no_full_slip", f"full slip was not reached, or not held: {words}", states[-1].voltage)


def _without_load(states: Sequence[ContactState], closure: Closure | None, _: object) -> Iterator[Caution]:
    """Yield in how many charged states attraction alone holds the finger, and the ridge that adheres most."""
    charged = _touching(states, charged=True)
    held = [state for state in charged if state.f_ext <= _NO_LOAD * state.f_contact]
    if closure is None or not held:
        return
    last, most = held[-1], _most_attracted(held[-1])
    pull, words = min(last.f_ext, 0.0) + 0.0, sticking(closure, last.voltage)
    ridge = "" if most is None else f", most by ridge {most[0]}"
    text = (
        f"in {len(held)} of {len(charged)} charged states the finger adheres without a load{ridge}, at {pull:.3g} N/m "
        f"and {last.voltage:.4g} V" + (f"; {words}" if words else "")
    )
    yield Caution("adheres", text, pull)


def _most_attracted(state: ContactState) -> tuple[int, float] | None:
    """Return the ridge in contact whose attraction exceeds its contact force most, and by how much (N/m)."""
    if state.ridges is None or not (state.ridges.length > 0).any():
        return None
    excess = np.where(state.ridges.length > 0, state.ridges.f_electrostatic - state.ridges.f_contact, -np.inf)
    return int(state.ridges.number[int(excess.argmax())]), float(excess.max())


# -- breakdown of air ----------------------------------------------------------------------------------
def _breakdown_ahead(scene: Scene) -> list[Caution]:
    """Return the caution on the loads of a scene before anything is solved, in the gap of a ridge under 10 kPa.

    Ridges at the edge of a contact bear as little. Their gaps are the widest, and have the largest part of the voltage.
    """
    gap, name = float(scene.closure()(_LIGHT).d_eq), f"a ridge under {_LIGHT * 1e-3:g} kPa"
    if scene.drive is not None:
        return _breakdown([_over_period(scene.drive, name, gap)])
    share, loads = drive_loads.gap_factor(scene), scene.loads()
    part = gap / (gap + scene.h_0) * (1.0 if share is None else float(share(gap)))
    found = [(name, gap, abs(load.level) * part) for load in loads if load.level]
    found += [_over_period(_drive(scene, load.drive), name, gap) for load in loads if load.drive is not None]
    return _breakdown(found)


def _breakdown_in_gaps(scene: Scene, states: Sequence[ContactState], gaps: Iterable[Gap] = ()) -> list[Caution]:
    """Return the caution on the gap in which air is the farthest beyond breakdown, with the instant.

    Gaps are given, and those of ridges in contact in charged states.
    """
    drive, charged = scene.drive, [state for state in states if state.voltage and state.ridges is not None]
    of = (
        (name, gap, abs(u) * gap / (gap + scene.h_0)) if drive is None else _over_period(drive, name, gap)
        for name, gap, u in gaps
    )
    return _breakdown([*_instants(scene, charged), *_periods(scene, charged), *of])


def _breakdown(points: Iterable[_Across]) -> list[Caution]:
    worst = max(points, key=lambda each: each[2] / float(breakdown_voltage(each[1])), default=None)
    if worst is None or not worst[2] > (limit := float(breakdown_voltage(worst[1]))):
        return []
    where, gap, volts = worst
    text = (
        f"{volts:.4g} V are across a gap of {1e6 * gap:.3g} µm in {where}, and from {limit:.4g} V on air breaks down "
        "there, which is not in this model"
    )
    return [Caution("breakdown", text, float(volts))]


def _drive(scene: Scene, wave: CarriedWaveform) -> Drive:
    return drive_of(wave, scene.electric, scene.geometry.sc_thickness)


def _over_period(drive: Drive, name: str, gap: float) -> _Across:
    period = np.abs(drive.across(gap))
    when = int(period.argmax()) / len(period) / drive.frequency
    return f"{name} {when:.3g} s after the start of a period", gap, float(period.max())


def _instants(scene: Scene, states: Sequence[ContactState]) -> Iterator[_Across]:
    """Yield the farthest gap of each state at its voltage."""
    share, loads = drive_loads.gap_factor(scene), scene.loads()
    for state in states:
        touching, gaps = _in_contact(state)
        if not len(gaps):
            continue
        volts = abs(state.voltage) * (1.0 if share is None else share(gaps)) * gaps / (gaps + scene.h_0)
        k = int(np.argmax(volts / breakdown_voltage(gaps)))
        timed = 0 < state.load_number <= len(loads) and loads[state.load_number - 1].takes_time
        when = f" at {state.time:.4g} s" if timed else ""
        yield f"ridge {touching[k]} in {state.load!r}, step {state.step}{when}", gaps[k], volts[k]


def _periods(scene: Scene, states: Sequence[ContactState]) -> Iterator[_Across]:
    """Yield the narrowest and the widest gap under each drive of which states have the mean attraction.

    One of the two is the farthest beyond breakdown: the voltage across a gap rises with it, and the field falls.
    """
    of_wave, loads = dict[CarriedWaveform, list[tuple[float, str]]](), scene.loads()
    for state in states:
        wave = loads[state.load_number - 1].drive if 0 < state.load_number <= len(loads) else None
        mean = wave is not None and (scene.electric.follows == "mean" or wave.carrier is not None)
        if scene.drive is not None or mean:
            touching, gaps = _in_contact(state)
            places = [f"ridge {number} in {state.load!r}, step {state.step}," for number in touching]
            under = wave if scene.drive is None else scene.drive.wave
            assert under is not None
            of_wave.setdefault(under, []).extend(zip(map(float, gaps), places, strict=True))
    for wave, found in of_wave.items():
        for gap, where in {min(found), max(found)} if found else ():
            yield _over_period(_drive(scene, wave), where, gap)


def _in_contact(state: ContactState) -> tuple[np.ndarray, np.ndarray]:
    """Return number and air gap (m) of the ridges in contact."""
    assert state.ridges is not None
    inside = state.ridges.length > 0
    return state.ridges.number[inside], state.ridges.d_eq[inside]


CHECKS: dict[str, list[Callable[..., Iterable[Caution]]]] = {
    "scene": [*remarks.CHECKS],  # of a scene
    "law": [lambda scene: scene.contact.law.cautions()],  # of a scene, before a run
    "load": [_breakdown_ahead],  # of a scene, before a run
    "state": [_without_load, _beyond_closure, _deep, _made_energy],  # of states, closure and formulation
    "gap": [_breakdown_in_gaps],  # of a scene, its states, and gaps of states without ridges
    "result": [
        lambda of, _: long_steps(of.loads, of.record.get("force_error", 0.0)),
        _without_slip,
    ],  # of it, its states
    "note": [*remarks.NOTES],  # of a scene; what a result has as notes
}
"""What limits of validity are examined: by kind, and each as arguments of :func:`examine` by its comment."""
