"""Numbers and verdicts of the findings on contact, friction and voltage, each from the runs of a finger.

What is compared is the quantity that was measured. The apparent area is the gross area of the whole finger, a sum of
slices. The real area is the contact length or area of the ridges, and over the voltage that of asperities on them. The
stated error is the difference of two meshes.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks import viscosity
from benchmarks.measured import drives, rules
from benchmarks.measured.fingers import (
    FORCE,
    GROWS,
    HIGH,
    ROUGHER,
    SOFTER,
    VOLTAGES,
    Case,
    Computation,
    Finger,
    Row,
    adheres,
)
from benchmarks.measured.rules import CHANGED, EXPONENT, RATIO, SIMILAR, STRIKING, by_factor, by_form, by_share
from variational.attraction.dielectric import VACUUM_PERMITTIVITY
from variational.state import ContactState

Array = NDArray[np.float64]
AMPLITUDES = ((100.0, 150.0), (50.0, 100.0))
"""Voltages (V) within an amplitude of 75 to 150 V: as a constant voltage, and as that of a sine's mean square."""
_LOW, _ONE = 0.5, 1.0  # N: least force of several sources, where shares are compared, and force of fitted numbers
_GROWN = 0.95  # of the growth in the time of the hold


def _both(finger: Finger, value: Callable[[Finger], Any]) -> tuple[Any, float]:
    """Return a number or an array of a finger, and its largest difference from that of the coarser mesh."""
    fine, coarse = np.asarray(value(finger), dtype=float), np.asarray(value(finger.coarse), dtype=float)
    if fine.shape != coarse.shape:  # forces (N) that the traces of one mesh alone reach
        fine, coarse = (each[: min(len(fine), len(coarse))] for each in (fine, coarse))
    return fine, float(np.abs(fine - coarse).max())


def _value(case: Case, value: Callable[[Finger], Any]) -> Row:
    """Judge a number, or the range of several, by the rule of its row."""
    found, error = _both(case.finger, value)
    low, high = float(found.min()), float(found.max())
    return {"value": low, "low": low, "high": high, "error": error}, rules.by_rule(case.row, low, high)


def _near(case: Case, value: Callable[[Finger], Any]) -> Row:
    """Judge a number by its distance from the measured one: 0.1 for a hit, 0.2 for a part."""
    found, error = _both(case.finger, value)
    measured = 0.0 if isinstance(case.row.value, str) else case.row.bounds[0]
    return {"value": float(found), "error": error}, rules.by_bar(abs(float(found) - measured), 0.1, 0.2)


def _holds(case: Case, values: Callable[[Finger], Array], holds: Callable[[Array], NDArray[np.bool_]]) -> Row:
    """Judge at how many forces a statement on numbers holds."""
    found, error = _both(case.finger, values)
    where = holds(found)
    numbers = {"low": found.min(), "high": found.max(), "error": error, "holds": where.sum(), "loads": where.size}
    return numbers, by_share(float(where.mean()))


# -- contact area ----------------------------------------------------------------------------------------------
def _share(finger: Finger) -> float:
    area, gross = (finger.at(finger.pressed, name, _LOW) for name in ("contact_area", "gross_area"))
    return area / gross


def _one_newton(finger: Finger, name: str, scale: float) -> float:
    return scale * finger.at(finger.pressed, name, _ONE)


def _area_form(case: Case, least: float, form: rules.Form, other: rules.Form) -> Row:
    """Judge a form of the gross area over the force from a least one (N) on, beside another one."""
    force, area = case.finger.sums(case.finger.pressed, "gross_area", least)
    misfit, beside = (rules.of_each(each, force, area).misfit for each in (form, other))
    exponent, error = _both(case.finger, lambda of: rules.exponent(*of.sums(of.pressed, "gross_area")))
    numbers = {"misfit": misfit, "other": beside, "exponent": float(exponent), "error": error, "most": force[-1]}
    return numbers, by_form((misfit,), (beside,))


def _grow(finger: Finger) -> Array:
    """Return the least rise of gross and real area from force to force."""
    return np.min([np.diff(np.log(finger.sums(finger.pressed, f"{name}_area")[1])) for name in ("gross", "contact")], 0)


def _apparent(finger: Finger, after: tuple[str, float], before: tuple[str, float]) -> Array:
    """Return the relative change of the gross area from a state and voltage to another, at each force (N)."""
    areas = [finger.sums(getattr(finger, state)(voltage), "gross_area")[1] for state, voltage in (after, before)]
    count = min(map(len, areas))
    return np.asarray(areas[0][:count] / areas[1][:count] - 1)


