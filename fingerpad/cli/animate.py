"""``fingerpad animate``: a run as a moving picture, from its folder."""

from collections.abc import Sequence

from fingerpad.cli.arguments import Kind, Parser, echo, path
from fingerpad.results.result import Result

_EXAMPLES = """
    fingerpad animate results/mine
    fingerpad animate results/mine --out talk.gif
"""
_NAME = "animation.webp"


def main(argv: Sequence[str]) -> int:
    """Write the animation of a run; return the exit code."""
    parser = Parser("animate", _EXAMPLES)
    parser.add_argument("folder", type=path, metavar="DIR", help="folder of a run")
    kind = Kind("an animation", (".webp", ".gif"))
    parser.add_file("--out", kind, f"file of the animation (default: {_NAME} in the folder)", None)
    args = parser.read(argv)
    file = Result.load(args.folder).animate(args.out or args.folder / _NAME)
    echo(f"Written: {file} ({file.stat().st_size / 1e6:.1f} MB)")
    return 0
