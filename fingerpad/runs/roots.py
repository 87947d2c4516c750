"""A key of a scene over a range, and the places at which a function of it reaches a target.

Roots are sign changes on a grid. The range is divided into six intervals. In each at whose ends the function is on
either side of the target there is a root (R. P. Brent 1973, "Algorithms for Minimization without Derivatives",
chapter 4, by SciPy), or a jump. An extremum between three neighbours that comes near the target is computed first, so
that a pair of roots in one interval is found. Two roots closer than an interval may be missed beside others.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy  # its parts are imported where they are used first

from fingerpad.results.quantities import plus_minus
from fingerpad.scene import Scene, value_of, with_values
from fingerpad.scene.keys import by_name
from fingerpad.scene.messages import SceneError, clip, show

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
        """Return the place of a value of the key: its logarithm, or the value itself."""
        return math.log(value) if self.logarithmic else value

    def value(self, place: float) -> float:
        """Return the value of the key at a place, within the range."""
        return min(max(math.exp(place) if self.logarithmic else place, self.low), self.high)

    def spread(self, count: int) -> list[float]:
        """Return values of the key from end to end of the range, those between rounded to 6 digits."""
        places = np.linspace(self.place(self.low), self.place(self.high), count)[1:-1]
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


def axis(scene: Scene, key: str, between: Sequence[float | str] | None = None) -> Axis:
    """Return a key of a scene with a range.

    Args:
        scene: the scene.
        key: dotted, as in :func:`fingerpad.runs.sweep.sweep`; its values are numbers.
        between: first and last value, in SI or as texts with a unit; by default of :data:`RANGES`, or from a tenth to
            ten times the scene's value.

    Raises:
        SceneError: no such key, one without a number, or an impossible range.
    """
    if not isinstance(key, str) or "=" in key or not key:
        raise SceneError(f"over is {show(key)}; it must be the name of one key, such as 'voltage' or 'electric.d_i'")
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
    return Axis(key, low, high, found.unit)


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

    def slope(self, place: float) -> float:
        """Return the derivative at a place, by the nearest other place with a value."""
        step = 1e-3 * (self.high - self.low)
        other = place + step if place + step <= self.high else place - step
        return (self.values[other] - self.values[place]) / (other - place) if self._has(other) else math.nan

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
