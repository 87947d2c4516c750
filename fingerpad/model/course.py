"""Loads as targets of the path: relative moves from where the bone is, waveforms in pieces between samples; and time.

Time passes in loads over time alone: between the ends of a piece in equal parts, elsewhere with the way of the bone at
its speed. All other loads take none, since the model is quasi-static.
"""

import math
from collections.abc import Sequence
from functools import partial
from itertools import pairwise

from fingerpad.scene import Load
from fingerpad.scene.waveform import Sample, Waveform
from variational.solvers.continuation import Target

_BEGIN = 60e-6  # m, with which a slide begins
Piece = tuple[Target, float, float]
"""What to reach, from when to when (s) in its load."""


def _voltage(wave: Waveform, before: Sample, after: Sample, part: float) -> float:
    """Return the voltage (V) at a part of the time between two samples."""
    return wave.between(before, after, before[0] + part * (after[0] - before[0]))


class Course:
    """The targets of a path's loads, and the time.

    Attributes:
        over_time: whether the present load has a voltage over time.
    """

    def __init__(self, loads: Sequence[Load], step_scale: float) -> None:
        """Start at time 0, the bone in its unloaded place.

        Args:
            loads: of the path, in order.
            step_scale: see ``numerics.step_scale``.
        """
        self._step_scale = step_scale
        self._timed = any(load.takes_time for load in loads)
        self._now = self._x = 0.0
        self._speed, self._start, self._whole, self.over_time = 0.0, 0.0, 0.0, False
        self._pieces: list[Piece] = []

    def targets(self, load: Load, x: float) -> list[Target]:
        """Begin a load; return what to reach for it, one after the other.

        Args:
            load: the load.
            x: where the bone is (m).
        """
        place = load.place(x)
        self._x, self._start = x, self._now
        self._whole = seconds = load.seconds(0.0 if place is None else place - x)
        self._speed = 0.0 if place is None or seconds == 0 else abs(place - x) / seconds
        self.over_time = load.wave is not None
        if isinstance(load.voltage, Waveform):
            self._pieces = self._along(load.name, load.voltage, x, place)
        else:
            whole = Target(load.name, load.f_ext, load.bone_height, load.voltage, place, load.until_full_slip)
            self._pieces = [(whole, 0.0, seconds)]
        return [target for target, _, _ in self._pieces]

    def _along(self, load: str, wave: Waveform, x: float, place: float | None) -> list[Piece]:
        """Return the pieces of a voltage over time; the bone goes from x to a place (m), or stays."""
        samples = wave.samples(self._whole, self._step_scale)
        found = [(Target(load, voltage=samples[0][1]), 0.0, 0.0)]
        for sample, after in pairwise(samples):
            (before, _), (time, voltage) = sample, after
            aim = place
            if place is not None and time < self._whole:
                aim = x + time / self._whole * (place - x)
            begins = len(found) == 1 and aim is not None and abs(aim - x) > self._step_scale * _BEGIN
            continues = time > before and not begins  # what jumps, or begins with a long slide, is cut into steps
            inside = partial(_voltage, wave, sample, after) if time > before else None
            target = Target(load, voltage=voltage, bone_x=aim, voltage_at=inside, continues=continues)
            found.append((target, before, time))
        return found

    def time(self, target: Target, part: float, x: float) -> float:
        """Return the time of an accepted state (s), NaN where no load of the path is over time.

        Args:
            target: that the state is on the way to.
            part: of the way.
            x: where the bone is (m).
        """
        piece = next(((a, b) for each, a, b in self._pieces if each is target), None)
        if piece is not None:
            a, b = piece
            self._now = self._start + (b if part >= 1 else a + part * (b - a))
        elif self._speed > 0:  # sliding on at full slip
            self._now += abs(x - self._x) / self._speed
        self._x = x
        return self._now if self._timed else math.nan

    def done(self, target: Target, part: float) -> float:
        """Return the part of the load that is done, after :meth:`time`."""
        if not self.over_time:
            return part
        return min((self._now - self._start) / self._whole, 1.0) if self._whole > 0 else part
