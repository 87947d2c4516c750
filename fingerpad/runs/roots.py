"""Places at which a function reaches a target: sign changes on a grid, refined by Brent's method.

The range is divided into :data:`INTERVALS`. In each at whose ends the function is on either side of the target there is
a root (R. P. Brent 1973, "Algorithms for Minimization without Derivatives", chapter 4, by SciPy), or a jump, which is
reported as such. An extremum between three neighbours that comes near the target is looked for first, so that a pair of
roots in one interval is found. Two roots closer than an interval may be missed beside others.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import scipy  # its parts are imported where they are used first

from fingerpad.scene.messages import SceneError

INTERVALS = 6
_TOLERANCE = 1e-6  # of a root, relative to the range
_JUMP = 1e-3  # relative difference from the target behind which a sign change is a jump
_SAME = 1e-9  # relative difference of values that are one
_BISECTIONS = 8  # between a place with an answer and one without


@dataclass
class Roots:
    """A function over a range, and where it reaches a target."""

    function: Callable[[float], float]
    """Of a place; raises :class:`SceneError` where there is no answer."""
    low: float
    high: float
    target: float
    values: dict[float, float] = field(default_factory=dict)
    """By place, each computed once."""
    refusals: dict[float, str] = field(default_factory=dict)
    """Why there is no answer, by place."""
    jumps: list[float] = field(default_factory=list)
    """Places at which the function jumps over the target."""

    def find(self) -> list[float]:
        """Return the places at which the function has the target, in growing order.

        Raises:
            SceneError: there is no answer anywhere on the grid.
        """
        grid = [self.low + k * (self.high - self.low) / INTERVALS for k in range(INTERVALS)] + [self.high]
        for place in grid:
            self._has(place)
        if not self.values:
            raise SceneError(next(iter(self.refusals.values())))
        places = sorted({each for each in grid if each in self.values} | set(self._last_answers(grid)))
        places = sorted({*places, *self._extrema(places)})
        off = {each: self._off(each) for each in places}
        size = _SAME * max(abs(self.target), *map(abs, self.values.values()))
        found = [each for each in places if abs(off[each]) <= size]
        for a, b in zip(places, places[1:], strict=False):
            if min(abs(off[a]), abs(off[b])) > size and (off[a] > 0) != (off[b] > 0):
                root = self._between(a, b)
                miss = abs(self._off(root)) > _JUMP * (abs(self.target) or abs(off[b] - off[a]))
                (self.jumps if miss else found).append(root)
        return sorted(found)

    @property
    def constant(self) -> bool:
        """Whether all values are one."""
        least, most = min(self.values.values()), max(self.values.values())
        return most - least <= _SAME * max(abs(least), abs(most))

    def slope(self, place: float) -> float:
        """Return the derivative at a place, by the nearest other place with a value."""
        step = 1e-3 * (self.high - self.low)
        other = place + step if place + step <= self.high else place - step
        return (self.values[other] - self.values[place]) / (other - place) if self._has(other) else math.nan

    def _has(self, place: float) -> bool:
        """Compute the value at a place if it is not there, and return whether there is an answer."""
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

    def _last_answers(self, grid: Sequence[float]) -> Iterator[float]:
        """Yield the last places with an answer beside those without one, by bisection."""
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
                sign = math.copysign(1.0, off[1])
                found = scipy.optimize.minimize_scalar(
                    lambda x, sign=sign: sign * self._off(float(x)),
                    bounds=(a, b),
                    method="bounded",
                    options={"xatol": 1e-3 * (b - a)},
                )
                yield float(found.x)

    def _between(self, a: float, b: float) -> float:
        """Return where the function crosses the target between two places on either side of it."""
        tolerance = _TOLERANCE * (self.high - self.low)
        return float(scipy.optimize.brentq(lambda x: self._off(float(x)), a, b, xtol=tolerance))
