r"""A voltage over time: sine, square, triangle or a table of a file, with the samples at which it is solved for.

.. math:: U(t) = U_0 + \hat U \, w(f t), \quad w = \sin 2 \pi f t \text{ or the square or triangle of its phase}

Time starts with the load. The model is quasi-static: without viscous layers, friction in time and losses of the drive,
the frequency sets how far the finger slides in a period, and nothing else.

Turning points, jumps and zeros are always among the samples. A period has 24 of them: friction has twice the frequency
of the voltage, so that 12 are in each of its periods and 6 in each of its second harmonic's. The attraction goes with
the square of the voltage; that of a sine is off straight lines between the samples by 1.7 % of the peak at most. A
table's pieces are cut where the voltage changes by as much as between two samples of a sine. A piece behind a sudden
change of the voltage, and the first one, has the 12 samples of half a square's period: there friction goes on to
change at a constant voltage, as the finger slides. States between two samples, where a step must be shorter, are at the
waveform's own voltage. Fewer or more samples follow from ``numerics.step_scale``, as for all steps.
"""

import math
from collections.abc import Iterator
from itertools import count, pairwise
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from fingerpad.scene.messages import show
from fingerpad.scene.modulation import Burst, Carrier, refuse_carrier, shape, square_mean
from fingerpad.scene.wavefile import HIGHEST, POINTS, Probe, Seconds, Volts, or_zero, range_of, table
from geometry.units import Finite, Switch, Table, within

