"""``fingerpad solve``: the value of a key at which friction, or another quantity at full slip, has a target."""

import inspect
from collections.abc import Sequence
from typing import Any

from fingerpad.cli.arguments import Parser, echo, scene_of
from fingerpad.runs.inverse import solve
from fingerpad.scene.messages import SceneError, clip, show

_EXAMPLES = """
    fingerpad solve --target mu_app=0.4 --over voltage
    fingerpad solve --target "f_t=0.3 N" --set force="0.5 N"
    fingerpad solve --target mu_app=1.1 --relative --over electric.d_i --from "0.5 um" --to "5 um"
"""


def main(argv: Sequence[str]) -> int:
    """Find the values of a key; return the exit code."""
    parser = Parser("solve", _EXAMPLES)
    parser.add_scene()
    words = "at full slip, as mu_app=0.4 or 'f_t=0.3 N'"
    parser.add_argument("--target", action="append", default=[], metavar="QUANTITY=VALUE", help=words)
    words = "the target is a multiple of the value without voltage: mu_app=2 is twice the friction"
    parser.add_argument("--relative", action="store_true", help=words)
    parser.add_argument("--over", default="voltage", metavar="KEY", help="key that is varied (default: %(default)s)")
    parser.add_argument("--from", dest="low", metavar="VALUE", help="first value of the key, also with a unit")
    parser.add_argument("--to", dest="high", metavar="VALUE", help="last value of the key, also with a unit")
    args = parser.read(argv)
    if len(args.target) != 1:
        given = "no --target is given" if not args.target else f"--target is given {len(args.target)} times"
        raise SceneError(f"{given}; give one quantity and its value, as --target mu_app=0.4")
    name, equals, value = (part.strip() for part in args.target[0].partition("="))
    if not (name and equals and value):
        raise SceneError(f"target is {show(args.target[0])}; give a quantity and its value, as --target mu_app=0.4")
    if (args.low is None) != (args.high is None):
        raise SceneError(f"one of --from and --to is given without the other; give both, or none for {clip(args.over)}")
    between = None if args.low is None else [_number(args.low), _number(args.high)]
    if name in inspect.signature(solve).parameters:
        raise SceneError(f"target is {show(args.target[0])}; {name} is no quantity, such as mu_app")
    options: dict[str, Any] = {"relative": args.relative, "between": between, name: _number(value)}
    echo(str(solve(scene_of(args, meshed=False), args.over, **options)))
    return 0


def _number(text: str) -> float | str:
    """Return a number, or a text that may have a unit."""
    try:
        return float(text)
    except ValueError:
        return text
