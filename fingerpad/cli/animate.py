"""``fingerpad animate``: a run as a moving picture, from its folder."""

import sys
from collections.abc import Sequence

from fingerpad.cli.arguments import Kind, Parser, echo, path
from fingerpad.launcher import raising_at_ctrl_c
from fingerpad.results.result import Result
from fingerpad.results.terminal import watched
from fingerpad.runs.batch import progress

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
    result, file = Result.load(args.folder), args.out or args.folder / _NAME
    from fingerpad.results.animation import animate  # Matplotlib

    try:
        with raising_at_ctrl_c(), progress(quiet=not watched()) as bar:
            task = bar.add_task("frames drawn", total=None)
            animate(result, file, lambda done, count: bar.update(task, completed=done, total=count))
    except KeyboardInterrupt:
        print(f"fingerpad: stopped by Ctrl-C; {file} was not written, and what was there stays", file=sys.stderr)
        raise
    echo(f"Written: {file} ({file.stat().st_size / 1e6:.1f} MB)")
    return 0
