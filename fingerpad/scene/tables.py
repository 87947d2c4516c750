"""Tables of text, as people and instruments write them: columns with a name, a unit and cells.

Tabs, semicolons or commas part the cells; with the first two a decimal comma is read too, and a line ``sep=;`` names
the mark. Lines above the numbers are a preamble, whose last one has the heads, or names above a line of units. Without
any, the last comment (``#``) has them. A unit stands behind a name, in brackets or after ``/``, ``_`` or a space, or it
is the whole head. What is wrong is raised as a ValueError, to follow the name of the file.
"""

import io
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from fingerpad.scene.messages import show
from geometry.units import is_unit, to_si
from variational import files

MOST = 50e6
"""Largest size (bytes) of a table."""
_MOST_CELLS, _MOST_COLUMNS = 10_000_000, 1000
_LAST = 10  # lines at the end of a file, which show what parts its cells
_MAX_HEAD = 200  # characters of a head with a unit
_DECIMAL = r"^([+-]?\d*),(\d+(?:[eE][+-]?\d+)?\s*%?)$"
_BRACKETS = re.compile(r"(.*?)\s*[(\[]\s*([^()\[\]]*?)\s*[)\]]")  # the last ones have the unit
_ONE = r"[cmunµμkM]?(?:s|V|N|m|Pa|Hz)(?:\^?2|²)?"
_WORDS = r"(?i:[mun]?secs?|(?:milli|micro)?seconds?|(?:kilo|milli)?volts?)"
_MEASURED = r"[mk]?V[ _]?(?:rms|eff|pp|p-p|pk-?pk|peak[ -]to[ -]peak|peak|amplitude)"
_BARE = re.compile(rf"{_ONE}(?:/{_ONE})?|%|{_WORDS}|{_MEASURED}")
_SPELLINGS = (  # of instruments, and what they are here
    (re.compile(r"^([munµμ]?)(?:s|secs?|seconds?)$", re.IGNORECASE), lambda found: f"{found[1].lower()}s"),
    (re.compile(r"^(m|[kK]?)(?i:v|volts?)$"), lambda found: f"{found[1].lower()}V"),
    (re.compile(r"(?<=[^\W\d])([23])$"), r"^\1"),
)
NUMBERS = {"1": 1.0, "-": 1.0, "–": 1.0, "%": 0.01, "percent": 0.01}
"""Units of what has none."""


@dataclass(frozen=True, eq=False)
class Column:
    """A column of a table."""

    head: str
    """As written; empty where nothing stands above it."""
    name: str
    """Without the unit."""
    unit: str
    """As written; empty where none is given."""
    cells: "pd.Series[str]"
    """Empty where a cell is missing; the index has the lines of a file, or the rows of a DataFrame."""
    numeric: bool = True
    """Whether it has numbers in at least half as many cells as the column with most of them."""
    row: str = "line"
    """What a row is called."""

    def numbers(self, si: str, allowed: str = "", optional: bool = False) -> "pd.Series[float]":
        """Return the numbers in SI units.

        Args:
            si: the unit, one of :data:`geometry.units.QUANTITIES` or 1.
            allowed: units, for a refusal.
            optional: whether cells may be empty, which are NaN.

        Raises:
            ValueError: the unit is not known or of another dimension, or a cell has no finite number.
        """
        try:
            unit = factor(self.unit, si)
        except ValueError as error:
            why = re.split("[;:]", str(error))[0].removeprefix("its unit ")
            given = f"has {show(self.head)} in {show(self.unit)}, which {why}"
            raise ValueError(f"{given}; it must be in {allowed or si}") from None
        found = self.cells.where(pd.to_numeric(self.cells, errors="coerce").notna()).astype(float) * unit
        self.refuse(~np.isfinite(found) & ((self.cells != "") | (not optional)), "a finite number")
        return found

    def refuse(self, wrong: "pd.Series[bool]", allowed: str) -> None:
        """Refuse the first of some rows.

        Raises:
            ValueError: what is in the row, and what is allowed.
        """
        if wrong.any():
            k = int(wrong.to_numpy().argmax())
            cell = self.cells.iloc[k]
            given = f"has {show(cell) if cell else 'nothing'} in {self.row} {self.cells.index[k]} of {show(self.head)}"
            raise ValueError(f"{given}; it must be {allowed}{'; decimals have points' * (',' in cell)}")


@dataclass(frozen=True, eq=False)
class Table:
    """What a file has."""

    columns: list[Column]
    facts: dict[str, str]
    """Second cells of lines by their first ones in small letters, those of a preamble among them."""
    comments: list[str]
    headed: bool
    """Whether there are heads."""


# -- units ---------------------------------------------------------------------------------------------
def factor(unit: str, si: str) -> float:
    """Return a unit over an SI unit, which may be 1.

    Raises:
        ValueError: the unit is not known, or of another dimension.
    """
    if si != "1":
        return to_si(f"1 {_usual(unit)}", si)
    if unit not in NUMBERS:
        raise ValueError("is not a number")
    return NUMBERS[unit]


def _usual(unit: str) -> str:
    for spelling, usual in _SPELLINGS:
        unit = spelling.sub(usual, unit)
    return unit


def is_of(unit: str, si: str) -> bool:
    """Return whether a unit is of the dimension of an SI unit."""
    try:
        return factor(unit, si) > 0
    except ValueError:
        return False


