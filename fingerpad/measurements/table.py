"""Tables of measurements, from CSV or a DataFrame: columns by the program's names, in SI units.

    # source: Surname and Surname 2020, Journal 1, 2-3
    # doi: 10.1000/example
    # people: 5
    # state: full slip
    force [N/m]; voltage [V]; friction [%]; spread [%]; room temperature
    50; 100; 31,5; 4; 23

Files are those of :mod:`fingerpad.scene.tables`. A voltage is the rms value: ``voltage (Vpp)`` and ``voltage (V
amplitude)`` are converted as those of a sine. Friction may be in percent; a spread in percent is a part of the measured
value, if that is in another unit. The sign of a friction is its direction, and that of a voltage changes no force:
neither is compared.

A table with a column in newtons, or of an area, is of a whole finger; without one it is of a cross-section, in N/m.
``force`` and ``voltage`` are conditions, each optional. One more column is the quantity, and ``spread`` is its standard
deviation, which a row may lack. Others are ignored.

**Several quantities** (:func:`observations`) are columns of one table of whole fingers, whose cells may be empty:

    participant, force (N), voltage (Vpp), friction force (N), friction force spread (N), gross area (mm^2)
    1, 0.5, 200, 0.142, 0.004, 93
    2, 0.5, 200, 0.171, , 104

``QUANTITY spread`` is of one of them, ``spread`` of all others. Further conditions are the ``frequency`` of a drive and
a ``participant``, a name. A column without a meaning here is refused.
"""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd

from fingerpad.scene import tables
from fingerpad.scene.messages import SceneError, clip, ends, refuse_type, show
from fingerpad.scene.tables import NUMBERS, Column, is_of, parts

_CONDITIONS = {"force": ("N", "N/m"), "voltage": ("V",)}
_NONE = ("", "")  # of what a cross-section, or a whole finger, does not have
_QUANTITIES = {  # key of the result and SI unit: of a cross-section, and of a whole finger
    "friction": (("mu_app", "1"), ("mu_app", "1")),
    "friction force": (("f_t", "N/m"), ("f_t", "N")),
    "attraction": (("f_electrostatic", "N/m"), ("f_electrostatic", "N")),
    "contact length": (("contact_length", "m"), _NONE),
    "ridges": (("ridges_in_contact", "1"), _NONE),
    "gross area": (_NONE, ("gross_area", "m^2")),
    "contact area": (_NONE, ("contact_area", "m^2")),
    "depth": (("depth", "m"), ("indentation", "m")),  # the way down of the bone
}
OBSERVED = {of: whole[1] for of, (_, whole) in _QUANTITIES.items() if whole != _NONE and of != "attraction"} | {
    "share": "1", "air gap": "m", "threshold ratio": "1"
}  # fmt: skip
"""Quantities of a table of several and their SI units. Share: contact over gross area. Air gap: at the finger's centre.
Threshold ratio: voltage at the threshold of detection of a sine of the row's frequency, over that of 120 Hz."""
_GIVEN = {"force": "N", "voltage": "V", "frequency": "Hz"}
_STATES = {"uncharged": "uncharged", "charged": "charged", "full slip": "full_slip"}  # names in results
_NAMES = (*_CONDITIONS, *_QUANTITIES, "spread")
_PERCENT = ("%", "percent")
_COMMENT = re.compile(r"(source|doi|url|people|state)\s*:(.*)", re.IGNORECASE)
_SINE = re.compile(  # what a voltage is, behind its unit
    r"(?i)(?:^|(?<=[vu])|[ _-]+)(?:(rms|eff(?:ective)?)|(pp|p-p|pk-?pk|peak[ -]to[ -]peak)|(amplitude|peak))$"
)
_RMS = {1: 1.0, 2: 8**-0.5, 3: 2**-0.5}  # rms value of a sine over it, by the group of the expression
_LONGEST_PATH = 40_000  # characters, with all of them escaped


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
    """Columns ``measured``, ``spread`` (NaN where a row has none), and the conditions that the table has."""
    ignored: tuple[str, ...] = ()
    """Heads of columns that are not read."""
    turned: int = 0
    """Rows with a friction below 0, of the other direction: their magnitude is in ``rows``."""
    path: str = ""
    """Its file as it was given; empty of a DataFrame."""

    @property
    def key(self) -> str:
        """The quantity's name in results."""
        return _QUANTITIES[self.quantity][self.whole][0]

    @property
    def unit(self) -> str:
        """The quantity's SI unit."""
        return _QUANTITIES[self.quantity][self.whole][1]

    @property
    def force_unit(self) -> str:
        """The SI unit of forces."""
        return "N" if self.whole else "N/m"


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
    refuse_type("state", state, str | None, f"one of {', '.join(_STATES)}")
    refuse_type("columns", columns, Mapping | None, "names by heads, as {'CoF': 'friction (1)'}")
    for head, of in (columns or {}).items():
        refuse_type(f"of columns, the name of {clip(repr(head))}", of, str | None, "text, as 'friction (1)'")
    name = "the table" if isinstance(table, pd.DataFrame) else ends(table)
    try:
        heads, about, path = _of_frame(table) if isinstance(table, pd.DataFrame) else _of_file(table)
        wanted = (state or about.get("state", "full slip")).lower().replace("_", " ")
        if wanted not in _STATES:
            raise ValueError(f"has the state {show(wanted)}; it must be one of {', '.join(_STATES)}")
        used = _named(heads, given := {head.strip(): of or "" for head, of in (columns or {}).items()})
        quantity, whole = _quantity(heads, used, given, wanted)
        used = {of: column for of, column in used.items() if of == quantity or of not in _QUANTITIES}
        rows = _rows(used, quantity, whole)
        taken = {column.head for column in used.values()} | {head for head, of in given.items() if not of}
        ignored = [column for column in heads if column.head not in taken]
        _refuse_overlooked(used, ignored)
    except ValueError as error:
        raise SceneError(f"{name} {error}") from None
    measured = pd.DataFrame({"spread": np.nan} | rows).rename(columns={quantity: "measured"})
    turned = int((measured.measured < 0).sum())
    measured["measured"] = measured.measured.abs()
    left = tuple(column.head for column in ignored)
    return Measured(name, about, _STATES[wanted], quantity, whole, measured, left, turned, path)


