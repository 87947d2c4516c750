"""Tables of numbers on the screen and in files."""

import argparse
import csv
import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fingerpad.cli.arguments import PICTURE, Kind, Parser, echo
from fingerpad.io.files import replace


@dataclass(frozen=True)
class Column:
    """A column of a table."""

    key: str
    """Name in files, where numbers are in SI units."""
    head: str
    """Name on the screen."""
    unit: str = ""
    factor: float = 1.0
    """From SI units to the unit on the screen."""
    digits: str = ".4g"

    def cell(self, value: Any) -> str:
        """Return a value as it is printed, a dash where there is none."""
        if value is None:
            return "–"
        return str(value) if isinstance(value, str) else f"{value * self.factor:z{self.digits}}"


def text(columns: Sequence[Column], rows: Sequence[Mapping[str, Any]]) -> str:
    """Return an aligned table with units below the names."""
    cells = [[c.head for c in columns], [f"({c.unit})" if c.unit else "" for c in columns]]
    cells += [[c.cell(row.get(c.key)) for c in columns] for row in rows]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    return "\n".join("  ".join(map(str.rjust, row, widths)).rstrip() for row in cells)


def write(file: Path, columns: Sequence[Column], rows: Sequence[Mapping[str, Any]]) -> None:
    """Write a table as CSV in SI units, unrounded; :mod:`fingerpad.cli.ranges` has rounded its values."""
    out = io.StringIO()
    writer = csv.DictWriter(out, [c.key for c in columns], extrasaction="ignore", lineterminator="\n")
    writer.writerows(rows)
    replace(file, _head(columns) + out.getvalue())


def _head(columns: Sequence[Column]) -> str:
    return ",".join(c.key for c in columns) + "\n"


def add_files(parser: Parser, columns: Sequence[Column], picture: str, option: str = "--plot") -> None:
    """Add the options of a table in a file and of a picture; ``picture`` is the help of the picture's ``option``."""
    parser.add_file(option, PICTURE, picture, dest="plot")
    table = Kind("a table", (".csv",), _head(columns))
    parser.add_file("--csv", table, "table in SI units; results are unrounded")


def write_files(
    args: argparse.Namespace,
    columns: Sequence[Column],
    rows: Sequence[dict[str, Any]],
    draw: Callable[[Path, Sequence[dict[str, Any]]], None],
) -> None:
    """Write the files of :func:`add_files` that are wanted, and print their names."""
    if args.csv:
        write(args.csv, columns, rows)
    if args.plot:
        draw(args.plot, rows)
    for file in (args.csv, args.plot):
        if file:
            echo(f"Written: {file}")
