r"""What a load controls, and how fast: one entry each, which a field of :class:`fingerpad.scene.loads.Load` takes.

A control is a number, a move or a waveform in its own unit. Its entry has its range, its words, the key in whose place
it stands, and what of a :class:`~variational.solvers.target.Target` it sets. What is read of a load, refused, printed
and reached follows from the entries.

A voltage can have a carrier. The wave is then the envelope of a sine of higher frequency, with the depth m of
``modulation``, so that the amplitude is that of the peak:

.. math:: U(t) = U_0 + \hat U \, \frac{1 + m \, w(f t)}{1 + m} \sin 2 \pi f_c t
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from types import NoneType
from typing import Annotated, Any, TypeVar, get_args

import numpy as np
from numpy.typing import NDArray
from pydantic import Discriminator, Field, GetCoreSchemaHandler, Tag, WrapValidator, create_model, model_validator
from pydantic_core import CoreSchema

from fingerpad.scene.messages import NUMBER, WAVE, show
from fingerpad.scene.waveform import IN_WORDS, LISTED, Frequency, Waveform, shape
from geometry.units import Finite, Range, Table, within

Array = NDArray[np.float64]
_Wave = TypeVar("_Wave", bound=Waveform)
_MOST_CARRIED = 2000.0  # periods of a carrier in one of the wave and its burst


# -- waveforms -----------------------------------------------------------------------------------------
class Carrier(Table):
    """A sine of higher frequency, of which the wave is the envelope."""

    frequency: Frequency
    """Frequency of the carrier (Hz), above that of the wave. It is taken at the nearest multiple of the frequency with
    which the drive repeats itself."""
    modulation: Annotated[Finite, within(1e-3, 1)] | None = None
    """Depth m of the modulation, from none to 1, the default: an envelope that closes. Not for a file, whose voltages
    have their carrier in them."""

    @property
    def depth(self) -> float:
        """Depth m of the modulation."""
        return self.modulation or 1.0


class CarriedWaveform(Waveform):
    """A voltage over time, in place of a number; see :mod:`fingerpad.scene.waveform`."""

    carrier: Carrier | None = None
    """A sine of higher frequency, of which the wave is the envelope; see :mod:`fingerpad.scene.controls`."""

    @model_validator(mode="after")
    def _consistent_carrier(self) -> "CarriedWaveform":
        if self.carrier is None:
            return self
        frequency, modulation = self.carrier.frequency, self.carrier.modulation
        step = max((after - before for before, after in pairwise(self.times or ())), default=0.0)
        given = f"carrier.frequency is {show(frequency)} Hz"
        if self.times is not None and modulation is not None:
            raise ValueError(
                f"carrier.modulation is {show(modulation)} and waveform is 'file', whose voltages have their carrier "
                "in them; leave it out"
            )
        if step * frequency > 0.5:
            raise ValueError(
                f"{given} and the record has points {step:.4g} s apart; they must be at most {0.5 / frequency:.4g} s "
                "apart, two in a period (Nyquist)"
            )
        if self.times is None and frequency <= (self.frequency or 0.0):
            both = f"{given} and frequency is {show(self.frequency)} Hz"
            raise ValueError(f"{both}; the carrier must have the higher one")
        if self.times is None and (periods := frequency * self.period) > _MOST_CARRIED:
            words = f"{given}, {periods:.4g} periods in one of the drive"
            raise ValueError(f"{words}; there must be at most {_MOST_CARRIED:g}")
        return self

    def _square_mean(self) -> float:
        mean = super()._square_mean()
        if self.carrier is None:
            return mean
        return (1 + self.carrier.depth**2 * mean) / (1 + self.carrier.depth) ** 2 / 2

    def _carried(self, found: Array, part: Array, parts: float) -> Array:
        if self.carrier is None:
            return found
        carried, depth = part * round(self.carrier.frequency * self.period), self.carrier.depth
        return (1 + depth * found) / (1 + depth) * shape("sine", carried, parts)

    def _carried_in_words(self) -> str:
        return "" if self.carrier is None else f" on a carrier of {self.carrier.frequency:g} Hz"


def _in_unit(name: str, limits: Range, base: type[_Wave]) -> type[_Wave]:
    """Return the waveforms whose sizes and values are within limits; ``name`` is theirs in this module, for pickle."""
    low, high, unit = limits.low, limits.high, limits.unit
    number: Any = Annotated[Finite, WrapValidator(limits)]
    size, double = (Annotated[Finite, within(low, most, unit)] | None for most in (high, 2 * high))
    values: Any = Annotated[tuple[number, ...], LISTED] | None
    types = {"amplitude": size, "peak_to_peak": double, "rms": size, "offset": number, "values": values}
    known = base.model_fields
    fields: Any = {k: (of, Field(known[k].default, description=known[k].description)) for k, of in types.items()}
    found: type[_Wave] = create_model(name, __base__=base, __module__=__name__, __doc__=base.__doc__, **fields)
    found.limits = limits
    return found


# -- keys ----------------------------------------------------------------------------------------------
@dataclass(frozen=True, eq=False)
class LoadKey:
    """A key of a load that has a number: what it controls, or how fast."""

    limits: Range
    words: str
    """With ``{}`` for the number, in mm for m."""
    instead: str = ""
    """Key in whose place it stands: a load has one of the two."""
    remedy: str = ""
    """What is to be done about both."""
    wave: type[Waveform] | None = None
    """Its waveforms; None where it has none."""
    moves: str = ""
    """Control that it moves from its present value; empty where its number is the value."""
    held: bool = True
    """Whether a slide to full slip may stop before it is reached."""
    paces: Callable[[float, float], float] | None = None
    """How long the load takes (s), by the number and the way of the bone (m); None of what is controlled."""

    @property
    def annotation(self) -> Any:
        """What it can be, for pydantic and for the reference of keys."""
        number = Annotated[Finite, WrapValidator(self.limits)]
        if self.wave is None:
            return number
        either: Any = Annotated[number, Tag(NUMBER)] | Annotated[self.wave, Tag(WAVE)]  # type: ignore[name-defined]
        return Annotated[either, Discriminator(lambda given: WAVE if isinstance(given, dict | Waveform) else NUMBER)]

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Return the schema of what it can be."""
        return handler.generate_schema(self.annotation | None if NoneType in get_args(source) else self.annotation)

    def in_words(self, value: float | Waveform) -> str:
        """Return what a load does by it."""
        if isinstance(value, Waveform):
            return f"{self.words.partition(' to ')[0]}: {value}"
        return self.words.format(value * IN_WORDS.get(self.limits.unit, (1.0, ""))[0])


