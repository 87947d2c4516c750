r"""A force, height, place or voltage over time: sine, square, triangle or a table of a file, with its samples.

.. math:: q(t) = q_0 + \hat q \, w(f t), \quad w = \sin 2 \pi f t \text{ or the square or triangle of its phase}

The unit of q is that of the control of a load (:mod:`fingerpad.scene.controls`), and time starts with the load. A burst
is a number of whole periods of the wave, and a pause at the offset.

Turning points, jumps and zeros are always among the samples, at which the load is solved for. A period has 24 of them:
under a voltage friction has twice its frequency, so that 12 are in each of its periods. The square of a sine is off
straight lines between the samples by 1.7 % of the peak at most. A table's pieces are cut where the value changes by as
much. A piece behind a sudden change, and the first one, has the 12 samples of half a square's period: there friction
goes on to change at a constant value, as the finger slides. Fewer or more samples follow from ``numerics.step_scale``.
"""

import math
from collections.abc import Iterator
from itertools import count
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from annotated_types import Ge, Le
from numpy.typing import ArrayLike, NDArray
from pydantic import BeforeValidator, Field, Strict, WrapValidator, model_validator

from fingerpad.scene.messages import show
from fingerpad.scene.wavefile import MEASURES, PROBES, Sample, Seconds, or_zero, refined, refuse_table, table
from geometry.units import Finite, Range, Switch, Table, within

SAMPLES = 24
"""Samples of a period at ``numerics.step_scale`` 1."""
MOST = 10_000
"""Most samples of a load."""
_SQUARE_MEAN = {"sine": 0.5, "square": 1.0, "triangle": 1 / 3}  # of each wave of amplitude 1
Frequency = Annotated[Finite, within(1e-3, 1e6, "Hz")]
IN_WORDS = {"m": (1e3, "mm"), "m/s": (1e3, "mm/s")}
"""Factor from an SI unit to that of words, and the latter, where the two differ."""
_TIME_TOLERANCE = 1e-9  # of a period: two times that are one
_ROUNDOFF = 1e-12  # of the peak
_Count = Annotated[int, Strict(), Ge(1), Le(500)]
LISTED = BeforeValidator(lambda value: tuple(value) if isinstance(value, list) else value)
"""Behind a validator that reads a file, strict rules no longer take a list for a tuple."""
_OF_FILE = ("file", "column", "probe")  # keys of a file, of which a scene keeps the points alone


def shape(waveform: str, part: ArrayLike, parts: float = 1.0) -> NDArray[np.float64]:
    """Return a wave of amplitude 1, at a jump the value behind it; its quarters are the same to the last bit.

    Args:
        waveform: ``"sine"``, ``"square"`` or ``"triangle"``.
        part: place in time, in parts of the period.
        parts: of a period.
    """
    quarter, rest = np.divmod(part, parts / 4)
    rise = np.where(quarter % 2 == 0, rest, parts / 4 - rest) / (parts / 4)
    size = {"sine": np.sin(np.pi / 2 * rise), "square": np.ones_like(rise), "triangle": rise}[waveform]
    return np.where(quarter % 4 < 2, size, -size)


class Burst(Table):
    """Whole periods of the wave, and a pause at the offset."""

    on: _Count
    """Number of periods of the wave."""
    off: _Count
    """Length of the pause, in periods of the wave."""


