"""Changes of a scene: which keys they make meaningless, and the coarse start of a scene with an accuracy."""

from collections.abc import Mapping
from typing import Any

DEFAULT_HISTORY = ("f_ext", "voltage", "slide_length")
"""Keys of the default loads, which a history replaces."""
_START = {"contact": 20e-6, "receptor": 40e-6, "interface": 120e-6, "growth": 0.5}  # m, but for the growth
_START_AT_SITES = 10e-6  # m; coarser elements do not resolve the tips of 6 µm: halving them does not show the error


def changed(
    present: Mapping[str, Any], accuracy: Mapping[str, float] | None, changes: Mapping[str, Any]
) -> dict[str, Any]:
    """Return the data of a scene with changes, without the keys that the changes make meaningless.

    Args:
        present: the keys that are given so far.
        accuracy: the present tolerances by quantity; None without any.
        changes: values by key, as for :meth:`fingerpad.scene.Scene.replace`.
    """
    present = dict(present)
    if "accuracy" in changes and accuracy is not None:
        coarse = start(accuracy)
        present["mesh"] = {key: size for key, size in present.get("mesh", {}).items() if coarse.get(key) != size}
    replaced = {"history": (*DEFAULT_HISTORY, "force"), "force": ("f_ext",), "f_ext": ("force",)}
    gone = {other for key, others in replaced.items() if changes.get(key) is not None for other in others}
    present = {key: value for key, value in present.items() if key not in gone}
    shape = changes.get("geometry")
    if isinstance(shape, Mapping) and "file" in shape:
        present["geometry"] = {k: value for k, value in present.get("geometry", {}).items() if k != "file_sha256"}
    return _merged(present, changes)


def _merged(present: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return a table with changes: tables are merged, all else is replaced."""
    found = dict(present)
    for key, value in changes.items():
        before = found.get(key)
        both = isinstance(value, Mapping) and isinstance(before, Mapping) and _same_law(before, value.get("law"))
        found[key] = _merged(before, value) if both else value  # type: ignore[arg-type]
    return found


def _same_law(present: Mapping[str, Any], name: Any) -> bool:
    """Return whether changes of a table are not of another law than the table's."""
    kind = present.get("law")
    names = (f"{kind.__module__}:{kind.__qualname__}", kind.__name__) if isinstance(kind, type) else ()
    return name in (None, kind, *names)


def with_coarse_start(data: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return the data of a scene; with an accuracy, sizes that are not given are those of :func:`start`."""
    mesh, accuracy = data.get("mesh", {}), data.get("accuracy")
    if not (isinstance(mesh, dict) and isinstance(accuracy, dict) and accuracy):
        return data
    return {**data, "mesh": start(accuracy) | mesh}


def start(asked: Mapping[str, Any]) -> dict[str, float]:
    """Return the element sizes from which a scene starts that asks for accuracies by quantity."""
    return _START | ({"receptor": _START_AT_SITES} if asked.get("sed") is not None else {})
