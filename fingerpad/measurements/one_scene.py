"""Whether runs are of one scene and model, but for their force and voltage; no dolfinx."""

import os
import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from fingerpad.scene import as_kept
from fingerpad.scene.messages import SceneError, clip, show

if TYPE_CHECKING:
    from fingerpad.io.result import Result

_FREE = re.compile(
    r"(history\[\d+\]\.)?(f_ext|force|voltage)"  # the conditions of a measurement,
    r"|history\[\d+\]\.(bone_height|name)"  # the force by another control, and a word for it,
    r"|output\.(errors|each_load|receptors)|numerics\.memory"  # and what changes no value
)
_MOST = 50  # characters of a folder


class _Difference(NamedTuple):
    key: str
    one: Any
    other: Any


def refuse_mixed(runs: Sequence["Result"]) -> None:
    """Refuse runs that differ in more than force and voltage: their values are no function of the two.

    Raises:
        SceneError: the first key that differs, its two values and the two folders.
    """
    for run in runs[1:]:
        if found := _difference(_conditions(runs[0]), _conditions(run)):
            raise SceneError(
                f"{found.key} is {_shown(found.one)} in {folder(runs[0])} and {_shown(found.other)} in {folder(run)}; "
                "give runs that differ in force and voltage alone"
            )


def folder(run: "Result") -> str:
    """Return the folder of a run for a message: its end, where it is long."""
    if run.folder is None:
        return "a run"
    name = min(str(run.folder), os.path.relpath(run.folder), key=len)
    name = name if len(name) <= _MOST else "..." + name[3 - _MOST :]
    return clip(name, _MOST)


def _conditions(run: "Result") -> dict[str, Any]:
    """Return the model of a run and every key of its scene."""
    kept = run.record.get("parameters") or run.scene.parameters()
    scene = as_kept(kept)
    return {"model": run.model} | scene.model_dump(mode="json")


def _difference(one: Any, other: Any, key: str = "") -> _Difference | None:
    """Return the first key under a key whose values differ and may not; None where there is none."""
    if _FREE.fullmatch(key) or one == other:
        return None
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        names = [(name, f"{key}.{name}".lstrip(".")) for name in dict.fromkeys([*one, *other])]
        parts = (_difference(one.get(name), other.get(name), inner) for name, inner in names)
    elif isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        pairs = enumerate(zip(one, other, strict=True))
        parts = (_difference(*pair, f"{key}[{k}]") for k, pair in pairs)
    else:
        return _Difference(key, one, other)
    return next((part for part in parts if part), None)


def _shown(value: Any) -> str:
    """Return a value for a message; tables and lists by their size."""
    if value is None:
        return "not given"
    if isinstance(value, list | Mapping):
        kind = "list" if isinstance(value, list) else "table"
        return f"a {kind} of {len(value)}"
    return clip(show(value), 40)
