"""Changes of a scene: which keys they make meaningless, and the keys that a finger's name or an accuracy gives."""

from collections.abc import Mapping, Sequence
from dataclasses import is_dataclass
from typing import Any

from pydantic import BaseModel

from fingerpad.scene.fingers import ADULT, DEFAULTS, FINGERS
from fingerpad.scene.law_keys import keys_of
from geometry.parameters import Fingertip

DEFAULT_HISTORY = ("f_ext", "voltage", "slide_length")
"""Keys of the default loads, which a history replaces."""
_SHAPE = (*(name for name in Fingertip.model_fields if name != "sc_thickness"), "file_sha256")
REPLACED = {
    "history": (*DEFAULT_HISTORY, "force"),
    "force": ("f_ext",),
    "f_ext": ("force",),
    "slices.height": ("slices.radius", "slices.length"),
    "geometry.file": tuple(f"geometry.{name}" for name in _SHAPE),
}
"""Keys that another one makes meaningless: those of a finger's name, and of a scene that is changed, give way to it."""
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
    present = without_finger(present) if "finger" in changes else dict(present)
    if "accuracy" in changes and accuracy is not None:
        coarse = start(accuracy)
        present["mesh"] = {key: size for key, size in present.get("mesh", {}).items() if coarse.get(key) != size}
    no_mesh = {"geometry.file_sha256"} if "file" in (changes.get("geometry") or {}) else set[str]()
    for key in _replaced(changes) | no_mesh:
        if _at(present, key.split(".")) is not None:
            present = _put(present, key.split("."), None)
    return _merged(present, changes)


def _replaced(data: Mapping[str, Any]) -> set[str]:
    """Return the keys that others of nested tables make meaningless."""
    return {key for given, keys in REPLACED.items() if _at(data, given.split(".")) is not None for key in keys}


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


# -- fingers by name -----------------------------------------------------------------------------------
def with_finger(data: Mapping[str, Any], laws: Mapping[str, type]) -> tuple[Mapping[str, Any], list[str]]:
    """Return the data of a scene with the values of its finger, and the keys of these.

    A key that is given wins, and so does one that makes it meaningless (:data:`REPLACED`), or a law that is given as
    an object, of one's own, or without such a parameter.

    Args:
        data: nested tables.
        laws: of the package, by name.
    """
    name = data.get("finger")
    values = FINGERS[name].values if isinstance(name, str) and name in FINGERS else {}
    taken, found, gone = list[str](), data, _replaced(data)
    for key, value in values.items():
        parts = key.split(".")
        if key not in gone and _takes(found, parts, laws):
            found = _put(found, parts, value)
            taken.append(key)
    return found, taken


def forget(scene: BaseModel, given: Mapping[str, Any], keys: Sequence[str]) -> None:
    """Take keys that a finger gave off the set of those that were given, so that another finger gives its own.

    Args:
        scene: the scene.
        given: its data without those of the finger.
        keys: of the finger.
    """
    for key in keys:
        parts = key.split(".")
        table: Any = scene
        for depth, part in enumerate(parts, start=1):
            if isinstance(table, BaseModel) and _at(given, parts[:depth]) is None:
                table.__pydantic_fields_set__.discard(part)
            table = getattr(table, part)


def without_finger(data: Mapping[str, Any], laws: bool = True) -> dict[str, Any]:
    """Return the data of a scene without the values of its present finger.

    These are in the record of a run, which gives every key, and in tables of laws, which do not tell what was given.

    Args:
        data: nested tables.
        laws: whether values in tables of laws are left out, too, where the data are no record.
    """
    name = data.get("finger", ADULT)
    own = FINGERS[name].values if isinstance(name, str) and name in FINGERS else {}
    record = all(_at(data, key.split(".")) is not None for key in DEFAULTS if key.partition(".")[0] not in _PARTIAL)
    found: Mapping[str, Any] = dict(data)
    for key, value in {**DEFAULTS, **own}.items():
        parts = key.split(".")
        if (record or laws and parts[0] in ("roughness", "materials")) and _at(found, parts) == value:
            found = _put(found, parts, None)
    return dict(found)


_PARTIAL = ("geometry", "materials", "roughness")  # of which a record has other keys with a mesh or laws of one's own


def _takes(table: Any, parts: Sequence[str], laws: Mapping[str, type]) -> bool:
    """Return whether a value may be put at a place: nothing else stands there or on the way."""
    if not isinstance(table, Mapping):
        return False
    if len(parts) > 1:
        return _takes(table.get(parts[0], {}), parts[1:], laws)
    law = table.get("law")
    law = laws.get(law) if isinstance(law, str) else law
    known = "law" not in table or (isinstance(law, type) and is_dataclass(law) and parts[0] in keys_of(law))
    return known and parts[0] not in table


def _put(table: Mapping[str, Any], parts: Sequence[str], value: Any) -> dict[str, Any]:
    """Return nested tables with a value at a place; without it where it is None."""
    inner = value if len(parts) == 1 else _put(table.get(parts[0], {}), parts[1:], value)
    rest = {key: each for key, each in table.items() if key != parts[0]}
    return rest if inner is None else {**rest, parts[0]: inner}


def _at(table: Any, parts: Sequence[str]) -> Any:
    """Return the value at a place of nested tables, None where there is none."""
    for part in parts:
        table = table.get(part) if isinstance(table, Mapping) else None
    return table