def _falls(change: Array) -> NDArray[np.bool_]:
    return change <= -CHANGED


def _length(finger: Finger) -> Array:
    """Return the relative change of the contact length from rest to full slip, at each force."""
    after, before = (np.array([s.contact_length for s in states]) for states in (finger.slip(), finger.rest()))
    return np.asarray(after / before - 1)


def _stuck(finger: Finger, force: float) -> tuple[Array, Array]:
    """Return friction (N/m) and the stuck share of the contact, from rest to full slip without voltage."""
    path = [finger.path(f"slide {force:g}", "press")[-1], *finger.path(f"slide {force:g}", "slip 0")]
    path = path[: 1 + next(k for k, state in enumerate(path) if state.all_slip)]
    return np.array([s.f_t for s in path]), np.array([1 - s.slipping for s in path])


def _off_line(finger: Finger) -> float:
    """Return how far the stuck share is from a straight line over the tangential force (rms)."""
    force, stuck = _stuck(finger, FORCE)
    part = np.linspace(0, 1, 101)
    return float(np.sqrt(np.mean((np.interp(part, force / force[-1], stuck) - (1 - part)) ** 2)))


def _half_stuck(finger: Finger) -> Array:
    """Return the tangential force (N/m) at which half of what sticks at rest still sticks, at each force."""
    found = [_stuck(finger, force) for force in finger.forces]
    return np.array([np.interp(-stuck[0] / 2, -stuck, f_t) for f_t, stuck in found])


def _slopes(finger: Finger, values: Array) -> Array:
    """Return the exponent of values over the force, between neighbouring forces."""
    return np.diff(np.log(values)) / np.diff(np.log(finger.forces))


def _stuck_wet(case: Case) -> Row:
    def ratio(wet: Finger, dry: Finger) -> Array:
        wets, dries = (dict(zip(each.forces, _half_stuck(each), strict=True)) for each in (wet, dry))
        return np.array([wets[f] / dries[f] for f in wets if f in dries])

    found, error = _of_two(case, "fitted", ratio)
    return {"low": found.min(), "high": found.max(), "error": error}, by_share(float((found > 1 + SIMILAR).mean()))


def _of_two(case: Case, other: str, value: Callable[[Finger, Finger], Any]) -> tuple[Any, float]:
    """Return what follows from two fingers, and its difference from that of the coarser meshes."""
    both = case.finger, case.every[other]
    found, coarse = np.asarray(value(*both)), np.asarray(value(*(each.coarse for each in both)))
    return found, float(np.abs(found - coarse).max())


# -- pressing --------------------------------------------------------------------------------------------------
def _force_depth(case: Case) -> Row:
    """Judge an exponential beside a power law, by the misfit of each force and by that of the largest."""
    force, depth = case.finger.sums(case.finger.pressed, "indentation")
    kinds, forms = (rules.of_each, rules.of_largest), (rules.exponential, rules.power)
    own, other = ([fit(form, depth, force).misfit for fit in kinds] for form in forms)
    names = ("each", "largest", "other_each", "other_largest")
    return dict(zip(names, [*own, *other], strict=True)) | {"most": force[-1]}, by_form(own, other)


def _pressure(case: Case) -> Row:
    """Judge a paraboloid beside half an ellipse, over the largest pressure of a ridge."""

    def misfits(of: Finger) -> list[float]:
        ridges = of.path(f"slide {FORCE:g}", "press")[-1].ridges
        assert ridges is not None
        touch = ridges.length > 0
        points = ridges.number[touch].astype(float), ridges.f_contact[touch]
        return [rules.of_largest(form, *points).misfit for form in (rules.paraboloid, rules.ellipse)]

    (misfit, other), error = _both(case.finger, misfits)
    return {"misfit": misfit, "other": other, "error": error}, by_form((misfit,), (other,))


def _change(finger: Finger, kind: str) -> Array:
    """Return the relative changes of contact length and gross width by other skin or friction."""

    def pressed(kind: str) -> Array:
        state = finger.path(kind, "press")[-1]
        width = (state.ridges_in_contact - 1) * finger.scene.geometry.ridge_wavelength
        return np.array([state.contact_length, width + state.contact_length / state.ridges_in_contact])

    return pressed(kind) / pressed(f"slide {FORCE:g}") - 1


