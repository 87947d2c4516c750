"""Numbers with a unit, as text, and their ranges: ``"50 N/m"``, ``"0.05 N/mm"``, ``"5 µm"``, ``"0.2 kV"``, ``"16 GB"``.

The units are pint's (BSD licence), which is imported when the first text comes that is not in one of :data:`_PLAIN`,
with a prefix or as a ratio of two: pint reads its definitions for a fifth of a second. A text is converted in decimals
and rounded once, so that "5 µm" is the same number as 5e-6. A number alone is in the SI unit; a text without a unit is
refused, since nobody can tell a forgotten unit from a number in quotation marks. Temperatures, decibels and the like
are refused as all units of another dimension are.

A quantity of a scene has a range, beyond what anyone has measured or would try. A value outside it is a slip, of the
keyboard or of units, and not a choice. Most slips of units are a power of a thousand; where one of them leads back into
the range, the refusal says so. What a program has computed is no slip, and is taken as it is inside :func:`computed`.
"""

import math
import re
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from decimal import Decimal
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import AllowInfNan, BaseModel, ConfigDict, Strict, ValidatorFunctionWrapHandler, WrapValidator
from pydantic_core import PydanticCustomError

if TYPE_CHECKING:
    import pint

QUANTITIES = {
    "m": "length",
    "Pa": "pressure",
    "N": "force",
    "m^2": "area",
    "N/m": "force per length",
    "Pa/m": "pressure per length",
    "V": "voltage",
    "B": "memory",
    "s": "time",
    "Hz": "frequency",
    "m/s": "speed",
    "ohm m^2": "resistance of a unit of area",
}
"""What each unit of a parameter measures."""

_LONGEST = 60  # characters of a number with its unit
_POWER = r"(?:\s?(?:\^|\*\*)\s?-?[0-9]|⁻?[¹²³⁴])?"
_NAME = r"[^\W\d]+" + _POWER
_NUMBER = re.compile(r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?)\s*(.*?)\s*", re.DOTALL)
_COMMA = re.compile(r"\s*([+-]?[0-9]+),([0-9]+(?:[eE][+-]?[0-9]+)?)(?![0-9])([^,]*)")
_UNIT = re.compile(rf"{_NAME}(?:(?:\s*[*/·]\s*|\s+){_NAME})*")  # pint's own texts can be whole calculations

_PLAIN = ("m", "N", "V", "Pa", "s", "Hz")
_PREFIXES = {"": 0, "n": -9, "u": -6, "µ": -6, "μ": -6, "m": -3, "k": 3, "M": 6}  # powers of ten

_OF_DRIVE = re.compile(r"([nuµμmk]?V)[\s_]*\(?(rms|eff|ac|pp|p-p|pk-pk|pk|peak|p)\)?", re.IGNORECASE)
_MEASURES = {"rms": ("rms", "eff", "ac"), "peak_to_peak": ("pp", "p-p", "pk-pk"), "amplitude": ("pk", "peak", "p")}
"""Keys of a drive by what instruments write behind V."""

# What a number may have been meant in, over the SI unit that it is taken for.
_SLIPS = {
    "m": ("lengths are in m", (1e-3, 1e-6, 1e-9, 1e-2)),
    "Pa": ("pressures and moduli are in Pa", (1e3, 1e6, 1e9)),
    "N": ("forces are in N", (1e-3, 1e3)),
    "N/m": ("forces per length are in N/m", (1e-3, 1e3)),
    "Pa/m": ("stiffnesses are in Pa/m", (1e9, 1e6, 1e12)),
    "V": ("voltages are in V", (1e-3, 1e3)),
    "B": ("memory is in bytes", (1e9, 1e6)),
    "s": ("times are in s", (1e-3, 1e-6)),
    "Hz": ("frequencies are in Hz", (1e3, 1e-3)),
    "m/s": ("speeds are in m/s", (1e-3,)),
}
OUT_OF_RANGE = "out_of_range"  # kinds of the errors that a range raises
NO_QUANTITY = "no_quantity"
_COMPUTED = ContextVar("computed", default=False)


