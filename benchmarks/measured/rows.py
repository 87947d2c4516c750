"""Numbers and verdicts of the findings on friction and voltage, each from the runs of a finger.

What is compared is the quantity that was measured. The real area over the voltage is that of asperities on the ridges.
The stated error is the difference of two meshes. Those on contact without voltage are in :mod:`.contact`.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from benchmarks import viscosity
from benchmarks.measured import contact, drives, rules
from benchmarks.measured.fingers import HIGH, VOLTAGES, Array, Case, Computation, Finger, Row, adheres
from benchmarks.measured.rules import EXPONENT, RATIO, SIMILAR, by_factor, by_form, by_share
from variational.attraction.dielectric import VACUUM_PERMITTIVITY
from variational.state import ContactState

AMPLITUDES = ((100.0, 150.0), (50.0, 100.0))
"""Voltages (V) within an amplitude of 75 to 150 V: as a constant voltage, and as that of a sine's mean square."""


# -- friction --------------------------------------------------------------------------------------------------
def _mu(finger: Finger) -> float:
    """Return the friction coefficient of the whole finger without voltage under 1 N."""
    return finger.at(finger.slip(), "mu_app", rules.ONE)


def _mus(finger: Finger) -> tuple[Array, Array]:
    """Return forces (N) of several sources and the friction coefficient at each."""
    return finger.sums(finger.slip(), "mu_app", rules.LEAST)


def _exponent(finger: Finger) -> float:
    return rules.exponent(*_mus(finger))


def _over_load(case: Case, judge: Callable[[Case, Array], str]) -> Row:
    """Judge the friction coefficients at all forces per length."""
    mu, error = rules.both(case.finger, lambda of: of.mu)
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
    found, error = rules.both_of(case, "fitted", lambda finger, dry: _mu(finger) / _mu(dry))
    return {"value": float(found), "error": error}, rules.by_rule(case.row, float(found), float(found))


def _stiffness(finger: Finger) -> Array:
    """Return the exponent of the tangential stiffness over the load, between neighbouring forces."""
    firsts = [
        [finger.path(f"slide {f:g}", "press")[-1], finger.path(f"slide {f:g}", "slip 0")[0]] for f in finger.forces
    ]
    return rules.slopes(finger, np.array([(two.f_t - one.f_t) / (two.bone_x - one.bone_x) for one, two in firsts]))


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
    found, error = rules.both(case.finger, lambda of: [exponents(values(of), voltages) for voltages in ranges])
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
_SAME = partial(_over_load, judge=lambda case, mu: by_share(float(_factor(mu) <= 1 + SIMILAR)))
_FACTOR = partial(_over_load, judge=lambda case, mu: rules.by_rule(case.row, _factor(mu), _factor(mu)))
_LESS = partial(_over_load, judge=lambda case, mu: by_share(float(1 - mu[-1] / mu[0] > SIMILAR)))
ROWS: dict[str, Computation] = {
    **contact.ROWS,
    "friction_input": partial(rules.judge_value, value=lambda of: of.mu),
    "friction_wet": partial(rules.judge_value, value=_mu),
    "friction_glass": partial(rules.judge_value, value=lambda of: _mus(of)[1]),
    "friction_power": _power_law,
    **dict.fromkeys(("friction_load", "friction_savescu"), _SAME),
    "friction_occluded": _FACTOR,
    "friction_acrylic": _LESS,
    "friction_seo": partial(rules.judge_near, value=_exponent),
    "friction_speed": partial(_speed, wanted=True),
    "friction_no_speed": partial(_speed, wanted=False),
    **dict.fromkeys(("friction_humid", "friction_moist_palm", "friction_time"), _ratio),
    "stiffness_shear": partial(rules.judge_holds, values=_stiffness, holds=lambda found: np.abs(found - 1) <= EXPONENT),
    "delay_way": partial(rules.judge_value, value=_way),
    **dict.fromkeys(("adhesion", "adhesion_people"), _pull_off),
    "friction_voltage": partial(_power, values=_friction, ranges=(VOLTAGES[1:],)),
    "friction_range": partial(_power, values=_friction, ranges=AMPLITUDES),
    "real_area": partial(_power, values=_asperities, ranges=AMPLITUDES),
    "friction_slip": partial(rules.judge_holds, values=_rises, holds=lambda rise: rise > 0),
    "gap": partial(rules.judge_value, value=_gaps),
    "gap_sliding": _impedance,
    **drives.ROWS,
}
"""By the name of a finding."""
TIMED: dict[str, Callable[[Mapping[str, Any]], Row]] = {"relaxation": _relaxation, "speed": _delay}
"""Of the numbers of docs/viscosity.json."""
