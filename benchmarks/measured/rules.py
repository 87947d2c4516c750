"""The rules of the verdicts, the same for every row of a kind, and the forms that are fitted to curves.

Their words are at the head of data/findings.toml. A measured form of a curve stands beside another one with as many
parameters.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from benchmarks.measured.findings import Finding
from benchmarks.measured.fingers import Case, Finger, Row

HIT, PART, MISS, OPEN = "hit", "partly", "miss", "not computed"
LEAST, ONE = 0.5, 1.0  # N: least force of several sources, where shares are compared, and of fitted numbers
EXPONENT = 0.25  # from the measured exponent: what 10 % of scatter makes of a factor of 2 in voltage
RATIO, VALUE = 1.25, 2.0  # largest factors of a ratio that is hit, and of a number that is met partly
MISFIT = 0.1  # rms of a fitted curve
STRIKING, SIMILAR = 0.25, 0.1  # relative changes that count as strikingly higher, and as similar
CHANGED = 0.03  # relative change from which on a gross area counts as another: half a ridge of 17
SPREADS = 1.5  # from the measured value


def by_share(share: float) -> str:
    """Return the verdict on a statement that holds at a part of the loads: all, half of them or more, or fewer."""
    return HIT if share == 1 else PART if share >= 0.5 else MISS


def by_factor(low: float, high: float, least: float, most: float, allowed: float = 1.0) -> str:
    """Return the verdict on numbers from ``low`` to ``high`` beside measured ones from ``least`` to ``most``.

    All positive; ``allowed`` is the factor by which a number that is hit can be outside.
    """
    beyond = max(least / low, high / most, 1.0)
    return HIT if beyond <= allowed else PART if beyond <= VALUE else MISS


def by_spread(low: float, high: float, value: float, spread: float) -> str:
    """Return the verdict on numbers from ``low`` to ``high`` beside a measured one and its standard deviation."""
    return HIT if max(value - low, high - value) <= SPREADS * spread else MISS


def by_bar(number: float, hit: float, part: float | None = None) -> str:
    """Return the verdict on a number that should be small."""
    return HIT if number <= hit else PART if part is not None and number <= part else MISS


def by_rule(row: Finding, low: float, high: float) -> str:
    """Return the verdict on numbers from ``low`` to ``high`` by the rule of a finding: ratio, range or spread."""
    if row.spread is not None and row.rule == "spread":
        return by_spread(low, high, row.bounds[0], row.spread)
    sign = np.sign(row.bounds[0])
    (least, most), (low, high) = (sorted(sign * each for each in ends) for ends in (row.bounds, (low, high)))
    return by_factor(low, high, least, most, RATIO if row.rule == "ratio" else 1.0) if low > 0 else MISS


def by_form(misfits: Sequence[float], others: Sequence[float]) -> str:
    """Return the verdict on a measured form of a curve, beside another form with as many parameters.

    Args:
        misfits: rms of the fitted form, by each measure of it.
        others: rms of the other form, in the same order. Where it fits too, the curve cannot show which form it has.
    """
    found = by_share(sum(each <= MISFIT for each in misfits) / len(misfits))
    return PART if found == HIT and all(each <= MISFIT for each in others) else found


# -- forms -----------------------------------------------------------------------------------------------------
Array = NDArray[np.float64]


class Fit(NamedTuple):
    """A form fitted to a curve: its parameter and the rms of what is left."""

    parameter: float
    misfit: float


class Form(NamedTuple):
    """A curve over x with one parameter, of any scale."""

    curve: Callable[[Array, float], Array]
    low: float
    """Least parameter that is looked for."""
    high: float
    """Largest one."""

    def __call__(self, x: Array, parameter: float) -> Array:
        """Return the curve."""
        return np.asarray(self.curve(x, parameter))


exponential = Form(lambda x, b: np.expm1(b * x / x.max()), 1e-3, 50.0)
power = Form(lambda x, n: (x / x.max()) ** n, 0.05, 10.0)
line = Form(lambda x, start: start + (1 - start) * x / x.max(), 0.0, 0.99)
high_pass = Form(lambda x, cut: x**2 / (x**2 + (cut * x.max()) ** 2), 1e-4, 1.0)
"""The square of a first-order one, with a cut-off in units of the largest x."""
first_order = Form(lambda x, tau: -np.expm1(-x / (tau * x.max())), 1e-3, 10.0)
ramp = Form(lambda x, end: np.minimum(x / (end * x.max()), 1.0), 1e-3, 1.0)
falling_power = Form(lambda x, n: (x / x.min()) ** -n, 1e-3, 10.0)
falling_line = Form(lambda x, end: 1 - (1 - end) * (x - x.min()) / np.ptp(x), 1e-3, 1.0)
paraboloid = Form(lambda x, a: np.clip(1 - (x / (a * np.abs(x).max())) ** 2, 0, None), 1.0, 10.0)
ellipse = Form(lambda x, a: np.sqrt(paraboloid(x, a)), 1.0, 10.0)
"""Half an ellipse, Hertz's pressure."""


