r"""Keys of a scene over their ranges, targets, and the places at which functions of keys reach them.

Roots over one key are sign changes on a grid. The range is divided into six intervals. In each at whose ends the
function is on either side of the target there is a root (R. P. Brent 1973, "Algorithms for Minimization without
Derivatives", chapter 4, by SciPy), or a jump. An extremum between three neighbours that comes near the target is
computed first, so that a pair of roots in one interval is found. Two roots closer than an interval may be missed beside
others.

Over several keys, and where a value takes a whole run, :func:`newton` solves for the residuals r by
:math:`J \Delta x = -r`. A row of J is of the slopes of the present state. A row without them is that of the state
before, with Broyden's update, :math:`J_i \leftarrow J_i + (\Delta r_i - J_i \Delta x) \Delta x^T / |\Delta x|^2`
(C. G. Broyden 1965, doi:10.1090/S0025-5718-1965-0198670-6), which over one key is the secant.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, Self

import numpy as np
import scipy  # its parts are imported where they are used first
from numpy.typing import NDArray

from fingerpad.results.quantities import FINGER, QUANTITIES, Output, in_table, plus_minus
from fingerpad.scene import Scene, value_of, with_values
from fingerpad.scene.keys import by_name
from fingerpad.scene.messages import SceneError, clip, show
from geometry.units import to_si

Array = NDArray[np.float64]
RANGES = {
    "voltage": (0.0, 400.0),
    "force": (0.05, 3.0),
    "f_ext": (5.0, 150.0),
    "friction": (0.1, 1.0),
    "electric.d_i": (0.1e-6, 100e-6),
    "electric.eps_i": (2.0, 30.0),
}
"""Default ranges of keys (SI): of people's loads, and of coatings and films on screens.

Others are from a tenth to ten times their value."""
EQUAL = 1e-9
"""Relative difference of values that are equal."""
_EQUAL_RATIOS = 8.0  # ratio of the ends of a range, from which on it is divided at equal ratios
_INTERVALS = 6
_TOLERANCE = 1e-6  # of a root, relative to the range
_JUMP = 1e-3  # relative difference from the target at a sign change that is a jump
_BISECTIONS = 8  # between a place with a value and one without
TOLERANCE = 1e-4
"""Relative distance from a target at which Newton's method ends."""
_MOST, _PROBE = 10, 1e-3  # steps of Newton's method, and a step for slopes that are not known
_ALIKE = 1e8  # condition number of slopes, from which on keys act alike


@dataclass(frozen=True)
class Axis:
    """A key of a scene and its range; SI units."""

    key: str
    low: float
    high: float
    unit: str
    """Of the key, in SI; empty without one."""

    @property
    def logarithmic(self) -> bool:
        """Whether the range is divided at equal ratios."""
        return self.low > 0 and self.high > _EQUAL_RATIOS * self.low

    def place(self, value: float) -> float:
        """Return the place of a value of the key in its range, 0 to 1: at equal ratios, or at equal distances."""
        a, b, x = map(math.log, (self.low, self.high, value)) if self.logarithmic else (self.low, self.high, value)
        return (x - a) / (b - a)

    def value(self, place: float) -> float:
        """Return the value of the key at a place, within the range."""
        ratio = self.high / self.low if self.logarithmic else 1.0
        found = self.low * ratio**place if self.logarithmic else self.low + place * (self.high - self.low)
        return float(min(max(found, self.low), self.high))

    def slope(self, place: float) -> float:
        """Return the derivative of the key by its place."""
        width = self.high - self.low
        return self.value(place) * math.log(self.high / self.low) if self.logarithmic else width

    def spread(self, count: int) -> list[float]:
        """Return values of the key from end to end of the range, those between rounded to 6 digits."""
        places = np.linspace(0.0, 1.0, count)[1:-1]
        return [self.low, *(float(f"{self.value(place):.6g}") for place in places), self.high]

    def shown(self, *values: float, error: float = math.nan) -> str:
        """Return one or two values of the key with their unit, also with its error; short lengths in µm."""
        short = self.unit == "m" and max(map(abs, values)) < 1e-3
        unit, factor = ("µm", 1e6) if short else (self.unit, 1.0)
        known = error == error
        text = (
            plus_minus(values[0] * factor, error * factor)
            if known
            else " to ".join(f"{v * factor:.4g}" for v in values)
        )
        return f"{text} {unit}".rstrip()

    @classmethod
    def of(cls, scene: Scene, key: str, between: Sequence[float | str] | None = None) -> Self:
        """Return a key of a scene with a range.

        Args:
            scene: the scene.
            key: dotted, as in :func:`fingerpad.runs.sweep.sweep`; its values are numbers.
            between: first and last value, in SI or as texts with a unit; by default of :data:`RANGES`, or from a
                tenth to ten times the scene's value.

        Raises:
            SceneError: no such key, one without a number, or an impossible range.
        """
        if not isinstance(key, str) or "=" in key or not key:
            raise SceneError(
                f"over is {show(key)}; it must be the name of one key, such as 'voltage' or 'electric.d_i'"
            )
        found = by_name(Scene).get(key)
        if found is None:
            with_values(scene, {key: 1.0})  # refuses an unknown one, with the nearest
        if found is None or found.limits is None or found.choices:
            raise SceneError(
                f"over is {clip(key)}; it must be a key of one number that may have a fraction, such as voltage "
                "(fingerpad sweep varies whole numbers and names)"
            )
        if between is not None:
            if isinstance(between, str) or not isinstance(between, Sequence) or len(between) != 2:
                raise SceneError(f"between is {show(between)}; it must be the first and the last value of {key}")
            low, high = (float(value_of(with_values(scene, {key: each}), key)) for each in between)
        elif key in RANGES:
            low, high = RANGES[key]
        else:
            try:
                present = value_of(scene, key)
            except AttributeError:  # of a table in whose place the scene has a number
                present = None
            if not isinstance(present, int | float) or not present:
                raise SceneError(f"{key} has no value in the scene to vary around; give its first and its last value")
            low, high = sorted((present / 10.0, present * 10.0))
            low, high = max(low, found.limits.low), min(high, found.limits.high)
        if not low < high:
            raise SceneError(f"the range of {key} is {low:g} to {high:g}; the last value must be above the first")
        return cls(key, low, high, found.unit)


