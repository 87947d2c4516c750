"""One HTML file from its parts: text, tables, parameters, pictures and charts, with style, data and programs inside."""

import base64
import html
import json
import re
import shlex
from collections.abc import Container, Iterable, Mapping, Sequence
from importlib import resources
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fingerpad.results.quantities import SYMBOL
from fingerpad.scene import Scene, SceneError, changed_keys, override
from fingerpad.scene.reading import DEFAULT_MODEL, flat
from variational.files import read

if TYPE_CHECKING:
    from PIL.Image import Image

_COLOURS = 128  # of a picture's palette; the pictures have fewer hues, and a third of the bytes is left
_MAX_PIXELS = 50_000_000  # of a picture; those of a run have two millions
PAPER = (
    "Forsbach, F., Heß, M., Papangelo, A. (2023). A two-scale FEM-BAM approach for fingerpad friction under "
    "electroadhesion. Frontiers in Mechanical Engineering. doi:10.3389/fmech.2022.1074393"
)
GOOD, CARE, BAD = "holds", "care", "fails"
MARKS = {GOOD: "✓ holds", CARE: "! care", BAD: "✗ fails"}
"""Verdicts as they are shown."""
_UNITS = r"[kM]?Pa|k?N|N/m|k?J/m³?|[kM]?Hz|k?V|[mµ]?m²?|[mµ]?s|MB|%"
_VALUE = re.compile(rf"(?<=\d) (?=(?:±|{_UNITS})(?!\w))|(?<=[±=>]) (?=[−-]?\d)|(?<=[\w>]) (?==)")


def text(words: object) -> str:
    """Return words as text of a page, letter by letter, as of code and of drawings."""
    return html.escape(str(words))


def typeset(words: object) -> str:
    """Return words as text of a page: symbols with their subscripts, as d_eq, and no line that breaks in a value."""
    return _VALUE.sub("\u00a0", SYMBOL.sub(r"\1<sub>\2</sub>", text(words)))


def paragraph(words: object, kind: str = "") -> str:
    """Return a paragraph, with the class ``kind``."""
    return f"<p{_class(kind)}>{typeset(words)}</p>"


def banner(
    what: str, folder: Path | None, sentence: str, number: str, said: str, kind: str, words: str, claims: str = ""
) -> str:
    """Return the head of a page, whose first line is the finding.

    Args:
        what: the page is.
        folder: of the results.
        sentence: the finding.
        number: of it, HTML; empty without one.
        said: of what the number is.
        kind: the verdict.
        words: of the verdict, HTML.
        claims: how far the number is solved and known, HTML.
    """
    where = "" if folder is None else f" · {text(folder.resolve().name)}"
    shown = f'<p class="number">{number} <span class="said">{typeset(said)}</span></p>' if number else ""
    shown = shown or (paragraph(said, "said") if said else "")
    return (
        f'<header><h1>{typeset(sentence)}</h1>{shown}{claims}<p class="verdict {kind}"><b>{MARKS[kind]}</b> {words}</p>'
        f'<p class="kind">fingerpad · {what}{where}</p></header>'
    )


def claims(sentences: Iterable[str], figure: str) -> str:
    """Return sentences on how far a number is solved and known, in bold up to a bracket or a mark, and a figure."""
    lines = list[str]()
    for each in sentences:
        first = re.split(r"(?=[,;:]| \()", each, maxsplit=1)[0]
        lines.append(f"<p><b>{typeset(first[0].upper() + first[1:])}</b>{typeset(each[len(first) :])}.</p>")
    return f'<div class="claims"><div>{"".join(lines)}</div>{figure}</div>' if lines else ""


def items(lines: Iterable[object]) -> str:
    """Return a list of lines; nothing without a line."""
    found = "".join(f"<li>{typeset(line)}</li>" for line in lines)
    return f"<ul>{found}</ul>" if found else ""


def table(heads: Sequence[object], rows: Iterable[Sequence[object]], kind: str = "") -> str:
    """Return a table that scrolls sideways where it is wider than its place; the first cell of a row is its head."""
    first_row = "".join(f'<th scope="col">{typeset(head)}</th>' for head in heads)
    lines, name = [f"<tr>{first_row}</tr>"], text if kind == "parameters" else typeset
    for first, *rest in rows:
        cells = "".join(f"<td>{typeset(cell)}</td>" for cell in rest)
        lines.append(f'<tr><th scope="row">{name(first)}</th>{cells}</tr>')
    return f'<div class="wide" tabindex="0"><table{_class(kind)}>{"".join(lines)}</table></div>'


def section(name: str, title: str, *parts: str) -> str:
    """Return a section with a place to link to; nothing without a part."""
    inside = "\n".join(filter(None, parts))
    return f'<section id="{name}"><h2>{typeset(title)}</h2>\n{inside}\n</section>' if inside else ""


def first(finding: str, shown: str) -> str:
    """Return the first screen: the finding, and beside or below it what is shown; the finding alone without that."""
    return f'<div class="first"><div class="finding">{finding}</div>{shown}</div>' if shown else finding


