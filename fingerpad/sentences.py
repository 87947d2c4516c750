"""What is wrong with a model's input, in one sentence: the dotted key, the value given, and what is allowed."""

import re
from collections.abc import Iterable, Iterator
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

_TYPES = {
    "float_type": "a number",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "bool_type": "true or false",
    "string_type": "text",
    "tuple_type": "a list",
    "model_type": "a table of keys",
    "model_attributes_type": "a table of keys",
    "finite_number": "a finite number",
}
_BOUNDS = {
    "greater_than": ("gt", "greater than"),
    "greater_than_equal": ("ge", "at least"),
    "less_than": ("lt", "less than"),
    "less_than_equal": ("le", "at most"),
}


def first_error(error: ValidationError, root: type[BaseModel]) -> str:
    """Return the first error of a validation of ``root`` as one sentence."""
    first = error.errors(include_url=False)[0]
    kind, context, given = first["type"], first.get("ctx", {}), show(first["input"])
    key = re.sub(r"\.(\d+)", r"[\1]", ".".join(str(part) for part in first["loc"]))
    if kind == "extra_forbidden":
        table, _, _ = key.rpartition(".")
        keys = ", ".join(_model_at(root, first["loc"][:-1]).model_fields)
        return f"{key} is not a key of {table or 'a scene'}; keys are {keys}"
    if kind == "missing":
        return f"{key} is missing; it must be given"
    if kind == "value_error":
        model = _model_at(root, first["loc"])
        return qualify(str(context["error"]), f"{key}." if key else "", model.model_fields)
    if kind in _BOUNDS:
        name, words = _BOUNDS[kind]
        return f"{key} is {given}; it must be {words} {show(context[name])}"
    if kind == "literal_error":
        return f"{key} is {given}; it must be {context['expected']}"
    if kind == "too_short":
        return f"{key} is empty; it must have at least one entry"
    if kind in _TYPES:
        return f"{key} is {given}; it must be {_TYPES[kind]}"
    return f"{key} is {given}; {first['msg']}"


def _model_at(model: type[BaseModel], loc: Iterable[int | str]) -> type[BaseModel]:
    """Return the model at a place in another one."""
    for part in loc:
        if isinstance(part, str):
            model = next(_models_in(model.model_fields[part].annotation))
    return model


def _models_in(annotation: Any) -> Iterator[type[BaseModel]]:
    """Yield the models in an annotation such as ``tuple[Model, ...] | None``."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for part in get_args(annotation):
        yield from _models_in(part)


def qualify(message: str, prefix: str, names: Iterable[str]) -> str:
    """Put the table's name before the keys a message speaks of."""
    for name in names:
        message = re.sub(rf"(?<![\w.]){name}\b", prefix + name, message)
    return message


def show(value: Any) -> str:
    """Return a value as a person would type it, shortened."""
    if isinstance(value, bool) or value is None:
        return {True: "true", False: "false", None: "empty"}[value]
    if isinstance(value, int | float):
        return f"{value:.12g}"
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
