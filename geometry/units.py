"""Numbers with a unit, as text: ``"50 N/m"``, ``"0.05 N/mm"``, ``"5 µm"``, ``"0.2 kV"``, ``"16 GB"``.

The units are pint's (BSD licence), which is imported when the first text comes. A text is converted in decimals and
rounded once, so that "5 µm" is the same number as 5e-6. A number alone is in the SI unit; a text without a unit is
refused, since nobody can tell a forgotten unit from a number in quotation marks. Temperatures, decibels and the like
are refused as all units of another dimension are.
"""

import re
from decimal import Decimal
from functools import cache
from typing import TYPE_CHECKING

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
}
"""What each unit of a parameter measures."""

_LONGEST = 60  # characters of a number with its unit
_POWER = r"(?:\s?(?:\^|\*\*)\s?-?[0-9]|⁻?[¹²³⁴])?"
_NAME = r"[^\W\d]+" + _POWER
_NUMBER = re.compile(r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?)\s*(.*?)\s*", re.DOTALL)
_COMMA = re.compile(r"\s*([+-]?[0-9]+),([0-9]+(?:[eE][+-]?[0-9]+)?)(?![0-9])([^,]*)")
_UNIT = re.compile(rf"{_NAME}(?:(?:\s*[*/·]\s*|\s+){_NAME})*")  # pint's own texts can be whole calculations


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
    try:
        found = _root(given)
    except ImportError:
        raise ValueError(f"its unit needs the package pint, which is not installed; {wanted}") from None
    if found is None:
        raise ValueError(f"its unit is not known; {wanted}")
    (factor, root), (one, wanted_root) = found, _root(unit) or found
    if root != wanted_root:
        raise ValueError(f"its unit is not a unit of {QUANTITIES[unit]}; {wanted}")
    return float(Decimal(number) * factor / one)


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
