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

from benchmarks.measured import drives, rules
from benchmarks.measured.findings import Finding
from benchmarks.measured.fingers import FORCE, GROWS, HIGH, ROUGHER, SOFTER, VOLTAGES, Finger
from benchmarks.measured.rules import (
    CHANGED,
    EXPONENT,
    RATIO,
    SIMILAR,
    STRIKING,
    by_factor,
    by_form,
    by_share,
)
from variational.attraction.dielectric import VACUUM_PERMITTIVITY
from variational.state import ContactState

Array = NDArray[np.float64]
Row = tuple[dict[str, float], str]
"""Numbers of a row by name, and its verdict."""
Fingers = Mapping[str, Finger]
Computation = Callable[[Finding, Finger, Fingers], Row]
"""Of a finding, the finger that it names, and all fingers."""
AMPLITUDES = ((100.0, 150.0), (50.0, 100.0))
"""Voltages (V) within an amplitude of 75 to 150 V: as a constant voltage, and as that of a sine's mean square."""
_LOW, _ONE, _SHARE = 0.5, 1.0, 0.5  # N: least force of several sources, that of fitted numbers, that of shares
_GROWN = 0.95  # of the growth in the time of the hold


def _both(finger: Finger, value: Callable[[Finger], Any]) -> tuple[Array, float]:
    """Return a number or an array of a finger, and its largest difference from that of the coarser mesh."""
    fine, coarse = np.asarray(value(finger), dtype=float), np.asarray(value(finger.coarse), dtype=float)
    count = min(fine.size, coarse.size) if fine.ndim == 1 else None
    return fine, float(np.abs(fine[:count] - coarse[:count]).max() if count else np.abs(fine - coarse).max())


def _value(row: Finding, finger: Finger, value: Callable[[Finger], float]) -> Row:
    """Judge a number by the rule of its row."""
    found, error = _both(finger, value)
    return {"value": float(found), "error": error}, rules.by_rule(row, float(found), float(found))


def _range(row: Finding, finger: Finger, values: Callable[[Finger], Array]) -> Row:
    """Judge numbers at several forces by the rule of their row."""
    found, error = _both(finger, values)
    low, high = float(found.min()), float(found.max())
    return {"low": low, "high": high, "error": error}, rules.by_rule(row, low, high)


def _holds(finger: Finger, values: Callable[[Finger], Array], holds: Callable[[Array], NDArray[np.bool_]]) -> Row:
    """Judge at how many forces a statement on numbers holds."""
    found, error = _both(finger, values)
    where = holds(found)
    numbers = {"low": found.min(), "high": found.max(), "error": error, "holds": where.sum(), "loads": where.size}
    return numbers, by_share(float(where.mean()))


# -- contact area ----------------------------------------------------------------------------------------------
def _share(finger: Finger, force: float = _SHARE) -> float:
    areas = (finger.at(finger.pressed, name, force) for name in ("contact_area", "gross_area"))
    return next(areas) / next(areas)


def _one_newton(name: str, scale: float, finger: Finger) -> float:
    return scale * finger.at(finger.pressed, name, _ONE)


def _area_form(least: float, form: rules.Form, other: rules.Form, finger: Finger) -> Row:
    """Judge a form of the gross area over the force from a least one (N) on, beside another one."""
    force, area = finger.sums(finger.pressed, "gross_area")
    at = force >= least
    fits = [rules.of_each(each, force[at], area[at]).misfit for each in (form, other)]
    exponent, error = _both(finger, lambda of: np.polyfit(*np.log(of.sums(of.pressed, "gross_area")), 1)[0])
    numbers = {"misfit": fits[0], "other": fits[1], "exponent": float(exponent), "error": error, "most": force[-1]}
    return numbers, by_form(fits[:1], fits[1:])


def _area_load(finger: Finger) -> Row:
    areas = [np.diff(np.log(finger.sums(finger.pressed, name)[1])) for name in ("gross_area", "contact_area")]
    grows = (areas[0] > 0) & (areas[1] > 0)
    return {"holds": grows.sum(), "loads": grows.size}, by_share(float(grows.mean()))


def _apparent(after: Callable[[Finger], list[ContactState]], before: Any, finger: Finger) -> Array:
    """Return the relative change of the gross area from states to others, at each force (N)."""
    areas = [finger.sums(states(finger), "gross_area")[1] for states in (after, before)]
    count = min(map(len, areas))
    return np.asarray(areas[0][:count] / areas[1][:count] - 1)


def _rest(voltage: float) -> Callable[[Finger], list[ContactState]]:
    return lambda finger: finger.rest(voltage)