@dataclass(frozen=True, eq=False)
class Observations:
    """A table of several quantities of whole fingers, in SI units."""

    name: str
    """Its file, shortened for messages."""
    state: str
    """Of all quantities but friction, a name of :data:`fingerpad.results.states.STATES`."""
    rows: pd.DataFrame
    """A row for each cell with a value: ``line``, ``participant`` (empty without one), ``force``, ``voltage`` and
    ``frequency`` (NaN where they are not given), ``quantity``, ``measured`` and ``spread``, relative to the value (NaN
    without one)."""


def observations(table: str | Path | pd.DataFrame, columns: Mapping[str, str | None] | None = None) -> Observations:
    """Return the quantities of a table of whole fingers; arguments are those of :func:`read`.

    Raises:
        SceneError: what is wrong in the table, with line and column.
    """
    refuse_type("table", table, str | Path | pd.DataFrame, "a DataFrame of pandas, or the path of a CSV file")
    name = "the table" if isinstance(table, pd.DataFrame) else ends(table)
    try:
        heads, about, _ = _of_frame(table) if isinstance(table, pd.DataFrame) else _of_file(table)
        state = about.get("state", "full slip").lower().replace("_", " ")
        if state not in _STATES:
            raise ValueError(f"has the state {show(state)}; it must be one of {', '.join(_STATES)}")
        names = {*_GIVEN, *OBSERVED, "participant", "spread", *(f"{of} spread" for of in OBSERVED)}
        given = {head.strip(): of or "" for head, of in (columns or {}).items()}
        used = _named(heads, given, sorted(names))
        left = {column.head for column in used.values()} | {head for head, of in given.items() if not of}
        if unknown := next((column.head for column in heads if column.head not in left), ""):
            raise ValueError(
                f"has the column {show(unknown)}, whose meaning is not known; name it by columns, as in "
                f"{{{show(unknown)}: 'friction force (N)'}}, or leave it out by {{{show(unknown)}: ''}}"
            )
        observed = [of for of in used if of in OBSERVED]
        if not observed or "force" not in used:
            raise ValueError(
                f"has {'no force' if observed else 'no quantity'}; it must have 'force (N)' and one of "
                f"{', '.join(OBSERVED)}"
            )
        rows = pd.concat([_observed(used, of) for of in observed]).sort_values("line", kind="stable", ignore_index=True)
    except ValueError as error:
        raise SceneError(f"{name} {error}") from None
    return Observations(name, _STATES[state], rows)