def _softer(case: Case) -> Row:
    """Judge either area at each softening of the stratum corneum."""
    less, more = (_both(case.finger, partial(_change, kind=f"soft {each:g}")) for each in SOFTER)
    areas, gross = [less[0][0], more[0][0]], max(less[0][1], more[0][1])
    numbers = {"less": areas[0], "less_error": less[1], "more": areas[1], "error": more[1], "gross": gross}
    return numbers, by_share(float(np.mean([*(each >= STRIKING for each in areas), *[gross <= SIMILAR] * 2])))


def _modulus(case: Case) -> Row:
    kinds = f"soft {SOFTER[-1]:g}", "rough"
    (soft, error), (rough, _) = (_both(case.finger, partial(_change, kind=kind)) for kind in kinds)
    numbers = {"soft": soft[0], "rough": rough[0], "error": error, "friction": ROUGHER}
    return numbers, by_share(float(abs(soft[0]) > abs(rough[0])))


def _time(case: Case) -> Row:
    """Judge for how long the contact of a held finger grows."""
    states = [case.finger.path("hold", "press")[-1], *case.finger.path("hold", "hold")]
    time, length = (np.array([getattr(s, key) for s in states]) for key in ("time", "contact_length"))
    time, growth = np.nan_to_num(time - np.nanmin(time)), float(length[-1] / length[0] - 1)
    grown = np.maximum.accumulate((length - length[0]) / (length[-1] - length[0])) if growth > SIMILAR else length * 0
    until = float(np.interp(_GROWN, grown, time)) if growth > SIMILAR else 1e-9
    return {"growth": growth, "until": until, "seconds": GROWS}, by_factor(until, until, GROWS, GROWS, RATIO)


# -- friction --------------------------------------------------------------------------------------------------
def _mu(finger: Finger) -> float:
    """Return the friction coefficient of the whole finger without voltage under 1 N."""
    return finger.at(finger.slip(), "mu_app", _ONE)


def _mus(finger: Finger) -> tuple[Array, Array]:
    """Return forces (N) of several sources and the friction coefficient at each."""
    return finger.sums(finger.slip(), "mu_app", _LOW)


def _exponent(finger: Finger) -> float:
    return rules.exponent(*_mus(finger))


def _over_load(case: Case, judge: Callable[[Case, Array], str]) -> Row:
    """Judge the friction coefficients at all forces per length."""
    mu, error = _both(case.finger, lambda of: of.mu)
    numbers = {"factor": mu.max() / mu.min(), "first": mu[0], "last": mu[-1], "error": error}
    return numbers | {"least": case.finger.forces[0], "most": case.finger.forces[-1]}, judge(case, mu)


def _factor(mu: Array) -> float:
    return float(mu.max() / mu.min())


def _power_law(case: Case) -> Row:
    """Judge whether friction depends on the load, and by a power law."""
    mu, force = case.finger.mu, np.array(case.finger.forces)
    misfit, line = (rules.of_each(form, force, mu).misfit for form in (rules.falling_power, rules.falling_line))
    verdict = by_form((misfit,), (line,)) if _factor(mu) > 1 + SIMILAR else rules.MISS
    return {"misfit": misfit, "line": line, "factor": _factor(mu), "exponent": rules.exponent(force, mu)}, verdict


def _speed(case: Case, wanted: bool) -> Row:
    """Judge whether friction depends on the speed: laws with a speed do, and no others."""
    return {}, by_share(float(hasattr(case.finger.scene.friction_law(), "v_0") == wanted))


def _ratio(case: Case) -> Row:
    """Judge the friction coefficient over that of a dry finger, at 1 N."""
    found, error = _of_two(case, "fitted", lambda finger, dry: _mu(finger) / _mu(dry))
    return {"value": float(found), "error": error}, rules.by_rule(case.row, float(found), float(found))


def _stiffness(finger: Finger) -> Array:
    """Return the exponent of the tangential stiffness over the load, between neighbouring forces."""
    firsts = [
        [finger.path(f"slide {f:g}", "press")[-1], finger.path(f"slide {f:g}", "slip 0")[0]] for f in finger.forces
    ]
    return _slopes(finger, np.array([(two.f_t - one.f_t) / (two.bone_x - one.bone_x) for one, two in firsts]))


def _way(finger: Finger) -> Array:
    """Return the ways (µm) of sliding after which 63 % of a rise by voltage is there, at each force."""
    found = []
    for force in finger.forces:
        kind = f"slide {force:g}"
        path = [finger.path(kind, "charge")[-1], *finger.path(kind, f"slip {HIGH:g}")]
        rise, way = (np.array([getattr(s, key) - getattr(path[0], key) for s in path]) for key in ("f_t", "bone_x"))
        found.append(np.interp(1 - np.exp(-1), np.maximum.accumulate(rise / rise[-1]), way))
    return 1e6 * np.array(found)