def _slip(voltage: float) -> Callable[[Finger], list[ContactState]]:
    return lambda finger: finger.slip(voltage)


def _same(change: Array) -> NDArray[np.bool_]:
    return np.abs(change) < CHANGED


def _falls(change: Array) -> NDArray[np.bool_]:
    return change <= -CHANGED


def _length(finger: Finger) -> Array:
    """Return the relative change of the contact length from rest to full slip, at each force."""
    ends = [np.array([s.contact_length for s in states]) for states in (finger.slip(), finger.rest())]
    return np.asarray(ends[0] / ends[1] - 1)


def _stuck(finger: Finger, force: float) -> tuple[Array, Array]:
    """Return friction (N/m) and the stuck share of the contact, from rest to full slip without voltage."""
    path = [finger.path(f"slide {force:g}", "press")[-1], *finger.path(f"slide {force:g}", "slip 0")]
    path = path[: 1 + next(k for k, state in enumerate(path) if state.all_slip)]
    return np.array([s.f_t for s in path]), np.array([1 - s.slipping for s in path])


def _linear(finger: Finger) -> Row:
    """Judge how far the stuck share is from a straight line over the tangential force."""

    def off(of: Finger) -> float:
        force, stuck = _stuck(of, FORCE)
        part = np.linspace(0, 1, 101)
        return float(np.sqrt(np.mean((np.interp(part, force / force[-1], stuck) - (1 - part)) ** 2)))

    found, error = _both(finger, off)
    return {"value": float(found), "error": error}, rules.by_bar(float(found), 0.1, 0.2)


def _half_stuck(finger: Finger) -> Array:
    """Return the tangential force (N/m) at which half of the contact sticks, at each force."""
    found = [_stuck(finger, force) for force in finger.forces]
    return np.array([np.interp(-0.5, -stuck, f_t) for f_t, stuck in found])


def _stuck_wet(finger: Finger, all_: Fingers) -> Row:
    def ratio(wet: Finger, dry: Finger) -> Array:
        pairs = [dict(zip(each.forces, _half_stuck(each), strict=True)) for each in (wet, dry)]
        return np.array([pairs[0][f] / pairs[1][f] for f in pairs[0] if f in pairs[1]])

    dry = all_["fitted"]
    found, error = ratio(finger, dry), float(np.abs(ratio(finger, dry) - ratio(finger.coarse, dry.coarse)).max())
    numbers = {"low": found.min(), "high": found.max(), "error": error}
    return numbers, by_share(float((found > 1 + SIMILAR).mean()))


# -- pressing --------------------------------------------------------------------------------------------------
def _force_depth(finger: Finger) -> Row:
    """Judge an exponential beside a power law, by the misfit of each force and by that of the largest."""
    force, depth = finger.sums(finger.pressed, "indentation")
    fits = [
        [fit(form, depth, force).misfit for fit in (rules.of_each, rules.of_largest)]
        for form in (rules.exponential, rules.power)
    ]
    names = ("each", "largest", "other_each", "other_largest")
    return dict(zip(names, [*fits[0], *fits[1]], strict=True)) | {"most": force[-1]}, by_form(*fits)


def _pressure(finger: Finger) -> Row:
    """Judge a paraboloid beside half an ellipse, over the largest pressure of a ridge."""

    def misfits(of: Finger) -> list[float]:
        ridges = of.path(f"slide {FORCE:g}", "press")[-1].ridges
        assert ridges is not None
        touch = ridges.length > 0
        points = ridges.number[touch].astype(float), ridges.f_contact[touch]
        return [rules.of_largest(form, *points).misfit for form in (rules.paraboloid, rules.ellipse)]

    (misfit, other), error = _both(finger, misfits)
    return {"misfit": misfit, "other": other, "error": error}, by_form((misfit,), (other,))


def _pressed(kind: str, finger: Finger) -> tuple[float, float]:
    """Return contact length and gross width (m) of a pressed finger."""
    state = finger.path(kind, "press")[-1]
    width = (state.ridges_in_contact - 1) * finger.scene.geometry.ridge_wavelength
    return state.contact_length, width + state.contact_length / state.ridges_in_contact


def _changes(kind: str, finger: Finger) -> tuple[Array, float]:
    """Return the relative changes of both by other skin or friction, and the error of the first."""

    def change(of: Finger) -> Array:
        return np.array(_pressed(kind, of)) / np.array(_pressed(f"slide {FORCE:g}", of)) - 1

    return change(finger), float(np.abs(change(finger) - change(finger.coarse))[0])


