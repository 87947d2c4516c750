"""Units of :class:`~fingerpad.afferents.filtered.FilteredUnit` from a user's own copy of a parameter file.

The file is ``constants.py`` of TouchSim, which has no licence and is not part of this package. It is read and not
executed: lists of numbers that are assigned to the names of :data:`NAMES` are taken, thirteen for each unit.
"""

import ast
from pathlib import Path

from fingerpad.afferents.filtered import FilteredUnit
from fingerpad.scene.messages import SceneError, clip

NAMES = {"SA1": ("affparamsSA", "merkel"), "RA1": ("affparamsRA", "meissner"), "PC": ("affparamsPC", "pacinian")}
"""Names of lists in the file, and sites, by class."""
_COUNT = 13


def read_units(file: str | Path) -> dict[str, tuple[FilteredUnit, ...]]:
    """Return the units of a parameter file by class.

    Args:
        file: Python source that assigns ``affparamsSA``, ``affparamsRA`` and ``affparamsPC``.

    Raises:
        SceneError: it cannot be read, or has no units.
    """
    path, name = Path(file), clip(str(file), 80)
    try:
        body = ast.parse(path.read_text(encoding="utf-8")).body
    except (OSError, SyntaxError, ValueError) as error:
        raise SceneError(f"the parameter file {name} cannot be read: {error}") from None
    given = {
        target.id: line.value
        for line in body
        if isinstance(line, ast.Assign)
        for target in line.targets
        if isinstance(target, ast.Name)
    }
    found = {}
    for each, (key, site) in NAMES.items():
        if key not in given:
            raise SceneError(f"the parameter file {name} has no {key}; it must be constants.py of TouchSim")
        found[each] = tuple(FilteredUnit(row, site) for row in _rows(given[key], f"{key} in {name}"))
    return found


def _rows(value: ast.expr, where: str) -> list[tuple[float, ...]]:
    """Return the rows of a list, or of the array that is made of it."""
    table = value.args[0] if isinstance(value, ast.Call) and value.args else value
    try:
        rows = [tuple(float(number) for number in row) for row in ast.literal_eval(table)]
    except (ValueError, TypeError):
        rows = []
    if not rows or any(len(row) != _COUNT for row in rows):
        raise SceneError(f"{where} is no list of rows of {_COUNT} numbers")
    return rows
