"""``fingerpad params``: every key of a scene, as a table or a page."""

import json
import textwrap
from collections.abc import Sequence
from typing import Any

from fingerpad.cli.arguments import Parser, echo
from fingerpad.scene import Scene
from fingerpad.scene.keys import Key, every
from fingerpad.scene.messages import SceneError, clip

_WIDTH = 120
_EXAMPLES = """
    fingerpad params roughness
    fingerpad params --markdown > scene.md
"""
_PAGE = """# Scene reference

A scene has {keys} keys in {tables} tables. An empty file is the default scene: 75 N/m, 200 V, friction 0.25,
slid to full slip. Most scenes change only `f_ext`, `voltage`, `friction` and one or two tables. Only three keys have no
default: the name of a load, the shape of a waveform and the file of a height map, all in optional tables.

- In a file, a key stands in its table: `[mesh]`, then `contact = 10e-6`.
- In Python: `fp.Scene(mesh={{"contact": 10e-6}})`. On the command line: `--set mesh.contact=10e-6`.
- Numbers are in SI units. A number with a unit can be given as text: `"10 um"`, `"50 N/m"`.
- Forces are per metre of finger out of the plane of the cross-section (N/m).
- A value outside its range is refused with the key, the value, the range and, where likely, the unit that was meant.
- *Assumption* marks choices that the paper leaves open. [assumptions.md](assumptions.md) gives their effect.

`fingerpad params --markdown` writes this page from the program's own definitions."""


def main(argv: Sequence[str]) -> int:
    """Print keys; return the exit code."""
    parser = Parser("params", _EXAMPLES)
    parser.add_argument("filter", nargs="?", default="", metavar="FILTER", help="keys with this in their name")
    parser.add_argument("--markdown", action="store_true", help="as a page: the scene reference")
    args = parser.read(argv)
    found = [key for key in every(Scene) if args.filter.lower() in key.name.lower()]
    if not found:
        raise SceneError(f"no key of a scene has {clip(args.filter)} in its name; fingerpad params lists all of them")
    echo(page(found) if args.markdown else table(found))
    return 0


def table(found: Sequence[Key]) -> str:
    """Return keys in aligned columns, what they mean below each."""
    rows = [("key", "unit", "default", "allowed"), *((key.name, key.unit, _default(key), key.allowed) for key in found)]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    head, *lines = ["  ".join(map(str.ljust, row, widths)).rstrip() for row in rows]
    return "\n".join([head, *(f"{line}\n{_wrapped(key, '    ')}" for line, key in zip(lines, found, strict=True))])


def _wrapped(key: Key, indent: str) -> str:
    return "\n".join(textwrap.wrap(key.meaning, _WIDTH, initial_indent=indent, subsequent_indent=indent))


def page(found: Sequence[Key]) -> str:
    """Return keys as a page in Markdown, one table for each table of a scene."""
    by_table: dict[str, list[Key]] = {}
    for key in found:
        by_table.setdefault(key.name.rpartition(".")[0], []).append(key)
    lines = [_PAGE.format(keys=len({key.name for key in found}), tables=len([name for name in by_table if name]))]
    for name, keys in by_table.items():
        plain = name.replace("[]", "")
        heading = f"`[[{plain}]]`" if name.endswith("[]") else f"`[{plain}]`" if name else "Top level"
        lines += ["", f"## {heading}", "", "| key | unit | default | allowed | meaning |", "|---|---|---|---|---|"]
        for key in keys:
            default = f"{key.default:.12g}" if isinstance(key.default, float) else _default(key)
            cells = (f"`{key.name.rpartition('.')[2]}`", key.unit, default, key.allowed, key.meaning)
            lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def _default(key: Key) -> str:
    if key.required:
        return "(required)"
    return "–" if key.default is None else _value(key.default)


def _value(value: Any) -> str:
    """Return a value as TOML has it."""
    if isinstance(value, tuple):
        return f"[{', '.join(map(_value, value))}]"
    return json.dumps(value, ensure_ascii=False) if isinstance(value, bool | str) else repr(value)
