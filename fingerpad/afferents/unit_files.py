"""Units of :class:`~fingerpad.afferents.filtered.FilteredUnit` from a user's own copy of a parameter file.

The file is ``constants.py`` of TouchSim, which has no licence and is not part of this package. It is read as text and
not executed: lists of numbers that are assigned to the names of :data:`NAMES` are taken, thirteen for each unit.
"""

import math
import re
from pathlib import Path

from fingerpad.afferents.filtered import FilteredUnit
from fingerpad.scene.messages import SceneError, clip
from variational import files

NAMES = {"SA1": ("affparamsSA", "merkel"), "RA1": ("affparamsRA", "meissner"), "PC": ("affparamsPC", "pacinian")}
"""Names of lists in the file, and sites, by class."""
_COUNT = 13
_LIST = re.compile(r"[^\[\n]*\[\s*\[(.*?)\]\s*(?:,\s*)?\]", re.DOTALL)


def read_units(file: str | Path) -> dict[str, tuple[FilteredUnit, ...]]:
    """Return the units of a parameter file by class.

    Args:
        file: Python source that assigns ``affparamsSA``, ``affparamsRA`` and ``affparamsPC``.

    Raises:
        SceneError: it cannot be read, or has no units.
    """
    name = clip(str(file), 80)
    try:
        text = files.text(files.read(file, files.MOST_OF_TEXT)) or ""
    except OSError as error:
        raise SceneError(f"the parameter file {name} cannot be read: {error.strerror or error}") from None
    return {
        each: tuple(FilteredUnit(row, site) for row in _rows(text, key, name)) for each, (key, site) in NAMES.items()
    }


def _rows(text: str, key: str, name: str) -> list[tuple[float, ...]]:
    """Return the rows of a list, or of the array that is made of it."""
    start = re.search(rf"^{key}\s*=", text, re.MULTILINE)
    if start is None:
        raise SceneError(f"the parameter file {name} has no {key}; it must be constants.py of TouchSim")
    found = _LIST.match(text, start.end())
    rows = re.split(r"\]\s*,\s*\[", re.sub(r"#.*", "", found[1])) if found else []
    try:
        numbers = [tuple(map(float, row.strip(" \r\n\t,").split(","))) for row in rows]
    except ValueError:
        numbers = []
    if not numbers or any(len(row) != _COUNT or not all(map(math.isfinite, row)) for row in numbers):
        raise SceneError(f"{key} in {name} is no list of rows of {_COUNT} finite numbers")
    return numbers
