"""``fingerpad report``: a folder of results as one HTML file."""

from collections.abc import Sequence

from fingerpad.cli.arguments import Parser, echo, path
from fingerpad.report.write import write

_EXAMPLES = """
    fingerpad report results/mine
    fingerpad report results/sweep
"""


def main(argv: Sequence[str]) -> int:
    """Write the report of a folder; return the exit code."""
    parser = Parser("report", _EXAMPLES)
    parser.add_argument("folder", type=path, metavar="DIR", help="folder of a run or of a sweep")
    args = parser.read(argv)
    file = write(args.folder)
    echo(f"Written: {file} ({file.stat().st_size / 1e6:.1f} MB)")
    return 0
