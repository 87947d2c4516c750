"""The command line of demos and benchmarks: a scene, overrides of it, and PETSc's own options."""

import argparse
import contextlib
import io
import math
import re
import sys
from collections.abc import Callable, Iterable, Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import NoReturn

from fingerpad.folder import check_folder
from fingerpad.scene import Scene, check, load
from fingerpad.sentences import SceneError, clip

_OPTIONS = {"f_ext": "f_ext", "voltage": "voltage", "contact_size": "mesh.contact", "friction": "friction"}
_PETSC = "-fingerpad_"  # prefix of PETSc's options
_NEAR = 0.6  # likeness, from 0 to 1, at which an option may have been meant


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options every run has: a scene, four overrides, and where results go."""
    parser.add_argument("--scene", type=_path, metavar="FILE", help="scene in TOML (default: press, charge, slide)")
    parser.add_argument("--f-ext", metavar="N/m", help="external normal force per length")
    parser.add_argument("--voltage", metavar="V", help="instantaneous voltage")
    parser.add_argument("--contact-size", metavar="M", help="size of surface elements where ridges can touch")
    parser.add_argument("--friction", metavar="MU", help="friction coefficient")
    parser.add_argument("--out", type=_path, metavar="DIR", default=Path("results"), help="folder of the results")


def from_arguments(args: argparse.Namespace) -> Scene:
    """Return the checked scene that parsed options of :func:`add_arguments` ask for.

    Raises:
        SceneError: the first key at fault.
    """
    given = {key: getattr(args, name) for name, key in _OPTIONS.items()}
    scene = load(args.scene, {key: _number(text) for key, text in given.items() if text is not None})
    check(scene)
    return scene


def petsc_options(rest: Sequence[str], options: Iterable[str]) -> list[str]:
    """Return arguments no option claimed, if they are PETSc's: ``-fingerpad_name`` or ``-fingerpad_name value``.

    Args:
        rest: the arguments.
        options: the program's own.

    Raises:
        SceneError: the first argument that is not, with the nearest option there is.
    """
    value_allowed = False
    for word in rest:
        is_value = not re.match(r"-[A-Za-z-]", word)
        if is_value and value_allowed:
            value_allowed = False
            continue
        if not re.fullmatch(_PETSC + r"[A-Za-z][A-Za-z0-9_]*", word):
            raise SceneError(f"{clip(word) or 'an empty text'} is not an option; {_instead(word, options)}")
        value_allowed = True
    return list(rest)


def _instead(word: str, options: Iterable[str]) -> str:
    """Return what may have been meant by a word that is no option."""
    own = [option for option in options if option.startswith("--")]
    name = word[:60].lstrip("-").partition("=")[0].replace("_", "-").lower()
    near = get_close_matches(name, [option[2:] for option in own], n=1, cutoff=_NEAR)
    if near:
        return f"did you mean --{near[0]}?"
    if re.fullmatch(r"-[A-Za-z][A-Za-z0-9_]*", word) and len(word) <= 60:
        return f"did you mean {_PETSC}{word[1:]}? (PETSc's options have this prefix)"
    return f"options are {', '.join(own)}, and PETSc's own with the prefix {_PETSC}"


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
        try:
            args, petsc = _parse(parser, sys.argv[1:] if argv is None else argv)
            scene = from_arguments(args)
            check_folder(args.out)
            return scene, args, petsc
        except SceneError as error:
            print(f"fingerpad: {error}", file=sys.stderr)
            sys.exit(2)


def _parse(parser: argparse.ArgumentParser, argv: Sequence[str]) -> tuple[argparse.Namespace, list[str]]:
    """Return options and PETSc's options.

    Raises:
        SceneError: what the parser refuses, without its usage.
    """

    def refuse(message: str) -> NoReturn:
        raise SceneError(f"command line: {message}")

    parser.error = refuse  # type: ignore[method-assign]
    options = list(parser._option_string_actions)
    # -voltage and -help are no options, but argparse would take the latter for -h and more.
    for word in argv:
        if re.match(r"-[A-Za-z]", word) and word not in options and not word.startswith(_PETSC):
            raise SceneError(f"{clip(word)} is not an option; {_instead(word, options)}")
    args, rest = parser.parse_known_args(argv)
    return args, petsc_options(rest, options)


def _path(text: str) -> Path:
    """Return a path; without a text there is none."""
    if not text:
        raise argparse.ArgumentTypeError("it is empty; it must be a path")
    return Path(text)


def positive(kind: type[int] | type[float]) -> Callable[[str], float]:
    """Return a type of arguments: positive numbers of a kind."""

    def read(text: str) -> float:
        try:
            value = kind(text)
        except ValueError:
            value = kind(0)
        if not 0 < value < math.inf:
            words = "whole number" if kind is int else "number"
            raise argparse.ArgumentTypeError(f"{clip(text)} is not allowed; it must be a {words} greater than 0")
        return value

    return read


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text
