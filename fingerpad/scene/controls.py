"""What a load controls, and how fast: one entry each, which a field of :class:`fingerpad.scene.loads.Load` takes.

A control is a number, a move or a waveform in its own unit. Its entry has its range, its words, the key in whose place
it stands, and the field of a :class:`~variational.solvers.target.Target` that it sets. What is read of a load, refused,
printed and reached follows from the entries.
"""

from dataclasses import dataclass
from types import NoneType
from typing import Annotated, Any, TypeVar, get_args

from pydantic import Discriminator, Field, GetCoreSchemaHandler, Tag, create_model
from pydantic_core import CoreSchema

from fingerpad.scene.carrier import CarriedWaveform
from fingerpad.scene.messages import NUMBER, WAVE
from fingerpad.scene.waveform import IN_WORDS, LISTED, Waveform
from geometry.units import Finite, Range, within

_Wave = TypeVar("_Wave", bound=Waveform)


def _in_unit(name: str, limits: Range, base: type[_Wave]) -> type[_Wave]:
    """Return the waveforms of a control: their sizes and values are in its unit and within its limits.

    Args:
        name: of the class, which this module must have under it: scenes are pickled.
        limits: values that the control can have.
        base: waveforms of any unit.
    """
    low, high, unit = limits.low, limits.high, limits.unit
    number: Any = limits.annotation
    size, double = (Annotated[Finite, within(low, most, unit)] | None for most in (high, 2 * high))
    values: Any = Annotated[tuple[number, ...], LISTED] | None
    types = {"amplitude": size, "peak_to_peak": double, "rms": size, "offset": number, "values": values}
    known = base.model_fields
    fields: Any = {k: (of, Field(known[k].default, description=known[k].description)) for k, of in types.items()}
    found: type[_Wave] = create_model(name, __base__=base, __module__=__name__, __doc__=base.__doc__, **fields)
    found.limits = limits
    return found


@dataclass(frozen=True, eq=False)
class LoadKey:
    """A key of a load that has a number."""

    limits: Range
    """Its values."""
    words: str
    """With ``{}`` for the number, in mm for m."""
    instead: str = ""
    """Key in whose place it stands: a load has one of the two."""
    remedy: str = ""
    """What a load with both is answered."""

    @property
    def annotation(self) -> Any:
        """What it can be, for pydantic and for the reference of keys."""
        return self.limits.annotation

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Return the schema of its values."""
        return handler.generate_schema(self.annotation | None if NoneType in get_args(source) else self.annotation)

    def in_words(self, value: float | Waveform) -> str:
        """Return what a load does by it."""
        if isinstance(value, Waveform):
            return f"{self.words.partition(' to ')[0]}: {value}"
        return self.words.format(value * IN_WORDS.get(self.limits.unit, (1.0, ""))[0])


@dataclass(frozen=True, eq=False)
class Control(LoadKey):
    """A key by which a load changes what acts on the finger."""

    wave: type[Waveform] | None = None
    """Its waveforms; None where it has none."""
    target: str = ""
    """What it sets of a target where that is not of its own name."""
    moves: bool = False
    """Whether it is a move from the present value."""
    held: bool = True
    """Whether a slide to full slip may stop before it is reached."""

    @property
    def annotation(self) -> Any:
        """A number, or one of its waveforms."""
        if self.wave is None:
            return self.limits.annotation
        number, wave = (Annotated[of, Tag(tag)] for of, tag in ((self.limits.annotation, NUMBER), (self.wave, WAVE)))
        return Annotated[number | wave, Discriminator(_kind)]


def _kind(value: Any) -> str:
    return WAVE if isinstance(value, dict | Waveform) else NUMBER


_FORCE = Range(1e-3, 5e3, "N/m", zero=True)
_LENGTH = Range(1e-9, 0.1, "m", zero=True, sides=2)
_VOLTS = Range(1e-3, 5e3, "V", zero=True, sides=2)
ForceWaveform = _in_unit("ForceWaveform", _FORCE, Waveform)
LengthWaveform = _in_unit("LengthWaveform", _LENGTH, Waveform)
VoltageWaveform = _in_unit("VoltageWaveform", _VOLTS, CarriedWaveform)

FORCE = Control(_FORCE, "force to {:g} N/m (per metre of finger)", wave=ForceWaveform)
HEIGHT = Control(
    _LENGTH, "bone's height to {:+g} mm of the unloaded one", "f_ext", "at most one of the two can be prescribed",
    wave=LengthWaveform,
)  # fmt: skip
VOLTAGE = Control(_VOLTS, "voltage to {:g} V", wave=VoltageWaveform)
PLACE = Control(_LENGTH, "bone sideways to {:g} mm", wave=LengthWaveform, held=False)
MOVE = Control(
    _LENGTH, "bone sideways by {:+g} mm", "bone_x", "give the place or the move", target="bone_x", moves=True,
    held=False,
)  # fmt: skip
SPEED = LoadKey(Range(1e-6, 100.0, "m/s"), "at {:g} mm/s")
DURATION = LoadKey(Range(1e-6, 1e5, "s"), "in {:g} s", "speed", "one follows from the other, so give one")


def number_of(value: float | Waveform | None) -> float | None:
    """Return the value of a control where it is a number."""
    return None if isinstance(value, Waveform) else value


def ends_of(value: float | Waveform | None) -> tuple[float, float]:
    """Return the smallest and the largest value of a control, 0 where it stays."""
    return (value.low, value.high) if isinstance(value, Waveform) else (value or 0.0, value or 0.0)
