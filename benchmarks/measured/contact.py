"""Numbers and verdicts of the findings on contact areas, pressing and time, each from the runs of a finger.

The apparent area is the gross area of the whole finger, a sum of slices. The real area is the contact length or area of
the ridges.
"""

from functools import partial

import numpy as np

from benchmarks.measured import rules
from benchmarks.measured.fingers import FORCE, GROWS, HIGH, ROUGHER, SOFTER, Array, Case, Computation, Finger, Row
from benchmarks.measured.rules import CHANGED, EXPONENT, RATIO, SIMILAR, STRIKING, by_factor, by_form, by_share

_GROWN = 0.95  # of the growth in the time of the hold


# -- contact area ----------------------------------------------------------------------------------------------
def _share(finger: Finger) -> float:
    area, gross = (finger.at(finger.pressed, name, rules.LEAST) for name in ("contact_area", "gross_area"))
    return area / gross


def _one_newton(finger: Finger, name: str, scale: float) -> float:
    return scale * finger.at(finger.pressed, name, rules.ONE)


def _area_form(case: Case, least: float, form: rules.Form, other: rules.Form) -> Row:
    """Judge a form of the gross area over the force from a least one (N) on, beside another one."""
    force, area = case.finger.sums(case.finger.pressed, "gross_area", least)
    misfit, beside = (rules.of_each(each, force, area).misfit for each in (form, other))
    exponent, error = rules.both(case.finger, lambda of: rules.exponent(*of.sums(of.pressed, "gross_area")))
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


def _stuck_wet(case: Case) -> Row:
    def ratio(wet: Finger, dry: Finger) -> Array:
        wets, dries = (dict(zip(each.forces, _half_stuck(each), strict=True)) for each in (wet, dry))
        return np.array([wets[f] / dries[f] for f in wets if f in dries])

    found, error = rules.both_of(case, "fitted", ratio)
    return {"low": found.min(), "high": found.max(), "error": error}, by_share(float((found > 1 + SIMILAR).mean()))


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

    (misfit, other), error = rules.both(case.finger, misfits)
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
    less, more = (rules.both(case.finger, partial(_change, kind=f"soft {each:g}")) for each in SOFTER)
    areas, gross = [less[0][0], more[0][0]], max(less[0][1], more[0][1])
    numbers = {"less": areas[0], "less_error": less[1], "more": areas[1], "error": more[1], "gross": gross}
    return numbers, by_share(float(np.mean([*(each >= STRIKING for each in areas), *[gross <= SIMILAR] * 2])))


def _modulus(case: Case) -> Row:
    kinds = f"soft {SOFTER[-1]:g}", "rough"
    (soft, error), (rough, _) = (rules.both(case.finger, partial(_change, kind=kind)) for kind in kinds)
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


_FALLS = partial(rules.judge_holds, holds=lambda change: change <= -CHANGED)
_SHRINKS = partial(_FALLS, values=partial(_apparent, after=("slip", 0.0), before=("rest", 0.0)))
ROWS: dict[str, Computation] = {
    **dict.fromkeys(("share_db1", "share_db2", "ridges", "ridge_width"), partial(rules.judge_value, value=_share)),
    "gross_1n": partial(rules.judge_value, value=partial(_one_newton, name="gross_area", scale=1e6)),
    "depth_1n": partial(rules.judge_value, value=partial(_one_newton, name="indentation", scale=1e3)),
    "area_power": partial(_area_form, least=rules.LEAST, form=rules.power, other=rules.line),
    "area_linear": partial(_area_form, least=0.0, form=rules.line, other=rules.power),
    "area_load": partial(rules.judge_holds, values=_grow, holds=lambda rise: rise > 0),
    "area_before": partial(
        rules.judge_holds,
        values=partial(_apparent, after=("rest", HIGH), before=("rest", 0.0)),
        holds=lambda change: np.abs(change) < CHANGED,
    ),
    "area_after": partial(_FALLS, values=partial(_apparent, after=("slip", HIGH), before=("slip", 0.0))),
    **dict.fromkeys(("area_shear", "apparent_sliding"), _SHRINKS),
    "real_sliding": partial(rules.judge_holds, values=_length, holds=lambda change: change > 0),
    "real_shear": partial(rules.judge_holds, values=_length, holds=lambda change: change < 0),
    "stuck_share": partial(rules.judge_near, value=_off_line),
    "stuck_load": partial(
        rules.judge_holds,
        values=lambda of: -rules.slopes(of, _half_stuck(of)),
        holds=lambda found: np.abs(found + 1) <= EXPONENT,
    ),
    "stuck_wet": _stuck_wet,
    "time": _time,
    "softer": _softer,
    "modulus": _modulus,
    "force_depth": _force_depth,
    "pressure_shape": _pressure,
}
"""By the name of a finding."""
