"""The figures of the paper: what each shows, what it costs, its numbers and its picture.

environment/run python3 -m benchmarks.paper.figures [6 9A ...]     also: make paper FIGURE=6

Runs that are in the folder are not repeated, so that a figure that was stopped goes on.

A figure is an entry of :data:`FIGURES`. Its numbers go into a JSON file beside the picture and can be drawn again.
"""

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from benchmarks.harness import RESULTS, picture
from benchmarks.paper import loads, maps, microscale, section, sine, transition
from fingerpad.results.files import replace_json


@dataclass(frozen=True)
class PaperFigure:
    """A figure of the paper, or a panel whose runs are its own."""

    name: str
    shows: str
    cost: str
    """What has to be computed, and how long it takes on two idle cores; empty for a closed form."""
    numbers: Callable[[Path, int], dict[str, Any]]
    """Compute the numbers from a folder of runs, a number of jobs at a time: those that are missing are run."""
    paint: Callable[[Figure, Mapping[str, Any]], None]
    size: tuple[float, float] = (6.0, 4.0)
    """Width and height of the picture (in)."""
    panels: str = ""
    """Letters of its panels, which are drawn together."""
    of_loads: bool = False
    """Whether the numbers are some of those over all forces and voltages."""


FIGURES = {
    each.name: each
    for each in (
        PaperFigure("2", "stresses and air gaps along the skin, 120 N/m and 150 V", "one run, half a minute",
                    section.numbers, section.paint, (10, 9), "ABC"),
        PaperFigure("4", "air gap over the mean separation of a rough ridge", "",
                    microscale.air_gap, microscale.paint_air_gap),
        PaperFigure("5", "external pressure over the air gap of a rough ridge", "",
                    microscale.pressure, microscale.paint_pressure),
        PaperFigure("6", "friction force and apparent friction over the force",
                    "40 states of full slip, each from its neighbour, some 3 minutes",
                    loads.friction, loads.paint_friction, (10, 4), "AB", True),
        PaperFigure("7", "contact length and ridges over the force, normal and sliding", "16 runs, some 5 minutes",
                    loads.lengths, loads.paint_lengths, (11, 4), "ABC", True),
        PaperFigure("8A", "contact length from stick to slip, 120 N/m", "5 runs, some 2 minutes",
                    transition.numbers, transition.paint),
        PaperFigure("8B", "contact length lost by sliding over the mean shear stress", "40 runs, some 12 minutes",
                    loads.over_loads, loads.paint_reduction, of_loads=True),
        PaperFigure("9A", "maps of the strain energy density, 75 N/m", "2 runs, a minute",
                    maps.numbers, maps.paint, (12.0, 3.9)),
        PaperFigure("9B", "apparent friction and energy density at Merkel sites over a sine of the voltage",
                    "a run of 13 states of full slip, some 3 minutes", sine.numbers, sine.paint, (8, 8)),
    )
}  # fmt: skip


def draw(figure: PaperFigure, numbers: Mapping[str, Any], path: Path) -> None:
    """Draw a figure from its numbers into a PNG file."""
    picture(path, figure.size, lambda made: figure.paint(made, numbers))


def compute(figure: PaperFigure, out: Path, jobs: int) -> list[Path]:
    """Compute a figure in a folder, where runs are kept; return the paths of its picture and of its numbers.

    Raises:
        Unfinished: a run did not reach its end.
    """
    out.mkdir(parents=True, exist_ok=True)
    numbers = figure.numbers(out, jobs)
    drawn, kept = (out / f"figure_{figure.name}.{ending}" for ending in ("png", "json"))
    replace_json(kept, numbers)
    draw(figure, numbers, drawn)
    return [drawn, kept]


def main(given: Sequence[str] | None = None) -> int:
    """Compute and draw figures, or list them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    choices = sorted({*FIGURES, *(name.rstrip("AB") for name in FIGURES)})
    parser.add_argument("figures", nargs="*", help=f"{', '.join(choices)}; a list of them where none is given")
    parser.add_argument("--out", type=Path, default=RESULTS / "traces", help="folder of runs, pictures and numbers")
    parser.add_argument("--jobs", type=int, default=2, help="runs at a time (default: 2)")
    args = parser.parse_args(given)
    if unknown := set(args.figures) - set(choices):
        parser.error(f"no figure {', '.join(unknown)}; 1 is the mesh (fingerpad check --plot), 3 a measurement")
    for each in FIGURES.values():
        if not args.figures or {each.name, each.name.rstrip("AB")} & set(args.figures):
            print(f"Figure {each.name}, {each.shows}: {each.cost or 'a closed form'}.", flush=True)
            if args.figures:
                print(*compute(each, args.out, args.jobs), sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
