"""From a scene file, or from changes of one, to plain data: read within bounds, whatever is in it."""

import json
import os
import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import is_dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel

from fingerpad.scene.law_code import foreign
from fingerpad.scene.law_keys import table
from fingerpad.scene.messages import SceneError, clip, key_of, show
from variational import files
from variational.coefficients import Law
from variational.roughness.closure import Closure

DEFAULT_MODEL = "full"
"""Model of a run whose files name none, by :data:`fingerpad.runs.solve.MODELS`."""
_MAX_DEPTH = 8  # of tables in lists in tables; a scene has 3
_DEPTH = f"a scene has at most {_MAX_DEPTH} inside one another"
_MAX_BITS = 1000  # of a whole number; floating point has 1024
_NEW = {int: list, str: dict}  # what a key of a place that is not there yet is put into
_PATH = 80  # characters of a path in a message
_AFTER_VALUE = "Expected newline or end of document after a statement"  # tomllib, of 50,0 and of 50 N/m
_NAME = r"[A-Za-z0-9_-]+(\[[0-9]{1,6}\])?"
_FILES = r"geometry\.file|roughness\.topography\.file|(history\[\d+\]\.)?voltage\.file"
_QUOTED = re.compile(
    r'''#[^\n]*|"""(?:[^\\]|\\.)*?(?:"""|\Z)|\'{3}.*?(?:\'{3}|\Z)|"(?:[^"\\\n]|\\.)*"?|'[^'\n]*'?''', re.DOTALL
)  # comments and texts of TOML
_KEY = re.compile(rf"{_NAME}(\.{_NAME})*")


def read_study(path: Path) -> dict[str, Any]:
    """Return the data of a scene file that may have a table ``[sweep]``, or of ``scene.json`` of a run's folder.

    Files of a mesh, of a height map and of voltages are looked for beside it. A byte order mark is allowed.

    Raises:
        SceneError: it is no ordinary file, too large, or neither TOML nor the scene of a run.
    """
    foreign(path.parent)
    foreign(path.resolve().parent)
    if path.suffix.lower() == ".json":
        return {key: value for key, value in _record(path).items() if key != "model"}
    data: dict[str, Any] = plain(_parsed(path, "TOML", _toml))
    _beside(data, path.parent)
    _beside(data.get("sweep"), path.parent)
    return data


def read_scene(path: Path) -> dict[str, Any]:
    """Return the data of a scene file; files that it names are looked for beside it.

    Raises:
        SceneError: the file cannot be read, or holds a study.
    """
    data = read_study(path)
    if "sweep" in data:
        raise SceneError(f"{path} has a table sweep, which makes it a study; run it by fingerpad sweep, or without it")
    return data


def model_name(name: Any) -> str:
    """Return the name of a model in files of results, which may be of one that is not registered here.

    Raises:
        SceneError: it is no name.
    """
    if not (isinstance(name, str) and re.fullmatch(r"[^\W\d][\w .-]{0,59}", name)):
        raise SceneError(f"model is {show(name)}; it must be the name of a model: letters, digits and dots")
    return name


def model_of(path: Path | None) -> str:
    """Return the model of the run whose ``scene.json`` is given, :data:`DEFAULT_MODEL` of any other scene.

    Raises:
        SceneError: the file cannot be read.
    """
    if path is None or path.suffix.lower() != ".json":
        return DEFAULT_MODEL
    return model_name(_record(path).get("model", DEFAULT_MODEL))


def _record(path: Path) -> dict[str, Any]:
    """Return what a ``scene.json`` holds."""
    data = _parsed(path, "JSON", json.loads)
    if not isinstance(data, dict) or "geometry" not in data:
        raise SceneError(
            f"scene file {clip(str(path), _PATH)} is not the scene.json of a run; other scenes are in TOML"
        )
    return data


def _parsed(path: Path, kind: str, parse: Callable[[str], Any]) -> Any:
    """Return what a file of a user holds, of bounded size, in UTF-8 with or without a byte order mark."""
    name = f"scene file {clip(str(path), _PATH)}"
    try:
        return parse(files.read(path, files.MOST_OF_TEXT).decode("utf-8-sig"))
    except OSError as error:
        raise SceneError(f"{name} cannot be read: {error.strerror or error}") from None
    except UnicodeDecodeError:
        raise SceneError(f"{name} is not text in UTF-8; save it in UTF-8") from None
    except RecursionError:
        raise SceneError(f"{name} has lists or tables that are nested too deep; {_DEPTH}") from None
    except SceneError:
        raise
    except ValueError as error:  # the parser's, or a whole number of more digits than Python reads
        hint = "; decimals have points, and a value with a unit has quotes" if _AFTER_VALUE in str(error) else ""
        raise SceneError(f"{name} is not {kind}: {clip(str(error), 150)}{hint}") from None


def _beside(value: Any, folder: Path, where: str = "") -> Any:
    """Return a value with the files that it names, one by one or in a list, as paths from a folder on."""
    if isinstance(value, dict):
        value |= {key: _beside(inner, folder, f"{where}.{key}".lstrip(".")) for key, inner in value.items()}
    elif isinstance(value, list):
        names = [f"{where}[{k}]" if isinstance(inner, dict) else where for k, inner in enumerate(value)]
        return [_beside(inner, folder, name) for inner, name in zip(value, names, strict=True)]
    elif isinstance(value, str) and re.fullmatch(_FILES, where):
        return os.path.join(os.curdir, folder, value)  # ./=a.msh: a cell =a.msh would be a formula
    return value


