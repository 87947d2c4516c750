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
    """Return whether two texts have the same words and numbers.

    Numbers agree within a relative tolerance or so many last digits. Estimated errors, after ± or "by", only have to be
    of the same order: within a factor of three.
    """
    if NUMBER.sub("#", text).split() != NUMBER.sub("#", other).split():
        return False
    for a, b in zip(NUMBER.finditer(text), NUMBER.finditer(other), strict=True):
        digits = len(a[0].partition(".")[2].partition("e")[0])
        estimated = text[: a.start()].endswith(("± ", "by "))
        tolerance = 2.0 if estimated else relative
        if float(b[0]) != pytest.approx(float(a[0]), rel=tolerance, abs=last_digit * 10.0**-digits):
            return False
    return True


_ABBREVIATED = re.compile(r"\b(Eqs?|Figs?|ch|sec|vol|e\.g|i\.e|approx|min)\.\s")
_END = re.compile(r"(?<=[.!?])[*_)\"”]*\s+(?=[^a-z])")


def sentences(page: str) -> tuple[list[str], list[str]]:
    """Return the sentences of a page's text, and those of its tables; without code, formulas, headings and pictures."""
    page = re.sub(r"<!--.*?-->", "", page, flags=re.DOTALL)
    page = re.sub(r"^```.*?^```$|\$\$.*?\$\$", "", page, flags=re.DOTALL | re.MULTILINE)
    page = re.sub(r"^Not reached: .*$", "", page, flags=re.MULTILINE)  # a message of the program, quoted
    page = re.sub(r"^    (?![-*]).*$|^#.*$|^!\[.*$|^\|[-|: ]+$", "", page, flags=re.MULTILINE)
    page = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", re.sub(r"`[^`\n]*`", "code", page))
    rows = [line for line in page.splitlines() if line.startswith("|")]
    text = "\n".join("" if line.startswith("|") else line for line in page.splitlines())
    blocks = re.split(r"\n\s*\n|\n(?=\s*(?:[-*]|\d+\.)\s)", text)
    cells = [cell for row in rows for cell in row.strip("|").split("|")]
    return _sentences(blocks), _sentences(cells)


def _sentences(texts: list[str]) -> list[str]:
    plain = (_ABBREVIATED.sub(r"\1 ", " ".join(text.split())) for text in texts)
    return [sentence for text in plain for sentence in _END.split(text) if words(sentence)]


def words(sentence: str) -> int:
    """Return the number of words and numbers of a sentence."""
    return sum(any(c.isalnum() for c in word) for word in sentence.split())
