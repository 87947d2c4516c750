"""A report from its templates (Jinja): one HTML file with its text, tables, parameters, pictures, style and script."""

import base64
import json
import re
import shlex
from collections.abc import Collection, Mapping
from functools import cache, reduce
from importlib.resources import files
from io import BytesIO
from operator import getitem
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from fingerpad.results.quantities import SYMBOL
from fingerpad.scene import Scene, changed_keys
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
    made.filters |= {"typeset": _typeset, "symbols": _symbols, "sentence": _sentence, "cell": _cell}
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


def _typeset(words: object) -> Markup:
    """Return words as text of a page: symbols with their subscripts, as d_eq, and no line that breaks in a value."""
    return Markup(_VALUE.sub("\u00a0", SYMBOL.sub(r"\1<sub>\2</sub>", str(escape(words)))))


def _symbols(words: object) -> Markup:
    """Return words as text of an SVG, with the subscripts of symbols."""
    lower, back = '<tspan dy="4" font-size="0.8em">', '<tspan dy="-4">&#8203;</tspan>'
    return Markup(SYMBOL.sub(rf"\1{lower}\2</tspan>{back}", str(escape(words))))


def _sentence(words: str) -> Markup:
    """Return a sentence with its first part, up to a bracket or a mark, in bold."""
    first = re.split(r"(?=[,;:]| \()", words, maxsplit=1)[0]
    return Markup(f"<b>{_typeset(first[0].upper() + first[1:])}</b>{_typeset(words[len(first) :])}.")


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


def recipe(of: Mapping[str, Any], model: str, axes: Mapping[str, list[Any]] | None = None, option: str = "") -> str:
    """Return a scene file and the command that repeats a run or a sweep with it.

    Args:
        of: parameters of the scene.
        model: that was used.
        axes: values of each key that is varied; None of a run.
        option: another one of the command.
    """
    over = axes or {}
    lines = scene_file(of, over)
    lines += ["[sweep]", *(f"{_toml(key)} = {_toml(values)}" for key, values in over.items())] if over else []
    named = "" if model == DEFAULT_MODEL else f"--model {shlex.quote(model)}"
    parts = (
        "fingerpad",
        "sweep" if over else "run",
        "mine.toml" if lines else "",
        named,
        option,
        "--out results/again",
    )
    words = " ".join(filter(None, parts))
    return "\n".join(["# mine.toml", *lines, "", "# the command", words] if lines else [words])


def scene_file(of: Mapping[str, Any], without: Collection[str] = ()) -> list[str]:
    """Return the lines of a scene file with the parameters of a scene that are not those of the default one."""
    lines = list[str]()
    for key in dict.fromkeys(name.partition("[")[0] for name in changed_keys(of)):  # a list as a whole
        value = reduce(getitem, key.split("."), of)
        if value is not None and key != "model" and key not in without:
            lines.append(f"{key} = {_toml(value)}")
    return lines


def _toml(value: Any) -> str:
    """Return a number, a switch, a text, or a list or a table of these as TOML."""
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{key} = {_toml(each)}' for key, each in value.items() if each is not None)}}}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_toml, value))}]"
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str | bool) else repr(value)