def of_each(form: Form, x: Array, y: Array) -> Fit:
    """Fit a form by logarithms; the misfit is that of each value."""

    def rest(parameter: float) -> float:
        return float(np.std(np.log(y) - np.log(form(x, parameter))))

    return _least(rest, form)


def of_largest(form: Form, x: Array, y: Array) -> Fit:
    """Fit a form by least squares; the misfit is over the largest value."""

    def rest(parameter: float) -> float:
        curve = form(x, parameter)
        return float(np.sqrt(np.mean((y - scale(curve, y) * curve) ** 2)) / y.max())

    return _least(rest, form)


def exponent(x: Array, y: Array) -> float:
    """Return the exponent of a power law, fitted to logarithms."""
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])


def scale(curve: Array, y: Array) -> float:
    """Return the factor by which a curve is closest to ``y``."""
    return float(curve @ y / (curve @ curve))


def _least(rest: Callable[[float], float], form: Form) -> Fit:
    found = minimize_scalar(rest, bounds=(form.low, form.high), method="bounded", options={"xatol": 1e-9})
    return Fit(float(found.x), float(found.fun))


# -- numbers and verdicts that rows share ----------------------------------------------------------------------
def both(finger: Finger, value: Callable[[Finger], Any]) -> tuple[Any, float]:
    """Return a number or an array of a finger, and its largest difference from that of the coarser mesh."""
    fine, coarse = np.asarray(value(finger), dtype=float), np.asarray(value(finger.coarse), dtype=float)
    if fine.shape != coarse.shape:  # forces (N) that the traces of one mesh alone reach
        fine, coarse = (each[: min(len(fine), len(coarse))] for each in (fine, coarse))
    return fine, float(np.abs(fine - coarse).max())


def judge_value(case: Case, value: Callable[[Finger], Any]) -> Row:
    """Judge a number, or the range of several, by the rule of its row."""
    found, error = both(case.finger, value)
    low, high = float(found.min()), float(found.max())
    return {"value": low, "low": low, "high": high, "error": error}, by_rule(case.row, low, high)


def judge_near(case: Case, value: Callable[[Finger], Any]) -> Row:
    """Judge a number by its distance from the measured one: 0.1 for a hit, 0.2 for a part."""
    found, error = both(case.finger, value)
    measured = 0.0 if isinstance(case.row.value, str) else case.row.bounds[0]
    return {"value": float(found), "error": error}, by_bar(abs(float(found) - measured), 0.1, 0.2)


def judge_holds(case: Case, values: Callable[[Finger], Array], holds: Callable[[Array], NDArray[np.bool_]]) -> Row:
    """Judge at how many forces a statement on numbers holds."""
    found, error = both(case.finger, values)
    where = holds(found)
    numbers = {"low": found.min(), "high": found.max(), "error": error, "holds": where.sum(), "loads": where.size}
    return numbers, by_share(float(where.mean()))


def both_of(case: Case, other: str, value: Callable[[Finger, Finger], Any]) -> tuple[Any, float]:
    """Return what follows from two fingers, and its difference from that of the coarser meshes."""
    two = case.finger, case.every[other]
    found, coarse = np.asarray(value(*two)), np.asarray(value(*(each.coarse for each in two)))
    return found, float(np.abs(found - coarse).max())


def slopes(finger: Finger, values: Array) -> Array:
    """Return the exponent of values over the force, between neighbouring forces."""
    return np.diff(np.log(values)) / np.diff(np.log(finger.forces))
