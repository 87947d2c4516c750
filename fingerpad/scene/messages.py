"""Messages about an impossible scene, also of the first error of a validation: dotted key, value, what is allowed.

A message has one sentence, whatever a user wrote: texts of the user are shortened where they are quoted, and their
control characters are written out.
"""

import re
import unicodedata
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from difflib import SequenceMatcher
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

from geometry.units import NO_QUANTITY, OUT_OF_RANGE, to_si

_MAX_MESSAGE, _MAX_VALUE, _MAX_KEY = 1000, 60, 40  # characters of a message, of a value that is quoted, of a key

LAW = "law"  # kind of the errors of a law, whose context has the text and the place
NUMBER, WAVE, NAME, TABLE = "a number", "a waveform", "a name", "a table"
"""What a key with several kinds of values can be: parts of the place of an error that are no keys."""

_MAX_LIST = 150  # characters of a list of keys
_MIN_LIKENESS = 0.6  # likeness, from 0 to 1, at which a key of the same table may have been meant,
_ELSEWHERE = 0.85  # or one of another table
_ALLOWED = {
    "float_type": "a number",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "bool_type": "true or false",
    "string_type": "text",
    "tuple_type": "a list",
    "model_type": "a table of keys",
    "model_attributes_type": "a table of keys",
    "finite_number": "a finite number",
    "greater_than": "greater than {gt}",
    "greater_than_equal": "at least {ge}",
    "less_than": "less than {lt}",
    "less_than_equal": "at most {le}",
    "literal_error": "{expected}",
}
_SENTENCES = {kind: f"{{key}} is {{given}}; it must be {words}" for kind, words in _ALLOWED.items()} | {
    "missing": "{key} is missing; it must be given",
    "too_short": "{key} is empty; it must have at least one entry",
    "too_long": "{key} has too many entries; it must have at most {max_length}",
}
"""By pydantic's kind of an error, with the names of its context."""


class SceneError(ValueError):
    """A scene that cannot be run; the message names the key, its value and what is allowed."""

    def __init__(self, message: str) -> None:
        super().__init__(clip(message, _MAX_MESSAGE))


def refuse_type(name: str, value: object, allowed: Any, words: str) -> None:
    """Raise :class:`SceneError` where an argument is of none of the types allowed, in words; a type or a union."""
    if not isinstance(value, allowed):
        raise SceneError(f"{name} is of the type {type(value).__name__}; it must be {words}")


# -- texts ---------------------------------------------------------------------------------------------
def is_formula(text: str) -> bool:
    """Return whether a spreadsheet takes a cell with this text for a formula, also by a wide letter."""
    return unicodedata.normalize("NFKC", text[:1])[:1] in ("=", "+", "-", "@", "\t", "\r")


def clip(text: str, most: int = _MAX_VALUE) -> str:
    """Return a text in one line of printable characters, at most so many of them."""
    text = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text[: most + 1])
    return text if len(text) <= most else text[: most - 3] + "..."


def ends(value: Any, most: int = 80) -> str:
    """Return a text of at most so many printable characters, without its middle: a path has its name at the end."""
    text = clip(str(value), len(str(value)) * len("\\U0010ffff"))
    half = most // 2 - 2
    return text if len(text) <= most else f"{text[:half]}…{text[-half:]}"


def counted(count: int, one: str, many: str = "") -> str:
    """Return a number of things in words, of which there may be one; ``many`` is ``one`` with an s by default."""
    return f"{count} {one if count == 1 else many or one + 's'}"


def show(value: Any) -> str:
    """Return a value as a person would type it, shortened."""
    if isinstance(value, bool) or value is None:
        return {True: "true", False: "false", None: "empty"}[value]
    if isinstance(value, int | float):
        return f"{value:.12g}"
    text = repr(value)
    if isinstance(value, str) and len(text) > _MAX_VALUE:
        return clip(text, _MAX_VALUE - 1) + text[0]  # a quotation that is not closed would go on into the message
    return clip(text)


def key_of(parts: Iterable[int | str]) -> str:
    """Return the dotted key of a place in a scene; parts that are no plain keys are quoted."""
    key = ""
    for part in parts:
        if isinstance(part, int):
            key += f"[{part}]"
            continue
        plain = re.fullmatch(r"[A-Za-z0-9_-]+", part)
        key += "." * bool(key) + (clip(part, _MAX_KEY) if plain else clip(repr(part), _MAX_KEY))
    return key


def qualify(message: str, prefix: str, names: Iterable[str]) -> str:
    """Put the table's name before the keys that a message names, but not inside quotations."""
    parts = re.split(r"""((?<!\w)(?:'[^']*'|"[^"]*"))""", message)
    for k in range(0, len(parts), 2):
        for name in names:
            parts[k] = re.sub(rf"(?<![\w.]){name}\b", prefix + name, parts[k])
    return "".join(parts)


