"""The paper's figures and tables by our model, with what it says beside what we find.

environment/run python3 benchmarks/reproduce.py [--jobs 2] [--contact-size 10e-6] [--measured FILE.csv] [--draw]

Runs are kept in results/traces by a hash of their parameters and shared with the other benchmarks: started again, only
what is missing or changed is run, and drawing anew takes seconds. Writes docs/paper.md, docs/paper/*.png and
docs/paper/paper.json. Ends with 1 if a run is missing, or if a number is not the one that the page had.
"""

import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from matplotlib.figure import Figure

from benchmarks import arguments
from benchmarks.paper import friction, micro, page, scenes, section, sed, tables
from benchmarks.paper.statement import Statement
from benchmarks.paper.style import draw
from benchmarks.runs import Run
from fingerpad.cli.arguments import positive
from fingerpad.model.check import check
from fingerpad.runs.batch import sweep
from fingerpad.scene import Scene

_LIMIT = 3600.0  # s of processor time for one run; the sine takes longest


class Book:
    """Collects figures and statements; what a figure needs may not have been run."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.figures: list[tuple[str, str]] = []
        self.statements: list[Statement] = []
        self.missing: dict[str, str] = {}
        self.moved: list[str] = []

    def add(
        self,
        name: str,
        caption: str,
        size: tuple[float, float],
        paint: Callable[[Figure], None],
        statements: Callable[[], list[Statement]] = list,
    ) -> None:
        """Draw a figure and take its statements, or note that its runs are missing."""
        try:
            draw(self.folder / f"{name}.png", size, paint)
            self.statements += statements()
        except FileNotFoundError as missing:
            self.missing[name] = str(missing)
            return
        self.figures.append((f"{name}.png", caption))


def make(out: Path, docs: Path, size: float, measured: friction.Measured | None) -> Book:
    """Draw what has been run and write the page."""
    book = Book(docs / "paper")
    book.folder.mkdir(parents=True, exist_ok=True)

    def run(scene: Scene) -> Run:
        return Run(scene, out)

    def grid() -> friction.Grid:
        return {at: run(scene) for at, scene in scenes.grid(size).items()}

    def at(force: float, voltage: float) -> Run:
        return run(scenes.grid(size)[force, voltage])

    def rougher() -> Run:
        high = at(scenes.MAP, 200.0)
        return run(scenes.rougher(size, float(high.steps["mu_app"][high.slip])))

    force, voltage = scenes.SECTION
    book.add(
        "fig2",
        f"Fig. 2: along the skin at {force:g} N/m and {voltage:g} V",
        (9, 7.5),
        lambda figure: section.figure_2(figure, at(force, voltage)),
        lambda: section.statements(at(force, voltage)),
    )
    book.add("fig4", "Fig. 4: air gap over mean separation", (5, 3.2), micro.figure_4)
    book.add("fig5", "Fig. 5: external pressure over air gap", (9, 3.6), micro.figure_5, micro.statements)
    book.add(
        "fig6",
        "Fig. 6: tangential force and apparent friction at full slip" + (", stars: measured" if measured else ""),
        (9, 3.8),
        lambda figure: friction.figure_6(figure, grid(), measured),
        lambda: friction.statements(grid()),
    )
    book.add("fig7", "Fig. 7: contact length and ridges", (10, 3.5), lambda figure: friction.figure_7(figure, grid()))
    book.add("fig8", "Fig. 8: from stick to slip", (9, 3.8), lambda figure: friction.figure_8(figure, grid()))
    book.add(
        "fig9a",
        f"Fig. 9A: strain energy density at {scenes.MAP:g} N/m; circles: Merkel sites",
        (9, 5.5),
        lambda figure: sed.figure_9a(figure, at(scenes.MAP, 0.0), at(scenes.MAP, 200.0)),
        lambda: sed.statements(at(scenes.MAP, 200.0)),
    )
    book.add(
        "fig9b",
        f"Fig. 9B: response to a voltage of {scenes.PEAK:g} V times a sine, while sliding",
        (7, 6),
        lambda figure: sed.figure_9b(figure, run(scenes.sine(size))),
        lambda: sed.sine_statements(run(scenes.sine(size))),
    )
    book.add(
        "claim",
        "Section 5: energy density at the Merkel sites, electroadhesion against friction",
        (7, 3.5),
        lambda figure: sed.figure_claim(figure, at(scenes.MAP, 200.0), rougher()),
        lambda: [sed.claim_statement(at(scenes.MAP, 200.0), rougher())],
    )
    missing = f"**Not run yet:** {', '.join(book.missing)}." if book.missing else ""
    book.moved = page.moved(docs, size, book.statements)
    page.write(docs, size, book.statements, book.figures, tables.tables(), missing)
    return book


def main(given: Sequence[str] | None = None) -> int:
    """Run what is missing, draw, and write the page."""
    parser = arguments.parser(__doc__)
    parser.add_argument("--contact-size", type=positive(float), default=scenes.SIZE, help="m")
    parser.add_argument("--measured", type=Path, help="CSV of measured friction, drawn into Fig. 6")
    parser.add_argument("--draw", action="store_true", help="run nothing, draw what is there")
    args = parser.parse_args(given)
    size = args.contact_size
    try:
        check(scenes.grid(size)[scenes.SECTION])
        measured = friction.Measured.read(args.measured) if args.measured else None
    except (OSError, ValueError) as error:
        parser.error(str(error))
    if not args.draw:
        named = {f"{f:g} N/m, {u:g} V": scene for (f, u), scene in scenes.grid(size).items()}
        sweep({"sine": scenes.sine(size)} | named, args.out, args.jobs, _LIMIT)
        try:
            high = Run(scenes.grid(size)[scenes.MAP, 200.0], args.out)
            mimic = scenes.rougher(size, float(high.steps["mu_app"][high.slip]))
            sweep({f"friction {mimic.friction:g}": mimic}, args.out, args.jobs, _LIMIT)
        except FileNotFoundError as missing:
            print(f"the run without voltage but with more friction cannot be made: {missing}")
    book = make(args.out, args.docs, size, measured)
    for name, why in book.missing.items():
        print(f"missing: {name}, {why}")
    for words in book.moved:
        print(f"moved: {words}")
    print(args.docs / "paper.md")
    return 1 if book.missing or book.moved else 0


if __name__ == "__main__":
    sys.exit(main())
