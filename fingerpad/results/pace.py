"""The time that is left of a run, as a range, by its pace so far; and times in words."""

import math
import time
from collections.abc import Callable

_SURE = 0.1  # part done from which on the pace is known
_SPREAD = 2.0  # factor either way of the time left at the beginning; it shrinks to the next one
_LEAST_SPREAD = 1.25
_SLIPS = 0.9  # of a load that ends with full slip: done where friction is at its largest, before it is held
_ROUNDOFF = 1e-9  # of a load's end
_SHORT = 1.0  # s, below which no time is printed


class Pace:
    """How far a run is along its loads, each of which counts the same."""

    def __init__(self, loads: int = 1, first: int = 0, clock: Callable[[], float] = time.monotonic) -> None:
        """Start.

        Args:
            loads: number of loads.
            first: number of the load from which on the pace is counted, as of a waveform, whose steps take longer than
                those before; until then the time left is not known.
            clock: returns the time (s).
        """
        self._loads, self._first, self._clock = loads, first, clock
        self._start = clock() if first == 0 else math.nan
        self.part = 0.0
        """Part of the loads that is done."""

    def at(self, done: float, slipped: float = 0.0) -> None:
        """Take how far the run is.

        Args:
            done: part of the loads that is done, each load the same part.
            slipped: part of the present load, where it ends with full slip: friction over its largest value.
        """
        number = min(done, 1.0) * self._loads
        k = min(int(number + _ROUNDOFF), self._loads - 1)
        part = number - k
        if part > _ROUNDOFF:  # else the load before has just ended, perhaps with full slip
            part = max(part, min(slipped, _SLIPS))
        self.part = (k + part) / self._loads
        if math.isnan(self._start) and number >= self._first - _ROUNDOFF:
            self._start = self._clock()

    def left(self) -> str:
        """Return the time left in words, as a range; that it is not known before a tenth is done."""
        before = self._first / self._loads
        done = (self.part - before) / (1 - before)
        if math.isnan(self._start) or done < _SURE:
            return "not known"
        time_left = (self._clock() - self._start) * (1 - done) / done
        spread = max(_SPREAD ** (1 - done), _LEAST_SPREAD)
        return between(time_left / spread, time_left * spread)


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
