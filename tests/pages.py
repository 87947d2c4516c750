"""Pages in Markdown: their blocks of code, what these print, and their sentences."""

import contextlib
import io
import re
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[1]
NUMBER = re.compile(r"(?<![A-Za-z_])-?\d+\.?\d*(?:e[-+]?\d+)?")


def blocks(text: str) -> list[tuple[str, str]]:
    """Return the blocks of Python of a page, each with the block of output below it, empty where there is none."""
    found = re.findall(r"^```(\w*)\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)
    after = [*found[1:], ("", "")]
    return [
        (code, output if not language_after else "")
        for (language, code), (language_after, output) in zip(found, after, strict=True)
        if language == "python"
    ]


def printed(code: str, names: dict[str, Any]) -> str:
    """Run a block with the names of those before it and return what it prints."""
    with contextlib.redirect_stdout(io.StringIO()) as out:
        exec(compile(code, "page", "exec"), names)
    return out.getvalue()


def alike(text: str, other: str, relative: float, last_digit: float = 1.5) -> bool:
    """Return whether two texts have the same words, and the same numbers within a tolerance or so many last digits."""
    words, others = (NUMBER.sub("#", t).split() for t in (text, other))
    if words != others:
        return False
    for a, b in zip(NUMBER.findall(text), NUMBER.findall(other), strict=True):
        digits = len(a.partition(".")[2].partition("e")[0])
        if float(b) != pytest.approx(float(a), rel=relative, abs=last_digit * 10.0**-digits):
            return False
    return True
