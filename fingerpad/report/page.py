"""One HTML file from its parts: text, tables, pictures and charts, with style, data and programs inside."""

import base64
import html
import json
from collections.abc import Iterable, Mapping, Sequence
from importlib import resources
from io import BytesIO
from pathlib import Path
from typing import Any

_COLOURS = 128  # of a picture's palette; the pictures have fewer hues, and a third of the bytes is left
_MAX_PIXELS = 50_000_000  # of a picture; those of a run have two millions


def text(words: object) -> str:
    """Return words as text of a page."""
    return html.escape(str(words))


def paragraph(words: object, kind: str = "") -> str:
    """Return a paragraph, with the class ``kind``."""
    return f"<p{_class(kind)}>{text(words)}</p>"


def items(lines: Iterable[object]) -> str:
    """Return a list of lines; nothing without a line."""
    found = "".join(f"<li>{text(line)}</li>" for line in lines)
    return f"<ul>{found}</ul>" if found else ""


def table(heads: Sequence[object], rows: Iterable[Sequence[object]], kind: str = "") -> str:
    """Return a table that scrolls sideways where it is wider than the page; the first cell of a row is its head."""
    first_row = "".join(f'<th scope="col">{text(head)}</th>' for head in heads)
    lines = [f"<tr>{first_row}</tr>"]
    for first, *rest in rows:
        cells = "".join(f"<td>{text(cell)}</td>" for cell in rest)
        lines.append(f'<tr><th scope="row">{text(first)}</th>{cells}</tr>')
    return f'<div class="wide" tabindex="0"><table{_class(kind)}>{"".join(lines)}</table></div>'


def section(name: str, title: str, *parts: str) -> str:
    """Return a section with a place to link to; nothing without a part."""
    inside = "\n".join(filter(None, parts))
    return f'<section id="{name}"><h2>{text(title)}</h2>\n{inside}\n</section>' if inside else ""


def folded(title: str, *parts: str) -> str:
    """Return parts that a reader unfolds, also without JavaScript."""
    return f"<details><summary>{text(title)}</summary>\n{''.join(parts)}\n</details>"


def chart(name: str, words: str) -> str:
    """Return the place of a chart of the page's program, with words for those who do not see it."""
    return f'<div class="chart" id="{name}" role="img" aria-label="{html.escape(words)}"></div>'


def picture(file: Path, words: str) -> str:
    """Return a PNG file as a part of the page; a sentence where it cannot be read, and nothing without a file."""
    from PIL import Image  # comes with Matplotlib

    if not file.exists():
        return ""
    try:
        with Image.open(file, formats=("PNG",)) as drawn:
            if drawn.width * drawn.height > _MAX_PIXELS:
                raise ValueError
            out = BytesIO()
            drawn.convert("RGB").quantize(_COLOURS, dither=Image.Dither.NONE).save(out, "PNG", optimize=True)
            size = f'width="{drawn.width}" height="{drawn.height}"'
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError):
        return paragraph(f"{file.name} is left out: it is no picture of a run, or not a whole one.", "note")
    data = base64.b64encode(out.getvalue()).decode()
    caption = f"<figcaption>{text(words)}</figcaption>"
    shown = f'<img {size} alt="{html.escape(words)}" src="data:image/png;base64,{data}">'
    return f"<figure>{shown}{caption}</figure>"


def page(title: str, body: str, data: Mapping[str, Any]) -> str:
    """Return the file.

    Args:
        title: of the window.
        body: HTML.
        data: of the charts; ready for JSON.
    """
    here = resources.files("fingerpad.report")
    style, program, plotly = (
        (here / name).read_text(encoding="utf-8") for name in ("page.css", "page.js", "plotly.min.js")
    )
    inside = json.dumps(data, ensure_ascii=False, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,">
<title>{text(title)}</title>
<style>
{style}
</style>
</head>
<body>
<main>
{body}
</main>
<script type="application/json" id="data">{inside}</script>
<script>{plotly}</script>
<script>{program}</script>
</body>
</html>
"""


def _class(kind: str) -> str:
    return f' class="{kind}"' if kind else ""
