"""``fingerpad sensitivities``: what moves a result of a run, by the slopes that it was made with."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fingerpad.cli import output
from fingerpad.cli.arguments import Parser, echo, path
from fingerpad.results.quantities import STEPS, Output
from fingerpad.results.result import Result
from fingerpad.results.slopes import left_out, rows

_EXAMPLES = """
    fingerpad sensitivities results/mine
    fingerpad sensitivities results/mine --of contact_length --csv slopes.csv --plot slopes.png
"""
_NUMBERS = ("value", "slope", "scatter", "elasticity", "lowest", "highest")
_COLUMNS = tuple(Output(name, "") for name in ("key", "value", "unit", *_NUMBERS[1:]))
_DRAWN = 15  # bars of the picture


def main(argv: Sequence[str]) -> int:
    """Print the slopes of a run by every number of its scene; return the exit code."""
    parser = Parser("sensitivities", _EXAMPLES)
    parser.add_argument("folder", type=path, metavar="DIR", help="folder of a run with output.sensitivities")
    parser.add_argument("--of", default="mu_app", metavar="QUANTITY", help="quantity of a state (default: mu_app)")
    parser.add_argument("--state", default="", help="named state (default: full_slip)")
    output.add_files(parser, _COLUMNS, "picture of the largest elasticities")
    args = parser.read(argv)
    result = Result.load(args.folder)
    found = [row._asdict() for row in rows(result, args.of, args.state)]
    printed = [row | {name: f"{row[name]:.4g}" for name in _NUMBERS} for row in found]
    echo(f"Slopes of {STEPS[args.of].words}, SI; scatter: their change where points in contact stay as they are;")
    echo("elasticity: % for 1 % of the number:")
    echo(output.text(_COLUMNS, printed))
    echo("Between lowest and highest the same ridges touch, by straight extrapolation; inf: at all values allowed.")
    for key, why in left_out(result, args.state).items():
        echo(f"{key} is left out: {why}.")
    output.write_files(args, _COLUMNS, found, _draw)
    return 0


def _draw(file: Path, found: Sequence[dict[str, Any]]) -> None:
    """Draw the largest elasticities as bars."""
    from fingerpad.results.pictures import style

    with output.panels(file, "What moves the result most") as (_, (ax,)):
        most = [row for row in found if row["elasticity"]][:_DRAWN]
        ax.barh([row["key"] for row in most], [row["elasticity"] for row in most], color=style.CATEGORIES[0])
        ax.invert_yaxis()
        ax.set(xlabel=style.plain("elasticity (% for 1 %)"))
