"""Tables of text: states side by side, whose first column is words."""

from collections.abc import Sequence


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