@dataclass(frozen=True)
class Target:
    """A quantity at full slip and the value that it is to have."""

    quantity: Output
    whole: bool
    """Whether it is of the whole finger, else of the section at its centre."""
    value: float
    """In SI, or relative to the value without voltage."""
    relative: bool
    at: Mapping[str, Any]
    """Values of other keys in its state, by dotted key."""

    @classmethod
    def of(cls, name: str, given: Any, relative: bool, whole: bool, at: Mapping[str, Any]) -> Self:
        """Return a target.

        Args:
            name: of the quantity.
            given: its value in SI, or a text with a unit.
            relative: whether the value is a multiple of that without voltage.
            whole: whether a name of both is that of the whole finger; the unit of a text decides first.
            at: values of other keys.

        Raises:
            SceneError: no such quantity, no number, or a unit that does not fit.
        """
        tables = {True: {key: each for key, each in FINGER.items() if key != "f_ext"},
                  False: {key: QUANTITIES[key] for key in in_table("target")}}  # fmt: skip
        found = [(table[name], of) for of in (whole, not whole) if name in (table := tables[of])]
        if not found:
            known = ", ".join(dict.fromkeys([*tables[False], *tables[True]]))
            raise SceneError(f"{clip(name)} is not a quantity of a target; it must be one of {known}")
        why = "it must be a finite number"
        if isinstance(given, str) and not relative:
            for quantity, of in found if found[0][0].unit else ():  # f_t may be N/m or N
                try:
                    return cls(quantity, of, to_si(given, quantity.si), False, at)
                except ValueError as error:
                    why = str(error) if why.endswith("number") else why
        elif isinstance(given, int | float) and not isinstance(given, bool) and math.isfinite(given):
            return cls(*found[0], float(given), relative, at)
        raise SceneError(f"target {name} is {show(given)}; {why}")

    @property
    def words(self) -> str:
        """Name and state, in words."""
        at = ", ".join(f"{key} {show(value)}" for key, value in self.at.items())
        return f"{self.quantity.name} at {at}" if at else self.quantity.name

    def shown(self, *values: float) -> str:
        """Return one or two values of the kind of :attr:`value` in the unit of tables."""
        unit = "times its value without voltage" if self.relative else self.quantity.unit
        scale = 1.0 if self.relative else self.quantity.scale
        return f"{' to '.join(f'{value * scale:.4g}' for value in values)} {unit}".rstrip()