def _observed(used: Mapping[str, Column], of: str) -> pd.DataFrame:
    """Return the cells of one quantity that have a value, with their conditions."""
    values = _numbers(used[of], OBSERVED[of], optional=True).abs()
    rows = pd.DataFrame({"line": values.index, "measured": values.to_numpy(), "quantity": of})
    for condition, si in _GIVEN.items():
        rows[condition] = _numbers(used[condition], si).to_numpy() if condition in used else math.nan
    who = used["participant"].cells if "participant" in used else None
    if who is not None:
        used["participant"].refuse(who == "", "a name")
    rows["participant"] = "" if who is None else who.to_numpy()
    spread = used.get(f"{of} spread") or used.get("spread")
    if spread is not None:
        found = _numbers(replace(spread, name="spread"), OBSERVED[of], optional=True).to_numpy()
        rows["spread"] = found if spread.unit in _PERCENT else found / rows.measured
    else:
        rows["spread"] = math.nan
    return rows[rows.measured.notna()]


def _of_frame(table: pd.DataFrame) -> tuple[list[Column], dict[str, str], str]:
    """Return the columns of a DataFrame, whose index has some where it has names, and its facts."""
    if any(name is not None for name in table.index.names):
        table = table.reset_index(allow_duplicates=True)
    cells = (table.iloc[:, k].astype(object) for k in range(table.shape[1]))  # also of categories, and with pd.NA
    texts = (each.where(each.notna(), "").map(lambda cell: str(cell).strip()) for each in cells)
    heads = [str(head).strip() for head in table]
    columns = [Column(head, *parts(head), each, row="row") for head, each in zip(heads, texts, strict=True)]
    columns = [replace(each, numeric=pd.to_numeric(each.cells, errors="coerce").notna().any()) for each in columns]
    return columns, {key: str(value) for key, value in table.attrs.items()}, ""


def _of_file(file: str | Path) -> tuple[list[Column], dict[str, str], str]:
    """Return the columns of a file that have heads, its facts and its path."""
    found = tables.read(file, "force (N/m), friction (1)")
    comments = [match for comment in found.comments if (match := _COMMENT.fullmatch(comment))]
    about = {match[1].lower(): match[2].strip() for match in comments}
    return [column for column in found.columns if column.head], about, ends(file, _LONGEST_PATH)


def _named(heads: Sequence[Column], given: Mapping[str, str], names: Sequence[str] = _NAMES) -> dict[str, Column]:
    """Return columns by their names in this program, with their units."""
    found = dict[str, Column]()
    if unknown := given.keys() - {column.head for column in heads}:
        has = clip(", ".join(column.head for column in heads), 200)
        raise ValueError(f"has no column {show(min(unknown))}; it has {has}")
    for column in heads:
        of, unit = parts(given[column.head]) if column.head in given else (column.name, column.unit)
        of, unit, cells = of.lower(), unit or column.unit, column.cells
        if of not in names:
            if of and column.head in given:
                raise ValueError(f"has {show(of)} for {show(column.head)}; it must be one of {', '.join(names)}")
            continue
        if of in found:
            raise ValueError(f"has two columns with the name {of}; give one, and leave out the other")
        if (not unit or unit in NUMBERS) and any(cells) and all(not cell or cell.endswith("%") for cell in cells):
            cells, unit = cells.str.rstrip("% "), "%"
        found[of] = replace(column, name=of, unit=unit, cells=cells)
    return found


