"""Tables of quantities on the screen, and in files by their names and in SI units."""

import argparse
import csv
import io
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from fingerpad.cli.arguments import PICTURE, Kind, Parser, echo
from fingerpad.results.files import replace
from fingerpad.results.quantities import Output


def text(columns: Sequence[Output], rows: Sequence[Mapping[str, Any]]) -> str:
    """Return an aligned table with units below the names."""
    cells = [[c.symbol for c in columns], [f"({c.unit})" if c.unit else "" for c in columns]]
    cells += [[c.shown(row.get(c.name)) for c in columns] for row in rows]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    return "\n".join("  ".join(map(str.rjust, row, widths)).rstrip() for row in cells)


def write(file: Path, columns: Sequence[Output], rows: Sequence[Mapping[str, Any]]) -> None:
    """Write a table as CSV in SI units, unrounded; :mod:`fingerpad.cli.ranges` has rounded its values."""
    out = io.StringIO()
    writer = csv.DictWriter(out, [c.name for c in columns], extrasaction="ignore", lineterminator="\n")
    writer.writerows(rows)
    replace(file, _head(columns) + out.getvalue())


def _head(columns: Sequence[Output]) -> str:
    return ",".join(c.name for c in columns) + "\n"


def add_files(parser: Parser, columns: Sequence[Output], picture: str, option: str = "--plot") -> None:
    """Add the options of a table in a file and of a picture; ``picture`` is the help of the picture's ``option``."""
    parser.add_file(option, PICTURE, picture, dest="plot")
    table = Kind("a table", (".csv",), _head(columns))
    parser.add_file("--csv", table, "table in SI units; results are unrounded")


def write_files(
    args: argparse.Namespace,
    columns: Sequence[Output],
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