def _toml(text: str) -> dict[str, Any]:
    """Return what a text in TOML holds; refuse dotted keys of many parts, in which tomllib's time is quadratic."""
    for part in re.split(r"[^\w\s.-]|\n", _QUOTED.sub("_", text)):  # a key or a value, with all its dots
        if part.count(".") > _MAX_DEPTH:
            raise _too_deep([name.strip() for name in part.split(".")])
    return tomllib.loads(text)


def _too_deep(place: Sequence[int | str]) -> SceneError:
    return SceneError(f"{key_of(tuple(place[:3]))} has lists or tables that are nested too deep; {_DEPTH}")


def plain(value: Any, place: tuple[int | str, ...] = ()) -> Any:
    """Return data of tables, lists, numbers and texts that JSON can hold.

    Dates become texts, NumPy's numbers and arrays Python's, a model a table of what it was given, and a quantity of
    pint a number with its unit.

    Raises:
        SceneError: data that is nested too deep, or a whole number beyond floating point.
    """
    if len(place) > _MAX_DEPTH:
        raise _too_deep(place)
    if isinstance(value, np.generic | np.ndarray):
        value = float(value) if isinstance(value, np.floating) else value.tolist()
    if is_dataclass(value) or isinstance(value, type | Law | Closure):
        return value  # a law, its class, or what was meant to be one
    if isinstance(value, BaseModel):
        value = {name: table(inner) for name, inner in value if name in value.model_fields_set}
    if isinstance(value, Mapping):
        return {_text(str(key)): plain(inner, (*place, _text(str(key)))) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [plain(inner, (*place, k)) for k, inner in enumerate(value)]
    if value is None or isinstance(value, bool | float):
        return value
    if hasattr(value, "magnitude") and hasattr(value, "units"):  # of pint; all digits, whatever its format for printing
        return f"{plain(value.magnitude, place)} {value.units:D}"
    if isinstance(value, int):
        if value.bit_length() > _MAX_BITS:
            raise SceneError(
                f"{key_of(place)} has some {int(value.bit_length() * 0.30103)} digits; at most 300 are read"
            )
        return value
    return _text(str(value))


def _text(text: str) -> str:
    """Return a text that can be written as UTF-8."""
    return text.encode("utf-8", "backslashreplace").decode("utf-8")


# -- changes -------------------------------------------------------------------------------------------
def override(text: str) -> tuple[str, Any]:
    """Return key and value of ``key=value``, for :func:`fingerpad.scene.load`.

    Args:
        text: a dotted key and a value as in TOML: a number, true or false, a quoted text, a list or a table. Any other
            value is a text without quotation marks: ``f_ext=50 N/m``, ``contact.formulation=nitsche``.

    Raises:
        SceneError: no key, no value, or a value with a bracket or a quotation mark left open.
    """
    key, equals, value = (part.strip() for part in text.partition("="))
    if not (equals and value and _KEY.fullmatch(key)):
        shown = clip(text.strip()) or "an empty text"
        raise SceneError(f"{shown} is no change of a scene; it must be key=value, as in mesh.contact=10e-6")
    try:
        found = _toml(f"value = {value}") if value.isprintable() else {}
    except (ValueError, RecursionError):
        found = {}
    if found.keys() == {"value"}:
        return key, plain(found["value"], (key,))
    if value[0] in "[{\"'":
        raise SceneError(f"{clip(key)} is {show(value)}; it must be a value as in TOML, with all brackets and quotes")
    try:
        return key, float(value)
    except ValueError:
        return key, plain(value, (key,))


def put(data: dict[str, Any], key: str, value: Any) -> None:
    """Put a value at a dotted key (``history[0].f_ext``), with the tables on the way to it; a list keeps its length.

    Raises:
        SceneError: a table, or an entry of a list, that is not there; or too many of them inside one another.
    """
    parts = [
        int(part[1:-1]) if part.startswith("[") else part for part in re.split(r"\.|(?=\[[0-9]{1,6}\](?:\.|$))", key)
    ]
    if len(parts) > _MAX_DEPTH:
        raise _too_deep(parts)
    here: Any = data
    for depth, part in enumerate(parts):
        name = key_of(parts[:depth])
        kind, words = (list, "a list") if isinstance(part, int) else (dict, "a table of keys")
        if not isinstance(here, kind):
            raise SceneError(f"{name} is {show(here)}; it must be {words}")
        if isinstance(part, int) and part >= len(here):
            raise SceneError(f"{key_of(parts[: depth + 1])} is not there; {name} has {len(here)} entries")
        if depth == len(parts) - 1:
            here[part] = value
        else:
            here = here[part] if isinstance(part, int) else here.setdefault(part, _NEW[type(parts[depth + 1])]())


def put_all(data: dict[str, Any], changes: Mapping[str, Any]) -> None:
    """Put values at dotted keys, as :func:`put` does; of ``f_ext`` and ``force`` a change of one replaces the other."""
    for key, other in (("force", "f_ext"), ("f_ext", "force")):
        if key in changes:
            data.pop(other, None)
    for key, value in changes.items():
        put(data, key, value)


def flat(parameters: Mapping[str, Any], where: str = "") -> dict[str, Any]:
    """Return the values of nested tables by dotted key, as :func:`put` takes them.

    Entries of lists of tables are as ``history[0].f_ext``.
    """
    found: dict[str, Any] = {}
    for key, value in parameters.items():
        if isinstance(value, Mapping):
            found |= flat(value, f"{where}{key}.")
        elif isinstance(value, list | tuple) and value and all(isinstance(each, Mapping) for each in value):
            for k, each in enumerate(value):
                found |= flat(each, f"{where}{key}[{k}].")
        else:
            found[where + key] = value
    return found
