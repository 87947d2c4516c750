"""A report from its templates (Jinja): one HTML file with its text, tables, parameters, pictures, style and script."""

import base64
import json
import re
import shlex
from collections.abc import Collection, Mapping
from functools import cache
from importlib.resources import files
from io import BytesIO
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from fingerpad.results.quantities import SYMBOL
from fingerpad.scene import Scene, SceneError, changed_keys, override
from fingerpad.scene.keys import by_name
from fingerpad.scene.reading import DEFAULT_MODEL, flat
from variational.files import read

_MAX_PIXELS = 50_000_000  # of a picture; those of a run have two millions
_QUALITY = 80  # of WebP, of 100
GOOD, CARE, BAD = "holds", "care", "fails"
"""Verdicts."""
_UNITS = r"[kM]?Pa|k?N|N/m|k?J/m³?|[kM]?Hz|k?V|[mµ]?m²?|[mµ]?s|MB|%"
_VALUE = re.compile(rf"(?<=\d) (?=(?:±|{_UNITS})(?!\w))|(?<=[±=>]) (?=[−-]?\d)|(?<=[\w>]) (?==)")


@cache
def _environment() -> Environment:
    made = Environment(
        loader=PackageLoader("fingerpad", "report"), autoescape=True, trim_blocks=True, undefined=StrictUndefined
    )
    made.filters |= {"typeset": typeset, "symbols": _symbols, "sentence": _sentence, "cell": _cell}
    return made


def render(template: str, **values: Any) -> Markup:
    """Return a template of this folder with its values filled in."""
    return Markup(_environment().get_template(template).render(values))


def page(template: str, title: str, **values: Any) -> str:
    """Return the file of a page.

    Args:
        template: of its body, whose sections have a name for the navigation.
        title: of the window.
        values: of the template.
    """
    body = str(render(template, **values))
    links = re.findall(r'<section id="([\w-]+)" data-link="(\w+)"', body)
    body = body.replace("<nav></nav>", render("nav.html", links=links), 1)
    style, script = (
        Markup((files("fingerpad.report") / name).read_text(encoding="utf-8")) for name in ("page.css", "page.js")
    )
    return str(render("base.html", title=title, body=Markup(body), style=style, script=script))


def typeset(words: object) -> Markup:
    """Return words as text of a page: symbols with their subscripts, as d_eq, and no line that breaks in a value."""
    return Markup(_VALUE.sub("\u00a0", SYMBOL.sub(r"\1<sub>\2</sub>", str(escape(words)))))


def _symbols(words: object) -> Markup:
    """Return words as text of an SVG, with the subscripts of symbols."""
    lower, back = '<tspan dy="4" font-size="0.8em">', '<tspan dy="-4">&#8203;</tspan>'
    return Markup(SYMBOL.sub(rf"\1{lower}\2</tspan>{back}", str(escape(words))))


def _sentence(words: str) -> Markup:
    """Return a sentence with its first part, up to a bracket or a mark, in bold."""
    first = re.split(r"(?=[,;:]| \()", words, maxsplit=1)[0]
    return Markup(f"<b>{typeset(first[0].upper() + first[1:])}</b>{typeset(words[len(first) :])}.")


def _cell(value: Any) -> str:
    """Return the value of a parameter as a table has it."""
    if value is None:
        return "–"
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def picture(file: Path) -> str:
    """Return a PNG file as a link that holds a WebP image; empty where it is no picture of a run, or not whole."""
    from PIL import Image  # comes with Matplotlib

    try:
        with Image.open(BytesIO(read(file)), formats=("PNG",)) as drawn:
            if drawn.width * drawn.height > _MAX_PIXELS:
                return ""
            return linked(drawn.convert("RGB"))
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError):
        return ""


def linked(image: Any) -> str:
    """Return an image of PIL as a link that holds it."""
    out = BytesIO()
    image.save(out, "WEBP", quality=_QUALITY)
    return f"data:image/webp;base64,{base64.b64encode(out.getvalue()).decode()}"


# -- parameters and how to repeat a run -------------------------------------------------------------------
def parameters(of: Mapping[str, Any], varied: Collection[str] = ()) -> list[tuple[str, str, str, str, str]]:
    """Return a row for each parameter of a scene: key, value, unit, who chose it, and its meaning.

    Args:
        of: parameters of a scene.
        varied: keys without a value of their own, since a sweep varies them.
    """
    keys, other, rows = by_name(Scene), changed_keys(of), []
    for name, value in flat(of).items():
        key = keys.get(re.sub(r"\[\d+\]", "[]", name))
        by = "the sweep" if name in varied else "this scene" if name in other else "default"
        shown = "varied" if name in varied else _cell(value)
        rows.append((name, shown, key.unit if key else "", by, key.meaning if key else ""))
    return rows


def again(of: Mapping[str, Any], model: str) -> str:
    """Return the command that repeats a run, or Python where its scene does not fit on a command line.

    Args:
        of: parameters of its scene.
        model: that was used.
    """
    given = {key: value for key, (value, _) in changed_keys(of).items() if key != "model"}
    if any("[" in key or isinstance(value, list) or value is None for key, value in given.items()):
        return (
            'import fingerpad as fp\n\nscene = fp.Scene.load("scene.json")  # in this folder\n'
            f'fp.run(scene, model={json.dumps(model)}, out="results/again")'
        )
    options = [option_of(key, value) for key, value in given.items()]
    return " ".join(["fingerpad run", *options, *model_option(model), "--out results/again"])


def model_option(model: str) -> list[str]:
    """Return the option of a model; none of the default one."""
    return [] if model == DEFAULT_MODEL else [f"--model {shlex.quote(model)}"]


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
