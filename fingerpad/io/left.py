"""The time that is left of something, as a range: by what was expected at first, by the pace so far later."""

import math
import time
from collections.abc import Callable, Sequence

_EXPECTED = 2.0  # factor either way within which a time is expected
_KNOWN = 1 / 3  # part done from which on the pace alone counts
_LEAST = 1.25  # factor either way of the pace at the end
_SURE = 0.1  # part done of loads without an expected time from which on their pace is known
_SLIPS = 0.9  # of a load that ends with full slip: done where friction is at its largest, before it is held
_NEAR = 1e-9  # of a load: roundoff of its end
_SHORT = 1.0  # s, below which no time is told


def left(expected: float, elapsed: float, part: float) -> tuple[float, float]:
    """Return the least and the longest time left (s).

    Args:
        expected: time of the whole (s), as it was expected.
        elapsed: time until now (s).
        part: part of the whole that is done, from 0 to 1.
    """
    if part >= 1:
        return 0.0, 0.0
    weight = min(part / _KNOWN, 1.0) if elapsed > 0 else 0.0
    whole = expected ** (1 - weight) * (elapsed / part if weight else 1.0) ** weight
    factor = max(_EXPECTED ** (1 - part), _LEAST)
    return whole * (1 - part) / factor, whole * (1 - part) * factor


def between(low: float, high: float) -> str:
    """Return a range of times (s) in words, in the unit in which the longer one is read."""
    if high < _SHORT:
        return f"less than {_SHORT:g} s"
    size, unit = _unit(high)
    return f"{about(low / size)} to {about(high / size)} {unit}"


def in_words(seconds: float) -> str:
    """Return a time (s) in words, in the unit in which it is read."""
    size, unit = _unit(seconds)
    return f"{about(seconds / size)} {unit}"


def _unit(seconds: float) -> tuple[float, str]:
    units = ((3600.0, "hours"), (60.0, "minutes"))
    return next(((s, u) for s, u in units if seconds >= 2 * s), (1.0, "s"))


def about(value: float) -> str:
    """Return a number of two digits, as it is read."""
    rounded = float(f"{value:.2g}")
    return f"{rounded:,.0f}".replace(",", " ") if rounded >= 10 else f"{rounded:g}"


class Pace:
    """How far a run is, in time: its loads, then its error estimate."""

    def __init__(
        self,
        loads: Sequence[float],
        after: float,
        clock: Callable[[], float] = time.monotonic,
        unsure: int | None = None,
    ) -> None:
        """Start.

        Args:
            loads: expected time of each load (s).
            after: expected time after the loads (s).
            clock: returns the time (s).
            unsure: number of the first load whose time is no more than a guess: the time left is known from its own
                pace alone. None without such a load.
        """
        self._loads, self._after, self._clock, self._start = loads, after, clock, clock()
        self._whole = sum(loads) + after
        self._before = 0.0 if unsure is None else sum(loads[:unsure]) / self._whole
        self._unsure, self._entered = unsure is not None, math.nan
        self.part = 0.0
        """Part of the time that is done."""

    def on_path(self, done: float, slipped: float = 0.0) -> None:
        """Take how far the path is.

        Args:
            done: part of the loads that is done, each load the same part.
            slipped: part of the present load, where it ends with full slip: friction over its largest value.
        """
        number = min(done, 1.0) * len(self._loads)
        k = min(int(number + _NEAR), len(self._loads) - 1)
        part = number - k
        if part > _NEAR:  # else the load before has just ended, perhaps with full slip
            part = max(part, min(slipped, _SLIPS))
        self.part = (sum(self._loads[:k]) + part * self._loads[k]) / self._whole
        if math.isnan(self._entered) and self.part >= self._before:
            self._entered = self._clock()

    def after_path(self, part: float) -> None:
        """Take the part that is done of what comes after the loads."""
        self.part = (sum(self._loads) + part * self._after) / self._whole

    def left(self) -> str:
        """Return in words that so much time is left, or that it is not known."""
        if not self._unsure:
            return between(*left(self._whole, self._clock() - self._start, self.part))
        part = (self.part - self._before) / (1 - self._before)
        if math.isnan(self._entered) or part < _SURE:
            return "not known"
        passed = self._clock() - self._entered
        return between(*left(passed / part, passed, part))
