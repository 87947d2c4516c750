"""Tables of measurements: CSV with a header of names and units, and comments that name the source.

    # source: Surname and Surname 2020, Journal 1, 2-3
    # doi: 10.1000/example
    # people: 5
    # state: full slip
    force (N/m), voltage (V), friction (1), spread (1)
    50, 100, 0.31, 0.04

A table with a column in newtons, or of an area, is of a whole finger; without one it is of a cross-section, in N/m.
The conditions are ``force`` and ``voltage``, each optional; the sign of a voltage changes no force and is left out. One
more column is the quantity, and ``spread`` is its standard deviation, in the same unit; a row may be without one. Only
the source is required of the comments; without a state it is full slip.
"""

import csv
import io
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from fingerpad.scene.messages import SceneError, clip
from geometry.units import to_si
from variational import files

CONDITIONS = {"force": ("f_ext", "N/m"), "voltage": ("voltage", "V")}
"""Names of the columns that are conditions: key of ours, and its SI unit."""
QUANTITIES = {
    "friction": ("mu_app", "1"),
    "friction force": ("f_t", "N/m"),
    "attraction": ("f_electrostatic", "N/m"),
    "contact length": ("contact_length", "m"),
    "ridges": ("ridges_in_contact", "1"),
    "depth": ("depth", "m"),
}
"""The same of the columns that are compared; ``depth`` is the way that the bone has come down."""
WHOLE = {
    "force": ("f_ext", "N"),
    "friction force": ("f_t", "N"),
    "attraction": ("f_electrostatic", "N"),
    "gross area": ("gross_area", "m^2"),
    "contact area": ("contact_area", "m^2"),
    "friction": ("mu_app", "1"),
    "depth": ("indentation", "m"),
}
"""The same of a table of a whole finger: one with a column in newtons, or of an area."""
STATES = {"uncharged": "uncharged", "charged": "charged", "full slip": "full_slip"}
"""What ``# state:`` can be, and the name of ours."""
_COMMENT = re.compile(r"#\s*([A-Za-z]+)\s*:\s*(.*?)\s*")
_ABOUT = ("source", "doi", "url", "people", "state")
_HEAD = re.compile(r"\s*(.*?)\s*\(\s*(.*?)\s*\)\s*")
_NEWTONS = re.compile(r"(?:[a-zA-Zµμ]{0,2}N|[a-z]*newtons?)")
_LARGEST = 1_000_000  # bytes of a file


@dataclass(frozen=True)
class Measured:
    """A table of measurements, in SI units."""

    file: Path
    source: str
    state: str
    """A name of :data:`fingerpad.io.states.STATES`."""
    quantity: str
    """A name of :data:`QUANTITIES`, or of :data:`WHOLE`."""
    conditions: dict[str, tuple[float, ...]]
    """Values by key, ``f_ext`` and ``voltage``; those of the columns that the table has."""
    values: tuple[float, ...]
    spread: tuple[float, ...]
    """NaN in a row without it."""
    about: dict[str, str] = field(default_factory=dict)
    """The comments by name."""
    whole: bool = False
    """Whether it is of a whole finger, in N and m², and not of a cross-section."""

    @property
    def key(self) -> str:
        """The quantity's name in ours."""
        return _names(self.whole)[self.quantity][0]

    @property
    def unit(self) -> str:
        """The quantity's SI unit."""
        return _names(self.whole)[self.quantity][1]

    @property
    def force_unit(self) -> str:
        """The SI unit of forces."""
        return "N" if self.whole else "N/m"


def _names(whole: bool) -> dict[str, tuple[str, str]]:
    """Return key and unit of every column that can be in a table."""
    return {"voltage": CONDITIONS["voltage"]} | WHOLE if whole else CONDITIONS | QUANTITIES


@dataclass(frozen=True)
class _Column:
    name: str
    unit: str
    factor: float


def read(file: Path) -> Measured:
    """Return the measurements in a file.

    Raises:
        SceneError: what is wrong in the file, with the line and the column.
    """
    name = clip(str(file), 80)
    try:
        lines = files.read(file, _LARGEST).decode("utf-8-sig").splitlines()
    except OSError as error:
        raise SceneError(f"{name} cannot be read: {error.strerror or error}") from None
    except UnicodeDecodeError:
        raise SceneError(f"{name} is not text in UTF-8; save it as CSV in UTF-8") from None
    try:
        about, rows = _parts(lines)
    except csv.Error as error:
        raise SceneError(f"{name} is no table in CSV: {error}") from None
    if not about.get("source"):
        raise SceneError(f"{name} has no source; add a first line such as '# source: Surname 2020, Journal 1, 2-3'")
    if (state := about.get("state", "full slip").lower()) not in STATES:
        raise SceneError(f"{name}: state is {clip(repr(state))}; it must be one of {', '.join(STATES)}")
    if len(rows) < 2:
        raise SceneError(f"{name} has no rows of numbers below a header such as 'force (N/m), friction (1)'")
    header = rows[0][1]
    if len(header) == 1 and re.search(r"\).*[;\t].*\(", header[0]):
        raise SceneError(f"{name}, line {rows[0][0]} is {clip(repr(header[0]))}; columns must be separated by commas")
    if state != "full slip" and any(re.match(r"\s*friction\b", head, re.IGNORECASE) for head in header):
        raise SceneError(f"{name} has friction at the state {state}; before the finger slides it has none")
    whole = any((parts := _HEAD.fullmatch(head)) and _of_whole(*parts.groups()) for head in rows[0][1])
    columns = _columns(name, *rows[0], whole)
    found = [_numbers(name, line, cells, columns) for line, cells in rows[1:]]
    by_name = dict(zip((column.name for column in columns), zip(*found, strict=True), strict=True))
    quantity = next(each for each in by_name if each in _names(whole) and each not in CONDITIONS)
    conditions = {key: by_name[each] for each, (key, _) in CONDITIONS.items() if each in by_name}
    spread = by_name.get("spread", (math.nan,) * len(found))
    return Measured(file, about["source"], STATES[state], quantity, conditions, by_name[quantity], spread, about, whole)


