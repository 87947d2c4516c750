"""``fingerpad sweep``: a scene over values of its keys, each run in a process of its own and kept on disk."""

import inspect
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fingerpad.cli import ranges
from fingerpad.cli.arguments import Parser, changes, echo, positive
from fingerpad.launcher import raising_at_ctrl_c
from fingerpad.results.files import check_folder
from fingerpad.runs import batch  # noqa: F401  # before Ctrl-C raises
from fingerpad.runs.solve import MODELS
from fingerpad.runs.sweep import FILES, STATES, sweep
from fingerpad.scene import from_data, override
from fingerpad.scene.messages import SceneError, clip, show
from fingerpad.scene.reading import DEFAULT_MODEL, flat, read_study
from fingerpad.scene.scene import overridden

_EXAMPLES = """
    fingerpad sweep --over voltage=0:200:5 --over f_ext=25,75 --jobs 2 --out results/sweep
    fingerpad sweep --over voltage=0:200:21 --over f_ext=25:75:11 --states full_slip
    fingerpad sweep --over force="0.1, 0.3, 0.5 N" --model cylinders
    fingerpad sweep study.toml --set friction=0.3
"""


def main(argv: Sequence[str]) -> int:
    """Run a study; return the exit code."""
    parser = Parser("sweep", _EXAMPLES)
    parser.add_scene()
    words = "values of a key: 0,50 or first:last:count, with a unit at the end or on each value; or words"
    parser.add_argument("--over", action="append", default=[], metavar="KEY=RANGE", help=words)
    parser.add_out("results/sweep", "folder of all runs and of table.csv", quiet="table")
    parser.add_argument("--jobs", type=positive, default=2, metavar="N", help="runs at a time (default: 2)")
    parser.add_argument("--model", choices=MODELS, default=DEFAULT_MODEL, help="model to run (default: %(default)s)")
    words = "all, each point by its path, or full_slip alone, from point to point: some 4 times as fast (default: all)"
    parser.add_argument("--states", choices=STATES, default=STATES[0], help=words)
    args = parser.read(argv)
    check_folder(args.out)
    base, axes = study(args.scene, args.set, args.over)
    scene = from_data(base)
    if own := next((key for key in axes if key in inspect.signature(sweep).parameters), None):
        raise SceneError(f"{own} is varied and is no key of a scene; a sweep has one {own} for all of its points")
    try:
        with raising_at_ctrl_c():
            found = sweep(
                scene, args.out, jobs=args.jobs, model=args.model, quiet=args.quiet, states=args.states, executor=None,
                **axes,
            )  # fmt: skip
    except (KeyboardInterrupt, SystemExit):  # of signals
        print(f"fingerpad: stopped; points are kept in {args.out}, and the same command goes on", file=sys.stderr)
        raise
    echo(str(found))
    files = [name for name in FILES if (args.out / name).exists()]
    echo(f"Written: {args.out / files[0]}, {', '.join(files[1:])}" if files[1:] else f"Written: {args.out / files[0]}")
    return 1 if any(result.failure for result in found.results) else 0


def study(file: Path | None, given: Sequence[str], over: Sequence[str]) -> tuple[dict[str, Any], dict[str, list[Any]]]:
    """Return the data of a scene, and the values of each key that is varied.

    Args:
        file: a scene with a table ``[sweep]``, of a list or a range for each key.
        given: ``KEY=VALUE`` for the scene.
        over: ``KEY=RANGE``, which win over the table's; or words as in ``numerics.element=P1,P2``.

    Raises:
        SceneError: nothing is varied, or a key is given twice by options.
    """
    data = read_study(file) if file is not None else {}
    axes: dict[str, list[Any]] = {}
    table = data.pop("sweep", {})
    if not isinstance(table, dict):
        raise SceneError(f'sweep is {show(table)}; it must be a table such as [sweep] with voltage = "0:200:5"')
    for key, value in flat(table).items():
        axes[key] = ranges.read(f"sweep.{key}", value) if isinstance(value, str) else value
        if not isinstance(axes[key], list) or not axes[key]:
            raise SceneError(f'sweep.{key} is {show(value)}; it must be a list or a range such as "0:200:5"')
    given_over = set[str]()
    for text in over:
        key, equals, values = (part.strip() for part in text.partition("="))
        if not (equals and key):
            raise SceneError(f"--over {clip(text) or 'an empty text'} is no KEY=RANGE; write --over voltage=0:200:5")
        if key in given_over:
            raise SceneError(f"--over {clip(key)} is given twice; give all of its values in one")
        given_over.add(key)
        axes[key] = _words(values) or ranges.read(f"--over {key}", values)
    if not axes:
        raise SceneError("nothing is varied; give a table [sweep] in the scene file or --over KEY=RANGE")
    set_ = changes(given)
    if both := next((key for key in set_ if key in axes), None):
        raise SceneError(f"--set {both} is given and {both} is varied; give one of the two")
    return overridden(data, set_), axes


def _words(text: str) -> list[Any]:
    """Return the values of a list of words, switches among them; empty where a part of it is none."""
    parts = [part.strip() for part in text.split(",")]
    words = all(re.fullmatch(r"[A-Za-z/~][\w ./~-]*", part) for part in parts)
    return [override(f"key={part}")[1] for part in parts] if words else []