SAMPLES = 24
"""Samples of a period at ``numerics.step_scale`` 1."""
MOST = 10_000
"""Most samples of a load."""
_TIME_TOLERANCE = 1e-9  # of a period: two times that are one
_SUDDEN = 0.01  # of the peak: a change of the voltage, within one sample before a piece of a table, that cuts the piece
_OWN = 0.5  # of the piece's own change: a smaller change before it cuts no piece
_NOTHING = 1e-12  # of the peak: a voltage that is roundoff of zero
Sample = tuple[float, float]
"""Time (s) since the start of the load, and voltage (V)."""
_Tabled = Annotated[Volts, BeforeValidator(or_zero)]
# Behind a validator that reads a file, strict rules no longer take a list for a tuple.
_LISTED = BeforeValidator(lambda value: tuple(value) if isinstance(value, list) else value)
MEASURES = ("amplitude", "peak_to_peak", "rms")
"""Keys that say how large a wave is; one of them is given."""
OF_FILE = ("file", "column", "probe")
"""Keys of a file, of which a scene keeps the points alone."""


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
    frequency: Annotated[Finite, within(1e-3, 1e6, "Hz")] | None = None
    """Frequency (Hz). Required but for a file. Range: a period of a quarter of an hour to a radio wave."""
    offset: Volts = 0.0
    """Direct voltage (V) to which the wave is added, of either sign."""
    carrier: Carrier | None = None
    """A sine of higher frequency, of which the wave is the envelope; see :mod:`fingerpad.scene.modulation`."""
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
        rest = {key: value for key, value in data.items() if key not in OF_FILE}
        return rest | table(data["file"], column, factor, repeat=data.get("repeat") is True)

    @model_validator(mode="after")
    def _consistent(self) -> "Waveform":
        for name in OF_FILE[1:]:
            if getattr(self, name) is not None:
                raise ValueError(f"{name} is {show(getattr(self, name))} and no file is given; {name} is one of a file")
        if self.waveform == "file":
            self._refuse_table()
            return self
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
            what = "amplitude" if not given else "frequency"
            instead = ", or peak_to_peak or rms in its place" if not given else ""
            raise ValueError(f"{what} is missing; waveform is {show(self.waveform)} and needs it{instead}")
        if self.peak > HIGHEST:
            raise ValueError(
                f"offset is {show(self.offset)} and {given[0]} is {show(getattr(self, given[0]))}, together "
                f"{self.peak:g} V; they must reach at most {HIGHEST:g} V"
            )
        if self.carrier is not None:
            refuse_carrier(self)
        return self

    def _refuse_table(self) -> None:
        for name in (*MEASURES, "frequency", "offset", "burst"):
            if name in self.model_fields_set and getattr(self, name) not in (None, 0.0):
                given = "given" if name == "burst" else show(getattr(self, name))
                raise ValueError(f"{name} is {given} and waveform is 'file', which has none")
        if self.times is None or self.voltages is None:
            raise ValueError("file is missing; waveform is 'file' and needs it")
        if len(self.times) != len(self.voltages):
            raise ValueError(f"times are {len(self.times)} and voltages are {len(self.voltages)}; give as many of each")
        if not 2 <= len(self.times) <= POINTS:
            raise ValueError(f"times are {len(self.times)}; there must be from 2 to {POINTS} of them")
        if self.times[0] != 0:
            raise ValueError(f"times start at {show(self.times[0])} s; the first must be 0, where the load starts")
        late = next((k for k in range(1, len(self.times)) if self.times[k] <= self.times[k - 1]), None)
        if late is not None:
            raise ValueError(
                f"times are {show(self.times[late - 1])} and then {show(self.times[late])} s; each must be later than "
                "the one before, so give a jump a short time"
            )
        if self.carrier is not None:
            refuse_carrier(self)

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
        if self.rms is not None:
            return self.rms / math.sqrt(square_mean(self.waveform, self.carrier))
        return self.amplitude or (self.peak_to_peak or 0.0) / 2

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
        pieces = zip(pairwise(self.times), pairwise(self.voltages), strict=True)
        return sum((t1 - t0) * (u0 + u1) / 2 for (t0, t1), (u0, u1) in pieces) / self.times[-1]

    def __str__(self) -> str:
        """Return the wave in words."""
        if self.times is not None:
            repeated = ", repeated" if self.repeat else ""
            return f"by a table of {len(self.times)} points over {self.times[-1]:g} s, up to {self.peak:g} V{repeated}"
        offset = f" about {self.offset:g} V" if self.offset else ""
        measure = next(name for name in MEASURES if getattr(self, name) is not None)
        how = "" if measure == "amplitude" else f" {measure.replace('_', ' ')}"
        found = f"{self.waveform} of {getattr(self, measure):g} V{how}{offset} at {self.frequency:g} Hz"
        found += "" if self.carrier is None else f" on a carrier of {self.carrier.frequency:g} Hz"
        return found + ("" if self.burst is None else f", {self.burst.on} periods on and {self.burst.off} off")

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
        return self._value(float(shape("sine", time * (self.frequency or 0.0))))

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
        turns = ((k + 0.5) * half for k in range(math.ceil(seconds / half)))
        return [time for time in turns if not self._in_pause(time)]

    def _value(self, shape: float) -> float:
        value = self.offset + self.height * shape
        return 0.0 if abs(value) < _NOTHING * self.peak else value

    def _points(self, n: int) -> Iterator[tuple[float, ...]]:
        """Yield a time and the voltage there, before and after a jump, without end but for a file."""
        if self.times is not None and self.voltages is not None:
            table = [*_refined(self.times, self.voltages, 2 * math.pi / n * self.peak, n // 2)]
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
        for period in count():
            for phase, *values in one:
                yield (period * periods + phase) / (self.frequency or math.nan), *values

    def _one_period(self, n: int) -> list[tuple[float, ...]]:
        """Return phases from 0 to below 1 and the voltages there."""
        values = [self._value(float(value)) for value in shape(self.waveform, np.arange(n), n)]
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


def _refined(times: tuple[float, ...], voltages: tuple[float, ...], most: float, behind: int) -> Iterator[Sample]:
    """Yield the points of a table, the zeros between them, and more within its pieces.

    Args:
        times: of the table (s).
        voltages: of the table (V).
        most: change of the voltage between two samples (V).
        behind: samples of a piece behind a sudden change, and of the first piece.
    """
    least = _SUDDEN * max(map(abs, voltages))
    yield times[0], voltages[0]
    for k in range(1, len(times)):
        (t0, t1), (u0, u1) = times[k - 1 : k + 1], voltages[k - 1 : k + 1]
        before = _change_before(times, voltages, k - 1, (t1 - t0) / behind)
        even = behind if k == 1 or before > max(least, _OWN * abs(u1 - u0)) else 1
        crosses = u0 * u1 < 0
        ends = [(t0, u0), *([(t0 + (t1 - t0) * u0 / (u0 - u1), 0.0)] if crosses else []), (t1, u1)]
        for (a, ua), (b, ub) in zip(ends, ends[1:], strict=False):
            by_time = math.ceil(even * (b - a) / (t1 - t0) - _TIME_TOLERANCE)
            by_voltage = math.ceil(abs(ub - ua) / most - _TIME_TOLERANCE) if most > 0 else 1
            pieces = max(by_time, by_voltage, 1)
            for j in range(1, pieces):
                yield a + (b - a) * j / pieces, ua + (ub - ua) * j / pieces
            yield b, ub


def _change_before(times: tuple[float, ...], voltages: tuple[float, ...], k: int, seconds: float) -> float:
    """Return by how much the voltage of a table changes in some seconds before its point k."""
    first, seen = times[k] - seconds, [voltages[k]]
    while k > 0 and times[k] > first:
        k -= 1
        part = min((times[k + 1] - first) / (times[k + 1] - times[k]), 1.0)
        seen.append(voltages[k + 1] + part * (voltages[k] - voltages[k + 1]))
    return max(seen) - min(seen)
