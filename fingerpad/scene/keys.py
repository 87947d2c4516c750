"""Every key of a scene: unit, default, range and meaning, from the models themselves."""

import ast
import inspect
import re
import textwrap
import types
from collections.abc import Iterator
from dataclasses import MISSING, dataclass, replace
from functools import cache
from itertools import pairwise
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, WrapValidator

from fingerpad.scene.controls import LoadKey
from fingerpad.scene.law_keys import LawKey, keys_of, range_of
from geometry.units import Range


@dataclass(frozen=True)
class Key:
    """A key of a scene."""

    name: str
    """With its tables, as in ``roughness.h_rms``; entries of a list of tables have ``[]``."""
    default: Any
    meaning: str
    """From the docstring of the key."""
    limits: Range | None = None
    """Of a number, or of each in a list."""
    choices: str = ""
    """What it may be besides, in words."""
    required: bool = False
    """Whether a table of its kind must give it."""

    @property
    def unit(self) -> str:
        """Its SI unit; empty without one."""
        return self.limits.unit if self.limits else ""

    @property
    def allowed(self) -> str:
        """What it may be, in words."""
        if self.limits is None:
            return self.choices
        sign = ", either sign" if self.limits.sides == 2 else ""
        return f"{self.choices}{'0 or ' if self.limits.zero else ''}{self.limits.low:g} to {self.limits.high:g}{sign}"


def every(scene: type[BaseModel]) -> Iterator[Key]:
    """Yield every key of the model of a scene, tables in the order in which a scene has them."""
    yield from _of(scene, "", None)


@cache
def by_name(scene: type[BaseModel]) -> dict[str, Key]:
    """Return every key by its name; of one that several laws read in their own ways that of the first law."""
    found = dict[str, Key]()
    for key in every(scene):
        found.setdefault(key.name, key)
    return found


def _of(model: type[BaseModel], table: str, instance: BaseModel | None) -> Iterator[Key]:
    inner, laws = [], list[tuple[str, LawKey, str]]()
    for name, field in model.model_fields.items():
        own = next((part.annotation for part in field.metadata if isinstance(part, LoadKey)), field.annotation)
        parts = tuple(_parts(own)) + tuple(field.metadata)
        law = next((part for part in parts if isinstance(part, LawKey)), None)
        if law is not None:
            meaning = _plain_text(field.description)
            if law.number:
                limits = range_of(keys_of(law.default)[law.number])
                yield Key(table + name, getattr(law.default, law.number), meaning, limits)
            laws.append((f"{table}{name}.", law, "" if law.number else meaning))
            continue
        inside = [part for part in parts if isinstance(part, type) and issubclass(part, BaseModel)]
        many = "[]" if tuple in parts else ""
        value = getattr(instance, name) if instance is not None else field.get_default(call_default_factory=True)
        if inside:
            inner.append((inside[0], f"{table}{name}{many}.", value if isinstance(value, inside[0]) else None))
            if not any(
                isinstance(part, WrapValidator) or get_origin(part) is Literal for part in parts
            ):  # may be a number or a name too
                continue
        required = instance is None and field.is_required()
        meaning = _plain_text(field.description)
        yield Key(table + name, None if required else value, meaning, *_allowed(parts), required=required)
    for where, key, meaning in laws:
        yield from _of_law(where, key, meaning)
    for kind, where, value in inner:
        yield from _of(kind, where, value)


def _of_law(table: str, key: LawKey, meaning: str) -> Iterator[Key]:
    """Yield the keys of a law's table: its name, and the parameters of the default law, or of all where a number is."""
    default = key.default
    name, names = key.kind.name(type(default)), ", ".join(f'"{name}"' for name in key.kind.laws)
    table = table.removesuffix("law.") if key.flat else table
    text = f"{meaning or 'Name of the law.'} A law of your own has its import path here (docs/laws.md)."
    yield Key(table + (key.flat or "law"), None if key.number else name, text, choices=f"{names} or module:Class")
    several = bool(key.all_laws or key.number or key.flat)
    readers = dict[Key, list[str]]()  # of what has one range and meaning, under one name
    for law in dict.fromkeys([type(default), *(key.kind.laws.values() if several else ())]):
        for field in keys_of(law).values():
            value = None if key.number or field.default is MISSING else field.default
            value = value if key.number or law is not type(default) else getattr(default, field.name)
            kind = "true or false" if field.type in (bool, "bool") else "text" if field.type in (str, "str") else ""
            choices = ", ".join(map(str, field.metadata.get("allowed", ()))) or kind
            found = Key(table + field.name, value, docstrings(law).get(field.name, ""), range_of(field), choices)
            same = next((each for each in readers if replace(each, default=value) == found), found)
            readers.setdefault(same, []).append(key.kind.name(law))
    for found, laws in readers.items():
        those = " and ".join([", ".join(laws[:-1]), laws[-1]] if laws[1:] else laws)
        alone = f" Of {those} alone." if several and len(laws) < len(key.kind.laws) else ""
        yield replace(found, meaning=found.meaning + alone)
    for each in key.tables(type(default)):  # that a law may have, and the default law has not
        yield from (replace(k, default=None) for k in _of(each, f"{table}{each.__name__.lower()}.", None))


def _parts(annotation: Any) -> Iterator[Any]:
    """Yield everything that an annotation such as ``Annotated[float, within(...)] | None`` is made of."""
    origin = get_origin(annotation)
    yield annotation if origin is None else origin
    if origin is Annotated:
        yield from _parts(annotation.__origin__)
        yield from annotation.__metadata__
    elif origin in (Union, types.UnionType, tuple):
        for part in get_args(annotation):
            yield from _parts(part)
    elif origin is Literal:
        yield annotation


def _allowed(parts: tuple[Any, ...]) -> tuple[Range | None, str]:
    """Return the range of a key, and what it may be besides, in words."""
    for part in parts:
        found = part.func if isinstance(part, WrapValidator) else None
        if isinstance(found, Range):
            return found, "list: " if tuple in parts else ""
    for part in parts:
        if get_origin(part) is Literal:
            return None, ", ".join(repr(value) for value in get_args(part)).replace("'", '"')
    bounds = [part for meta in parts for part in getattr(meta, "metadata", [meta])]  # of Field(...), or bare
    low, high = (next((getattr(b, n) for b in bounds if hasattr(b, n)), None) for n in ("ge", "le"))
    if low is not None and high is not None:
        return Range(low, high), "whole, "
    if bool in parts:
        return None, "true or false"
    return None, "text" if str in parts else ""


@cache
def docstrings(law: type) -> dict[str, str]:
    """Return what is written under the fields of a law and of its bases; empty where there is no source."""
    found = {key: words for base in law.__bases__ if base is not object for key, words in docstrings(base).items()}
    try:
        body = ast.parse(textwrap.dedent(inspect.getsource(law))).body[0]
    except (OSError, TypeError):
        return found
    for line, after in pairwise(getattr(body, "body", [])):
        if isinstance(line, ast.AnnAssign) and isinstance(line.target, ast.Name):
            if isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant):
                found[line.target.id] = _plain_text(str(after.value.value))
    return found


def _plain_text(text: str | None) -> str:
    """Return a docstring as a line of text, without the marks of reStructuredText."""
    text = re.sub(r":\w+:`~?([^`]*)`", r"\1", " ".join((text or "").split()))
    return re.sub(r"\*([Aa]ssumption)\*", r"\1", text.replace("``", ""))
