"""Tables of measurements, from CSV or a DataFrame: columns by the program's names, in SI units.

    # source: Surname and Surname 2020, Journal 1, 2-3
    # doi: 10.1000/example
    # people: 5
    # state: full slip
    participant; force [N/m]; voltage [V]; friction [%]; spread [%]; room temperature
    A; 50; 100; 31,5; 4; 23

Semicolons and tabs allow decimal commas. Friction may be in percent; a spread in percent is a part of the measured
value, if that is in another unit. The sign of a friction is its direction, and that of a voltage changes no force:
neither is compared. ``participant`` is a person's name or number.

A table with a column in newtons, or of an area, is of a whole finger; without one it is of a cross-section, in N/m.
``force`` and ``voltage`` are conditions, each optional. One
more column is the quantity, and ``spread`` is its standard deviation, which a row may lack. Others are ignored.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from fingerpad.scene.messages import SceneError, clip, ends, refuse_type
from geometry.units import to_si
from variational import files

CONDITIONS = {"force": ("N", "N/m"), "voltage": ("V",)}
"""Columns that are conditions, and their SI units."""
SECTION = {
    "friction": ("mu_app", "1"),
    "friction force": ("f_t", "N/m"),
    "attraction": ("f_electrostatic", "N/m"),
    "contact length": ("contact_length", "m"),
    "ridges": ("ridges_in_contact", "1"),
    "depth": ("depth", "m"),
}
"""Quantities of a cross-section: key of the result and SI unit; ``depth`` is the way that the bone has come down."""
WHOLE = {
    "friction": ("mu_app", "1"),
    "friction force": ("f_t", "N"),
    "attraction": ("f_electrostatic", "N"),
    "gross area": ("gross_area", "m^2"),
    "contact area": ("contact_area", "m^2"),
    "depth": ("indentation", "m"),
}
"""Quantities of a whole finger."""
STATES = {"uncharged": "uncharged", "charged": "charged", "full slip": "full_slip"}
"""What the state of a table can be, and its name in results."""
PERSON = "participant"
"""Column of who was measured."""
_NAMES = (*CONDITIONS, *(SECTION | WHOLE), "spread", PERSON)
_PERCENT = ("%", "percent")
_COMMENT = re.compile(r"#\s*(source|doi|url|people|state)\s*:(.*)", re.IGNORECASE)
_HEAD = re.compile(r"\s*(.*?)\s*[(\[]\s*([^()\[\]]*?)\s*[)\]]\s*")
_MAX_COLUMNS = 1000
_MAX_PATH = 40_000  # characters: of the longest path that Linux has, with all of them escaped
_MAX_HEAD = 200  # characters of a head with a unit


@dataclass(frozen=True, eq=False)
class Measured:
    """A table of measurements, in SI units."""

    name: str
    """Its file, shortened for messages."""
    about: dict[str, str]
    """Its comments by name: source, doi, url, people, state."""
    state: str
    """A name of :data:`fingerpad.results.states.STATES`."""
    quantity: str
    whole: bool
    """Whether it is of a whole finger, in N and m², and not of a cross-section."""
    rows: pd.DataFrame
    """Columns ``measured``, ``spread`` (NaN where a row has none), the conditions that the table has, and
    ``participant``."""
    ignored: tuple[str, ...] = ()
    """Heads of columns that are not read."""
    turned: int = 0
    """Rows with a friction below 0, of the other direction: their magnitude is in ``rows``."""
    path: str = ""
    """Its file as it was given; empty of a DataFrame."""

    @property
    def key(self) -> str:
        """The quantity's name in results."""
        return (WHOLE if self.whole else SECTION)[self.quantity][0]

    @property
    def unit(self) -> str:
        """The quantity's SI unit."""
        return (WHOLE if self.whole else SECTION)[self.quantity][1]

    @property
    def force_unit(self) -> str:
        """The SI unit of forces."""
        return "N" if self.whole else "N/m"


class _Column(NamedTuple):
    head: str
    name: str
    """Of this program; empty where the column is ignored."""
    unit: str
    """Empty where none is given."""
    mapped: bool
    """Whether a mapping names it."""
    where: str
    """For a refusal."""
    cells: "pd.Series[str]"
    """As text, empty where a cell is missing; the index has the lines of a file."""