def _softer(finger: Finger) -> Row:
    """Judge either area at each softening of the stratum corneum."""
    (less, less_error), (more, error) = (_changes(f"soft {each:g}", finger) for each in SOFTER)
    holds = [less[0] >= STRIKING, more[0] >= STRIKING, abs(less[1]) <= SIMILAR, abs(more[1]) <= SIMILAR]
    numbers = {"less": less[0], "less_error": less_error, "more": more[0], "error": error}
    return numbers | {"gross": max(less[1], more[1])}, by_share(sum(holds) / len(holds))


def _modulus(finger: Finger) -> Row:
    (soft, error), (rough, _) = (_changes(kind, finger) for kind in (f"soft {SOFTER[-1]:g}", "rough"))
    return {"soft": soft[0], "rough": rough[0], "error": error, "friction": ROUGHER}, by_share(
        float(abs(soft[0]) > abs(rough[0]))
    )


def _time(finger: Finger) -> Row:
    """Judge for how long the contact of a held finger grows."""
    states = [finger.path("hold", "press")[-1], *finger.path("hold", "hold")]
    time, length = (np.array([getattr(s, key) for s in states]) for key in ("time", "contact_length"))
    time, growth = np.nan_to_num(time - np.nanmin(time)), float(length[-1] / length[0] - 1)
    if growth < SIMILAR:
        return {"growth": growth, "until": 0.0, "seconds": GROWS}, rules.MISS
    grown = np.maximum.accumulate((length - length[0]) / (length[-1] - length[0]))
    until = float(np.interp(_GROWN, grown, time))
    return {"growth": growth, "until": until, "seconds": GROWS}, by_factor(until, until, GROWS, GROWS, RATIO)


# -- friction --------------------------------------------------------------------------------------------------
def _mu(force: float, finger: Finger) -> float:
    """Return the friction coefficient of the whole finger without voltage, at a force (N)."""
    return finger.at(finger.slip(), "mu_app", force)


def _mus(finger: Finger) -> Array:
    """Return it at the forces of several sources (N)."""
    force, mu = finger.sums(finger.slip(), "mu_app")
    return mu[force >= _LOW]


def _exponent(finger: Finger) -> float:
    force, mu = finger.sums(finger.slip(), "mu_app")
    at = force >= _LOW
    return float(np.polyfit(np.log(force[at]), np.log(mu[at]), 1)[0])


def _friction_seo(row: Finding, finger: Finger) -> Row:
    found, error = _both(finger, _exponent)
    off = abs(float(found) - row.bounds[0])
    return {"value": float(found), "error": error}, rules.by_bar(off, 0.1, 0.2)


def _over_load(judge: Callable[[Array], str], finger: Finger) -> Row:
    """Judge the friction coefficients at all forces per length."""
    mu, error = _both(finger, lambda of: of.mu)
    numbers = {"factor": mu.max() / mu.min(), "first": mu[0], "last": mu[-1], "error": error}
    return numbers | {"least": finger.forces[0], "most": finger.forces[-1]}, judge(mu)


def _depends(mu: Array) -> float:
    return float(mu.max() / mu.min() - 1)


def _power_law(finger: Finger) -> Row:
    """Judge whether friction depends on the load, and by a power law."""
    mu, force = finger.mu, np.array(finger.forces)
    misfit, line = (rules.of_each(form, force, mu).misfit for form in (rules.falling_power, rules.falling_line))
    verdict = by_form((misfit,), (line,)) if _depends(mu) > SIMILAR else rules.MISS
    numbers = {"misfit": misfit, "line": line, "factor": mu.max() / mu.min()}
    return numbers | {"exponent": float(np.polyfit(np.log(force), np.log(mu), 1)[0])}, verdict


def _speed(wanted: bool, finger: Finger) -> Row:
    """Judge whether friction depends on the speed: laws with a speed do, and no others."""
    law = finger.scene.friction_law()
    return {}, by_share(float(hasattr(law, "v_0") == wanted))


def _ratio(other: str, row: Finding, finger: Finger, all_: Fingers) -> Row:
    """Judge the friction coefficient over that of another finger, at 1 N."""
    found, coarse = (_mu(_ONE, each) / _mu(_ONE, dry) for each, dry in _meshes(finger, all_[other]))
    return {"value": found, "error": abs(found - coarse)}, rules.by_rule(row, found, found)


def _meshes(*fingers: Finger) -> Sequence[Sequence[Finger]]:
    return [fingers, [each.coarse for each in fingers]]