class Waveform(Table):
    """A value over time, in place of a number; see :mod:`fingerpad.scene.waveform`."""

    limits: ClassVar[Range]
    """Values that the control can have."""
    waveform: Literal["sine", "square", "triangle", "file"]
    """Shape. Sine and triangle start at the offset and rise, a square starts at its upper value; a file has any."""
    amplitude: Finite | None = None
    """Amplitude: half of the peak-to-peak value. One of amplitude, peak_to_peak and rms is required but for a file."""
    peak_to_peak: Finite | None = None
    """Peak-to-peak value, in place of the amplitude."""
    rms: Finite | None = None
    """Root mean square of the alternating part, without offset and pauses, in place of the amplitude."""
    frequency: Frequency | None = None
    """Frequency (Hz). Required but for a file. Range: a period of a quarter of an hour to a radio wave."""
    offset: Finite = 0.0
    """Constant value to which the wave is added."""
    burst: Burst | None = None
    """Whole periods of the wave, and a pause at the offset."""
    file: Annotated[str | None, Field(exclude=True)] = None
    """CSV file with a header such as ``time (s),voltage (V)``, or of an oscilloscope
    (:mod:`fingerpad.scene.wavefile`), straight between its points; a relative path starts at the scene file. The times
    increase, and the first counts as 0. A file that repeats itself has whole periods. It is read at once: a scene
    stores only its points."""
    column: Annotated[str | None, Field(exclude=True, max_length=100)] = None
    """Name of the column of values in a file with several, as ``CH1`` or ``CH1 (V)``."""
    probe: Annotated[Annotated[Finite, WrapValidator(PROBES)] | None, Field(exclude=True)] = None
    """Factor on the values of a file, 1 by default; 100 for a channel without the factor of its 1:100 probe."""
    repeat: Switch = False
    """Whether a file's points repeat themselves for as long as a load takes, as the other waveforms do."""
    times: Annotated[tuple[Seconds, ...], LISTED] | None = None
    """Times (s) of a file's points, or in place of a file."""
    values: Annotated[tuple[Finite, ...], LISTED] | None = None
    """Values at these times; what is smaller than any value allowed is 0."""

    @model_validator(mode="before")
    @classmethod
    def _read(cls, data: Any) -> Any:
        if not isinstance(data, dict) or data.get("waveform") != "file":
            return data
        if isinstance(data.get("values"), list | tuple):
            data = data | {"values": tuple(or_zero(value, cls.limits) for value in data["values"])}
        if not isinstance(data.get("file"), str):
            return data
        column, probe = data.get("column"), data.get("probe")
        factor = 1.0 if probe is None else probe
        if not isinstance(column, str | None) or type(factor) not in (int, float) or factor not in PROBES:
            return data  # for the checks of these keys
        for name in ("times", "values"):
            if data.get(name) is not None:
                raise ValueError(f"{name} and file are both given; give the file alone, which has them")
        rest = {key: value for key, value in data.items() if key not in _OF_FILE}
        return rest | table(data["file"], cls.limits, column, factor, repeat=data.get("repeat") is True)

    @model_validator(mode="after")
    def _consistent(self) -> "Waveform":
        for name in _OF_FILE[1:]:
            if getattr(self, name) is not None:
                raise ValueError(f"{name} is {show(getattr(self, name))} and no file is given; {name} is one of a file")
        if self.waveform == "file":
            refuse_table(self)
        else:
            self._refuse_wave()
        return self

    def _refuse_wave(self) -> None:
        if self.repeat:
            raise ValueError(f"repeat is true and waveform is {show(self.waveform)}, which always is so; leave it out")
        for name in ("file", "times", "values"):
            if getattr(self, name) is not None:
                raise ValueError(f"{name} is given and waveform is {show(self.waveform)}; it must be 'file'")
        given = [name for name in MEASURES if getattr(self, name) is not None]
        if len(given) > 1:
            values = " and ".join(f"{name} is {show(getattr(self, name))}" for name in given[:2])
            raise ValueError(f"{values}; give one of {', '.join(MEASURES)}")
        if not given or self.frequency is None:
            what, instead = ("frequency", "") if given else ("amplitude", ", or peak_to_peak or rms in its place")
            raise ValueError(f"{what} is missing; waveform is {show(self.waveform)} and needs it{instead}")
        most, unit = self.limits, self.limits.unit
        reach = f"offset is {show(self.offset)} and {given[0]} is {show(getattr(self, given[0]))}, together"
        if self.peak > most.high:
            raise ValueError(f"{reach} {self.peak:g} {unit}; they must reach at most {most.high:g} {unit}")
        if most.sides == 1 and self.ends[0] < -_ROUNDOFF * self.peak:
            raise ValueError(f"{reach} down to {self.ends[0]:g} {unit}; they must not go below 0")

    # -- what it is --------------------------------------------------------------------------------------
    @property
    def period(self) -> float:
        """Time (s) after which it repeats itself, with its pause; of a file its last time."""
        if self.times is not None:
            return self.times[-1]
        return (1 if self.burst is None else self.burst.on + self.burst.off) / (self.frequency or math.nan)

    @property
    def height(self) -> float:
        """Amplitude, by whichever measure it is given; 0 of a file."""
        if self.rms is None:
            return self.amplitude or (self.peak_to_peak or 0.0) / 2
        return self.rms / math.sqrt(self._square_mean())

    def _square_mean(self) -> float:
        """Return the mean square of the wave at amplitude 1."""
        return _SQUARE_MEAN[self.waveform]

    @property
    def end(self) -> float:
        """Time (s) at which it ends: a file's last, unless it is repeated, else infinite."""
        return math.inf if self.times is None or self.repeat else self.times[-1]

    @property
    def ends(self) -> tuple[float, float]:
        """Smallest and largest value."""
        found = self.values or (self.offset - self.height, self.offset + self.height)
        return min(found), max(found)

    @property
    def peak(self) -> float:
        """Largest amount of the value."""
        return max(map(abs, self.ends))

    @property
    def mean(self) -> float:
        """Mean of a period; of a file over its length."""
        if self.times is None or self.values is None:
            return self.offset
        return float(np.trapezoid(self.values, self.times)) / self.times[-1]

    def __str__(self) -> str:
        """Return the wave in words."""
        factor, unit = IN_WORDS.get(self.limits.unit, (1.0, self.limits.unit))
        if self.times is not None:
            end, repeated = f"{factor * self.peak:g} {unit}", ", repeated" if self.repeat else ""
            return f"by a table of {len(self.times)} points over {self.times[-1]:g} s, up to {end}{repeated}"
        offset = f" about {factor * self.offset:g} {unit}" if self.offset else ""
        measure = next(name for name in MEASURES if getattr(self, name) is not None)
        how = f" {measure.replace('_', ' ')}".removesuffix(" amplitude")
        found = f"{self.waveform} of {factor * getattr(self, measure):g} {unit}{how}{offset} at {self.frequency:g} Hz"
        found += self._carried_in_words()
        return found + ("" if self.burst is None else f", {self.burst.on} periods on and {self.burst.off} off")

    def _carried_in_words(self) -> str:
        return ""

    # -- values ------------------------------------------------------------------------------------------
    def at(self, part: ArrayLike, parts: float | None = None) -> NDArray[np.float64]:
        """Return the value at times from the start on, of their shape; at a jump that behind it.

        Args:
            part: times, in parts of the period; in seconds without ``parts``.
            parts: of a period; whole numbers of both give the same values in each quarter, to the last bit.
        """
        parts = parts or self.period
        if self.times is not None and self.values is not None:
            return np.asarray(np.interp(np.asarray(part) / parts * self.period, self.times, self.values))
        phase = np.asarray(part) * round(self.period * (self.frequency or 1.0))  # in parts of the wave's own period
        found = self._carried(shape(self.waveform, phase, parts), np.asarray(part), parts)
        if self.burst is not None:
            found = np.where(phase < self.burst.on * parts, found, 0.0)
        return np.asarray(self.offset + self.height * found)

    def _carried(self, found: NDArray[np.float64], part: NDArray[np.float64], parts: float) -> NDArray[np.float64]:
        return found

    # -- samples -----------------------------------------------------------------------------------------
    def count(self, seconds: float, step_scale: float) -> float:
        """Return how many samples a load of some seconds has; zeros of a periodic wave come on top."""
        if math.isinf(step_scale):
            return 0.0
        if self.times is not None:
            periods = max(seconds / self.period, 1.0) if self.repeat else 1.0
            return periods * len(self.samples(seconds / periods, step_scale))
        return seconds * (self.frequency or math.nan) * _per_period(step_scale)

    def samples(self, seconds: float, step_scale: float) -> list[Sample]:
        """Return times and values to go to one after the other, the first at time 0.

        Two samples of one time are a jump. The value does not change its sign between two others.

        Args:
            seconds: length of the load (s).
            step_scale: see ``numerics.step_scale``.
        """
        near, before, found = _TIME_TOLERANCE * self.period, (0.0, 0.0), list[Sample]()
        for time, *values in self._points(_per_period(step_scale)):
            if time <= near:
                found.append((0.0, values[-1]))
            elif time < seconds - near:
                found += [(time, value) for value in dict.fromkeys(values)]
            else:
                cut = time - seconds > near
                found.append((seconds, self.between(before, (time, values[0]), seconds) if cut else values[0]))
                break
            before = time, values[-1]
        return found

    def between(self, before: Sample, after: Sample, time: float) -> float:
        """Return the value at a time (s) between two samples, one next to the other."""
        (t0, u0), (t1, u1) = before, after
        if self.waveform != "sine" or self._in_pause(time):
            return u0 + min((time - t0) / (t1 - t0), 1.0) * (u1 - u0)
        return self._wave(time * (self.frequency or 0.0))

    def _in_pause(self, time: float) -> bool:
        phase = time % self.period * (self.frequency or 0.0)
        return self.burst is not None and phase > self.burst.on * (1 + _TIME_TOLERANCE)

    def corners(self, seconds: float) -> list[float]:
        """Return the times (s) at which the value bends sharply, up to some seconds; jumps are not among them."""
        if self.times is not None:
            periods = math.ceil(seconds / self.period) if self.repeat else 1
            found = (k * self.period + time for k in range(periods) for time in self.times)
            return [time for time in found if time <= seconds]
        if self.waveform != "triangle":
            return []
        half = 0.5 / (self.frequency or math.nan)
        return [t for k in range(math.ceil(seconds / half)) if not self._in_pause(t := (k + 0.5) * half)]

    def _wave(self, part: float, parts: float = 1.0) -> float:
        """Return the value of the wave without a carrier, at a part of its own period."""
        value = self.offset + self.height * float(shape(self.waveform, part, parts))
        return 0.0 if abs(value) < _ROUNDOFF * self.peak else value

    def _points(self, n: int) -> Iterator[tuple[float, ...]]:
        """Yield a time and the value there, before and after a jump, without end but for a file."""
        if self.times is not None and self.values is not None:
            table = [*refined(self.times, self.values, 2 * math.pi / n * self.peak, n // 2)]
            yield table[0]
            for period in count() if self.repeat else range(1):
                yield from ((period * self.period + time, value) for time, value in table[1:-1])
                jump = [table[0][1]] if self.repeat and table[0][1] != table[-1][1] else []
                yield (period + 1) * self.period, table[-1][1], *jump
            return
        one, periods = self._one_period(n), round(self.period * (self.frequency or math.nan))
        if self.burst is not None:
            on, off, pause = self.burst.on, self.burst.off, self.offset
            waves = [(k + phase, *values) for k in range(on) for phase, *values in one]
            parts = [(on + off * k / (n // 2), pause) for k in range(1, n // 2)]
            one = [(0.0, pause, one[0][-1]), *waves[1:], (float(on), one[0][1], pause), *parts]
        for k in count():
            yield from (((k * periods + phase) / (self.frequency or math.nan), *values) for phase, *values in one)

    def _one_period(self, n: int) -> list[tuple[float, ...]]:
        """Return phases from 0 to below 1 and the values there."""
        values = [self._wave(k, n) for k in range(n)]
        if self.waveform == "square":
            return [(k / n, *([values[k - 1]] if k in (0, n // 2) else []), values[k]) for k in range(n)]
        found: list[tuple[float, ...]] = [(k / n, value) for k, value in enumerate(values)]
        ratio = -self.offset / self.height
        if abs(ratio) < 1:
            first = math.asin(ratio) / (2 * math.pi) if self.waveform == "sine" else ratio / 4
            for zero in (first % 1.0, 0.5 - first):
                if all(min(d := abs(zero - phase), 1 - d) > _TIME_TOLERANCE for phase, _ in found):
                    found.append((zero, 0.0))
        return sorted(found)


def _per_period(step_scale: float) -> int:
    """Return the samples of a period: a multiple of 4, so that the turning points are among them."""
    return 4 * math.ceil(SAMPLES / 4 / step_scale)
