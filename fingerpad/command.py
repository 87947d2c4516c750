"""The command line of demos and benchmarks: a scene, overrides of it, and PETSc's own options."""

import argparse
import contextlib
import io
import math
import re
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from fingerpad.scene import Scene, SceneError, check, load

_OPTIONS = {"f_ext": "f_ext", "voltage": "voltage", "contact_size": "mesh.contact", "friction": "friction"}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options every run has: a scene, four overrides, and where results go."""
    parser.add_argument("--scene", type=Path, metavar="FILE", help="scene in TOML (default: press, charge, slide)")
    parser.add_argument("--f-ext", metavar="N/m", help="external normal force per length")
    parser.add_argument("--voltage", metavar="V", help="instantaneous voltage")
    parser.add_argument("--contact-size", metavar="M", help="size of surface elements where ridges can touch")
    parser.add_argument("--friction", metavar="MU", help="friction coefficient")
    parser.add_argument("--out", type=Path, metavar="DIR", default=Path("results"), help="folder of the results")


def from_arguments(args: argparse.Namespace) -> Scene:
    """Return the checked scene that parsed options of :func:`add_arguments` ask for.

    Raises:
        SceneError: the first key at fault.
    """
    given = {key: getattr(args, name) for name, key in _OPTIONS.items()}
    scene = load(args.scene, {key: _number(text) for key, text in given.items() if text is not None})
    check(scene)
    return scene


def petsc_options(rest: Sequence[str]) -> list[str]:
    """Return arguments no option claimed, if they can be PETSc's: ``-name`` or ``-name value``.

    Raises:
        SceneError: the first argument that cannot.
    """
    value_allowed = False
    for word in rest:
        is_value = not re.match(r"-[A-Za-z-]", word)
        if word.startswith("--") or (is_value and not value_allowed):
            raise SceneError(
                f"{word} is not an option; options are --scene, --f-ext, --voltage, --contact-size, --friction, "
                "--out, and PETSc's own with one dash"
            )
        value_allowed = not is_value
    return list(rest)


def command_line(
    parser: argparse.ArgumentParser, argv: Sequence[str] | None = None, quiet: bool = False
) -> tuple[Scene, argparse.Namespace, list[str]]:
    """Read scene, options and PETSc's options, or exit with code 2 and one sentence.

    Args:
        parser: has the options of :func:`add_arguments` and perhaps more.
        argv: arguments; the process's own if None.
        quiet: print nothing, for all ranks but one.
    """
    silence = io.StringIO()
    with contextlib.ExitStack() as stack:
        if quiet:
            stack.enter_context(contextlib.redirect_stdout(silence))
            stack.enter_context(contextlib.redirect_stderr(silence))
        args, rest = parser.parse_known_args(argv)
        try:
            petsc = petsc_options(rest)
            return from_arguments(args), args, petsc
        except SceneError as error:
            print(f"fingerpad: {error}", file=sys.stderr)
            sys.exit(2)


def positive(kind: type[int] | type[float]) -> Callable[[str], float]:
    """Return a type of arguments: positive numbers of a kind."""

    def read(text: str) -> float:
        try:
            value = kind(text)
        except ValueError:
            value = kind(0)
        if not 0 < value < math.inf:
            words = "whole number" if kind is int else "number"
            raise argparse.ArgumentTypeError(f"{text} is not allowed; it must be a {words} greater than 0")
        return value

    return read


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text
