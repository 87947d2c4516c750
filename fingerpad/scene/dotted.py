"""Values of a scene by dotted key, as ``electric.d_i`` or ``history[0].f_ext``: what a sweep and a search vary."""

import re
from collections.abc import Mapping
from typing import Any

from fingerpad.scene import Scene, law_name
from fingerpad.scene.reading import plain, put


def with_values(scene: Scene, changes: Mapping[str, Any]) -> Scene:
    """Return the scene with other values by dotted key, as :meth:`Scene.replace` does."""
    data: dict[str, Any] = {}
    for key, value in sorted(changes.items(), key=lambda change: "[" not in change[0]):  # whole lists first
        table = re.split(r"[.\[]", key, maxsplit=1)[0]
        if "[" in key and table not in data:  # an entry of a list, of which the others stay
            data[table] = scene.parameters().get(table)
        put(data, key, plain(value))
    return scene.replace(**data)


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