def parts(head: str) -> tuple[str, str]:
    """Return name and unit of a head, the latter empty where there is none."""
    head = head.strip()
    if found := _BRACKETS.fullmatch(head[:_MAX_HEAD]):
        return found[1], found[2]
    if _BARE.fullmatch(head):
        return head, head
    for mark in re.finditer(r"\s*([/_ ])\s*", head[:_MAX_HEAD]):
        unit = head[mark.end() :]
        if _BARE.fullmatch(unit) or (mark[1] == "/" and is_unit(unit)):
            return head[: mark.start()], unit
    return head, ""


# -- files ---------------------------------------------------------------------------------------------
def read(file: str | Path, header: str) -> Table:
    """Return the table in a file.

    Args:
        file: its path.
        header: an example of its heads, for refusals.

    Raises:
        ValueError: it cannot be read, or holds no table with numbers.
    """
    try:
        text = files.text(files.read(file, MOST))
    except OSError as error:
        raise ValueError(f"cannot be read: {show(error.strerror or str(error))}") from None  # quoted: no key
    if text is None:
        raise ValueError("is no text")
    lines = text.rstrip().splitlines()
    named = re.fullmatch(r'"?sep=(.)"?', lines[0].strip(" ")) if lines else None
    comments = [line.strip().lstrip("# ") for line in lines if line.lstrip().startswith("#")]
    lines = ["" if line.lstrip().startswith("#") or (named and k == 0) else line for k, line in enumerate(lines)]
    last = [line for line in lines if line.strip()][-_LAST:]
    mark = next((mark for mark in "\t;" if 2 * sum(mark in line for line in last) > len(last)), ",")
    frame = _parted(lines, mark := named[1] if named else mark)
    bare = frame.apply(lambda cells: cells.str.rstrip("% ")) if "%" in text else frame
    numbers = bare.apply(lambda cells: pd.to_numeric(cells, errors="coerce").notna())
    counts = numbers.sum()
    places = [k for k in frame if 2 * counts[k] >= counts.max() > 0]
    rows = numbers[places].any(axis=1) & (numbers[places] | (frame[places] == "")).all(axis=1)
    if not rows.any():
        raise ValueError(f"has no numbers below a header such as '{header}'")
    above, body = frame[frame.index < rows.idxmax()], frame[frame.index >= rows.idxmax()]
    if above.empty and comments and comments[-1].count(mark) + 1 == len(frame.columns):  # as NumPy writes heads
        above = _parted(comments[-1:], mark)
    heads = _heads(above, places)
    width = max((k for k in frame if heads[k][0]), default=len(heads)) + 1
    more = (body.loc[:, width:] != "").any(axis=1)
    if more.any():
        why = "decimals have points, not commas" if mark == "," else "each cell must have a head"
        raise ValueError(f"has more cells in line {more.idxmax()} than its {width} heads; {why}")
    every = ((*heads[k], body[k], k in places) for k in frame if heads[k][0] or (body[k] != "").any())
    columns = [Column(head, name, unit, cells, numeric) for head, name, unit, cells, numeric in every]
    facts = {key.casefold(): value for key, value in frame.iloc[:100, :2].itertuples(index=False) if value}
    return Table(columns, facts, comments, not above.empty)


def _parted(lines: Sequence[str], mark: str) -> pd.DataFrame:
    """Return the cells of the lines that are not empty, by the numbers of the lines."""
    width = max((line.count(mark) for line in lines), default=0) + 1
    if width > _MOST_COLUMNS or width * len(lines) > _MOST_CELLS:
        raise ValueError(f"has {len(lines)} lines of up to {width} cells; at most {_MOST_COLUMNS} columns are read")
    if not any(map(str.strip, lines)):
        return pd.DataFrame(columns=range(2), dtype=str)
    form = {"header": None, "names": range(max(width, 2)), "index_col": False, "dtype": str}
    form |= {"keep_default_na": False, "skip_blank_lines": False, "skipinitialspace": True}
    try:
        frame = pd.read_csv(io.StringIO("\n".join(lines) + "\n"), sep=mark, **form)
    except pd.errors.ParserError:
        frame = pd.DataFrame()
    if len(frame) != len(lines):  # a quotation went on
        line = next((k for k, line in enumerate(lines, start=1) if line.count('"') % 2), 1)
        raise ValueError(f"is no table in CSV: a quotation in line {line} does not end there")
    frame.index += 1
    frame = frame.fillna("").apply(lambda cells: cells.str.strip())
    if mark != ",":
        frame = frame.apply(lambda cells: cells.str.replace(_DECIMAL, r"\1.\2", regex=True))
    return frame[(frame != "").any(axis=1)]


def _heads(above: pd.DataFrame, places: Sequence[int]) -> list[tuple[str, str, str]]:
    """Return head, name and unit of each column from the lines above the numbers."""
    *names, last = [[""] * len(above.columns), *([*row] for row in above.itertuples(index=False))]
    bare = [cell.strip("()[] ") for cell in last]
    known = (not u or u in NUMBERS or is_unit(_usual(u)) or is_unit(u.lower()) for u in bare)
    in_brackets = all(cell[0] in "([" for cell in last if cell)
    if len(names) > 1 and (in_brackets or (any(map(_BARE.fullmatch, bare)) and all(known))):
        return [(head, parts(head)[0], unit) for head, unit in zip(names[-1], bare, strict=True)]
    if len(names) > 1 and any(files.is_number(last[k]) for k in places):
        wrong = next(last[k] for k in places if pd.isna(pd.to_numeric(last[k] or "-", errors="coerce")))
        raise ValueError(f"has {show(wrong)} in line {above.index[-1]}; it must be a finite number")
    return [(head, *parts(head)) for head in last]
