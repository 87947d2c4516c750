"""What subcommands have in common on the command line: a scene, values for its keys, and PETSc's own options."""

import argparse
import math
import os
import re
import shlex
import sys
from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from itertools import combinations
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

from fingerpad import launcher
from fingerpad.cli import COMMANDS, ranges
from fingerpad.model.options import check
from fingerpad.scene import Scene, from_data, load, override
from fingerpad.scene.keys import every
from fingerpad.scene.law_code import allow
from fingerpad.scene.messages import SceneError, clip, ends
from geometry.units import to_si

_PETSC = "-fingerpad_"  # prefix of PETSc's options
_MIN_LIKENESS = 0.6  # likeness, from 0 to 1, at which an option may have been meant


class Kind(NamedTuple):
    """A kind of files that a command writes."""

    words: str
    endings: tuple[str, ...]
    """Of their names; the first is shown in the help."""
    begins: str = ""
    """Of their text; a file that begins otherwise is a user's, and is not replaced."""


PICTURE = Kind("a picture", (".png", ".pdf", ".svg", ".jpg", ".jpeg", ".eps", ".tif", ".tiff", ".webp"))


class Parser(argparse.ArgumentParser):
    """A parser that refuses by :class:`SceneError` and prints on rank 0 alone."""

    def __init__(self, command: str, examples: str) -> None:
        """Describe a command of :data:`fingerpad.cli.COMMANDS`, with examples of command lines, one a line."""
        lines = "\n".join(f"  {line.strip()}" for line in examples.strip().splitlines())
        what = COMMANDS.get(command, "")
        super().__init__(
            prog=f"fingerpad {command}",
            description=f"{what[:1].upper()}{what[1:]}.",
            epilog=f"examples:\n{lines}",
            formatter_class=argparse.RawDescriptionHelpFormatter,
            allow_abbrev=False,
        )
        self._written: dict[str, Kind] = {}  # files, by the names of their values

    def error(self, message: str) -> NoReturn:
        """Raise :class:`SceneError` where argparse refuses, without its usage."""
        raise SceneError(f"command line: {message}")

    def _print_message(self, message: str, file: Any = None) -> None:
        if launcher.rank() == 0:
            super()._print_message(message, file)

    def add_scene(self) -> None:
        """Add a scene file and values for its keys."""
        what = "scene in TOML (default: press, charge, slide)"
        self.add_argument("scene", nargs="?", type=path, metavar="SCENE", help=what)
        what = "a key of the scene; one --set for each key"
        self.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help=what)
        what = "a folder of your own from which laws may be imported; may be given again"
        self.add_argument("--laws", action="append", default=[], type=path, metavar="FOLDER", help=what)

    def add_ranges(self, *keys: str) -> None:
        """Add an option for several values of each of these keys, which :func:`several` reads."""
        for key in every(Scene):
            if key.name in keys:
                what = f"{key.meaning.partition('. ')[0].rstrip('.')}; several as 0,100 or 0:200:5, also with a unit"
                self.add_argument(f"--{key.name.replace('_', '-')}", metavar="RANGE", help=what)

    def add_table(self, table: str) -> None:
        """Add an option for each optional key of a table of a scene."""
        for key in every(Scene):
            if key.name.startswith(f"{table}.") and not key.required:
                pair: dict[str, Any] = {"nargs": 2, "metavar": ("X", "Y")} if key.allowed.startswith("list") else {}
                self.add_argument(f"--{key.name.removeprefix(table)[1:]}", **pair, help=key.meaning)

    def add_heads(self) -> None:
        """Add the option that names columns of tables of measurements, which :func:`heads_of` reads."""
        words = "a column of the tables by the name and unit it has here, as 'Fn=force (N)'; 'Fn=' leaves it out"
        self.add_argument("--column", action="append", default=[], metavar="HEAD=NAME", help=words)

    def add_out(self, default: str, what: str, quiet: str = "") -> None:
        """Add the folder that results go to, and ``--quiet`` where the command prints something alone with it."""
        words = f"{what} (default: {default})"
        self.add_argument("--out", type=path, metavar="PATH", default=Path(default), help=words)
        if quiet:
            words = f"print the {quiet} alone: no line of a step or a run, no progress bar"
            self.add_argument("--quiet", action="store_true", help=words)

    def add_file(self, option: str, kind: Kind, what: str, dest: str | None = None) -> None:
        """Add a file that the command writes, which is refused where it may not be replaced.

        Args:
            option: as ``--csv``.
            kind: of the file.
            what: for the help.
            dest: name of the value; by default that of the option.
        """
        name = dest or option.lstrip("-")
        self._written[name] = kind
        metavar = kind.endings[0][1:].upper()
        self.add_argument(option, dest=name, type=path, metavar=metavar, help=what)

    def read(self, argv: Sequence[str], petsc: bool = False) -> argparse.Namespace:
        """Return options; those for PETSc are the list ``petsc``, where they are allowed.

        Raises:
            SceneError: the first word at fault, with the nearest option there is.
        """
        words, passed = separate(argv) if petsc else (list(argv), [])
        options = list(self._option_string_actions)
        # -voltage and -help are no options, but argparse would take the latter for -h and more.
        for word, after in zip(words, [*words, ""][1:], strict=True):
            if re.match(r"-[A-Za-z]", word) and word not in options:
                self._refuse(word, petsc)
            takes = word in options and self._option_string_actions[word].nargs != 0
            if takes and re.match(r"-[\d.]", after) and not self._negative_number_matcher.match(after):
                given = shlex.quote(clip(after))
                raise SceneError(f"a value that begins with a minus has an equals sign before it; write {word}={given}")
        args, rest = self.parse_known_args(words)
        if rest:
            self._refuse(rest[0], petsc)
        for folder in getattr(args, "laws", ()):
            try:
                allow(folder)
            except ValueError as error:
                raise SceneError(f"--laws is {clip(str(folder), 80)}; {error}") from None
        values = [each for value in vars(args).values() for each in (value if isinstance(value, list) else [value])]
        for name, kind in self._written.items():
            file = getattr(args, name)
            if file is None:
                continue
            refuse_file(file, kind)
            if sum(isinstance(each, Path) and _same(each, file) for each in values) > 1:
                raise SceneError(f"{ends(file)} is given twice, once to be written; give it another name")
        args.petsc = passed
        return args

    def _refuse(self, word: str, petsc: bool) -> NoReturn:
        instead = _instead(word, self._option_string_actions, petsc)
        what = "is not an option" if word.startswith("-") or not word else "is a word too many"
        raise SceneError(f"{clip(word) or 'an empty text'} {what}; {instead}")