def beside(sections: Iterable[str]) -> str:
    """Return sections beside each other where a window is wide enough for two."""
    return f'<div class="beside">{"".join(sections)}</div>'


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
        content = read(file)
        with Image.open(BytesIO(content), formats=("PNG",)) as drawn:
            if drawn.width * drawn.height > _MAX_PIXELS:
                raise ValueError
            drawn.load()
            size = f'width="{drawn.width}" height="{drawn.height}"'
            found = _as_it_is(content, drawn) or _of_few_colours(drawn)
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError):
        return paragraph(f"{file.name} is left out: it is no picture of a run, or not a whole one.", "note")
    data = base64.b64encode(found).decode()
    caption = f"<figcaption>{typeset(words)}</figcaption>"
    shown = f'<img {size} alt="{html.escape(words)}" src="data:image/png;base64,{data}">'
    return f"<figure>{shown}{caption}</figure>"


def _as_it_is(content: bytes, drawn: "Image") -> bytes:
    """Return a file of a palette, as a run writes it; nothing of one that holds more than its pixels."""
    return content if drawn.mode == "P" and len(content) <= drawn.width * drawn.height else b""


def _of_few_colours(drawn: "Image") -> bytes:
    """Return a picture of all colours, as of an earlier version, as a PNG file with a palette."""
    from PIL.Image import Dither

    out = BytesIO()
    drawn.convert("RGB").quantize(_COLOURS, dither=Dither.NONE).save(out, "PNG", optimize=True)
    return out.getvalue()


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


# -- parameters: how to run it again, and how to cite it ------------------------------------------------
def all_parameters(parameters: Mapping[str, Any], varied: Container[str] = ()) -> str:
    """Return the table of every parameter; those that are not the default are marked.

    Args:
        parameters: of a scene.
        varied: keys without a value of their own, since a sweep varies them.
    """
    from fingerpad.scene.keys import by_name  # reads the docstrings of the models

    keys, other, rows = by_name(Scene), changed_keys(parameters), []
    for name, value in flat(parameters).items():
        key = keys.get(re.sub(r"\[\d+\]", "[]", name))
        shown = "varied" if name in varied else _shown(value)
        of = "the sweep" if name in varied else "this scene" if name in other else "default"
        rows.append((name, shown, key.unit if key else "", of, key.meaning if key else ""))
    heads = ("key", "value", "unit", "chosen by", "meaning and source")
    note = "SI units. Without another source a default is the paper's; “Assumption” marks a choice that it leaves open."
    return folded(f"All {len(rows)} parameters", paragraph(note), table(heads, rows, "parameters"))


def again(parameters: Mapping[str, Any], model: str) -> str:
    """Return how a run is repeated.

    Args:
        parameters: of its scene.
        model: that was used.
    """
    given = {key: value for key, (value, _) in changed_keys(parameters).items() if key != "model"}
    option = "" if model == DEFAULT_MODEL else f" --model {shlex.quote(model)}"
    if any("[" in key or isinstance(value, list) or value is None for key, value in given.items()):
        code = (
            'import fingerpad as fp\n\nscene = fp.Scene.load("scene.json")  # in this folder\n'
            f'fp.run(scene, model={json.dumps(model)}, out="results/again")'
        )
        return f"<pre><code>{text(code)}</code></pre>"
    options = "".join(f" {option_of(key, value)}" for key, value in given.items())
    return f"<pre><code>{text(f'fingerpad run{options}{option} --out results/again')}</code></pre>"


def cite(version: str) -> str:
    """Return what is cited.

    Args:
        version: of the program that computed the results; empty where it is not known.
    """
    name = f"fingerpad {version}" if version else "fingerpad"
    return paragraph("Please cite the program with its version, and the paper whose model it implements:") + (
        f"<blockquote>{text(name)}: two-scale finite element model of a fingertip under electroadhesion.</blockquote>"
        f"<blockquote>{text(PAPER)}</blockquote>"
    )


def option_of(key: str, value: Any, option: str = "--set") -> str:
    """Return a key and its value as an option of a command line, quoted for a shell.

    Args:
        key: a dotted key.
        value: a number, a switch, a text or a list of these; of another option than ``--set``, its text as it stands.
        option: which takes ``KEY=VALUE``.
    """
    shown = value if option != "--set" else _bare(value) if isinstance(value, str) else toml(value)
    return f"{option} {shlex.quote(f'{key}={shown}')}"


def toml(value: Any) -> str:
    """Return a number, a switch, a text or a list of these as TOML."""
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(toml, value))}]"
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str | bool) else repr(value)


def _bare(text: str) -> str:
    """Return a text as ``--set`` reads it: without quotation marks, where it would be nothing else without them."""
    try:
        return text if override(f"key={text}")[1] == text else toml(text)
    except SceneError:
        return toml(text)


def _shown(value: Any) -> str:
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
