"""Every parameter of a scene with unit, value and source; how to run it again, and how to cite it."""

import json
import re
import shlex
from collections.abc import Container, Mapping
from typing import Any

from fingerpad.report.page import folded, paragraph, table, text
from fingerpad.scene import Scene, SceneError, override
from fingerpad.scene.reading import DEFAULT_MODEL, flat

PAPER = (
    "Forsbach, F., Heß, M., Papangelo, A. (2023). A two-scale FEM-BAM approach for fingerpad friction under "
    "electroadhesion. Frontiers in Mechanical Engineering. doi:10.3389/fmech.2022.1074393"
)


def changed(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters that are not those of the default scene, by dotted key."""
    default, given = (flat(json.loads(json.dumps(each))) for each in (Scene().parameters(), parameters))
    empty = {key for key, value in given.items() if value is None and key not in default}  # of a table that is given
    return {key: value for key, value in given.items() if key not in empty and default.get(key, ...) != value}


def all_of(parameters: Mapping[str, Any], varied: Container[str] = ()) -> str:
    """Return the table of every parameter; those that are not the default are marked.

    Args:
        parameters: of a scene.
        varied: keys without a value of their own, since a sweep varies them.
    """
    from fingerpad.scene.keys import every  # reads the docstrings of the models

    keys, other, rows = {key.name: key for key in every(Scene)}, changed(parameters), []
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
    given = {key: value for key, value in changed(parameters).items() if key != "model"}
    option = "" if model == DEFAULT_MODEL else f" --model {model}"
    if any("[" in key or isinstance(value, list) or value is None for key, value in given.items()):
        code = (
            'import fingerpad as fp\n\nscene = fp.Scene.load("scene.json")  # in this folder\n'
            f'fp.run(scene, model="{model}", out="results/again")'
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
