"""What a notebook shows of a value: HTML in which every word is escaped, and a progress bar that is written over."""

import html
import sys
import time
from collections.abc import Iterable, Sequence
from typing import Any

_EVERY = 0.2  # s between two states of the bar
_CELL = "text-align: right; white-space: nowrap"


def page(title: str, *parts: str) -> str:
    """Return a title and the parts below it."""
    return f"<div><b>{html.escape(title)}</b>{''.join(parts)}</div>"


def table(heads: Sequence[object], rows: Iterable[Sequence[object]]) -> str:
    """Return a table whose first column is words; a row that is cut short ends in words."""
    lines = [("th", heads), *(("td", row) for row in rows)]
    text = "".join(f"<tr>{''.join(_cell(kind, k, each) for k, each in enumerate(row))}</tr>" for kind, row in lines)
    return f"<table>{text}</table>"


def _cell(kind: str, column: int, words: object) -> str:
    return f'<{kind} style="{_CELL if column else "text-align: left"}">{html.escape(str(words))}</{kind}>'


def lines(sentences: Iterable[object]) -> str:
    """Return sentences, each on a line of its own."""
    return "".join(f"<div>{html.escape(str(each))}</div>" for each in sentences)


def folded(title: str, sentences: Sequence[object]) -> str:
    """Return sentences that a reader unfolds; nothing without one."""
    return f"<details><summary>{html.escape(title)}</summary>{lines(sentences)}</details>" if sentences else ""


def running() -> bool:
    """Return whether this process is the kernel of a notebook."""
    shell = sys.modules["IPython"].get_ipython() if "IPython" in sys.modules else None
    return getattr(shell, "kernel", None) is not None


class Bar:
    """A progress bar in the output of the present cell."""

    def __init__(self) -> None:
        """Show an empty bar."""
        from IPython.display import display

        self._time, self._handle = -_EVERY, display(self._html(0.0, ""), raw=True, display_id=True)

    def update(self, part: float, words: str) -> None:
        """Show a part that is done and what is being done, at most some times a second."""
        if time.monotonic() - self._time >= _EVERY:
            self._time = time.monotonic()
            self._handle.update(self._html(part, words), raw=True)

    def close(self) -> None:
        """Take the bar away."""
        self._handle.update({"text/html": "", "text/plain": ""}, raw=True)

    @staticmethod
    def _html(part: float, words: str) -> dict[str, Any]:
        bar = f'<progress value="{part:.3f}" max="1"></progress> {100 * part:.0f} % {html.escape(words)}'
        return {"text/html": bar, "text/plain": f"{100 * part:.0f} % {words}"}


def head_rows(states: Sequence[str]) -> list[list[str]]:
    """Return the two lines of heads of states side by side, by their words."""
    heads = [words.split(" normal") for words in states]
    return [["", *(head[0] for head in heads)], ["", *("normal" + head[1] if head[1:] else "" for head in heads)]]


def side_by_side(rows: Sequence[Sequence[str]]) -> list[str]:
    """Return the lines of a table whose first column is words and whose others are numbers."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = list[str]()
    for first, *rest in rows:
        cells = (cell.rjust(width) for cell, width in zip(rest, widths[1:], strict=True))
        lines.append("   ".join(["  " + first.ljust(widths[0]), *cells]).rstrip())
    return lines
