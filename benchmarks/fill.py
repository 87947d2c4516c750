"""Numbers put in place: pages of docs/ are their own source, and hold the expressions of their numbers in comments.

A page is Markdown with four comments, which a reader does not see:

- ``<!--numbers NAME-->``: from here on, names in expressions are those of the study NAME, as its ``draw`` passes them;
- ``0.594<!--=EXPRESSION-->``: the word before the comment is the value of an expression, formatted as in an f-string;
- ``<!--rows TARGET in VALUES: | {EXPRESSION} | … |-->``: the rows of the table that follows, below its head; several
  lines of this form in one comment are groups of rows, and a line that begins with ``|`` is one row;
- ``<!--block EXPRESSION-->`` to ``<!--end-->``: a text of several lines.
"""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

NUMBERS = re.compile(r"^<!--numbers (\w+)-->\n", re.MULTILINE)
_WORD = r"[^\s(\[|*=`]+"  # of a value in a line
_VALUE = re.compile(rf"({_WORD})<!--=(.+?)-->")
_ROWS = re.compile(r"^(<!--rows ((?s:.+?))-->\n\|.*\n\|[-| :]+\n)((?:\|.*\n)*)", re.MULTILINE)
_BLOCK = re.compile(r"^(<!--block (.+)-->\n)(?s:.*?)^<!--end-->$", re.MULTILINE)


def pages(docs: Path, study: str) -> list[Path]:
    """Return the pages of a folder that show numbers of a study."""
    return [path for path in sorted(docs.glob("*.md")) if study in NUMBERS.findall(path.read_text(encoding="utf-8"))]


def filled(page: str, study: str, names: Mapping[str, Any]) -> str:
    """Return a page with the numbers of one study put in place.

    Args:
        page: the page, with whatever numbers it has.
        study: whose parts of the page are filled.
        names: what expressions may use.

    Raises:
        ValueError: a value in a line has a space or another character by which it would not be found again.
    """
    before, *parts = NUMBERS.split(page)
    for name, text in zip(parts[::2], parts[1::2], strict=True):
        before += f"<!--numbers {name}-->\n" + (_part(text, dict(names)) if name == study else text)
    return before


def _part(text: str, names: dict[str, Any]) -> str:
    def value(found: re.Match[str]) -> str:
        word = str(eval(f"rf'''{{{found[2]}}}'''", names))
        if not re.fullmatch(_WORD, word):
            raise ValueError(f"{found[2]} is {word!r}; a value in a line must be one word")
        return f"{word}<!--={found[2]}-->"

    def rows(found: re.Match[str]) -> str:
        groups = (re.fullmatch(r"(?:(.+?): )?(\|.*)", line) for line in found[2].splitlines())
        every = (eval(f"[rf'''{each[2]}''' for {each[1] or '_ in [0]'}]", names) for each in groups if each)
        return found[1] + "".join(f"{line}\n" for lines in every for line in lines)

    def block(found: re.Match[str]) -> str:
        return f"{found[1]}\n{str(eval(found[2], names)).strip()}\n\n<!--end-->"

    return _BLOCK.sub(block, _ROWS.sub(rows, _VALUE.sub(value, text)))
