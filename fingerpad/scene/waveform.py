r"""A voltage over time: sine, square, triangle or a table of a file, with the samples at which it is solved for.

.. math:: U(t) = U_0 + \hat U \, w(f t), \quad w = \sin 2 \pi f t \text{ or the square or triangle of its phase}

Time starts with the load. With a carrier the wave is the envelope of a sine of higher frequency, with the depth m of
``modulation``, so that the amplitude is that of the peak:

.. math:: U(t) = U_0 + \hat U \, \frac{1 + m \, w(f t)}{1 + m} \sin 2 \pi f_c t

A burst is a number of whole periods of the wave, and a pause at the offset.

Turning points, jumps and zeros are always among the samples. A period has 24 of them: friction has twice the frequency
of the voltage, so that 12 are in each of its periods. The square of a sine is off straight lines between the samples by
1.7 % of the peak at most. A table's pieces are cut where the voltage changes by as much. A piece behind a sudden change
of the voltage, and the first one, has the 12 samples of half a square's period: there friction goes on to change at a
constant voltage, as the finger slides. Fewer or more samples follow from ``numerics.step_scale``.
"""

import math
from collections.abc import Iterator
from itertools import count
from typing import Annotated, Any, Literal

import numpy as np
from annotated_types import Ge, Le
from numpy.typing import ArrayLike, NDArray
from pydantic import BeforeValidator, Field, Strict, model_validator

from fingerpad.scene.messages import show
from fingerpad.scene.wavefile import (
    HIGHEST,
    MEASURES,
    Probe,
    Sample,
    Seconds,
    Volts,
    or_zero,
    range_of,
    refined,
    refuse_table,
    table,
)
from geometry.units import Finite, Switch, Table, within

SAMPLES = 24
"""Samples of a period at ``numerics.step_scale`` 1."""
MOST = 10_000
"""Most samples of a load."""
_MOST_CARRIED = 2000.0  # periods of a carrier in one of the wave and its burst
_SQUARE_MEAN = {"sine": 0.5, "square": 1.0, "triangle": 1 / 3}  # of each wave of amplitude 1
_HIGHEST_FREQUENCY = 1e6  # Hz
_TIME_TOLERANCE = 1e-9  # of a period: two times that are one
_ROUNDOFF = 1e-12  # of the peak
_Count = Annotated[int, Strict(), Ge(1), Le(500)]
_Tabled = Annotated[Volts, BeforeValidator(or_zero)]
# Behind a validator that reads a file, strict rules no longer take a list for a tuple.
_LISTED = BeforeValidator(lambda value: tuple(value) if isinstance(value, list) else value)
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


class Carrier(Table):
    """A sine of higher frequency, of which the wave is the envelope."""

    frequency: Annotated[Finite, within(1e-3, _HIGHEST_FREQUENCY, "Hz")]
    """Frequency of the carrier (Hz), above that of the wave. It is taken at the nearest multiple of the frequency with
    which the drive repeats itself."""
    modulation: Annotated[Finite, within(1e-3, 1)] | None = None
    """Depth m of the modulation, from none to 1, the default: an envelope that closes. Not for a file, whose voltages
    have their carrier in them."""

    @property
    def depth(self) -> float:
        """Depth m of the modulation."""
        return self.modulation or 1.0


class Burst(Table):
    """Whole periods of the wave, and a pause at the offset."""

    on: _Count
    """Number of periods of the wave."""
    off: _Count
    """Length of the pause, in periods of the wave."""