def _stiffness(finger: Finger) -> Row:
    """Judge the exponent of the tangential stiffness over the load, between neighbouring forces."""

    def exponents(of: Finger) -> Array:
        stiffness = []
        for force in of.forces:
            before, first = of.path(f"slide {force:g}", "press")[-1], of.path(f"slide {force:g}", "slip 0")[0]
            stiffness.append(first.f_t / (first.bone_x - before.bone_x))
        return np.diff(np.log(stiffness)) / np.diff(np.log(of.forces))

    return _holds(finger, exponents, lambda found: np.abs(found - 1) <= EXPONENT)


def _way(finger: Finger) -> Array:
    """Return the ways (m) of sliding after which 63 % of a rise by voltage is there, at each force."""
    found = []
    for force in finger.forces:
        before, *path = [
            finger.path(f"slide {force:g}", "charge")[-1],
            *finger.path(f"slide {force:g}", f"slip {HIGH:g}"),
        ]
        rise = np.array([s.f_t for s in (before, *path)]) - before.f_t
        way = np.array([s.bone_x for s in (before, *path)]) - before.bone_x
        found.append(float(np.interp(1 - np.exp(-1), np.maximum.accumulate(rise / rise[-1]), way)))
    return 1e6 * np.array(found)


# -- over the voltage ------------------------------------------------------------------------------------------
def exponents(values: Array, voltages: Sequence[float]) -> Array:
    """Return the exponent of the rise over the value at 0 V, fitted to logarithms, at each force; shape (forces,)."""
    at = [VOLTAGES.index(u) for u in voltages]
    rise = values[:, at] - values[:, :1]
    return np.polyfit(np.log(voltages), np.log(np.maximum(rise, 1e-15)).T, 1)[0]


def _power(values: Callable[[Finger], Array], ranges: Sequence[Sequence[float]], finger: Finger) -> Row:
    """Judge whether a rise is as the square of the voltage, at each force and in each of the ranges (V)."""
    found, error = _both(finger, lambda of: np.array([exponents(values(of), voltages) for voltages in ranges]))
    near = (np.abs(found - 2) <= EXPONENT).all(axis=0)
    numbers = {"holds": near.sum(), "loads": near.size, "error": error}
    numbers |= {"low": found[0].min(), "high": found[0].max(), "other_low": found[-1].min()}
    return numbers | {"other_high": found[-1].max()}, by_share(float(near.mean()))


def _friction(finger: Finger) -> Array:
    return finger.slips("f_t")


def _asperities(finger: Finger) -> Array:
    """Return the length (m) of asperities in contact, by the mean pressure over the ridges' contact."""
    law, length = finger.scene.closure(), finger.slips("contact_length")
    borne = np.array(finger.forces)[:, None] + finger.slips("f_electrostatic")
    return length * law.statistics(np.clip(borne / length, *law.pressures)).area  # type: ignore[attr-defined]


def _rises(finger: Finger) -> Array:
    f_t = finger.slips("f_t")
    return f_t[:, -1] / f_t[:, 0] - 1


def plates(finger: Finger, states: Sequence[ContactState], voltage: float) -> tuple[Array, Array]:
    """Return air gap (m) and length (m) of equal plates that attract as the ridges do, at each force."""
    length = np.array([s.contact_length for s in states])
    pressure = np.array([s.f_electrostatic for s in states]) / length
    return voltage * np.sqrt(VACUUM_PERMITTIVITY / 2 / pressure) - finger.scene.h_0, length


def _gaps(finger: Finger) -> Array:
    """Return the air gaps (µm) of equal plates, of all forces, voltages and states."""
    states = [(finger.rest(HIGH), HIGH), *((finger.slip(u), u) for u in VOLTAGES[1:])]
    return 1e6 * np.concatenate([plates(finger, each, u)[0] for each, u in states])


def _impedance(row: Finding, finger: Finger, all_: Fingers) -> Row:
    """Judge the impedance of a sliding finger over that of one at rest."""
    held = all_["held"]
    return drives.sliding(
        row, held, plates(held, held.rest(HIGH), HIGH), finger, plates(finger, finger.slip(HIGH), HIGH)
    )


