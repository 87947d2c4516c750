"""A key of a scene that is varied over a range."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from fingerpad.richardson import plus_minus
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
"""Ranges of keys (SI): of people's loads, and of coatings and films on screens.

Others are from a tenth to ten times their value."""
MAX_POINTS = 10_000
"""Of a sweep, a map or a table."""
_AROUND = 10.0
_RATIOS = 8.0  # of the ends of a range, from which on it is divided at equal ratios


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
        return self.low > 0 and self.high > _RATIOS * self.low

    def place(self, value: float) -> float:
        """Return the place of a value of the key: its logarithm, or the value itself."""
        return math.log(value) if self.logarithmic else value

    def value(self, place: float) -> float:
        """Return the value of the key at a place, within the range."""
        return min(max(math.exp(place) if self.logarithmic else place, self.low), self.high)

    def shown(self, *values: float) -> str:
        """Return one or two values of the key with their unit; short lengths in µm."""
        unit, factor = self._unit(*values)
        return " to ".join(f"{value * factor:.4g}" for value in values) + f" {unit}" * bool(unit)

    def with_error(self, value: float, error: float) -> str:
        """Return a value of the key with its error and unit, as in tables."""
        unit, factor = self._unit(value)
        return plus_minus(value * factor, error * factor) + f" {unit}" * bool(unit)

    def _unit(self, *values: float) -> tuple[str, float]:
        small = self.unit == "m" and max(map(abs, values)) < 1e-3
        return ("µm", 1e6) if small else (self.unit, 1.0)


def refuse_many(count: int, what: str = "sweep") -> None:
    """Refuse more points than :data:`MAX_POINTS`.

    Raises:
        SceneError: there are more.
    """
    if count > MAX_POINTS:
        raise SceneError(f"the {what} has {count} points; at most {MAX_POINTS} are allowed")


def axis(scene: Scene, key: str, between: Sequence[float | str] | None = None) -> Axis:
    """Return a key of a scene with a range.

    Args:
        scene: the scene.
        key: dotted, as of :func:`fingerpad.runs.sweep.sweep`; its values are numbers.
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
        present = _present(scene, key)
        if not present:
            raise SceneError(f"{key} has no value in the scene to vary around; give its first and its last value")
        low, high = sorted((present / _AROUND, present * _AROUND))
        low, high = max(low, found.limits.low), min(high, found.limits.high)
    if not low < high:
        raise SceneError(f"the range of {key} is {low:g} to {high:g}; the last value must be above the first")
    return Axis(key, low, high, found.unit)


def _present(scene: Scene, key: str) -> float:
    """Return the scene's value of a key; 0 where it has none."""
    try:
        value = value_of(scene, key)
    except AttributeError:  # of a table in whose place the scene has a number
        return 0.0
    return float(value) if isinstance(value, int | float) else 0.0