def _quantity(
    heads: Sequence[Column], used: Mapping[str, Column], given: Mapping[str, str], state: str
) -> tuple[str, bool]:
    """Return the quantity of a table, and whether it is of a whole finger."""
    found = [of for of in used if of in _QUANTITIES]
    found = [of for of in found if used[of].head in given] or found  # one that a mapping names is meant
    if len(found) != 1:
        has = ", ".join(found) or f"no quantity; it has the columns {clip(', '.join(each.head for each in heads), 100)}"
        example = "by its heads or by columns, as in {'CoF': 'friction (1)'}"
        raise ValueError(f"has {has}, and must have one of {', '.join(_QUANTITIES)}, {example}")
    of_kind = {of: each for of, each in used.items() if of == found[0] or of not in _QUANTITIES}
    whole = any("area" in of or (of != "spread" and is_of(each.unit, "N")) for of, each in of_kind.items())
    if found[0].startswith("friction") and state != "full slip":
        raise ValueError(f"has {found[0]} at the state {state}; before the finger slides it has none")
    if _QUANTITIES[found[0]][whole] == _NONE:
        kind = "a whole finger, which has a column in newtons or of an area," if whole else "a cross-section"
        others = ", ".join(of for of, each in _QUANTITIES.items() if each[whole] != _NONE)
        raise ValueError(f"has {found[0]}, and {kind} has {others}")
    return found[0], whole


def _rows(used: Mapping[str, Column], quantity: str, whole: bool) -> "dict[str, pd.Series[float]]":
    """Return the values of the columns by name, in SI units."""
    si = _QUANTITIES[quantity][whole][1]
    units = {quantity: si, "spread": si, "force": "N" if whole else "N/m", "voltage": "V"}
    rows = {of: _numbers(each, units[of]) for of, each in used.items()}
    used[quantity].refuse((rows[quantity] == 0) & (rows.get("voltage", 1.0) != 0), "other than 0 but at 0 V")
    if "spread" in used and used["spread"].unit in _PERCENT and used[quantity].unit not in _PERCENT:
        rows["spread"] *= rows[quantity].abs()
    return rows


def _refuse_overlooked(used: Mapping[str, Column], ignored: Sequence[Column]) -> None:
    """Refuse a table without a condition where an ignored column may be it."""
    for condition, units in _CONDITIONS.items():
        for column in ignored if condition not in used else ():
            if any(is_of(_SINE.sub("", column.unit), si) for si in units) if column.unit else column.numeric:
                head, meant = show(column.head), f"'{condition} ({units[0]})'"
                meant += " or 'voltage (V peak to peak)'" if condition == "voltage" else ""
                raise ValueError(
                    f"has no {condition}, and its column {head} may be one; name it by columns, as in {{{head}: "
                    f"{meant}}}, or leave it out by {{{head}: ''}}"
                )


def _numbers(column: Column, si: str, optional: bool = False) -> "pd.Series[float]":
    """Return the values of a column in SI units, NaN of optional empty cells; a voltage as the rms value of a sine."""
    of, unit, rms = column.name, column.unit, 1.0
    if not unit:
        example = f"write '{of} ({si})' in the head or by columns, and (1) for a number without"
        raise ValueError(f"has {show(column.head)} without a unit; {example}")
    if of == "voltage" and (measure := _SINE.search(unit)):
        unit, rms = unit[: measure.start()], _RMS[measure.lastindex or 1]
    allowed = {"N/m": "N/m, or in N for a whole finger", "N": "N, as another column is of a whole finger"}
    si = "1" if of == "spread" and unit in _PERCENT else si
    column = replace(column, unit=unit)
    values = rms * column.numbers(si, allowed.get(si, "1 or %" if si == "1" else si), optional or of == "spread")
    if of == "voltage":
        return values.abs()
    if of.startswith("friction"):
        column.refuse(values == 0, "a finite number other than 0")
    else:
        zero = of in ("spread", "attraction")
        column.refuse((values < 0) | ((values == 0) & (not zero)), "0 or more" if zero else "greater than 0")
    return values
