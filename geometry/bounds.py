"""Ranges of physical quantities, in SI units, each beyond what anyone has measured or would try.

A number may be given as text with a unit (:mod:`geometry.units`).

A value outside its range is a slip, of the keyboard or of units, and not a choice. Most slips of units are a power of a
thousand; where one of them leads back into the range, the refusal says so. What a program has computed is no slip, and
is taken as it is inside :func:`computed`.
"""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any

from pydantic import ValidatorFunctionWrapHandler, WrapValidator
from pydantic_core import PydanticCustomError

from geometry.units import to_si

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