def _parts(lines: Sequence[str]) -> tuple[dict[str, str], list[tuple[int, list[str]]]]:
    """Return the comments by name, and the cells of the other lines that are not empty, with their numbers."""
    about, rows = {}, []
    for number, line in enumerate(lines, start=1):
        if line.lstrip().startswith("#"):
            comment = _COMMENT.fullmatch(line.strip())
            if comment and comment[1].lower() in _ABOUT:
                about[comment[1].lower()] = comment[2]
        elif line.strip():
            rows.append((number, [cell.strip() for cell in next(csv.reader(io.StringIO(line), skipinitialspace=True))]))
    return about, rows


def _of_whole(name: str, unit: str) -> bool:
    return bool(_NEWTONS.fullmatch(unit)) or "area" in name.lower()


def _columns(name: str, line: int, heads: Sequence[str], whole: bool) -> list[_Column]:
    known = _names(whole)
    columns = [_column(f"{name}, line {line}, column {k}", head, known) for k, head in enumerate(heads, start=1)]
    names = [column.name for column in columns]
    if twice := next((each for each in names if names.count(each) > 1), None):
        raise SceneError(f"{name}, line {line}: two columns have the name {twice}; give one")
    allowed = [each for each in known if each not in CONDITIONS]
    quantities = [column for column in columns if column.name in allowed]
    if len(quantities) != 1:
        which = ", ".join(column.name for column in quantities) or "none"
        raise SceneError(f"{name}, line {line} must have one quantity out of {', '.join(allowed)}; it has {which}")
    return list(_with_spread(name, line, columns, known[quantities[0].name][1]))


def _with_spread(name: str, line: int, columns: Sequence[_Column], wanted: str) -> Iterator[_Column]:
    """Yield the columns; that of the spread has the dimension of the quantity."""
    for column in columns:
        if column.name == "spread":
            where = f"{name}, line {line}, column {columns.index(column) + 1}"
            yield _Column("spread", column.unit, _factor(where, "spread", column.unit, wanted))
        else:
            yield column


def _column(where: str, head: str, known: Mapping[str, tuple[str, str]]) -> _Column:
    parts = _HEAD.fullmatch(head)
    if parts is None or not parts[2]:
        raise SceneError(f"{where}: {clip(repr(head))} has no unit; write 'name (unit)', and (1) for a number without")
    name, unit = parts[1].lower(), parts[2]
    if name == "spread":
        return _Column(name, unit, 1.0)
    if name not in known:
        raise SceneError(f"{where}: ours has no {clip(repr(name))}; columns are {', '.join(known)} and spread")
    return _Column(name, unit, _factor(where, name, unit, known[name][1]))


def _factor(where: str, name: str, unit: str, wanted: str) -> float:
    """Return the factor from a unit to the SI unit of a column."""
    if wanted == "1":
        if unit != "1":
            raise SceneError(f"{where}: the unit of {name} is {clip(repr(unit))}; it must be 1")
        return 1.0
    try:
        return to_si(f"1 {unit}", wanted)
    except ValueError as error:
        why = str(error).partition(";")[0]
        of_whole = {"N/m": "N/m, or in N for a whole finger", "N": "N, as another column is of a whole finger"}
        allowed = of_whole.get(wanted, wanted)
        raise SceneError(f"{where}: the unit of {name} is {clip(repr(unit))}; {why}; it must be in {allowed}") from None


def _numbers(name: str, line: int, cells: Sequence[str], columns: Sequence[_Column]) -> list[float]:
    if len(cells) > len(columns):
        raise SceneError(
            f"{name}, line {line} has {len(cells)} cells below {len(columns)} columns; decimals have points, not commas"
        )
    found = []
    for k, column in enumerate(columns):
        where, text = f"{name}, line {line}, column {k + 1}", cells[k] if k < len(cells) else ""
        if not text and column.name == "spread":
            found.append(math.nan)
            continue
        if not text:
            raise SceneError(f"{where}: the {column.name} is missing; leave the row out or give the number")
        try:
            if "_" in text:  # which Python takes for a mark between digits
                raise ValueError
            value = float(text)
        except ValueError:
            raise SceneError(f"{where}: the {column.name} is {clip(repr(text))}; it must be a number") from None
        if column.name == "voltage":
            value = abs(value)
        allowed = {"voltage": "", "spread": " and 0 or more"}.get(column.name, " and greater than 0")
        if not math.isfinite(value) or value < 0 or (value == 0 and "greater" in allowed):
            raise SceneError(f"{where}: the {column.name} is {clip(text)}; it must be finite{allowed}")
        found.append(value * column.factor)
    return found