def to_si(text: str, unit: str) -> float:
    """Return the number that a text means, in a given SI unit.

    Args:
        text: a number and its unit; powers as ``m^2``, ``m**2`` or ``m²``.
        unit: one of :data:`QUANTITIES`.

    Raises:
        ValueError: it is no number, has a decimal comma, no unit, or one of another dimension, or pint is not
            installed; to follow the text and a semicolon.
    """
    parts = _NUMBER.fullmatch(text) if len(text) <= _LONGEST else None
    number, given = parts.groups() if parts else ("1", "")
    wanted = f"it must be a number in {unit} or a text such as '{number} {unit}'"
    if comma := _COMMA.fullmatch(text[:_LONGEST]):
        whole, decimals, rest = comma.groups()
        rest = rest.rstrip() or f" {unit}"
        thousands = len(decimals) == 3 and decimals.isdigit() and whole.lstrip("+-0") != ""
        other = f", or '{whole}{decimals}{rest}' if the comma parts thousands" if thousands else ""
        raise ValueError(f"decimals have points: write '{whole}.{decimals}{rest}'{other}")
    if parts is None:
        raise ValueError(wanted)
    if not given:
        raise ValueError(f"it has no unit; {wanted}")
    if (power := _power(given, unit)) is not None:
        return finite(Decimal(number).scaleb(power))
    try:
        found = _root(given)
    except ImportError:
        raise ValueError(f"its unit needs the package pint, which is not installed; {wanted}") from None
    if found is None:
        measure = _OF_DRIVE.fullmatch(given)
        if measure is None or unit != "V":
            raise ValueError(f"its unit is not known; {wanted}")
        key = next(key for key, words in _MEASURES.items() if measure[2].lower() in words)
        raise ValueError(
            f"its unit is {measure[1]}, and {measure[2]} is a measure of a drive: write voltage = {{waveform = 'sine', "
            f"{key} = '{number} {measure[1]}', frequency = '100 Hz'}}"
        )
    (factor, root), (one, wanted_root) = found, _root(unit) or found
    if root != wanted_root:
        raise ValueError(f"its unit is not a unit of {QUANTITIES[unit]}; {wanted}")
    return finite(Decimal(number) * factor / one)


def finite(number: str | Decimal) -> float:
    """Return a number that was written.

    Raises:
        ValueError: it is none, or too large for a floating-point number; to follow the text and a semicolon.
    """
    found = float(number)
    if not math.isfinite(found):
        raise ValueError("it must be a finite number, at most 1.8e308")
    return found


def _power(given: str, unit: str) -> int | None:
    """Return the power of ten from a unit of :data:`_PLAIN`, or a ratio of two, to an SI unit; None of all else."""
    parts, wanted = given.split("/"), unit.split("/")
    if len(parts) != len(wanted) or not all(of in _PLAIN for of in wanted):
        return None
    powers = [_PREFIXES.get(part.removesuffix(of)) for part, of in zip(parts, wanted, strict=True) if part.endswith(of)]
    known = [power for power in powers if power is not None]
    return known[0] - sum(known[1:]) if len(known) == len(parts) else None


@cache
def _registry() -> "pint.UnitRegistry":
    import pint

    return pint.UnitRegistry(non_int_type=Decimal)


@cache
def _root(unit: str) -> "tuple[Decimal, pint.Unit] | None":
    """Return a unit as a factor of root units, None where it is unknown; two of one dimension have the same root."""
    if not _UNIT.fullmatch(unit):
        return None
    registry = _registry()
    try:
        factor, root = registry.get_root_units(registry.parse_units(unit))
    except (AttributeError, ValueError, TypeError, ArithmeticError):  # pint's own errors are of the first three
        return None
    return Decimal(str(factor)), root


def is_unit(text: str) -> bool:
    """Return whether a text is a unit of any dimension, False where pint is not installed."""
    try:
        return _root(text) is not None
    except ImportError:
        return False