class Waveform(Table):
    """A voltage over time, in place of a number; see :mod:`fingerpad.scene.waveform`."""

    waveform: Literal["sine", "square", "triangle", "file"]
    """Shape. Sine and triangle start at the offset and rise, a square starts at its upper value; a file has any."""
    amplitude: Annotated[Finite, within(1e-3, HIGHEST, "V")] | None = None
    """Amplitude (V): half of the peak-to-peak value. One of amplitude, peak_to_peak and rms is required but for a
    file."""
    peak_to_peak: Annotated[Finite, within(1e-3, 2 * HIGHEST, "V")] | None = None
    """Peak-to-peak value (V), in place of the amplitude."""
    rms: Annotated[Finite, within(1e-3, HIGHEST, "V")] | None = None
    """Root mean square (V) of the alternating part, without offset and pauses, in place of the amplitude."""
    frequency: Annotated[Finite, within(1e-3, _HIGHEST_FREQUENCY, "Hz")] | None = None
    """Frequency (Hz). Required but for a file. Range: a period of a quarter of an hour to a radio wave."""
    offset: Volts = 0.0
    """Direct voltage (V) to which the wave is added, of either sign."""
    carrier: Carrier | None = None
    """A sine of higher frequency, of which the wave is the envelope; see :mod:`fingerpad.scene.waveform`."""
    burst: Burst | None = None
    """Whole periods of the wave, and a pause at the offset."""
    file: Annotated[str | None, Field(exclude=True)] = None
    """CSV file with the header ``time (s),voltage (V)``, or of an oscilloscope (:mod:`fingerpad.scene.wavefile`),
    straight between its points; a relative path starts at the scene file. The times increase, and the first counts as
    0. A file that repeats itself is cut to whole periods. It is read at once: a scene stores only its points."""
    column: Annotated[str | None, Field(exclude=True, max_length=100)] = None
    """Name of the column of voltages in a file with several, as ``CH1`` or ``CH1 (V)``."""
    probe: Annotated[Probe | None, Field(exclude=True)] = None
    """Factor on the voltages of a file, 1 by default; 100 for a channel without the factor of its 1:100 probe."""
    repeat: Switch = False
    """Whether a file's points repeat themselves for as long as a load takes, as the other waveforms do."""
    times: Annotated[tuple[Seconds, ...], _LISTED] | None = None
    """Times (s) of a file's points, or in place of a file."""
    voltages: Annotated[tuple[_Tabled, ...], _LISTED] | None = None
    """Voltages (V) at these times; below 1 mV they are 0."""

    @model_validator(mode="before")
    @classmethod
    def _read(cls, data: Any) -> Any:
        if not isinstance(data, dict) or not isinstance(data.get("file"), str) or data.get("waveform") != "file":
            return data
        column, probe = data.get("column"), data.get("probe")
        factor = 1.0 if probe is None else probe
        if not isinstance(column, str | None) or type(factor) not in (int, float) or factor not in range_of(Probe):
            return data  # for the checks of these keys
        for name in ("times", "voltages"):
            if data.get(name) is not None:
                raise ValueError(f"{name} and file are both given; give the file alone, which has them")
        rest = {key: value for key, value in data.items() if key not in _OF_FILE}
        return rest | table(data["file"], column, factor, repeat=data.get("repeat") is True)

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
        for name in ("file", "times", "voltages"):
            if getattr(self, name) is not None:
                raise ValueError(f"{name} is given and waveform is {show(self.waveform)}; it must be 'file'")
        given = [name for name in MEASURES if getattr(self, name) is not None]
        if len(given) > 1:
            values = " and ".join(f"{name} is {show(getattr(self, name))}" for name in given[:2])
            raise ValueError(f"{values}; give one of {', '.join(MEASURES)}")
        if not given or self.frequency is None:
            what, instead = ("frequency", "") if given else ("amplitude", ", or peak_to_peak or rms in its place")
            raise ValueError(f"{what} is missing; waveform is {show(self.waveform)} and needs it{instead}")
        if self.peak > HIGHEST:
            raise ValueError(
                f"offset is {show(self.offset)} and {given[0]} is {show(getattr(self, given[0]))}, together "
                f"{self.peak:g} V; they must reach at most {HIGHEST:g} V"
            )
        if self.carrier is None:
            return
        if self.carrier.frequency <= self.frequency:
            both = f"carrier.frequency is {show(self.carrier.frequency)} Hz and frequency is {show(self.frequency)} Hz"
            raise ValueError(f"{both}; the carrier must have the higher one")
        if (periods := self.carrier.frequency * self.period) > _MOST_CARRIED:
            words = f"carrier.frequency is {show(self.carrier.frequency)} Hz, {periods:.4g} periods in one of the drive"
            raise ValueError(f"{words}; there must be at most {_MOST_CARRIED:g}")

    # -- what it is --------------------------------------------------------------------------------------
    @property
    def period(self) -> float:
        """Time (s) after which it repeats itself, with its pause; of a file its last time."""
        if self.times is not None:
            return self.times[-1]
        return (1 if self.burst is None else self.burst.on + self.burst.off) / (self.frequency or math.nan)

    @property
    def height(self) -> float:
        """Amplitude (V), by whichever measure it is given; 0 of a file."""
        if self.rms is None:
            return self.amplitude or (self.peak_to_peak or 0.0) / 2
        mean = _SQUARE_MEAN[self.waveform]
        if self.carrier is not None:
            mean = (1 + self.carrier.depth**2 * mean) / (1 + self.carrier.depth) ** 2 / 2
        return self.rms / math.sqrt(mean)

    @property
    def end(self) -> float:
        """Time (s) at which it ends: a file's last, unless it is repeated, else infinite."""
        return math.inf if self.times is None or self.repeat else self.times[-1]

    @property
    def peak(self) -> float:
        """Largest amount of the voltage (V)."""
        return max(map(abs, self.voltages)) if self.voltages else abs(self.offset) + self.height

    @property
    def mean(self) -> float:
        """Mean voltage (V) of a period; of a file over its length."""
        if self.times is None or self.voltages is None:
            return self.offset
        return float(np.trapezoid(self.voltages, self.times)) / self.times[-1]

    def __str__(self) -> str:
        """Return the wave in words."""
        if self.times is not None:
            repeated = ", repeated" if self.repeat else ""
            return f"by a table of {len(self.times)} points over {self.times[-1]:g} s, up to {self.peak:g} V{repeated}"
        offset = f" about {self.offset:g} V" if self.offset else ""
        measure = next(name for name in MEASURES if getattr(self, name) is not None)
        how = f" {measure.replace('_', ' ')}".removesuffix(" amplitude")
        found = f"{self.waveform} of {getattr(self, measure):g} V{how}{offset} at {self.frequency:g} Hz"
        found += "" if self.carrier is None else f" on a carrier of {self.carrier.frequency:g} Hz"
        return found + ("" if self.burst is None else f", {self.burst.on} periods on and {self.burst.off} off")

    # -- values ------------------------------------------------------------------------------------------
    def at(self, part: ArrayLike, parts: float | None = None) -> NDArray[np.float64]:
        """Return the voltage (V) at times from the start on, of their shape; at a jump that behind it.

        Args:
            part: times, in parts of the period; in seconds without ``parts``.
            parts: of a period; whole numbers of both give the same values in each quarter, to the last bit.
        """
        parts = parts or self.period
        if self.times is not None and self.voltages is not None:
            return np.asarray(np.interp(np.asarray(part) / parts * self.period, self.times, self.voltages))
        phase = np.asarray(part) * round(self.period * (self.frequency or 1.0))  # in parts of the wave's own period
        found = shape(self.waveform, phase, parts)
        if self.carrier is not None:
            carried = np.asarray(part) * round(self.carrier.frequency * self.period)
            found = (1 + self.carrier.depth * found) / (1 + self.carrier.depth) * shape("sine", carried, parts)
        if self.burst is not None:
            found = np.where(phase < self.burst.on * parts, found, 0.0)
        return np.asarray(self.offset + self.height * found)

    # -- samples -----------------------------------------------------------------------------------------
    def count(self, seconds: float, step_scale: float) -> float:
        """Return how many samples a load of some seconds has; zeros of a periodic voltage come on top."""
        if math.isinf(step_scale):
            return 0.0
        if self.times is not None:
            periods = max(seconds / self.period, 1.0) if self.repeat else 1.0
            return periods * len(self.samples(seconds / periods, step_scale))
        return seconds * (self.frequency or math.nan) * _per_period(step_scale)

    def samples(self, seconds: float, step_scale: float) -> list[Sample]:
        """Return times and voltages to go to one after the other, the first at time 0.

        Two samples of one time are a jump. The voltage does not change its sign between two others.

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
        """Return the voltage (V) at a time (s) between two samples, one next to the other."""
        (t0, u0), (t1, u1) = before, after
        if self.waveform != "sine" or self._in_pause(time):
            return u0 + min((time - t0) / (t1 - t0), 1.0) * (u1 - u0)
        return self._wave(time * (self.frequency or 0.0))

    def _in_pause(self, time: float) -> bool:
        phase = time % self.period * (self.frequency or 0.0)
        return self.burst is not None and phase > self.burst.on * (1 + _TIME_TOLERANCE)

    def corners(self, seconds: float) -> list[float]:
        """Return the times (s) at which the voltage bends sharply, up to some seconds; jumps are not among them."""
        if self.times is not None:
            periods = math.ceil(seconds / self.period) if self.repeat else 1
            found = (k * self.period + time for k in range(periods) for time in self.times)
            return [time for time in found if time <= seconds]
        if self.waveform != "triangle":
            return []
        half = 0.5 / (self.frequency or math.nan)
        return [t for k in range(math.ceil(seconds / half)) if not self._in_pause(t := (k + 0.5) * half)]

    def _wave(self, part: float, parts: float = 1.0) -> float:
        """Return the voltage (V) of the wave without its carrier, at a part of its own period."""
        value = self.offset + self.height * float(shape(self.waveform, part, parts))
        return 0.0 if abs(value) < _ROUNDOFF * self.peak else value

    def _points(self, n: int) -> Iterator[tuple[float, ...]]:
        """Yield a time and the voltage there, before and after a jump, without end but for a file."""
        if self.times is not None and self.voltages is not None:
            table = [*refined(self.times, self.voltages, 2 * math.pi / n * self.peak, n // 2)]
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
        """Return phases from 0 to below 1 and the voltages there."""
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