# -- over the voltage ------------------------------------------------------------------------------------------
def exponents(values: Array, voltages: Sequence[float]) -> Array:
    """Return the exponent of the rise over the value at 0 V, fitted to logarithms, at each force; shape (forces,)."""
    at = [VOLTAGES.index(u) for u in voltages]
    rise = values[:, at] - values[:, :1]
    return np.polyfit(np.log(voltages), np.log(np.maximum(rise, 1e-15)).T, 1)[0]


def _power(case: Case, values: Callable[[Finger], Array], ranges: Sequence[Sequence[float]]) -> Row:
    """Judge whether a rise is as the square of the voltage, at each force and in each of the ranges (V)."""
    found, error = _both(case.finger, lambda of: [exponents(values(of), voltages) for voltages in ranges])
    near = (np.abs(found - case.row.bounds[0]) <= EXPONENT).all(axis=0)
    numbers = {"holds": near.sum(), "loads": near.size, "error": error, "low": found[0].min(), "high": found[0].max()}
    return numbers | {"other_low": found[-1].min(), "other_high": found[-1].max()}, by_share(float(near.mean()))


def _friction(finger: Finger) -> Array:
    return finger.slips("f_t")


def _asperities(finger: Finger) -> Array:
    """Return the length (m) of asperities in contact, by the mean pressure over the ridges' contact."""
    law: Any = finger.scene.closure()
    length = finger.slips("contact_length")
    borne = np.array(finger.forces)[:, None] + finger.slips("f_electrostatic")
    return np.asarray(length * law.statistics(np.clip(borne / length, *law.pressures)).area)


def _rises(finger: Finger) -> Array:
    f_t = finger.slips("f_t")
    return np.asarray(f_t[:, -1] / f_t[:, 0] - 1)


def plates(finger: Finger, states: Sequence[ContactState], voltage: float) -> tuple[Array, Array]:
    """Return air gap (m) and length (m) of equal plates that attract as the ridges do, at each force."""
    length = np.array([s.contact_length for s in states])
    pressure = np.array([s.f_electrostatic for s in states]) / length
    return voltage * np.sqrt(VACUUM_PERMITTIVITY / 2 / pressure) - finger.scene.h_0, length


def _gaps(finger: Finger) -> Array:
    """Return the air gaps (µm) of equal plates, of all forces, voltages and states."""
    states = [(finger.rest(HIGH), HIGH), *((finger.slip(u), u) for u in VOLTAGES[1:])]
    return 1e6 * np.concatenate([plates(finger, each, u)[0] for each, u in states])


def _impedance(case: Case) -> Row:
    """Judge the impedance of a sliding finger over that of one at rest."""
    held, finger = case.every["held"], case.finger
    at = plates(held, held.rest(HIGH), HIGH), plates(finger, finger.slip(HIGH), HIGH)
    return drives.sliding(case.row, held, at[0], finger, at[1])


# -- viscous skin, of docs/viscosity.json (make viscosity) -----------------------------------------------------
def _relaxation(known: Mapping[str, Any]) -> Row:
    """Judge the three times of the force at a held depth."""
    times = known["held"]["times"]
    factors = np.array(times) / viscosity.TIMES
    numbers = {f"time_{k}": 1e3 * time for k, time in enumerate(times)}
    return numbers, by_factor(factors.min(), factors.max(), 1.0, 1.0, RATIO)


def _delay(known: Mapping[str, Any]) -> Row:
    """Judge that friction follows a voltage with a delay, at first order, and sooner at the higher speed."""
    delays, fitted = [], []
    for speed in viscosity.SPEEDS:
        found = known["steps"][f"fingerpad at {1e3 * speed:g} mm/s"]
        time, rise = np.array(found["time"]), np.array(found["rise"])
        delays.append(float(np.interp(1 - np.exp(-1), np.maximum.accumulate(rise), time)))
        early = time <= 3 * found["way"] / speed
        fits = [rules.of_largest(form, time[early][1:], rise[early][1:]) for form in (rules.first_order, rules.ramp)]
        fitted.append([fit.misfit for fit in fits])
    misfits, others = zip(*fitted, strict=True)
    holds = [min(delays) > 0, delays[1] < delays[0], by_form(misfits, others) == rules.HIT]
    names = {"slow": 1e3 * delays[0], "fast": 1e3 * delays[1], "misfit": max(misfits), "ramp": max(others)}
    return names, by_share(sum(holds) / len(holds))


