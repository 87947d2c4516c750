"""From a scene file to plain data: read within bounds, whatever the path leads to and whatever is in it."""

import os
import stat
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel

from fingerpad.sentences import SceneError, clip, key_of

_MOST_BYTES = 1_000_000  # of a file; the longest scene that comes along has 1000
_MOST_DEPTH = 8  # of tables in lists in tables; a scene has 3
_DEPTH = f"a scene has at most {_MOST_DEPTH} inside one another"
_MOST_BITS = 1000  # of a whole number; floating point has 1024
_PATH = 80  # characters of a path in a sentence


def read(path: Path) -> dict[str, Any]:
    """Return what a TOML file holds; a byte order mark before it is allowed.

    Raises:
        SceneError: it is no ordinary file, too large, or not TOML.
    """
    name = f"scene file {clip(str(path), _PATH)}"
    try:
        raw = _bytes(path)
    except (OSError, ValueError) as error:  # ValueError: a path with a zero byte
        raise SceneError(f"{name} cannot be read: {getattr(error, 'strerror', None) or error}") from None
    if len(raw) > _MOST_BYTES:
        raise SceneError(f"{name} has more than {_MOST_BYTES} bytes; a scene has a few hundred")
    try:
        return tomllib.loads(raw.decode("utf-8-sig"))
    except ValueError as error:  # of the encoding or of TOML
        raise SceneError(f"{name} is not TOML: {clip(str(error), 150)}") from None
    except RecursionError:
        raise SceneError(f"{name} has lists or tables that are nested too deep; {_DEPTH}") from None


def _bytes(path: Path) -> bytes:
    """Return the first bytes of an ordinary file, one more than are allowed."""
    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)  # a pipe must not make the program wait
    with os.fdopen(descriptor, "rb") as file:
        mode = os.fstat(descriptor).st_mode
        if stat.S_ISDIR(mode):
            raise OSError("Is a directory")
        if not stat.S_ISREG(mode):
            raise OSError("it is not an ordinary file")
        return file.read(_MOST_BYTES + 1)


def plain(value: Any, place: tuple[int | str, ...] = ()) -> Any:
    """Return data of tables, lists, numbers and texts that JSON can hold.

    Dates become texts, NumPy's numbers and arrays Python's, and a model a table of what it was given.

    Raises:
        SceneError: data that is nested too deep, or a whole number beyond floating point.
    """
    if len(place) > _MOST_DEPTH:
        raise SceneError(f"{key_of(place[:3])} has lists or tables that are nested too deep; {_DEPTH}")
    if isinstance(value, np.generic | np.ndarray):
        value = float(value) if isinstance(value, np.floating) else value.tolist()
    if isinstance(value, BaseModel):
        value = {name: inner for name, inner in value if name in value.model_fields_set}
    if isinstance(value, Mapping):
        return {_text(str(key)): plain(inner, (*place, _text(str(key)))) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [plain(inner, (*place, k)) for k, inner in enumerate(value)]
    if value is None or isinstance(value, bool | float):
        return value
    if isinstance(value, int):
        if value.bit_length() > _MOST_BITS:
            raise SceneError(
                f"{key_of(place)} has some {int(value.bit_length() * 0.30103)} digits; at most 300 are read"
            )
        return value
    return _text(str(value))


def _text(text: str) -> str:
    """Return a text that can be written as UTF-8."""
    return text.encode("utf-8", "backslashreplace").decode("utf-8")