def heads_of(args: argparse.Namespace) -> dict[str, str | None]:
    """Return names of this program by heads of tables, of the option of :meth:`Parser.add_heads`.

    Raises:
        SceneError: one without an equals sign.
    """
    found = dict[str, str | None]()
    for text in args.column:
        head, equals, name = text.rpartition("=")
        if not equals:
            raise SceneError(f"--column is {clip(repr(text))}; it must be HEAD=NAME, such as 'Fn=force (N)'")
        found[head] = name
    return found


def scene_of(args: argparse.Namespace, meshed: bool = True) -> Scene:
    """Return the scene of the options of :meth:`Parser.add_scene`, by default one whose finger can be meshed.

    Raises:
        SceneError: the first key at fault.
    """
    scene = load(args.scene, changes(args.set))
    if meshed:
        check(scene)
    return scene


def changes(given: Sequence[str]) -> dict[str, Any]:
    """Return the values of ``KEY=VALUE`` by key.

    Raises:
        SceneError: a key is given twice, by itself or in a table.
    """
    pairs = [override(text) for text in given]
    for (one, _), (other, _) in combinations(pairs, 2):
        short, long = sorted((one, other), key=len)
        if long == short or long.startswith((f"{short}.", f"{short}[")):
            twice = "twice" if long == short else f"and {clip(long)} in it too"
            raise SceneError(f"--set {clip(short)} is given {twice}; give one value")
    return dict(pairs)


def several(args: argparse.Namespace, scene: Scene, key: str) -> list[float]:
    """Return the values of an option of :meth:`Parser.add_ranges`; the scene's own without it.

    Raises:
        SceneError: a value that the key cannot have, or the key is given by ``--set`` too.
    """
    option, text = f"--{key.replace('_', '-')}", getattr(args, key)
    refuse_twice(args, key, option)
    if text is None:
        return [scene.volts if key == "voltage" else getattr(scene, key)]  # of a drive its mean attraction's
    return [getattr(from_data({key: value}), key) for value in ranges.read(option, text)]


def refuse_twice(args: argparse.Namespace, key: str, option: str) -> None:
    """Raise :class:`SceneError` where ``--set`` gives a key of the scene beside an option of its own."""
    given = getattr(args, option.lstrip("-").replace("-", "_")) is not None
    if given and any(override(text)[0] == key for text in args.set):
        raise SceneError(f"--set {key} is given and {option} too; give one of the two")


