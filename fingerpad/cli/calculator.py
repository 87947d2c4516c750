"""``fingerpad calculator``: the closed form as one HTML page with sliders, which needs no Python and no network."""

from collections.abc import Sequence
from pathlib import Path

from fingerpad.cli.arguments import Parser, echo, writable
from fingerpad.io.files import replace

_EXAMPLES = """
    fingerpad calculator
    fingerpad calculator --out docs/calculator.html
"""


def main(argv: Sequence[str]) -> int:
    """Write the page; return the exit code."""
    parser = Parser(
        "fingerpad calculator",
        "Write a page that draws friction over force and voltage by the closed form, for any browser, offline.",
        _EXAMPLES,
    )
    parser.add_out("calculator.html", "file of the page (default: calculator.html)")
    args = parser.read(argv)
    writable(args.out)
    from fingerpad.calculator.page import page

    replace(Path(args.out), page())
    echo(f"Written: {args.out}")
    return 0