# -- adhesion --------------------------------------------------------------------------------------------------
def _pull_off(case: Case) -> Row:
    """Judge the largest tension of the whole finger while it is lifted."""
    if not adheres(case.finger.scene):
        return {"value": 0.0}, rules.MISS
    tension = -1e3 * float(case.finger.run("lift").result.record["pull_off"]["finger"])
    return {"value": tension}, rules.by_rule(case.row, tension, tension)


# -- all -------------------------------------------------------------------------------------------------------
_SHRINKS = partial(_holds, values=partial(_apparent, after=("slip", 0.0), before=("rest", 0.0)), holds=_falls)
_SAME = partial(_over_load, judge=lambda case, mu: by_share(float(_factor(mu) <= 1 + SIMILAR)))
_FACTOR = partial(_over_load, judge=lambda case, mu: rules.by_rule(case.row, _factor(mu), _factor(mu)))
_LESS = partial(_over_load, judge=lambda case, mu: by_share(float(1 - mu[-1] / mu[0] > SIMILAR)))
ROWS: dict[str, Computation] = {
    **dict.fromkeys(("share_db1", "share_db2", "ridges", "ridge_width"), partial(_value, value=_share)),
    "gross_1n": partial(_value, value=partial(_one_newton, name="gross_area", scale=1e6)),
    "depth_1n": partial(_value, value=partial(_one_newton, name="indentation", scale=1e3)),
    "area_power": partial(_area_form, least=_LOW, form=rules.power, other=rules.line),
    "area_linear": partial(_area_form, least=0.0, form=rules.line, other=rules.power),
    "area_load": partial(_holds, values=_grow, holds=lambda rise: rise > 0),
    "area_before": partial(
        _holds,
        values=partial(_apparent, after=("rest", HIGH), before=("rest", 0.0)),
        holds=lambda change: np.abs(change) < CHANGED,
    ),
    "area_after": partial(_holds, values=partial(_apparent, after=("slip", HIGH), before=("slip", 0.0)), holds=_falls),
    **dict.fromkeys(("area_shear", "apparent_sliding"), _SHRINKS),
    "real_sliding": partial(_holds, values=_length, holds=lambda change: change > 0),
    "real_shear": partial(_holds, values=_length, holds=lambda change: change < 0),
    "stuck_share": partial(_near, value=_off_line),
    "stuck_load": partial(
        _holds, values=lambda of: -_slopes(of, _half_stuck(of)), holds=lambda found: np.abs(found + 1) <= EXPONENT
    ),
    "stuck_wet": _stuck_wet,
    "time": _time,
    "softer": _softer,
    "modulus": _modulus,
    "force_depth": _force_depth,
    "pressure_shape": _pressure,
    "friction_input": partial(_value, value=lambda of: of.mu),
    "friction_wet": partial(_value, value=_mu),
    "friction_glass": partial(_value, value=lambda of: _mus(of)[1]),
    "friction_power": _power_law,
    **dict.fromkeys(("friction_load", "friction_savescu"), _SAME),
    "friction_occluded": _FACTOR,
    "friction_acrylic": _LESS,
    "friction_seo": partial(_near, value=_exponent),
    "friction_speed": partial(_speed, wanted=True),
    "friction_no_speed": partial(_speed, wanted=False),
    **dict.fromkeys(("friction_humid", "friction_moist_palm", "friction_time"), _ratio),
    "stiffness_shear": partial(_holds, values=_stiffness, holds=lambda found: np.abs(found - 1) <= EXPONENT),
    "delay_way": partial(_value, value=_way),
    **dict.fromkeys(("adhesion", "adhesion_people"), _pull_off),
    "friction_voltage": partial(_power, values=_friction, ranges=(VOLTAGES[1:],)),
    "friction_range": partial(_power, values=_friction, ranges=AMPLITUDES),
    "real_area": partial(_power, values=_asperities, ranges=AMPLITUDES),
    "friction_slip": partial(_holds, values=_rises, holds=lambda rise: rise > 0),
    "gap": partial(_value, value=_gaps),
    "gap_sliding": _impedance,
    **drives.ROWS,
}
"""By the name of a finding."""
TIMED: dict[str, Callable[[Mapping[str, Any]], Row]] = {"relaxation": _relaxation, "speed": _delay}
"""Of the numbers of docs/viscosity.json."""
