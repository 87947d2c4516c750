"""Messages about an impossible scene: the dotted key, the value given, and what is allowed.

A message has one sentence and at most :data:`MOST` characters, whatever a user wrote. Texts of the user are shortened
where they are quoted, and their control characters are written out.
"""

import re
from collections.abc import Iterable
from typing import Any

MOST = 280  # characters of a message; with the name of the program before it less than 300
_MAX_VALUE = 60  # of a value that is quoted
MOST_KEY = 40  # of a key

LAW = "law"  # kind of the errors of a law, whose context has the text and the place
NUMBER, WAVE = "a number", "a waveform"
"""What a voltage can be: parts of the place of an error that are no keys."""


class SceneError(ValueError):
    """A scene that cannot be run; the message names the key, its value and what is allowed."""

    def __init__(self, message: str) -> None:
        super().__init__(clip(message, MOST))


# -- texts ---------------------------------------------------------------------------------------------
def clip(text: str, most: int = _MAX_VALUE) -> str:
    """Return a text in one line of printable characters, at most so many of them."""
    text = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text[: most + 1])
    return text if len(text) <= most else text[: most - 3] + "..."


def ends(value: Any, most: int = 80) -> str:
    """Return a text of at most so many printable characters, without its middle: a path has its name at the end."""
    text = clip(str(value), len(str(value)) * len("\\U0010ffff"))
    half = most // 2 - 2
    return text if len(text) <= most else f"{text[:half]}…{text[-half:]}"


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
        key += "." * bool(key) + (clip(part, MOST_KEY) if plain else clip(repr(part), MOST_KEY))
    return key


def qualify(message: str, prefix: str, names: Iterable[str]) -> str:
    """Put the table's name before the keys that a message names, but not inside quotations."""
    parts = re.split(r"""((?<!\w)(?:'[^']*'|"[^"]*"))""", message)
    for k in range(0, len(parts), 2):
        for name in names:
            parts[k] = re.sub(rf"(?<![\w.]){name}\b", prefix + name, parts[k])
    return "".join(parts)