_FORCE = Range(1e-3, 5e3, "N/m", zero=True)
_LENGTH = Range(1e-9, 0.1, "m", zero=True, sides=2)
_VOLTS = Range(1e-3, 5e3, "V", zero=True, sides=2)
ForceWaveform = _in_unit("ForceWaveform", _FORCE, Waveform)
LengthWaveform = _in_unit("LengthWaveform", _LENGTH, Waveform)
VoltageWaveform = _in_unit("VoltageWaveform", _VOLTS, CarriedWaveform)

FORCE = LoadKey(_FORCE, "force to {:g} N/m (per metre of finger)", wave=ForceWaveform)
HEIGHT = LoadKey(_LENGTH, "bone's height to {:+g} mm of the unloaded one", "f_ext",
                 "at most one of the two can be prescribed", wave=LengthWaveform)  # fmt: skip
VOLTAGE = LoadKey(_VOLTS, "voltage to {:g} V", wave=VoltageWaveform)
PLACE = LoadKey(_LENGTH, "bone sideways to {:g} mm", wave=LengthWaveform, held=False)
MOVE = LoadKey(_LENGTH, "bone sideways by {:+g} mm", "bone_x", "give the place or the move", moves="bone_x", held=False)
SPEED = LoadKey(Range(1e-6, 100.0, "m/s"), "at {:g} mm/s", paces=lambda speed, way: abs(way) / speed)
DURATION = LoadKey(Range(1e-6, 1e5, "s"), "in {:g} s", "speed", "one follows from the other, so give one",
                   paces=lambda seconds, _: seconds)  # fmt: skip


def number_of(value: float | Waveform | None) -> float | None:
    """Return the value of a control where it is a number."""
    return None if isinstance(value, Waveform) else value


def ends_of(value: float | Waveform | None) -> tuple[float, float]:
    """Return the smallest and the largest value of a control, 0 where it stays."""
    return value.ends if isinstance(value, Waveform) else (value or 0.0, value or 0.0)