def separate(argv: Sequence[str]) -> tuple[list[str], list[str]]:
    """Return a program's own words and those for PETSc: ``-fingerpad_name`` or ``-fingerpad_name value``.

    A word after an option of PETSc's is its value, unless it is an option itself or the name of a TOML file.
    """
    own, petsc = list[str](), list[str]()
    before = False  # whether the word before is an option of PETSc's
    for word in argv:
        option = re.fullmatch(_PETSC + r"[A-Za-z][A-Za-z0-9_]*", word) is not None
        value = before and word and not re.match(r"-[A-Za-z-]", word) and not word.endswith(".toml")
        (petsc if option or value else own).append(word)
        before = option
    return own, petsc


def _instead(word: str, options: Iterable[str], petsc: bool) -> str:
    """Return what may have been meant by a word that is no option."""
    own = [option for option in options if option.startswith("--")]
    name = word[:60].lstrip("-").partition("=")[0].lower()
    near = get_close_matches(name.replace("_", "-"), [option[2:] for option in own], n=1, cutoff=_MIN_LIKENESS)
    if near:
        return f"did you mean --{near[0]}?"
    key = _key(name.replace("-", "_")) if "--set" in own else None
    if key:
        return f"did you mean --set {key}=...?"
    if petsc and re.fullmatch(r"-[A-Za-z][A-Za-z0-9_]*", word) and len(word) <= 60:
        return f"did you mean {_PETSC}{word[1:]}? (PETSc's options have this prefix)"
    more = f", and PETSc's own with the prefix {_PETSC}" if petsc else ""
    return f"options are {', '.join(own)}{more}"


def _key(name: str) -> str | None:
    """Return the key of a scene that a name may have been meant for, with its table or without."""
    whole = [key.name for key in every(Scene) if "[" not in key.name]
    names = {key.rpartition(".")[2]: key for key in reversed(whole)} | {key: key for key in whole}
    near = get_close_matches(name, names, n=1, cutoff=0.8)
    return names[near[0]] if near else None


def path(text: str) -> Path:
    """Return a path; without a text there is none."""
    if not text:
        raise argparse.ArgumentTypeError("it is empty; it must be a path")
    return Path(text)


def positive(text: str) -> int:
    """Return a positive whole number."""
    if re.fullmatch(r"0*[1-9]\d{0,17}", text):
        return int(text)
    given = clip(text) or "an empty text"
    raise argparse.ArgumentTypeError(f"{given} is not allowed; it must be a whole number greater than 0")


def quantities(option: str, text: str, unit: str) -> list[float]:
    """Return the positive numbers of a range (:mod:`fingerpad.cli.ranges`) in a unit.

    Raises:
        SceneError: one of them is no such number.
    """
    try:
        found = [to_si(v, unit) if isinstance(v, str) else float(v) for v in ranges.read(option, text)]
    except ValueError as error:
        raise SceneError(f"{option} is {clip(text)}; {error}") from None
    if not all(0 < value < math.inf for value in found):
        raise SceneError(f"{option} is {clip(text)}; it must be greater than 0")
    return found


def refuse_file(file: Path, kind: Kind) -> None:
    """Refuse a file that cannot be written, or that no command of this kind has written; nothing is made.

    Raises:
        SceneError: its folder is not there or read-only, it is no ordinary file, read-only, or of another kind.
    """
    name, folder, there = ends(file), file.absolute().parent, os.path.lexists(file)
    why = (
        "its folder is not there" if not folder.is_dir()
        else "it is no ordinary file" if there and (file.is_symlink() or not file.is_file())
        else "it is read-only" if not os.access(file if there else folder, os.W_OK)
        else ""
    )  # fmt: skip
    if why:
        raise SceneError(f"{name} cannot be written, since {why}; give another one")
    if file.suffix.lower() not in kind.endings:
        several = "one of " if len(kind.endings) > 1 else ""
        raise SceneError(f"{name} cannot be {kind.words}; its name must end with {several}{', '.join(kind.endings)}")
    if there and kind.begins:
        begins = kind.begins.encode()
        with file.open("rb") as present:
            if present.read(len(begins)) not in (b"", begins):
                raise SceneError(f"{name} is there and is not {kind.words} of this command; give another name")


def _same(one: Path, other: Path) -> bool:
    """Return whether two paths lead to one file."""
    return one.absolute() == other.absolute() or (one.exists() and other.exists() and one.samefile(other))


def echo(text: str = "") -> None:
    """Print on rank 0."""
    if launcher.rank() == 0:
        print(text, file=sys.stdout)