# -- adhesion --------------------------------------------------------------------------------------------------
def _pull_off(row: Finding, finger: Finger) -> Row:
    """Judge the largest tension of the whole finger while it is lifted, from slices that all were pressed."""
    adheres = getattr(finger.scene, "adhesion", None)
    if not adheres:
        return {"value": 0.0}, rules.MISS
    states = [*finger.path("lift", "press")[-1:], *finger.path("lift", "lift")]
    depth, force = (
        np.array([sign * getattr(s, key) for s in states]) for sign, key in ((-1, "bone_height"), (1, "f_ext"))
    )
    order = np.argsort(depth)
    pad = np.linspace(-1, 1, 2001) * finger.scene.slices.length / 2
    rise = pad**2 / (2 * finger.scene.slices.radius)
    every = [np.trapezoid(np.interp(d - rise, depth[order], force[order], left=0.0), pad) for d in depth]
    tension = -1e3 * float(min(every))
    return {"value": tension}, rules.by_rule(row, max(tension, 1e-9), max(tension, 1e-9))


# -- all -------------------------------------------------------------------------------------------------------
def _of(part: Callable[..., Row], *given: Any) -> Computation:
    """Return the computation of a row that needs its finger alone."""
    return lambda row, finger, all_: part(*given, finger)


def _with(part: Callable[..., Row], **named: Any) -> Computation:
    """Return the computation of a row that needs its finding and its finger."""
    return lambda row, finger, all_: part(row, finger, **named)


def _named(part: Callable[[Finger, Fingers], Row]) -> Computation:
    return lambda row, finger, all_: part(finger, all_)


_independent = _of(_over_load, lambda mu: by_share(float(_depends(mu) <= SIMILAR)))
_shrinks = lambda state, before, holds: (  # noqa: E731
    lambda row, finger, all_: _holds(finger, partial(_apparent, state, before), holds)
)
ROWS: dict[str, Computation] = {
    **dict.fromkeys(("share_db1", "share_db2", "ridges", "ridge_width"), _with(_value, value=_share)),
    "gross_1n": _with(_value, value=partial(_one_newton, "gross_area", 1e6)),
    "depth_1n": _with(_value, value=partial(_one_newton, "indentation", 1e3)),
    "area_power": _of(_area_form, _LOW, rules.power, rules.line),
    "area_linear": _of(_area_form, 0.0, rules.line, rules.power),
    "area_load": _of(_area_load),
    "area_before": _shrinks(_rest(HIGH), _rest(0.0), _same),
    "area_after": _shrinks(_slip(HIGH), _slip(0.0), _falls),
    **dict.fromkeys(("area_shear", "apparent_sliding"), _shrinks(_slip(0.0), _rest(0.0), _falls)),
    "real_sliding": lambda row, finger, all_: _holds(finger, _length, lambda change: change > 0),
    "real_shear": lambda row, finger, all_: _holds(finger, _length, lambda change: change < 0),
    "stuck_share": _of(_linear),
    "stuck_load": lambda row, finger, all_: _holds(
        finger,
        lambda of: -np.diff(np.log(_half_stuck(of))) / np.diff(np.log(of.forces)),
        lambda found: np.abs(found + 1) <= EXPONENT,
    ),
    "stuck_wet": _named(_stuck_wet),
    "time": _of(_time),
    "softer": _of(_softer),
    "modulus": _of(_modulus),
    "force_depth": _of(_force_depth),
    "pressure_shape": _of(_pressure),
    "friction_input": _with(_range, values=lambda of: of.mu),
    "friction_wet": _with(_value, value=partial(_mu, _ONE)),
    "friction_glass": _with(_range, values=_mus),
    "friction_power": _of(_power_law),
    **dict.fromkeys(("friction_load", "friction_savescu"), _independent),
    "friction_occluded": lambda row, finger, all_: _over_load(
        lambda mu: rules.by_rule(row, mu.max() / mu.min(), mu.max() / mu.min()), finger
    ),
    "friction_acrylic": _of(_over_load, lambda mu: by_share(float(1 - mu[-1] / mu[0] > SIMILAR))),
    "friction_seo": _with(_friction_seo),
    "friction_speed": _of(_speed, True),
    "friction_no_speed": _of(_speed, False),
    **dict.fromkeys(("friction_humid", "friction_moist_palm", "friction_time"), partial(_ratio, "fitted")),
    "stiffness_shear": _of(_stiffness),
    "delay_way": _with(_range, values=_way),
    **dict.fromkeys(("adhesion", "adhesion_people"), _with(_pull_off)),
    "friction_voltage": _of(_power, _friction, (VOLTAGES[1:],)),
    "friction_range": _of(_power, _friction, AMPLITUDES),
    "real_area": _of(_power, _asperities, AMPLITUDES),
    "friction_slip": lambda row, finger, all_: _holds(finger, _rises, lambda rise: rise > 0),
    "gap": _with(_range, values=_gaps),
    "gap_sliding": _impedance,
    **drives.ROWS,
}
"""By the name of a finding."""
