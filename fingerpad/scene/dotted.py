"""Values of a scene by dotted key, as ``electric.d_i`` or ``history[0].f_ext``: what a sweep and a search vary."""

import re
from collections.abc import Mapping
from dataclasses import is_dataclass
from typing import Any

from fingerpad.scene import Scene, law_name
from fingerpad.scene.law_keys import keys_of, parameters
from fingerpad.scene.materials import CLOSURES, FRICTION_LAWS, MATERIALS
from fingerpad.scene.reading import plain, put
from variational.contact.friction import Coulomb


def with_values(scene: Scene, changes: Mapping[str, Any]) -> Scene:
    """Return the scene with other values by dotted key, as :meth:`Scene.replace` does.

    Where a key changes a law alone, as ``roughness.law``, parameters of the same name keep their values: the surface of
    another closure is the same one.
    """
    data: dict[str, Any] = {}
    for key, value in changes.items():
        if key.endswith(".law"):
            changes = _shared(scene, key.removesuffix(".law"), value) | dict(changes)
    for key, value in sorted(changes.items(), key=lambda change: "[" not in change[0]):  # whole lists first
        table = re.split(r"[.\[]", key, maxsplit=1)[0]
        if "[" in key and table not in data:  # an entry of a list, of which the others stay
            data[table] = scene.parameters().get(table)
        put(data, key, plain(value))
    return scene.replace(**data)


def _shared(scene: Scene, key: str, name: Any) -> dict[str, Any]:
    """Return the parameters of a key's law that another one has too, by dotted key."""
    try:
        present = value_of(scene, key)
    except (AttributeError, IndexError, TypeError):  # no such key, which the scene refuses
        return {}
    if key == "friction" and isinstance(present, float):
        present = Coulomb(present)
    kind = next((kind for kind in (MATERIALS, FRICTION_LAWS, CLOSURES) if isinstance(present, kind.base)), None)
    if kind is None or not is_dataclass(present):
        return {}
    try:
        keys = keys_of(kind.find(name))
    except ValueError:  # the scene refuses it
        return {}
    return {f"{key}.{each}": value for each, value in parameters(present).items() if each in keys}


def value_of(scene: Scene, key: str) -> Any:
    """Return the value of a dotted key in SI; of the key ``law`` of a law's table the law's name."""
    value: Any = scene
    for part, place in re.findall(r"(\w+)|\[(\d+)\]", key):
        if part == "law" and not hasattr(value, "law"):
            return law_name(value)
        if part == "mu_f" and isinstance(value, float):  # of Coulomb's law, which a scene keeps as this number
            return value
        value = getattr(value, part) if part else value[int(place)]
    return value
