"""The lines above the numbers of a height map: its mark of missing pixels, and the units of points.

An ESRI ASCII grid has a line ``NODATA_value -9999``. A line that names x, y and z may give units, as
``x (mm), y (mm), z (µm)``, also in square brackets, or as ``x/mm`` or ``x_mm``.
"""

import re
from collections.abc import Sequence

UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "μm": 1e-6, "micron": 1e-6, "nm": 1e-9, "pm": 1e-12}
"""Units of length in m."""
_PREFIXES = {"": "m", "centi": "cm", "milli": "mm", "micro": "um", "nano": "nm"}
_SPELT = {
    **{f"{prefix}met{end}": unit for prefix, unit in _PREFIXES.items() for end in ("er", "re")},
    "micron": "um",
}
_MARK = re.compile(r"\W*nodata_value\W*\s(\S+)\s*", re.IGNORECASE)
_COLUMN = r"(?<![^\W_])(?:[xyz]|heights?)(?![^\W_])"
_NAME = re.compile(_COLUMN, re.IGNORECASE)
_UNIT = re.compile(
    rf"({_COLUMN})(?:(?!{_COLUMN})[^()\[\],;\t])*?"
    rf"(?:[(\[]\s*([^()\[\]]+?)\s*[)\]]|[/_]\s*({'|'.join(UNITS)})(?![^\W_]))",
    re.IGNORECASE,
)


def mark(header: Sequence[str]) -> str | None:
    """Return how the lines of a header mark missing pixels, None if they do not."""
    return next((found[1] for line in header if (found := _MARK.fullmatch(line))), None)


def units(header: Sequence[str]) -> dict[str, str]:
    """Return the units, of :data:`UNITS`, that the lines of a header give for the columns x, y and z.

    Words in brackets, as in ``x (along), y (across), z (up)``, are units where one of them is.

    Raises:
        ValueError: a unit that is not known, beside one that is.
    """
    given: dict[str, str] = {}
    for line in header:
        if {_axis(name) for name in _NAME.findall(line)} != set("xyz"):
            continue
        found = {_axis(name): (bracket or other).lower() for name, bracket, other in _UNIT.findall(line)}
        found = {axis: _SPELT.get(unit.removesuffix("s"), unit) for axis, unit in found.items()}
        known = {axis: unit for axis, unit in found.items() if unit in UNITS}
        if known and (unknown := found.keys() - known.keys()):
            axis = min(unknown)
            raise ValueError(
                f"its header gives {axis} in {found[axis][:20]!r}; a unit of length must be of {', '.join(UNITS)}, so "
                "change that line of the file"
            )
        given |= known
    return given


def _axis(name: str) -> str:
    """Return x, y or z for the name of a column; heights are z."""
    return name[0].lower().replace("h", "z")
