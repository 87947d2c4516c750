"""Voltages over time from a CSV file, with the header ``time (s),voltage (V)``."""

import csv
import math
from typing import Annotated, Any

from fingerpad.scene.messages import clip, show
from geometry.units import Finite, Range, within
from variational import files

POINTS = 2000
"""Most points of a file."""
HIGHEST = 5e3
"""Largest voltage (V)."""
_LEAST = 1e-3  # V; what is less in a table is 0: noise, or roundoff of a computed sine
_TIME, _VOLTAGE = "time (s)", "voltage (V)"
Volts = Annotated[Finite, within(_LEAST, HIGHEST, "V", zero=True, sides=2)]
Seconds = Annotated[Finite, within(1e-9, 1e5, "s", zero=True)]


def or_zero(value: Any) -> Any:
    """Return a voltage of a table, and 0 for one that is less than a scene can have."""
    return 0.0 if isinstance(value, float) and abs(value) < _LEAST else value


def table(file: str) -> dict[str, Any]:
    """Return times and voltages of a CSV file.

    Raises:
        ValueError: it cannot be read, has another header, or a row without two numbers in range.
    """
    name = f"file is {show(file)}"
    try:
        lines = list(csv.reader(files.read(file, files.MOST_OF_TEXT).decode("utf-8-sig").splitlines(), strict=True))
    except OSError as error:
        raise ValueError(f"{name}, which cannot be read: {show(error.strerror or str(error))}") from None
    except (ValueError, csv.Error) as error:
        raise ValueError(f"{name}, which is no table in CSV: {show(clip(str(error), 100))}") from None
    rows = [(k, [cell.strip() for cell in row]) for k, row in enumerate(lines, start=1) if any(map(str.strip, row))]
    header = rows[0][1] if rows else []
    if header != [_TIME, _VOLTAGE]:
        raise ValueError(f"{name} with the header {show(','.join(header))}; it must be '{_TIME},{_VOLTAGE}'")
    if len(rows) - 1 > POINTS:
        raise ValueError(f"{name} with {len(rows) - 1} points; there must be from 2 to {POINTS} of them")
    times, voltages = list[float](), list[float]()
    for line, row in rows[1:]:
        if len(row) != 2:
            raise ValueError(f"{name}, whose line {line} has {len(row)} cells; it must have 2, a time and a voltage")
        for text, found, allowed in ((row[0], times, _range(Seconds)), (row[1], voltages, _range(Volts))):
            try:
                value = float(text)
            except ValueError:
                value = math.nan
            if not math.isfinite(value):
                raise ValueError(f"{name}, whose line {line} has {show(text)}; it must be a finite number")
            value = or_zero(value) if found is voltages else value
            if value not in allowed:
                raise ValueError(f"{name}, whose line {line} has a number that {allowed.words(value)}")
            found.append(value)
    return {"times": times, "voltages": voltages}


def _range(annotation: Any) -> Range:
    """Return the range of a key's annotation."""
    return next(part.func for part in annotation.__metadata__ if isinstance(getattr(part, "func", None), Range))