# -- errors --------------------------------------------------------------------------------------------
def first_error(error: ValidationError, root: type[BaseModel], keys: Iterable[str]) -> str:
    """Return the first error of a validation of the model ``root`` as a message; ``keys`` are all that it has."""
    first = error.errors(include_url=False)[0]
    kind, context = first["type"], first.get("ctx", {})
    loc = tuple(part for part in (*first["loc"], *context.get("at", ())) if part not in (NUMBER, WAVE, NAME, TABLE))
    if loc[:2] == ("contact", "law"):  # whose formulation's keys stand in the table itself
        loc = ("contact", *("formulation" if part == "law" else part for part in loc[2:]))
    key, value = key_of(loc), context.get("value", first["input"])
    given = show(value)
    if kind == LAW:
        text = context["text"]  # of a whole law it is a sentence, which may begin with one of its keys
        if "keys" not in context:
            return f"{key} {text}"
        return f"{key}.{text}" if re.split(r"\W", text)[0] in context["keys"] else f"{key}: {text}"
    if kind == OUT_OF_RANGE:
        return f"{key} {context['range'].words(context['number'], context['slip'], _default(root, loc))}"
    if kind == "extra_forbidden":
        of = f" with the law {context['of']}" if "of" in context else ""
        own = context.get("keys") or tuple(getattr(_model_at(root, loc[:-1]), "model_fields", ()))
        return f"{key} is not a key of {key_of(loc[:-1]) or 'a scene'}{of}; {_instead(loc, own, keys)}"
    if kind == "value_error":
        model = _model_at(root, loc)
        if model is None:
            return f"{key} is {given}; {context['error']}"
        return qualify(str(context["error"]), f"{key}." if key else "", model.model_fields)
    if kind == NO_QUANTITY and key == "f_ext":
        with suppress(ValueError):
            to_si(value, "N")
            return f"{key} is {given}; it must be in N/m; a force on the whole finger is the key force"
    if kind in ("int_type", "int_from_float") and isinstance(value, float):
        given = repr(value)  # 5.0, which show writes as 5
    numbers = {name: show(each) for name, each in context.items() if isinstance(each, int | float)}
    sentence = _SENTENCES.get(kind, "{key} is {given}; {msg}")
    return sentence.format(**first | context | numbers | {"key": key or "a scene", "given": given})


def _default(root: type[BaseModel], loc: Iterable[int | str]) -> float | None:
    """Return the number that a key has by default, None where it has none."""
    value: Any = root.model_construct()
    for part in loc:
        value = getattr(value, part, None) if isinstance(part, str) else None
    return value if isinstance(value, int | float) else None


def _model_at(model: type[BaseModel], loc: Iterable[int | str]) -> type[BaseModel] | None:
    """Return the model at a place in another one, None where there is a value."""
    found: type[BaseModel] | None = model
    for part in loc:
        if isinstance(part, str) and found is not None:
            found = next(_models_in(found.model_fields[part].annotation), None)
    return found


def _models_in(annotation: Any) -> Iterator[type[BaseModel]]:
    """Yield the models in an annotation such as ``tuple[Model, ...] | None``."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for part in get_args(annotation):
        yield from _models_in(part)


# -- unknown keys --------------------------------------------------------------------------------------
def _instead(loc: tuple[int | str, ...], own: Sequence[str], every: Iterable[str]) -> str:
    """Return what may have been meant by the key at ``loc``: the nearest of all tables' keys, or those of its own."""
    table, name = key_of(loc[:-1]), str(loc[-1])
    wanted = clip(name, _MAX_KEY).lower().replace("-", "_")
    keys = [(table, key, _MIN_LIKENESS) for key in own]
    names = [name.replace("[]", "[0]").split(".") for name in every]
    tables = dict.fromkeys((".".join(name[:depth]), name[depth]) for name in names for depth in range(len(name)))
    keys += [(at, key, _ELSEWHERE) for at, key in tables if (at, key) != (table, wanted)]
    near = [
        (likeness, -k)
        for k, (_, key, least) in enumerate(keys)
        if (likeness := SequenceMatcher(None, wanted, key.lower()).ratio()) >= least
    ]
    if near:
        where, key, _ = keys[-max(near)[1]]
        return f"did you mean {where}{'.' * bool(where)}{key}?"
    known = ", ".join(own)
    return f"keys are {known if len(known) <= _MAX_LIST else known[:_MAX_LIST].rpartition(',')[0] + ' and others'}"
