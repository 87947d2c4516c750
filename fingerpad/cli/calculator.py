"""``fingerpad calculator``: the closed form as one HTML page with sliders, which needs no Python and no network."""

from collections.abc import Sequence
from importlib.resources import files

from fingerpad.cli.arguments import Kind, Parser, echo
from fingerpad.results.files import replace

_EXAMPLES = """
    fingerpad calculator
    fingerpad calculator --out docs/calculator.html
"""


def main(argv: Sequence[str]) -> int:
    """Write the page; return the exit code."""
    parser = Parser("calculator", _EXAMPLES)
    head = (files("fingerpad.calculator") / "page.html").read_text(encoding="utf-8").partition("{{")[0]
    kind = Kind("a page", (".html",), head)
    parser.add_file("--out", kind, "file of the page (default: calculator.html)", "calculator.html")
    args = parser.read(argv)
    from fingerpad.calculator.page import page

    replace(args.out, page())
    echo(f"Written: {args.out}")
    return 0
