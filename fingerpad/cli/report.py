"""``fingerpad report``: pages in HTML, the animation of a run, and the spikes of its afferents."""

import sys
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path

from fingerpad.afferents import DEFAULT, LAWS
from fingerpad.cli.arguments import Kind, Parser, echo, path, refuse_file
from fingerpad.launcher import raising_at_ctrl_c
from fingerpad.report.write import write
from fingerpad.results.files import replace
from fingerpad.results.result import Result
from fingerpad.results.terminal import watched
from fingerpad.runs.batch import progress
from fingerpad.scene.messages import SceneError

_EXAMPLES = """
    fingerpad report results/mine
    fingerpad report results/sweep
    fingerpad report results/mine --animate --out talk.gif
    fingerpad report results/mine --feel --class SA1 --class RA1
    fingerpad report --calculator
"""
CSV, NETCDF, PICTURE = "spikes.csv", "spikes.nc", "raster.png"


def main(argv: Sequence[str]) -> int:
    """Write the report of a folder, or what an option names instead; return the exit code."""
    parser = Parser("report", _EXAMPLES)
    parser.add_argument("folder", nargs="?", type=path, metavar="DIR", help="folder of a run or of a sweep")
    kind = parser.add_mutually_exclusive_group()
    words = "instead, the run as a moving picture: animation.webp in the folder"
    kind.add_argument("--animate", action="store_true", help=words)
    words = f"instead, spikes of afferents over a run in time: a table, {CSV}, {NETCDF} and {PICTURE}"
    kind.add_argument("--feel", action="store_true", help=words)
    words = "instead, and without a folder, the closed form as a page with sliders: calculator.html"
    kind.add_argument("--calculator", action="store_true", help=words)
    words = "file of --animate (.webp or .gif) or of --calculator (.html)"
    parser.add_argument("--out", type=path, metavar="FILE", help=words)
    words = f"class of afferents of --feel, one --class for each: {', '.join(LAWS)} (default: {', '.join(DEFAULT)})"
    parser.add_argument("--class", action="append", dest="classes", metavar="NAME", help=words)
    args = parser.read(argv)
    if args.out and not (args.animate or args.calculator):
        raise SceneError("--out is the file of --animate or --calculator; give one of the two")
    if args.classes and not args.feel:
        raise SceneError("--class is of --feel, which is not given")
    if args.calculator:
        if args.folder:
            raise SceneError("--calculator needs no folder; leave it out")
        return _written(_calculator(args.out or Path("calculator.html")))
    if args.folder is None:
        raise SceneError("command line: the following arguments are required: DIR")
    if args.animate:
        return _written(_animate(args.folder, args.out))
    return _feel(args.folder, args.classes) if args.feel else _written(write(args.folder))


def _written(file: Path) -> int:
    echo(f"Written: {file} ({file.stat().st_size / 1e6:.1f} MB)")
    return 0


def _calculator(file: Path) -> Path:
    head = (files("fingerpad.calculator") / "page.html").read_text(encoding="utf-8").partition("{{")[0]
    refuse_file(file, Kind("a page", (".html",), head))
    from fingerpad.calculator.page import page  # the closed form

    replace(file, page())
    return file


def _animate(folder: Path, file: Path | None) -> Path:
    result, file = Result.load(folder), file or folder / "animation.webp"
    refuse_file(file, Kind("an animation", (".webp", ".gif")))
    from fingerpad.results.pictures.animation import animate  # Matplotlib

    try:
        with raising_at_ctrl_c(), progress(quiet=not watched()) as bar:
            task = bar.add_task("frames drawn", total=None)
            animate(result, file, lambda done, count: bar.update(task, completed=done, total=count))
    except KeyboardInterrupt:
        print(f"fingerpad: stopped by Ctrl-C; {file} was not written, and what was there stays", file=sys.stderr)
        raise
    return file


def _feel(folder: Path, classes: list[str] | None) -> int:
    spikes = Result.load(folder).afferents(classes)
    echo(str(spikes))
    spikes.to_csv(folder / CSV)
    spikes.to_netcdf(folder / NETCDF)
    spikes.plot(folder / PICTURE)
    echo(f"Written: {', '.join(str(folder / name) for name in (CSV, NETCDF, PICTURE))}")
    return 0
