"""``fingerpad paper``: a figure of Forsbach, Heß and Papangelo (2023) by this model."""

import sys
from collections.abc import Sequence

from fingerpad.cli.arguments import Parser, echo, positive
from fingerpad.ctrl_c import raises
from fingerpad.paper.figures import FIGURES, compute, find
from fingerpad.paper.run import Unfinished
from fingerpad.runs import batch  # noqa: F401  # before Ctrl-C raises

_EXAMPLES = """
    fingerpad paper
    fingerpad paper 6
    fingerpad paper 9A 9B --out results/paper --jobs 2
"""


def main(argv: Sequence[str]) -> int:
    """Compute and draw figures of the paper, or list them; return the exit code."""
    parser = Parser("paper", _EXAMPLES)
    words = "figures: 2, 4, 5, 6, 7, 8, 8A, 8B, 9, 9A, 9B; a list of them where none is given"
    parser.add_argument("figures", nargs="*", metavar="FIGURE", help=words)
    parser.add_out("results/paper", "folder of runs, pictures and numbers; runs that are there are not repeated")
    parser.add_argument("--jobs", type=positive, default=2, metavar="N", help="runs at a time (default: 2)")
    args = parser.read(argv)
    for each in () if args.figures else FIGURES.values():
        echo(f"{each.name:3} {each.shows}: {each.cost or 'a closed form'}")
    chosen = {each.name: each for name in args.figures for each in find(name)}
    for each in chosen.values():
        echo(f"Figure {each.name}, {each.shows}: {each.cost or 'a closed form'}.")
        if each.cost:
            echo(f"Times are of two idle cores. Runs that {args.out} has are not repeated; the same command goes on.")
        try:
            with raises():
                written = compute(each, args.out, args.jobs)
        except Unfinished as error:
            echo(f"Figure {each.name} is not drawn: {error}")
            return 1
        except (KeyboardInterrupt, SystemExit):  # of signals
            print(f"fingerpad: stopped; runs are kept in {args.out}, and the same command goes on", file=sys.stderr)
            raise
        echo(f"Written: {', '.join(map(str, written))}")
    return 0
