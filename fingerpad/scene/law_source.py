"""What a law of the user's own is written as: two laws of one name and other code are two laws.

A class or function counts by its source, by that of its bases, and by what they read from around them: numbers, texts,
arrays, functions and classes, such as a constant at the head of the user's file. The compiled code counts too: the
file may have been edited after its import. Where there is no source, as in an interactive session, each counts as
itself alone, and in this process alone. Other modules that they use do not count.
"""

import hashlib
import inspect
import sys
from collections.abc import Iterator, Mapping
from contextlib import suppress
from functools import cache, cached_property
from types import CodeType, FunctionType
from typing import Any
from uuid import uuid4

import numpy as np

_LIBRARIES = {"variational", "fingerpad", "geometry", "numpy", "scipy", "ufl"}
_KNOWN = _LIBRARIES | (set(sys.stdlib_module_names) - {"__main__", "test"})


def digest(thing: type | FunctionType) -> str:
    """Return a hash of what a class or function is written as; empty for those of this program and of libraries."""
    text = "\n".join(_of_code(thing, set()))
    return hashlib.sha256(text.encode("utf-8", "backslashreplace")).hexdigest()[:16] if text else ""


def _of_code(thing: Any, seen: set[int]) -> Iterator[str]:
    """Yield the sources of a class or function, and what its functions read."""
    for part in thing.__mro__ if isinstance(thing, type) else (thing,):
        if id(part) in seen or str(part.__module__).partition(".")[0] in _KNOWN:
            continue
        seen.add(id(part))
        yield _source(part)
        for member in list(vars(part).values()) if isinstance(part, type) else [part]:
            function = _function(member)
            if function is not None:
                yield from map(_compiled, _codes(function))
                for name, value in _read(function).items():
                    yield from (f"{name}: {text}" for text in _of_value(value, seen))


@cache  # as it was first read: the file may be edited while a run is on
def _source(part: Any) -> str:
    try:
        return inspect.getsource(part)
    except (OSError, TypeError):
        return uuid4().hex


def _function(member: Any) -> FunctionType | None:
    """Return the function behind a member of a class, None if there is none."""
    if isinstance(member, staticmethod | classmethod):
        member = member.__func__
    elif isinstance(member, property):
        member = member.fget
    elif isinstance(member, cached_property):
        member = member.func
    return member if isinstance(member, FunctionType) else None


def _codes(function: FunctionType) -> list[CodeType]:
    """Return the compiled code of a function and of those inside."""
    codes = [function.__code__]
    for code in codes:  # which grows
        codes += [inner for inner in code.co_consts if isinstance(inner, CodeType)]
    return codes


def _compiled(code: CodeType) -> str:
    """Return compiled code as text, the same in every process."""
    values = [sorted(map(repr, c)) if isinstance(c, frozenset) else c for c in code.co_consts]
    return repr((code.co_code, code.co_names, [c for c in values if not isinstance(c, CodeType)]))


def _read(function: FunctionType) -> dict[str, Any]:
    """Return what a function may read from around it, by name."""
    names = {name for code in _codes(function) for name in code.co_names} & function.__globals__.keys()
    found = {name: function.__globals__[name] for name in sorted(names)}
    for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
        with suppress(ValueError):  # not filled yet
            found[name] = cell.cell_contents
    return found


def _of_value(value: Any, seen: set[int]) -> Iterator[str]:
    """Yield a value that a function reads, as text; nothing of what is neither number, text, array nor code."""
    if value is None or isinstance(value, bool | int | float | complex | str | bytes):
        yield repr(value)
    elif isinstance(value, np.ndarray | np.generic):
        yield repr(value.tolist())
    elif isinstance(value, Mapping | list | tuple):
        if id(value) not in seen:
            seen.add(id(value))
            for key, inner in value.items() if isinstance(value, Mapping) else enumerate(value):
                for text in _of_value(inner, seen):
                    yield f"{key}: {text}"
    elif isinstance(value, type | FunctionType):
        yield from _of_code(value, seen)
