"""Tables 1 to 3: the default parameters as they stand in the code, which of them the paper gives, which are assumed."""

import ast
import inspect
import textwrap
from collections.abc import Iterator

from pydantic import BaseModel

from fingerpad.scene import Scene

_TABLES = {"geometry": "Table 1", "materials": "Table 2", "electric": "Table 3", "roughness": "Table 3"}
_ELSEWHERE = {
    "materials.exponent": "Eq. 1, as printed",
    "roughness.gamma": "Eq. 9",
    "roughness.beta": "Eq. 9",
}
ASSUMED = {
    f"geometry.{name}"
    for name in (
        *("ridge_profile", "ridge_count", "bone_width", "bone_height", "bone_centre", "nail_thickness"),
        *("nail_half_width", "nail_bed_half_width", "merkel_offset", "meissner_offset"),
    )
} | {"roughness.p_floor"}


def meanings(model: type[BaseModel]) -> dict[str, str]:
    """Return what stands below each field in its class; a field without a word of its own has none."""
    body = ast.parse(textwrap.dedent(inspect.getsource(model))).body[0]
    assert isinstance(body, ast.ClassDef)
    found = {}
    for field, after in zip(body.body, body.body[1:], strict=False):
        told = isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant)
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name) and told:
            found[field.target.id] = " ".join(str(after.value.value).split())  # type: ignore[attr-defined]
    return found


def rows(model: BaseModel, prefix: str) -> Iterator[tuple[str, str, str, str]]:
    """Yield key, default, source and meaning of every parameter of a table."""
    told = meanings(type(model))
    for name in type(model).model_fields:
        value, key = getattr(model, name), f"{prefix}.{name}"
        if isinstance(value, BaseModel):
            yield from rows(value, key)
            continue
        shown = f"{value:g}" if isinstance(value, int | float) else str(value)
        source = "*assumption*" if key in ASSUMED else _ELSEWHERE.get(key, _TABLES[key.partition(".")[0]])
        yield key, shown, source, told.get(name, name.replace("_", " "))


def tables() -> str:
    """Return the parameters as Markdown."""
    scene = Scene()
    parts = []
    for name, number in _TABLES.items():
        lines = ["| key | default (SI) | source | meaning |", "|---|---|---|---|"]
        lines += [
            f"| `{key}` | {value} | {source} | {told} |"
            for key, value, source, told in rows(getattr(scene, name), name)
        ]
        parts.append(f"### {number}: {name}\n\n" + "\n".join(lines))
    return "\n\n".join(parts)