@dataclass
class Roots:
    """A function over a range, and where it reaches a target."""

    function: Callable[[float], float]
    """Of a place; raises :class:`SceneError` where it has no value."""
    low: float
    high: float
    target: float
    values: dict[float, float] = field(default_factory=dict)
    """By place, each computed once."""
    refusals: dict[float, str] = field(default_factory=dict)
    """Why there is no value, by place."""
    jumps: list[float] = field(default_factory=list)
    """Places at which the function jumps over the target."""

    def find(self) -> list[float]:
        """Return the places at which the function has the target, in growing order.

        Raises:
            SceneError: the function has no value anywhere on the grid.
        """
        grid = [self.low + k * (self.high - self.low) / _INTERVALS for k in range(_INTERVALS)] + [self.high]
        there = [each for each in grid if self._has(each)]
        if not there:
            raise SceneError(next(iter(self.refusals.values())))
        places = sorted({*there, *self._last_values(grid)})
        places = sorted({*places, *self._extrema(places)})
        off = {each: self._off(each) for each in places}
        size = EQUAL * max(abs(self.target), *map(abs, self.values.values()))
        found = [each for each in places if abs(off[each]) <= size]
        for a, b in zip(places, places[1:], strict=False):
            if min(abs(off[a]), abs(off[b])) > size and (off[a] > 0) != (off[b] > 0):
                tolerance = _TOLERANCE * (self.high - self.low)
                root = float(scipy.optimize.brentq(lambda x: self._off(float(x)), a, b, xtol=tolerance))
                miss = abs(self._off(root)) > _JUMP * (abs(self.target) or abs(off[b] - off[a]))
                (self.jumps if miss else found).append(root)
        return sorted(found)

    def _has(self, place: float) -> bool:
        """Compute the value at a place if it is not there, and return whether there is one."""
        if place not in self.values and place not in self.refusals:
            try:
                self.values[place] = self.function(place)
            except SceneError as error:
                self.refusals[place] = str(error)
        return place in self.values

    def _off(self, place: float) -> float:
        if not self._has(place):
            raise SceneError(self.refusals[place])
        return self.values[place] - self.target

    def _last_values(self, grid: Sequence[float]) -> Iterator[float]:
        """Yield the last places with a value next to those without one, by bisection."""
        for a, b in zip(grid, grid[1:], strict=False):
            if (a in self.values) != (b in self.values):
                good, bad = (a, b) if a in self.values else (b, a)
                for _ in range(_BISECTIONS):
                    middle = (good + bad) / 2
                    good, bad = (middle, bad) if self._has(middle) else (good, middle)
                yield good

    def _extrema(self, places: Sequence[float]) -> Iterator[float]:
        """Yield the extrema towards the target between places on one side of it."""
        for a, place, b in zip(places, places[1:], places[2:], strict=False):
            off = [self._off(each) for each in (a, place, b)]
            if len({x > 0 for x in off}) == 1 and abs(off[1]) < min(abs(off[0]), abs(off[2])):
                sign, options = math.copysign(1.0, off[1]), {"xatol": 1e-3 * (b - a)}
                yield float(scipy.optimize.minimize_scalar(
                    lambda x, sign=sign: sign * self._off(float(x)), bounds=(a, b), method="bounded", options=options
                ).x)  # fmt: skip


def newton(
    state: Callable[[Array], tuple[Array, Array]], place: Array, slopes: Array, keys: Sequence[str]
) -> tuple[Array, Array, str]:
    """Return the places of keys at which residuals vanish within :data:`TOLERANCE`, or the nearest that was found.

    A step ends at the ends of the ranges. One to larger residuals, or to no state, is shortened.

    Args:
        state: residuals at places from 0 to 1, shape (keys,), and their derivatives by the places, shape (keys, keys),
            NaN where they are not known; raises :class:`SceneError` where there is no state.
        place: where to start.
        slopes: derivatives there, for those that are not known of a state; NaN for the difference of two states.
        keys: their names.

    Returns:
        Places, derivatives there, and why residuals are larger; empty where they are not.

    Raises:
        SceneError: no state at the start, a key without effect, or keys that act alike.
    """
    off, exact = state(place)
    slopes = np.where(np.isnan(exact), slopes, exact)
    for k in np.flatnonzero(np.isnan(slopes).any(axis=0)):
        step = np.eye(len(place))[k] * (_PROBE if place[k] < 0.5 else -_PROBE)
        with suppress(SceneError):
            slopes[:, k] = np.where(np.isnan(slopes[:, k]), (state(place + step)[0] - off) / step[k], slopes[:, k])
    part, why = 1.0, ""
    for count in range(_MOST + 1):
        if np.abs(off).max() <= TOLERANCE:
            return place, slopes, ""
        if none := [key for key, by_key in zip(keys, slopes.T, strict=True) if not by_key.any()]:
            raise SceneError(f"{none[0]} has no effect here: its slope is 0; vary another key")
        if not np.linalg.cond(slopes) < _ALIKE:
            raise SceneError(f"{' and '.join(keys)} act alike here: their slopes are proportional; vary another key")
        wanted = place - part * np.linalg.solve(slopes, off)
        if beyond := [key for key, x, y in zip(keys, place, wanted, strict=True) if x <= 0 > y or x >= 1 < y]:
            return place, slopes, f"the range of {beyond[0]} ends there"
        if count == _MOST:
            break
        step = np.clip(wanted, 0.0, 1.0) - place
        try:
            other, known = state(place + step)
        except SceneError as error:
            part, why = part / 2, str(error)
            continue
        slopes = slopes + np.outer(other - off - slopes @ step, step) / (step @ step)
        if (ratio := float(np.linalg.norm(other) / np.linalg.norm(off))) < 1:
            place, off, exact, part, why = place + step, other, known, 1.0, ""
        else:
            part, why = part / (1 + ratio), "states beside it are further away"
        slopes = np.where(np.isnan(exact), slopes, exact)
    return place, slopes, why or f"{_MOST} steps were not enough"
