"""What the names of a scene give: keys of its finger and its accuracy, and keys that others make meaningless.

A scene keeps which keys were given. What its finger's name and its accuracy give (the presets) is put under them each
time, so that another name or accuracy gives its own.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import is_dataclass
from functools import reduce
from typing import Any

from fingerpad.scene.fingers import FINGERS, on_roughness
from fingerpad.scene.law_keys import keys_of
from geometry.parameters import Fingertip

DEFAULT_HISTORY = ("f_ext", "voltage", "slide_length")
"""Keys of the default loads, which a history replaces."""
_RECORD = ("geometry", "materials", "roughness", "electric", "slices", "output", "numerics")  # tables of every record
_SHAPE = (*(name for name in Fingertip.model_fields if name != "sc_thickness"), "file_sha256")
_REPLACED = {
    "history": (*DEFAULT_HISTORY, "force"),
    "force": ("f_ext",),
    "f_ext": ("force",),
    "slices.height": ("slices.radius", "slices.length"),
    "geometry.file": tuple(f"geometry.{name}" for name in _SHAPE),
}
"""Keys that another one makes meaningless: those of a preset, and of a scene that is changed, give way to it."""
_OF_MAP = ("h_rms", "wavelength")  # that a height map of the roughness gives
_START = {"contact": 20e-6, "receptor": 40e-6, "interface": 120e-6, "growth": 0.5}  # m, but for the growth
_START_AT_SITES = 10e-6  # m; coarser elements do not resolve the tips of 6 µm: halving them does not show the error


def start(tolerances: Mapping[str, Any]) -> dict[str, float]:
    """Return the element sizes (m) from which a scene with accuracies by quantity starts."""
    return _START | ({"receptor": _START_AT_SITES} if tolerances.get("sed") is not None else {})


def presets(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the finger and the accuracy of a scene give, by dotted key."""
    accuracy = data.get("accuracy")
    sizes = start(accuracy) if isinstance(accuracy, Mapping) and accuracy else {}
    return named(data) | {f"mesh.{key}": size for key, size in sizes.items()}


def named(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the finger of a scene gives by its name, by dotted key."""
    name = data.get("finger")
    return FINGERS[name].values_with(_closure(data)) if isinstance(name, str) and name in FINGERS else {}


def _closure(data: Mapping[str, Any]) -> str:
    """Return the closure of a scene in :data:`fingerpad.scene.fingers.AIR_GAP`, empty for one of one's own."""
    table = data.get("roughness") or {}
    if not isinstance(table, Mapping):
        return ""
    law = table.get("law", "BearingArea")
    return on_roughness(str(getattr(law, "__name__", law)), table.get("field_in_contact") is not False)


def with_presets(data: Mapping[str, Any], laws: Mapping[str, type]) -> Mapping[str, Any]:
    """Return the data of a scene with the values of its presets.

    A key that is given wins, and so does one that makes it meaningless (:data:`_REPLACED`), or a law that is given as
    an object, of one's own, or without such a parameter; ``laws`` has those of the package by name.
    """
    found, gone = data, set(_replaced(data))
    for key, value in presets(data).items():
        if key not in gone and _takes(found, key.split("."), laws):
            found = _put(found, key.split("."), value)
    return found


def preset_keys(data: Mapping[str, Any], laws: Mapping[str, type], default: Callable[[], Any]) -> list[str]:
    """Return the dotted keys for which a preset may stand: those that are not given.

    In the record of a run, which gives every key, they are those that have the default value or that of a preset.

    Args:
        data: nested tables.
        laws: of the package, by name.
        default: gives the default scene.
    """
    values = presets(data)
    keys = dict.fromkeys(key for finger in FINGERS.values() for key in finger.values) | values
    if any(data.get(name) is None for name in _RECORD):
        return [key for key in keys if _takes(data, key.split("."), laws)]
    scene = default()
    usual = {key: (values.get(key), reduce(getattr, key.split("."), scene)) for key in keys}
    return [key for key in keys if value_at(data, key) in usual[key]]


def without(data: Mapping[str, Any], keys: Sequence[str]) -> dict[str, Any]:
    """Return the data of a scene without some dotted keys."""
    found = dict(data)
    for key in keys:
        if value_at(found, key) is not None:
            found = _put(found, key.split("."), None)
    return found


def changed(present: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return the data of a scene with changes, without the keys that the changes make meaningless.

    Args:
        present: the keys that are given so far.
        changes: values by key, as for :meth:`fingerpad.scene.Scene.replace`.
    """
    no_mesh = ["geometry.file_sha256"] if "file" in (changes.get("geometry") or {}) else []
    return _merged(without(present, [*_replaced(changes), *no_mesh]), changes)


def _replaced(data: Mapping[str, Any]) -> Iterator[str]:
    """Yield the keys that others of nested tables make meaningless."""
    for given, keys in _REPLACED.items():
        yield from keys if value_at(data, given) is not None else ()


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


def _takes(table: Any, parts: Sequence[str], laws: Mapping[str, type]) -> bool:
    """Return whether a value may be put at a place: nothing else stands there or on the way."""
    if not isinstance(table, Mapping):
        return False
    if len(parts) > 1:
        return _takes(table.get(parts[0], {}), parts[1:], laws)
    law = table.get("law")
    law = laws.get(law) if isinstance(law, str) else law
    known = "law" not in table or (isinstance(law, type) and is_dataclass(law) and parts[0] in keys_of(law))
    of_map = "topography" in table and parts[0] in _OF_MAP
    return known and parts[0] not in table and not of_map


def _put(table: Mapping[str, Any], parts: Sequence[str], value: Any) -> dict[str, Any]:
    """Return nested tables with a value at a place; without it where it is None."""
    inner = value if len(parts) == 1 else _put(table.get(parts[0], {}), parts[1:], value)
    rest = {key: each for key, each in table.items() if key != parts[0]}
    return rest if inner is None else {**rest, parts[0]: inner}


def value_at(table: Any, key: str) -> Any:
    """Return the value at a dotted key of nested tables, None where there is none; a list as a tuple."""
    for part in key.split("."):
        table = table.get(part) if isinstance(table, Mapping) else None
    return tuple(table) if isinstance(table, list) else table