def read(
    table: str | Path | pd.DataFrame, columns: Mapping[str, str | None] | None = None, state: str | None = None
) -> Measured:
    """Return the measurements in a file or a DataFrame.

    Args:
        table: CSV separated by commas, semicolons or tabs, or a DataFrame, whose ``attrs`` stand for the comments, and
            the names of whose index are columns.
        columns: names of this program by heads of the table, with a unit where the head has none: ``{"Fn": "force
            (N)"}``; a column with an empty name is left out.
        state: ``"uncharged"``, ``"charged"`` or ``"full slip"``; by default that of the table, else full slip.

    Raises:
        SceneError: what is wrong in the table, with line and column.
    """
    refuse_type("table", table, str | Path | pd.DataFrame, "a DataFrame of pandas, or the path of a CSV file")
    refuse_type("state", state, str | None, f"one of {', '.join(STATES)}")
    refuse_type("columns", columns, Mapping | None, "names by heads, as {'CoF': 'friction (1)'}")
    for head, of in (columns or {}).items():
        refuse_type(f"of columns, the name of {clip(repr(head))}", of, str | None, "text, as 'friction (1)'")
    name, where, frame = ("the table", "row", _frame(table)) if isinstance(table, pd.DataFrame) else _file(Path(table))
    about = {key: str(value) for key, value in frame.attrs.items()}
    given = (state or about.get("state", "full slip")).lower().replace("_", " ")
    if given not in STATES:
        raise SceneError(f"{name}: state is {clip(repr(given))}; it must be one of {', '.join(STATES)}")
    found = _named(name, frame, columns or {})
    used, whole = {column.name: column for column in found if column.name}, False
    quantities = [column for column in used.values() if column.name in SECTION | WHOLE]
    if len(quantities) > 1:  # one that a mapping names is meant, whatever else is there
        quantities = [column for column in quantities if column.mapped] or quantities
        others = (SECTION | WHOLE).keys() - {column.name for column in quantities}
        used = {key: column for key, column in used.items() if key not in others}
    if len(quantities) != 1:
        heads = clip(", ".join(map(str, frame)), 100)
        has = ", ".join(column.name for column in quantities) or f"no quantity; it has the columns {heads}"
        raise SceneError(
            f"{name} has {has}, and must have one of {', '.join(SECTION | WHOLE)}, by its heads or by "
            "columns, as in {'CoF': 'friction (1)'}"
        )
    quantity, whole = quantities[0].name, any(_is_whole(column) for column in used.values())
    if quantity.startswith("friction") and given != "full slip":
        raise SceneError(f"{name} has {quantity} at the state {given}; before the finger slides it has none")
    known = WHOLE if whole else SECTION
    if quantity not in known:
        kind = "a whole finger, which has a column in newtons or of an area," if whole else "a cross-section"
        raise SceneError(f"{name} has {quantity}, and {kind} has {', '.join(known)}")
    units = dict.fromkeys((quantity, "spread"), known[quantity][1]) | {"force": "N" if whole else "N/m", "voltage": "V"}
    ignored = [column for column in found if column.name not in used and (column.name or not column.mapped)]
    person = used.pop(PERSON, None)
    rows = {key: _numbers(name, where, column, units[key]) for key, column in used.items()}
    turned = int((rows[quantity] < 0).sum())
    rows[quantity] = rows[quantity].abs()
    if "spread" in used and used["spread"].unit in _PERCENT and quantities[0].unit not in _PERCENT:
        rows["spread"] *= rows[quantity]
    _refuse_zero(name, where, quantities[0], rows)
    people = {} if person is None else {PERSON: _people(name, where, person)}
    for condition in CONDITIONS:
        if condition not in used:
            _refuse_overlooked(name, condition, ignored)
    measured = pd.DataFrame({"spread": np.nan} | rows | people, index=frame.index)
    measured, left = measured.rename(columns={quantity: "measured"}), tuple(column.head for column in ignored)
    path = "" if isinstance(table, pd.DataFrame) else ends(table, _MAX_PATH)
    return Measured(name, about, STATES[given], quantity, whole, measured, left, turned, path)


