"""Scenes: everything a run needs, checked, from Python, TOML or the command line, and their values by dotted key."""

import re
from collections.abc import Mapping
from typing import Any

from fingerpad.scene import law_keys
from fingerpad.scene.loads import Load
from fingerpad.scene.materials import ADHESION_LAWS, CLOSURES, FRICTION_LAWS, MATERIALS
from fingerpad.scene.messages import SceneError
from fingerpad.scene.parameters import CONTACT, Accuracy, Contact, Numerics, Output
from fingerpad.scene.presets import start
from fingerpad.scene.reading import override, plain, put
from fingerpad.scene.scene import Scene, as_kept, changed_keys, from_data, load
from variational.contact.friction import Coulomb

_KINDS = (MATERIALS, FRICTION_LAWS, ADHESION_LAWS, CLOSURES, CONTACT.kind)


def law_name(law: object) -> str:
    """Return the name of a law, or its import path where it is one of a user's own."""
    return next(kind.name(type(law)) for kind in _KINDS if isinstance(law, kind.base))


def laws_by_name() -> dict[str, type]:
    """Return the laws of the package by the names of their classes."""
    return {law.__name__: law for kind in _KINDS for law in kind.laws.values()}


def with_values(scene: Scene, changes: Mapping[str, Any]) -> Scene:
    """Return the scene with other values by dotted key, as :meth:`Scene.replace` does.

    Where a key changes a law alone, as ``roughness.law``, parameters of the same name keep their values: the surface of
    another closure is the same one.
    """
    data: dict[str, Any] = {}
    for key in [key for key in changes if key.endswith(".law")]:
        changes = _shared(scene, key.removesuffix(".law"), changes[key]) | dict(changes)
    for key, value in sorted(changes.items(), key=lambda change: "[" not in change[0]):  # whole lists first
        table = re.split(r"[.\[]", key, maxsplit=1)[0]
        if "[" in key and table not in data:  # an entry of a list, of which the others stay
            data[table] = scene.parameters().get(table)
        put(data, key, plain(value))
    return scene.replace(**data)


def _shared(scene: Scene, key: str, name: Any) -> dict[str, Any]:
    """Return the parameters of a key's law that another one has too, by dotted key."""
    try:
        law = value_of(scene, key)
        law = Coulomb(law) if key == "friction" and isinstance(law, float) else law
        keys = law_keys.keys_of(next(kind for kind in _KINDS if isinstance(law, kind.base)).find(name))
    except (AttributeError, IndexError, TypeError, ValueError, StopIteration):  # the scene refuses the change
        return {}
    return {f"{key}.{each}": value for each, value in law_keys.parameters(law).items() if each in keys}


def value_of(scene: Scene, key: str) -> Any:
    """Return the value of a dotted key in SI; of the key ``law`` of a law's table the law's name."""
    found: Any = scene
    for part, place in re.findall(r"(\w+)|\[(\d+)\]", key):
        if part in ("law", "mu_f") and isinstance(found, float):  # of Coulomb's law, which a scene keeps as this number
            found = Coulomb(found)
        if part == "law" and not hasattr(found, "law"):
            return law_name(found)
        found = getattr(found, part) if part else found[int(place)]
    return found


__all__ = [
    "Accuracy",
    "Contact",
    "Load",
    "Numerics",
    "Output",
    "Scene",
    "SceneError",
    "as_kept",
    "changed_keys",
    "from_data",
    "law_name",
    "laws_by_name",
    "load",
    "override",
    "start",
    "value_of",
    "with_values",
]
