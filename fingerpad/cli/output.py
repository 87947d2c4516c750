"""What commands write: tables of quantities on the screen and in files, in SI units there, and pictures."""

import argparse
import csv
import io
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import chdir, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from fingerpad.cli.arguments import PICTURE, Kind, Parser, echo
from fingerpad.results.files import replace
from fingerpad.results.quantities import Output
from fingerpad.scene.messages import is_formula

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_DASHES = ("-", "--", "-.", ":", (0, (6, 1, 1, 1, 1, 1)), (0, (8, 3)), (0, (1, 3)))
_MAX_MARKERS = 15  # points up to which each has a marker


def text(columns: Sequence[Output], rows: Sequence[Mapping[str, Any]]) -> str:
    """Return an aligned table with units below the names."""
    cells = [[c.symbol for c in columns], [f"({c.unit})" if c.unit else "" for c in columns]]
    cells += [[v if isinstance(v := row.get(c.name), str) else c.shown(v) for c in columns] for row in rows]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    return "\n".join("  ".join(map(str.rjust, row, widths)).rstrip() for row in cells)


def write(file: Path, columns: Sequence[Output], rows: Sequence[Mapping[str, Any]]) -> None:
    """Write a table as CSV in SI units, unrounded; :mod:`fingerpad.cli.arguments` has rounded its values.

    An apostrophe stands before a text of which a spreadsheet would make a formula.
    """
    out = io.StringIO()
    writer = csv.DictWriter(out, [c.name for c in columns], extrasaction="ignore", lineterminator="\n")
    for row in rows:
        writer.writerow({k: f"'{v}" if isinstance(v, str) and is_formula(v) else v for k, v in row.items()})
    replace(file, _head(columns) + out.getvalue())


def _head(columns: Sequence[Output]) -> str:
    return ",".join(c.name for c in columns) + "\n"


def add_files(parser: Parser, columns: Sequence[Output], picture: str, option: str = "--plot") -> None:
    """Add the options of a table in a file and of a picture.

    Args:
        parser: of the command.
        columns: of the table; a file is replaced whose columns are these.
        picture: help of the picture's ``option``.
        option: of the picture.
    """
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


# -- pictures ------------------------------------------------------------------------------------------
@contextmanager
def panels(file: Path, title: str, count: int = 1) -> "Iterator[tuple[Figure, list[Axes]]]":
    """Give a figure and its panels side by side; write it at the end of the block."""
    with chdir("/"):  # a matplotlibrc of the current folder is not obeyed, see fingerpad.startup
        from fingerpad.results.pictures import style

    with style.look():
        figure = style.figure(4.0, width=2.5 + 3.0 * count)
        figure.suptitle(style.plain(title))
        yield figure, list(figure.subplots(1, count, squeeze=False)[0])
        style.save(figure, file)


def curve(
    ax: "Axes", k: int, x: ArrayLike, y: ArrayLike, label: str, colour: Any = None, error: ArrayLike = 0.0
) -> None:
    """Draw curve number k, with markers where its points are few; ``colour`` takes the place of the palette's.

    A band is drawn of an ``error`` above and below; none where it is 0.
    """
    from fingerpad.results.pictures import style

    marked = np.size(x) <= _MAX_MARKERS
    marker: dict[str, Any] = {"marker": style.MARKERS[k % len(style.MARKERS)], "ms": 5} if marked else {}
    colour = style.CATEGORIES[k % len(style.CATEGORIES)] if colour is None else colour
    if np.any(error):
        ax.fill_between(x, np.subtract(y, error), np.add(y, error), color=colour, alpha=0.15, linewidth=0)
    ax.plot(x, y, color=colour, ls=_DASHES[k % len(_DASHES)], label=label, **marker)