def _frame(table: pd.DataFrame) -> pd.DataFrame:
    """Return a table whose index has no columns: of conditions, for example."""
    return table.reset_index(allow_duplicates=True) if any(name is not None for name in table.index.names) else table


def _file(file: Path) -> tuple[str, str, pd.DataFrame]:
    """Return the name of a file, what its rows are called, and its cells by head and line."""
    name = ends(file)
    try:
        text = files.text(files.read(file, files.MOST_OF_TEXT))
    except OSError as error:
        raise SceneError(f"{name} cannot be read: {error.strerror or error}") from None
    if text is None:
        raise SceneError(f"{name} is no text; it must be a table in CSV")
    comments = [match for line in text.splitlines() if (match := _COMMENT.fullmatch(line.strip()))]
    text = "\n".join("" if line.lstrip().startswith("#") else line for line in text.splitlines())
    head = next((line for line in text.splitlines() if line.strip()), "")
    mark = next((mark for mark in "\t;," if mark in head), ",")
    if head.count(mark) >= _MAX_COLUMNS:
        raise SceneError(f"{name} has {head.count(mark) + 1} columns; at most {_MAX_COLUMNS} are read")
    try:
        rows = files.parted(text, mark)
    except ValueError as error:
        raise SceneError(f"{name} is no table in CSV: {clip(str(error), 80)}") from None
    if len(rows) < 2:
        raise SceneError(f"{name} has no rows of numbers below a header such as 'force (N/m), friction (1)'")
    (_, heads), *rows = rows
    for line, cells in rows:
        if len(cells) > len(heads) and any(cells[len(heads) :]):
            why = "decimals have points, not commas" if mark == "," else "each must have one below each head"
            raise SceneError(f"{name}, line {line} has {len(cells)} cells below {len(heads)} columns; {why}")
    width = len(heads)
    frame = pd.DataFrame([(cells + [""] * width)[:width] for _, cells in rows], [n for n, _ in rows], heads, dtype=str)
    frame.attrs = {match[1].lower(): match[2].strip() for match in comments}
    return name, "line", frame


def _named(name: str, frame: pd.DataFrame, columns: Mapping[str, str | None]) -> list[_Column]:
    """Return the columns with their names in this program."""
    heads = [str(head).strip() for head in frame]
    given, found = {head.strip(): of or "" for head, of in columns.items()}, []
    if unknown := next((head for head in given if head not in heads), None):
        raise SceneError(f"{name} has no column {clip(repr(unknown))}; it has {clip(', '.join(heads), 200)}")
    for number, head in enumerate(heads, start=1):
        of, unit = _parts(given.get(head, head))
        if of not in _NAMES and head in given and of:
            allowed = ", ".join(_NAMES)
            raise SceneError(f"the column {clip(repr(head))} is {clip(repr(of))}; it must be one of {allowed}")
        cells = frame.iloc[:, number - 1].map(lambda cell: "" if pd.isna(cell) else str(cell).strip())
        of, unit = of if of in _NAMES else "", unit or _parts(head)[1]
        if unit in ("", "1", *_PERCENT) and any(cells) and all(not cell or cell.endswith("%") for cell in cells):
            cells, unit = cells.str.rstrip("% "), "%"
        found.append(_Column(head, of, unit, head in given, f"column {number}", cells))
        if of and [column.name for column in found].count(of) > 1:
            raise SceneError(f"{name}: two columns have the name {of}; give one, and leave out the other")
    return found


def _parts(head: str) -> tuple[str, str]:
    """Return name and unit of a head."""
    match = _HEAD.fullmatch(head[:_MAX_HEAD])
    return (match[1].lower(), match[2]) if match else (head.lower(), "")


def _is_whole(column: _Column) -> bool:
    return "area" in column.name or (column.name != "spread" and _is(column.unit, "N"))


def _is(unit: str, wanted: str) -> bool:
    """Return whether a unit is of the kind of another one."""
    try:
        return to_si(f"1 {unit}", wanted) > 0
    except ValueError:
        return False