def in_si(unit: str) -> tuple[str, float]:
    """Return the unit of :data:`QUANTITIES` that measures the same as a unit, and the factor from it to the unit.

    A unit of none of them, one that is not known, and any where pint is not installed, is its own with the factor 1.
    """
    try:
        found = _root(unit)
        roots = [(known, root) for known in QUANTITIES if (root := _root(known)) is not None]
    except ImportError:
        return unit, 1.0
    same = [(known, float(root[0] / found[0])) for known, root in roots if found and root[1] == found[1]]
    return same[0] if same else (unit, 1.0)


# -- tables --------------------------------------------------------------------------------------------
# Not by Field(...), whose one FieldInfo pydantic would share among keys: one of them would have another's default.
Finite = Annotated[float, Strict(), AllowInfNan(False)]
Switch = Annotated[bool, Strict()]


class Table(BaseModel):
    """A table of parameters that refuses keys it does not have, and cannot be changed."""

    model_config = ConfigDict(extra="forbid", frozen=True, use_attribute_docstrings=True)


# -- ranges --------------------------------------------------------------------------------------------
@contextmanager
def computed() -> Iterator[None]:
    """Refuse no number inside the block for its range: a program has computed them from numbers within theirs."""
    before = _COMPUTED.set(True)
    try:
        yield
    finally:
        _COMPUTED.reset(before)


@dataclass(frozen=True)
class Range:
    """Values that a quantity can have.

    Args:
        low: smallest value, of the amount where ``sides`` is 2.
        high: largest value.
        unit: empty for a number.
        zero: whether zero is allowed too, which stands for "none".
        sides: 2 where the sign is free.
    """

    low: float
    high: float
    unit: str = ""
    zero: bool = False
    sides: int = 1

    def __contains__(self, value: float) -> bool:
        """Return whether a value is allowed."""
        amount = abs(value) if self.sides == 2 else value
        return (self.zero and value == 0) or self.low <= amount <= self.high

    def __call__(self, value: Any, handler: ValidatorFunctionWrapHandler) -> float:
        """Validate a value; whole numbers are numbers, and so are texts with a unit where there is one."""
        if type(value) is int and abs(value) < 10**300:
            value = float(value)
        typed = isinstance(value, str) and self.unit != ""
        number = float(handler(self._read(value) if typed else value)) + 0.0  # which has no zero with a sign
        if number not in self and not _COMPUTED.get():
            given = {"words": self.words(number, slip=not typed), "range": self, "number": number, "slip": not typed}
            raise PydanticCustomError(OUT_OF_RANGE, "{words}", given)
        return number

    def _read(self, text: str) -> float:
        try:
            return to_si(text, self.unit)
        except ValueError as error:
            raise PydanticCustomError(NO_QUANTITY, str(error)) from None  # type: ignore[arg-type]

    def words(self, value: float, slip: bool = True, usual: float | None = None) -> str:
        """Return why a value is refused, to follow the key; with the question whether another unit was meant.

        Args:
            value: in SI.
            slip: whether to ask that.
            usual: value near which the one meant is looked for, such as the default; without it, or at zero, it is the
                middle of the range.
        """
        unit = f" {self.unit}" if self.unit else ""
        allowed = f"from {self.low:g} to {self.high:g}{unit}"
        if self.sides == 2:
            allowed += ", with either sign"
        if self.zero:
            allowed = f"0 or {allowed}"
        return f"is {value:.12g}{unit}; it must be {allowed}{self._slip(value, usual) if slip else ''}"

    def _slip(self, value: float, usual: float | None) -> str:
        """Return the question whether another unit was meant, empty where none leads to an allowed value."""
        name, factors = _SLIPS.get(self.unit, ("", ()))
        meant = [value * factor for factor in factors if value and value * factor in self]
        if not meant:
            return ""
        near = abs(usual or math.sqrt(self.low * self.high))
        return f" ({name}; did you mean {min(meant, key=lambda v: abs(math.log(abs(v) / near))):.6g}?)"


def within(low: float, high: float, unit: str = "", zero: bool = False, sides: int = 1) -> WrapValidator:
    """Return the annotation of a number that must be in a :class:`Range`."""
    return WrapValidator(Range(low, high, unit, zero, sides))
