"""Pages in HTML: ``fingerpad report`` of a folder of results, ``fingerpad calculator`` of the closed form."""

from collections.abc import Sequence
from importlib.resources import files

from fingerpad.cli.arguments import Kind, Parser, echo, path
from fingerpad.report.write import write
from fingerpad.results.files import replace

_REPORT = """
    fingerpad report results/mine
    fingerpad report results/sweep
"""
_CALCULATOR = """
    fingerpad calculator
    fingerpad calculator --out docs/calculator.html
"""


def main(argv: Sequence[str]) -> int:
    """Write the report of a folder; return the exit code."""
    parser = Parser("report", _REPORT)
    parser.add_argument("folder", type=path, metavar="DIR", help="folder of a run or of a sweep")
    args = parser.read(argv)
    file = write(args.folder)
    echo(f"Written: {file} ({file.stat().st_size / 1e6:.1f} MB)")
    return 0


def calculator(argv: Sequence[str]) -> int:
    """Write the page of the closed form, which needs no Python and no network; return the exit code."""
    parser = Parser("calculator", _CALCULATOR)
    head = (files("fingerpad.calculator") / "page.html").read_text(encoding="utf-8").partition("{{")[0]
    kind = Kind("a page", (".html",), head)
    parser.add_file("--out", kind, "file of the page (default: calculator.html)", "calculator.html")
    args = parser.read(argv)
    from fingerpad.calculator.page import page

    replace(args.out, page())
    echo(f"Written: {args.out}")
    return 0
