"""Every key of a scene: unit, default, range and meaning, from the models themselves.

What a key means is the text under it in the source of its model, by the standard library's ``ast``: pydantic's own
``use_attribute_docstrings`` would ask every model to be configured for it.
"""

import ast
import inspect
import re
import textwrap
import types
from collections.abc import Iterator
from dataclasses import MISSING, Field, dataclass
from functools import cache
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, WrapValidator

from fingerpad.scene.law_keys import LawKey, keys_of, range_of
from geometry.units import Range


@dataclass(frozen=True)
class Key:
    """A key of a scene."""

    name: str
    """With its tables, as in ``roughness.h_rms``; entries of a list of tables have ``[]``."""
    unit: str
    default: Any
    allowed: str
    """What it may be, in words."""
    meaning: str
    """From the docstring of the key."""
    required: bool = False
    """Whether a table of its kind must give it."""
    law: str = ""
    """Law that reads it, where that is not the default one."""


def every(scene: type[BaseModel]) -> Iterator[Key]:
    """Yield every key of the model of a scene, tables in the order in which a scene has them."""
    yield from _of(scene, "", None)


def tables(model: type[BaseModel]) -> Iterator[type[BaseModel]]:
    """Yield the model of a table and of every table in it; one that is there twice comes twice."""
    yield model
    for field in model.model_fields.values():
        for part in (*_parts(field.annotation), *field.metadata):
            if isinstance(part, type) and issubclass(part, BaseModel):
                yield from tables(part)


def _of(model: type[BaseModel], table: str, instance: BaseModel | None) -> Iterator[Key]:
    inner, laws = [], list[tuple[str, LawKey, str]]()
    for name, field in model.model_fields.items():
        parts = tuple(_parts(field.annotation)) + tuple(field.metadata)
        law = next((part for part in parts if isinstance(part, LawKey)), None)
        if law is not None:
            meaning = docstrings(model).get(name, "")
            if law.number:
                limits = range_of(keys_of(law.default)[law.number])
                allowed = "" if limits is None else _words(limits)
                yield Key(table + name, "", getattr(law.default, law.number), allowed, meaning)
            laws.append((f"{table}{name}.", law, "" if law.number else meaning))
            continue
        inside = [part for part in parts if isinstance(part, type) and issubclass(part, BaseModel)]
        many = "[]" if tuple in parts else ""
        value = getattr(instance, name) if instance is not None else field.get_default(call_default_factory=True)
        if inside:
            inner.append((inside[0], f"{table}{name}{many}.", value if isinstance(value, inside[0]) else None))
            if not any(isinstance(part, WrapValidator) for part in parts):  # else it may be a number too
                continue
        unit, allowed = _allowed(parts)
        required = instance is None and field.is_required()
        yield Key(table + name, unit, None if required else value, allowed, docstrings(model).get(name, ""), required)
    for where, key, meaning in laws:
        yield from _of_law(where, key, meaning)
    for kind, where, value in inner:
        yield from _of(kind, where, value)


def _of_law(table: str, key: LawKey, meaning: str) -> Iterator[Key]:
    """Yield the keys of a law's table: its name, and the parameters of the default law, or of all where a number is."""
    default = key.default
    name, names = key.kind.name(type(default)), ", ".join(f'"{name}"' for name in key.kind.laws)
    table = table.removesuffix("law.") if key.flat else table
    several = bool(key.number or key.flat)
    text = f"{meaning or 'Name of the law.'} A law of your own has its import path here (docs/laws.md)."
    yield Key(table + (key.flat or "law"), "", None if key.number else name, f"{names} or module:Class", text)
    seen = set[str]()
    for law in dict.fromkeys([type(default), *(key.kind.laws.values() if several else ())]):
        for field in keys_of(law).values():
            if field.name in seen:
                continue
            seen.add(field.name)
            value = None if key.number or field.default is MISSING else field.default
            value = value if key.number or law is not type(default) else getattr(default, field.name)
            limits = range_of(field)
            unit, allowed = ("", _choices(field)) if limits is None else (limits.unit, _words(limits))
            of = "" if law is type(default) else key.kind.name(law)
            yield Key(table + field.name, unit, value, allowed, docstrings(law).get(field.name, ""), law=of)
    for each in key.tables:
        yield from _of(each, f"{table}{each.__name__.lower()}.", None)


def _choices(field: "Field[Any]") -> str:
    return ", ".join(map(str, field.metadata.get("allowed", ())))


def _words(limits: Range, several: str = "") -> str:
    """Return a range in words."""
    sign = ", either sign" if limits.sides == 2 else ""
    return f"{several}{'0 or ' if limits.zero else ''}{limits.low:g} to {limits.high:g}{sign}"


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


def _allowed(parts: tuple[Any, ...]) -> tuple[str, str]:
    """Return unit and range of a key."""
    for part in parts:
        found = part.func if isinstance(part, WrapValidator) else None
        if isinstance(found, Range):
            return found.unit, _words(found, "list: " if tuple in parts else "")
    for part in parts:
        if get_origin(part) is Literal:
            return "", ", ".join(repr(value) for value in get_args(part)).replace("'", '"')
    bounds = [part for meta in parts for part in getattr(meta, "metadata", [meta])]  # of Field(...), or bare
    low, high = (next((getattr(b, n) for b in bounds if hasattr(b, n)), None) for n in ("ge", "le"))
    if low is not None and high is not None:
        return "", f"whole, {low} to {high}"
    if bool in parts:
        return "", "true or false"
    return "", "text" if str in parts else ""


@cache
def docstrings(model: type) -> dict[str, str]:
    """Return what is written under the keys of a model or a law, in one line each; empty where there is no source."""
    found = {
        key: words
        for base in model.__bases__
        if base not in (BaseModel, object)
        for key, words in docstrings(base).items()
    }
    try:
        body = ast.parse(textwrap.dedent(inspect.getsource(model))).body[0]
    except (OSError, TypeError):
        return found
    lines = getattr(body, "body", [])
    for line, after in zip(lines, lines[1:], strict=False):
        if isinstance(line, ast.AnnAssign) and isinstance(line.target, ast.Name):
            if isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant):
                found[line.target.id] = _plain(str(after.value.value))
    return found


def _plain(text: str) -> str:
    """Return a docstring as a line of text, without the marks of reStructuredText."""
    text = re.sub(r":\w+:`~?([^`]*)`", r"\1", " ".join(text.split()))
    return text.replace("``", "").replace("*Assumption*", "Assumption").replace("*assumption*", "assumption")