def _refuse_overlooked(name: str, condition: str, ignored: list[_Column]) -> None:
    """Refuse a table without a condition where an ignored column may be it."""
    for column in ignored:
        units = CONDITIONS[condition]
        numbers = column.cells.map(_number).notna().any()
        if any(_is(column.unit, unit) for unit in units) if column.unit else numbers:
            meant = condition if column.unit else f"{condition} ({units[0]})"
            head = clip(repr(column.head))
            raise SceneError(
                f"{name} has no {condition}, and its column {head} may be one; name it by columns, as in "
                f"{{{head}: '{meant}'}}, or leave it out by {{{head}: ''}}"
            )


def _numbers(name: str, row: str, column: _Column, wanted: str) -> "pd.Series[float]":
    """Return the values of a column in SI units."""
    factor = _factor(f"{name}, {column.where}", column, wanted)
    values, missing = column.cells.map(_number), column.cells == ""
    least = {"voltage": "", "spread": ", 0 or more", "attraction": ", 0 or more"}.get(column.name, " greater than 0")
    least = " other than 0" if column.name.startswith("friction") else least
    values = values.abs() if column.name == "voltage" else values
    wrong = ~np.isfinite(values) | ((values < 0) & (least != " other than 0")) | ((values == 0) & ("than" in least))
    wrong &= ~missing | (column.name != "spread")
    if wrong.any():
        at = int(wrong.to_numpy().argmax())
        cell, where = column.cells.iloc[at], f"{name}, {row} {column.cells.index[at]}, {column.where}"
        if not cell:
            raise SceneError(f"{where}: the {column.name} is missing; leave the row out or give the number")
        comma = "; decimals have points" if "," in cell else ""
        raise SceneError(f"{where}: the {column.name} is {clip(repr(cell))}; it must be a finite number{least}{comma}")
    return values * factor


def _number(cell: str) -> float:
    """Return the number in a cell, NaN where it is none."""
    try:
        return np.nan if "_" in cell else float(cell)  # Python takes _ for a mark between digits
    except ValueError:
        return np.nan


def _factor(where: str, column: _Column, wanted: str) -> float:
    """Return the factor from the unit of a column to its SI unit."""
    name, unit = column.name, column.unit
    if not unit:
        raise SceneError(
            f"{where}: {clip(repr(column.head))} has no unit; write '{name} ({wanted})' in the head or by columns, and "
            "(1) for a number without"
        )
    if unit in _PERCENT and (wanted == "1" or name == "spread"):
        return 0.01
    if wanted == "1" and unit != "1":
        raise SceneError(f"{where}: the unit of {name} is {clip(repr(unit))}; it must be 1 or %")
    try:
        return 1.0 if wanted == "1" else to_si(f"1 {unit}", wanted)
    except ValueError as error:
        why = str(error).partition(";")[0]
        of_whole = {"N/m": "N/m, or in N for a whole finger", "N": "N, as another column is of a whole finger"}
        allowed = of_whole.get(wanted, wanted)
        raise SceneError(f"{where}: the unit of {name} is {clip(repr(unit))}; {why}; it must be in {allowed}") from None


def _refuse_zero(name: str, row: str, column: _Column, rows: Mapping[str, "pd.Series[float]"]) -> None:
    """Refuse an attraction of 0 under a voltage; without one it is 0."""
    charged = rows["voltage"] != 0 if "voltage" in rows else True
    wrong = (rows[column.name] == 0) & charged
    if wrong.any():
        line = column.cells.index[int(wrong.to_numpy().argmax())]
        raise SceneError(f"{name}, {row} {line}, {column.where}: the {column.name} is 0; it must be so at 0 V alone")


def _people(name: str, row: str, column: _Column) -> "pd.Series[str]":
    """Return who was measured in each row."""
    if (missing := column.cells == "").any():
        line = column.cells.index[int(missing.to_numpy().argmax())]
        raise SceneError(f"{name}, {row} {line}, {column.where}: the participant is missing; give a name in each row")
    return column.cells.map(lambda cell: clip(cell, 40))
